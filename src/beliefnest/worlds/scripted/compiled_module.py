"""Machine code of the interpreter of programs, compiled once for each machine and version."""

import atexit
import hashlib
import os
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

__all__ = ["Compiled", "compiled"]

_RESERVED = 96 << 20
"""Addresses reserved for the memory of an interpreter, which is never larger."""


@dataclass(frozen=True, slots=True)
class Compiled:
    """Module, compiled for this machine.

    Attributes:
        engine: Wasmtime's engine.
        module: The module.
        imports: Names of what it imports, with their types, in order.
        start: Name of the function that runs the constructors.
    """

    engine: Any
    module: Any
    imports: tuple[tuple[str, Any], ...]
    start: str


@cache
def compiled(file: Path) -> Compiled:
    """Return the module of a file."""
    import wasmtime  # Import here: it takes 100 ms, and most nests run no such program.

    # Wasmtime's objects must be gone before Python takes its modules apart.
    atexit.register(compiled.cache_clear)
    config = wasmtime.Config()
    # Traps are checked by code and not by signals, whose handlers belong to the user's process.
    config.signals_based_traps = False
    config.memory_reservation = _RESERVED
    config.memory_guard_size = 0
    # Threads of a parallel compilation would be missing after a fork.
    config.parallel_compilation = False
    engine = wasmtime.Engine(config)
    source = file.read_bytes()
    name = f"{hashlib.sha256(source).hexdigest()[:16]}.cwasm"
    for folder in _folders():
        kept = folder / name
        try:
            return _described(engine, wasmtime.Module.deserialize_file(engine, str(kept)))
        except wasmtime.WasmtimeError:
            # Absent, damaged, or of another processor.
            continue
    module = wasmtime.Module(engine, source)
    _keep(bytes(module.serialize()), name)
    return _described(engine, module)


def _described(engine: Any, module: Any) -> Compiled:
    imports = tuple((str(each.name), each.type) for each in module.imports)
    # Emscripten exports the constructors of the module first.
    return Compiled(engine, module, imports, module.exports[0].name)


def _folders() -> Iterator[Path]:
    """Yield the folders in which machine code may be kept, the best first."""
    from importlib.metadata import version

    from platformdirs import user_cache_path

    yield user_cache_path("beliefnest", appauthor=False) / f"wasmtime-{version('wasmtime')}"


def _keep(code: bytes, name: str) -> None:
    """Write machine code into the first folder that takes it, if one does."""
    for folder in _folders():
        try:
            folder.mkdir(parents=True, exist_ok=True)
            handle, written = tempfile.mkstemp(dir=folder)
            with os.fdopen(handle, "wb") as stream:
                stream.write(code)
            Path(written).replace(folder / name)
        except OSError:
            continue
        return
