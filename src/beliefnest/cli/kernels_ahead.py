"""Kernels of a command: imported while Node works, and run by Python until they are compiled.

A first run finds no machine code, and compiling takes longer than a small scenario takes without
it. So another process compiles each kernel that is called, and this one meanwhile calls the same
functions in Python, which give the same results, for as long as `_SECONDS`. The compiling process
goes on when the command has ended.
"""

import os
import pickle
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from importlib import import_module
from types import FunctionType
from typing import Any, BinaryIO

import numpy as np

from beliefnest.perception.instead import INSTEAD

_SECONDS = 5.0
"""Processor time for calls in Python; afterwards the command waits for the compiler."""
_MOST_BYTES = 64 << 20
"""Greatest size of the arrays of a call in Python, which keeps a copy of them."""
_NICENESS = 10
"""Priority of the compiling process, of 19 for the lowest."""


class _SpentError(Exception):
    """Break of a call in Python that takes too long."""


@contextmanager
def kernels_ahead() -> Iterator[None]:
    """Import the kernels of belief beside the block; wait for the import at the end.

    Numba takes longer to import than anything else here, and a simulator needs it only when its
    first belief is computed. A failure is not told here: the code that needs a kernel imports it
    again and tells it.
    """
    thread = threading.Thread(target=_import, name="import of the kernels", daemon=True)
    thread.start()
    stand_ins = StandIns(_SECONDS)
    token = INSTEAD.set(stand_ins.find)
    try:
        yield
    finally:
        INSTEAD.reset(token)
        stand_ins.close()
        thread.join()


def _import() -> None:
    with suppress(ImportError):
        from beliefnest.belief import kernel  # noqa: F401 # only to have it loaded


class StandIns:
    """Functions of Python in place of kernels that another process compiles.

    Args:
        seconds: Processor time for all calls together.
    """

    def __init__(self, seconds: float) -> None:
        self._left = seconds
        self._until = 0.0
        self._plain: dict[Any, Callable[..., Any]] = {}
        self._asked: set[Any] = set()
        self._compiler: subprocess.Popen[bytes] | None = None

    def find(self, kernel: Any, types: Any) -> Callable[..., Any] | None:
        """Return what is called in place of a kernel; None: it must be compiled or waited for."""
        if self._left <= 0 or "no_cpython_wrapper" in kernel.targetoptions:
            return None
        if (kernel, types) not in self._asked:
            self._asked.add((kernel, types))
            self._compile(kernel, types)
        return partial(self._call, kernel, self._in_python(kernel))

    def close(self) -> None:
        """Let the compiler end after what it was asked for."""
        if self._compiler is not None:
            with suppress(OSError):
                self._compiler.communicate()

    def _call(self, kernel: Any, function: Callable[..., Any], *args: Any) -> Any:
        """Call a kernel in Python; undo what it did and wait for the compiled one if that fails."""
        arrays = [each for each in _arrays(args) if each.flags.writeable]
        if sum(each.nbytes for each in arrays) > _MOST_BYTES:
            self._left = 0.0
            return kernel(*args)
        before = [each.copy() for each in arrays]
        self._until = time.thread_time() + self._left
        try:
            with np.errstate(all="ignore"):
                return function(*args)
        except (_SpentError, ArithmeticError, ValueError):
            # Machine code divides by zero and takes roots below it; Python does not.
            self._until = 0.0
            for array, content in zip(arrays, before, strict=True):
                array[...] = content
        finally:
            self._left = self._until - time.thread_time()
        return kernel(*args)

    def _compile(self, kernel: Any, types: Any) -> None:
        """Ask the compiler for a kernel. If it cannot be asked, this process compiles it later."""
        function = kernel.py_func
        with suppress(OSError):
            self._compiler = self._compiler or _started_compiler()
            assert self._compiler.stdin is not None
            pickle.dump((function.__module__, function.__name__, types), self._compiler.stdin)
            self._compiler.stdin.flush()

    def _in_python(self, kernel: Any) -> Callable[..., Any]:
        """Return a kernel as a function that calls others in Python, too."""
        function = kernel.py_func
        if function in self._plain:
            return self._plain[function]
        names: dict[str, Any] = dict(function.__globals__)
        plain: Callable[..., Any] = FunctionType(
            function.__code__, names, function.__name__, function.__defaults__
        )
        if "forceinline" not in kernel.targetoptions and "inline" not in kernel.targetoptions:
            plain = partial(self._watched, plain)
        self._plain[function] = plain
        for name in function.__code__.co_names:
            if hasattr(names.get(name), "py_func"):
                names[name] = self._in_python(names[name])
        return plain

    def _watched(self, function: Callable[..., Any], *args: Any) -> Any:
        if time.thread_time() > self._until:
            raise _SpentError
        return function(*args)


def _started_compiler() -> subprocess.Popen[bytes]:
    """Start a process that starts the compiler, and ends at once.

    The compiler is no child of this process, which may live on, and nobody waits for it.
    Ctrl-C does not reach its process group. Linux heeds its priority only within one session.
    """
    begin = "import subprocess, sys; subprocess.Popen(sys.argv[1:], process_group=0)"
    nowhere = subprocess.DEVNULL
    return subprocess.Popen(
        [sys.executable, "-c", begin, sys.executable, "-m", __name__],
        stdin=subprocess.PIPE,
        stdout=nowhere,
        stderr=nowhere,
    )


def _arrays(value: Any) -> Iterator[np.ndarray[Any, Any]]:
    """Yield the arrays in the arguments of a kernel."""
    if isinstance(value, np.ndarray):
        yield value
    elif isinstance(value, tuple):
        for each in value:
            yield from _arrays(each)


def compile_all(wanted: BinaryIO) -> None:
    """Compile the kernels that are named, each with its types, until the stream ends."""
    with suppress(EOFError):
        while True:
            module, name, types = pickle.load(wanted)
            getattr(import_module(module), name).compile(types)


if __name__ == "__main__":
    # Only later commands need the machine code; where there is one processor, this one needs that.
    os.nice(_NICENESS)
    compile_all(sys.stdin.buffer)
