"""Machine code of the interpreter of programs, compiled once for each machine and version."""

import atexit
import hashlib
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import msgspec

from beliefnest.files import read_regular, replace_file

_DIGEST = hashlib.sha256().digest_size
_RESERVED = 96 << 20
"""Addresses reserved for the memory of an interpreter, which is never larger."""


class Compiled(msgspec.Struct, frozen=True):
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
    kept = _folder() / name
    code = _kept(kept)
    if code is not None:
        with suppress(wasmtime.WasmtimeError):  # It is of another processor.
            return _described(engine, wasmtime.Module.deserialize(engine, code))
    module = wasmtime.Module(engine, source)
    code = bytes(module.serialize())
    # Where nothing can be kept, each process compiles.
    with suppress(OSError):
        kept.parent.mkdir(parents=True, exist_ok=True)
        replace_file(kept, hashlib.sha256(code).digest() + code)
    return _described(engine, module)


def _kept(file: Path) -> bytes | None:
    """Return machine code that was kept in a file; None if it is not there, or is damaged."""
    try:
        content = read_regular(file)
    except OSError:
        return None
    digest, code = content[:_DIGEST], content[_DIGEST:]
    return code if hashlib.sha256(code).digest() == digest else None


def _described(engine: Any, module: Any) -> Compiled:
    imports = tuple((str(each.name), each.type) for each in module.imports)
    # Emscripten exports the constructors of the module first.
    return Compiled(engine, module, imports, module.exports[0].name)


def _folder() -> Path:
    """Return the folder in which machine code is kept."""
    from importlib.metadata import version

    from platformdirs import user_cache_path

    return user_cache_path("beliefnest", appauthor=False) / f"wasmtime-{version('wasmtime')}"
