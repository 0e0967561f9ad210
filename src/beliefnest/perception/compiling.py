"""Compilation of kernels by numba, and the folder that keeps their machine code.

A kernel is compiled when it is first called. Its machine code is then stored in the user's cache
folder, under the digest of all that it was made from. So any environment of this user that has
the same kernel finds it, wherever the package is installed, and versions do not overwrite each
other. Numba itself distinguishes processors and types of arguments within such a file.
"""

import functools
import gc
import os
import time
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from enum import EnumType
from hashlib import blake2b
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, TypeVar, cast

import numba
from numba.core import caching
from numba.core.runtime.nrt import rtsys

from beliefnest.locking import LockHeldError, ProcessLock
from beliefnest.perception.instead import INSTEAD
from beliefnest.perception.sealed_files import DamagedFileError, SealedFiles

F = TypeVar("F", bound=Callable[..., Any])

_KERNEL: dict[str, Any] = {"nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}
# Numba's reference counting is off: its atomic operations at each use of an array took two thirds
# of a tick and a fifth of the compilation. The caller of a kernel keeps the arrays alive.
_BORROWING: dict[str, Any] = {**_KERNEL, "_nrt": False}
# Kernels that only kernels call need no wrapper for Python, which would double their compilation.
_INNER: dict[str, Any] = {"no_cpython_wrapper": True}

# Damaged files, and those of a version whose types of arguments have other names.
_UNREADABLE = (OSError, DamagedFileError, AttributeError, ImportError)
_FORM = "sealed"
"""Form of the files; it distinguishes them from those of earlier versions."""
_PATIENCE = 300.0
"""Seconds to wait for another process that compiles the same kernel."""
_LOOK = 0.05


class KernelWarning(UserWarning):
    """Warning that kernels are compiled although that was done before."""


def compiled(function: F) -> F:
    """Compile a kernel on first use and store its code; the kernel must not allocate arrays.

    A process that can write to no folder (see `kernel_folder`) compiles for itself.
    """
    return _kept(function, _BORROWING)


def allocating(function: F) -> F:
    """Compile as `compiled` does, for a kernel that allocates arrays."""
    return _kept(function, _KERNEL)


def inner(function: F) -> F:
    """Compile as `compiled` does, for a kernel that only kernels call."""
    return _kept(function, _BORROWING | _INNER)


def inlined(function: F) -> F:
    """Let LLVM inline a kernel into each of its callers; the kernel must not allocate arrays."""
    return _jit(function, _BORROWING | _INNER | {"forceinline": True})


def merged(function: F) -> F:
    """Merge a kernel into its only caller before compilation; it must not allocate arrays.

    Numba inserts the code into the caller, which saves most of the compilation time of the
    kernel. With several callers `inlined` compiles faster.
    """
    return _jit(function, _BORROWING | _INNER | {"inline": "always"})


def inlined_allocating(function: F) -> F:
    """Inline as `inlined` does, for a kernel that allocates arrays."""
    return _jit(function, _KERNEL | _INNER | {"forceinline": True})


def is_compiled(function: Callable[..., object]) -> bool:
    """Return True if a kernel of `compiled` needs no compilation: done before, or stored."""
    kernel: Any = function
    if not hasattr(kernel, "py_func") or kernel.signatures:
        return True
    cache = _cache_of(kernel)
    return cache is not None and cache.holds_any(kernel.targetctx)


def kernel_folder(function: Callable[..., object]) -> Path | None:
    """Return the folder that keeps the machine code of a kernel; None: no folder is writable.

    It is the first writable one of: the folder that NUMBA_CACHE_DIR names, the user's cache
    folder, and `__pycache__` beside the source.
    """
    cache = _cache_of(function) if hasattr(function, "py_func") else None
    return None if cache is None else Path(cache.cache_path)


def _kept(function: F, options: dict[str, Any]) -> F:
    kernel = _jit(function, options)
    if not getattr(numba.config, "DISABLE_JIT", False):
        cast(Any, kernel).compile = _shared(kernel)
    return kernel


def _cache_of(kernel: Any) -> "_Cache | None":
    """Return the cache of a kernel, made on first use; None: there is no writable folder.

    When a kernel is defined, those that it calls and that stand below it are not: its digest would
    lack them.
    """
    if not isinstance(kernel._cache, _Cache):
        with suppress(RuntimeError):
            kernel._cache = _Cache(kernel)
    return kernel._cache if isinstance(kernel._cache, _Cache) else None


def _jit(function: F, options: dict[str, Any]) -> F:
    kernel: Any = numba.njit(**options)(function)
    # With NUMBA_DISABLE_JIT numba returns the function itself.
    if not getattr(numba.config, "DISABLE_JIT", False):
        kernel.compile = _without_collections(kernel.compile)
    return cast(F, kernel)


def _shared(kernel: Any) -> Callable[..., Any]:
    """Return the `compile` of a kernel that tells why it compiles anew, and ends its lock."""
    compile_it = kernel.compile

    @functools.wraps(compile_it)
    def run(*args: Any) -> Any:
        cache = _cache_of(kernel)
        if cache is None:
            folders = ", ".join(map(str, _folders(kernel.py_func.__code__.co_filename)))
            warnings.warn(
                f"no folder for compiled kernels can be written ({folders}), so every run compiles "
                "them again; set NUMBA_CACHE_DIR to a folder that can be written",
                KernelWarning,
                stacklevel=2,
            )
            return compile_it(*args)
        find = INSTEAD.get(None)
        if find is not None and not cache.holds(args[0], kernel.targetctx):
            stand_in = find(kernel, args[0])
            if stand_in is not None:
                return stand_in
        try:
            return compile_it(*args)
        finally:
            cache.end()

    return run


def _without_collections(function: F) -> F:
    """Return a function that runs with the garbage collector paused.

    Numba makes many objects that live until a kernel is compiled. Searching them again and again
    took a sixth of the compilation.
    """

    @functools.wraps(function)
    def run(*args: Any) -> Any:
        with _collections_paused():
            return function(*args)

    return cast(F, run)


@contextmanager
def _collections_paused() -> Iterator[None]:
    """Pause the garbage collector, unless somebody else has done so."""
    if not gc.isenabled():
        yield
        return
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


def _folders(source: str) -> Iterator[Path]:
    """Yield the folders in which the kernels of a source file may be kept, the best first."""
    # Numba reads only machine code of its own version, and would overwrite that of others.
    name = f"numba-{numba.__version__}"
    if chosen := getattr(numba.config, "CACHE_DIR", ""):
        yield Path(chosen) / "beliefnest" / name
    # Imported here because it is not needed if a folder was chosen.
    from platformdirs import user_cache_path

    yield user_cache_path("beliefnest", appauthor=False) / name
    yield Path(source).parent / "__pycache__"


class _Locator(caching._CacheLocator):
    """Place of the machine code of one kernel, as numba asks for it."""

    def __init__(self, folder: Path, digest: str) -> None:
        self._folder, self._digest = folder, digest

    def get_cache_path(self) -> str:
        """Return the folder."""
        return os.fspath(self._folder)

    def get_source_stamp(self) -> str:
        """Return a text that changes with the kernel."""
        return self._digest

    def get_disambiguator(self) -> str:
        """Return the part of file names that tells versions of a kernel from each other."""
        return self._digest


class _Search:
    """Search for the place of one kernel, in numba's list of such searches.

    Numba's own searches find code by the path and the content of its source file: another
    environment does not find it, and a kernel stays as it was when one that it calls has changed.
    """

    def __init__(self, digest: str) -> None:
        self._digest = digest

    def from_function(self, _: FunctionType, source: str) -> _Locator | None:
        """Return the place in the first writable folder; None if there is none."""
        for folder in _folders(source):
            place = _Locator(folder, self._digest)
            with suppress(OSError):
                place.ensure_cache_path()
                return place
        return None


class _Implementation(caching.CompileResultCacheImpl):
    """Storing of a compiled kernel at the place that `_Search` finds."""

    def __init__(self, kernel: Any) -> None:
        self._locator_classes: Any = (_Search(_digest(kernel)),)
        super().__init__(kernel.py_func)


class _Cache(caching.FunctionCache):
    """Machine code of one kernel on the disk. Trouble with the disk costs time only.

    Numba imports the compiler's 250 modules before it loads anything, 0.3 s of every process.
    Machine code needs only the runtime that its wrapper uses. Code that is not stored is compiled
    as always: the compiler imports its own modules.
    """

    _impl_class = _Implementation

    def __init__(self, kernel: Any) -> None:
        super().__init__(kernel)
        self._py_func = kernel.py_func
        self._lock: ProcessLock | None = None
        stamp = self._impl.locator.get_source_stamp()
        self._cache_file = SealedFiles(self._cache_path, self._impl.filename_base, stamp)

    def holds_any(self, target_context: Any) -> bool:
        """Return True if machine code for this processor is stored."""
        processor = target_context.codegen().magic_tuple()
        with suppress(*_UNREADABLE):
            return any(key[1] == processor for key in self._cache_file._load_index())
        return False

    def holds(self, sig: object, target_context: Any) -> bool:
        """Return True if machine code for types of arguments, and for this processor, is stored."""
        key = self._index_key(sig, target_context.codegen())
        with suppress(*_UNREADABLE):
            return key in self._cache_file._load_index()
        return False

    def load_overload(self, sig: object, target_context: Any) -> object:
        """Return the machine code for types of arguments; None: nothing readable is stored.

        If nothing is stored, this process gets the right to compile the kernel, until `end`.
        Other processes wait for it and then find the code.
        """
        rtsys.initialize(target_context)
        compiled = self._load(sig, target_context)
        if compiled is None and self._lock is None:
            self._lock = self._locked()
            compiled = self._load(sig, target_context)
        return compiled

    def save_overload(self, sig: object, data: object) -> None:
        """Store machine code, unless the folder is full or no longer writable."""
        with suppress(OSError):
            super().save_overload(sig, data)

    def end(self) -> None:
        """Let other processes compile the kernel, or load what this one has stored."""
        if self._lock is not None:
            self._lock.release()
            self._lock = None

    def _load(self, sig: object, target_context: Any) -> object:
        try:
            return self._load_overload(sig, target_context)
        except _UNREADABLE as fault:
            if isinstance(fault, DamagedFileError):
                warnings.warn(
                    f"compiled kernels in {self._cache_path} are damaged and are compiled again",
                    KernelWarning,
                    stacklevel=2,
                )
            with suppress(OSError):
                self.flush()
            return None

    def _locked(self) -> ProcessLock | None:
        """Wait for the right to compile the kernel; None: it cannot be had."""
        until = time.monotonic() + _PATIENCE
        path = Path(self._cache_file._index_path + "-lock")
        while time.monotonic() < until:
            try:
                return ProcessLock.acquire(path)
            except LockHeldError:
                time.sleep(_LOOK)
            except OSError:
                return None
        return None


def _digest(kernel: Any) -> str:
    """Return a digest of a kernel, the kernels that it calls, their types and their constants."""
    return blake2b("\n".join(_parts(kernel, set())).encode(), digest_size=8).hexdigest()


def _parts(kernel: Any, seen: set[object]) -> Iterator[str]:
    function = kernel.py_func
    seen.add(function)
    yield _FORM
    code = function.__code__
    constants = [each for each in code.co_consts if each != function.__doc__]
    yield repr((function.__name__, code.co_code, constants, code.co_names, code.co_varnames))
    yield repr(sorted(kernel.targetoptions.items()))
    yield from _types(function.__annotations__.values())
    for name in code.co_names:
        value = function.__globals__.get(name)
        match value:
            case _ if hasattr(value, "py_func"):
                if value.py_func not in seen:
                    yield from _parts(value, seen)
            case ModuleType():
                yield value.__name__
            case EnumType():
                yield repr(list(value))
            case type():
                yield repr(getattr(value, "_fields", name))
            case _:
                yield repr(value)


def _types(annotations: Iterable[object]) -> Iterator[str]:
    """Yield the names of types of arguments, and of their fields, by which numba stores them."""
    for each in annotations:
        yield repr(each)
        if hasattr(each, "_fields"):
            yield from _types(each.__annotations__.values())
