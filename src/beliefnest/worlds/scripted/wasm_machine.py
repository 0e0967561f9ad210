"""WebAssembly instance with plain calls: what wasmtime's own objects do, twenty times as fast.

Wasmtime's Python objects convert each argument with several calls of its C interface, which takes
longer than most calls of the interpreter. Here arguments and results are words in one array. The
names are those of the C interface (https://docs.wasmtime.dev/c-api/), which the package binds.
"""

import ctypes
import weakref
from collections.abc import Callable, Mapping
from ctypes import byref
from typing import Any

from beliefnest.worlds.scripted.compiled_module import Compiled

_MOST_WORDS = 8
_OK = 0


class TrapError(Exception):
    """Code of the instance did what it must not, or ran out of what it may use."""


class Machine:
    """Instance of a module that imports one memory and any functions.

    Args:
        code: The module.
        pages: Smallest and largest size of the memory, in pages of 64 KiB.
        imports: Functions by the names under which the module imports them, of the words of their
            arguments; they return the word of the result. Imports without a function do nothing.

    Attributes:
        close: Frees the memory; after that the instance must not be used.
    """

    def __init__(
        self,
        code: Compiled,
        pages: tuple[int, int],
        imports: Mapping[str, Callable[[Any], int | None]],
    ) -> None:
        import wasmtime as w
        from wasmtime import _ffi as ffi

        self._ffi, self._store = ffi, w.Store(code.engine)
        # As for `compiled`: at the latest when the process ends.
        self.close = weakref.finalize(self, self._store.close)
        self._context = self._store._context()
        self._words = (ffi.wasmtime_val_raw_t * _MOST_WORDS)()
        self._trap = ctypes.POINTER(ffi.wasm_trap_t)()
        self._value = ffi.wasmtime_val_t()
        self._value.kind = ffi.WASMTIME_I32
        # The C side keeps no reference to functions of Python.
        self._kept: list[object] = []
        self._raised: BaseException | None = None
        self._memory = w.Memory(self._store, w.MemoryType(w.Limits(*pages)))
        given_imports = [
            # Files and the system answer zero: programs need not have them.
            self._function(kind, imports.get(name, lambda words: 0))
            if isinstance(kind, w.FuncType)
            else self._memory
            for name, kind in code.imports
        ]
        self._instance = w.Instance(self._store, code.module, given_imports)._instance
        self._functions: dict[str, Any] = {}
        self._globals: dict[str, Any] = {}

    def call(self, name: str, *args: int) -> int:
        """Call an exported function of words; raises TrapError."""
        function = self._functions.get(name)
        if function is None:
            function = self._functions[name] = self._export(name).func
        words = self._words
        for place, word in enumerate(args):
            words[place].i64 = word
        return self._called(function)

    def call_with_number(self, name: str, first: int, number: float) -> int:
        """Call an exported function of a word and a floating-point number."""
        self._words[0].i64 = first
        self._words[1].f64 = number
        return self._called(self._export(name).func)

    def number(self, name: str) -> int:
        """Return the value of an exported global."""
        self._ffi.wasmtime_global_get(self._context, byref(self._global(name)), byref(self._value))
        return int(self._value.of.i32)

    def set_number(self, name: str, number: int) -> None:
        """Set an exported global."""
        self._value.of.i32 = number
        self._ffi.wasmtime_global_set(self._context, byref(self._global(name)), byref(self._value))

    def add_to_table(self, name: str, act: Callable[[Any], int | None], kinds: str) -> None:
        """Add a function to an exported table.

        Args:
            name: The table.
            act: The function, of the words of its arguments.
            kinds: Types of its arguments: `i` of 32 bits, `l` of 64 bits.
        """
        import wasmtime as w

        types = {"i": w.ValType.i32, "l": w.ValType.i64}
        kind = w.FuncType([types[each]() for each in kinds], [])
        table = w.Table._from_raw(self._export(name).table)
        table.grow(self._store, 1, self._function(kind, act))

    @property
    def size(self) -> int:
        """Size of the memory in bytes."""
        return int(self._memory.data_len(self._store))

    def grow(self, pages: int) -> bool:
        """Enlarge the memory; return False if it may not become so large."""
        import wasmtime

        try:
            self._memory.grow(self._store, pages)
        except wasmtime.WasmtimeError:
            return False
        return True

    def address(self, place: int) -> int:
        """Return the machine's address of a place in the memory, until the memory grows."""
        data = self._ffi.wasmtime_memory_data(self._context, byref(self._memory._memory))
        return ctypes.addressof(data.contents) + place

    def read(self, place: int, length: int) -> bytes:
        """Return bytes of the memory."""
        if not 0 <= place <= place + length <= self.size:
            raise TrapError("an address is out of the memory")
        return ctypes.string_at(self.address(place), length)

    def write(self, place: int, content: bytes) -> None:
        """Write bytes into the memory."""
        if not 0 <= place <= place + len(content) <= self.size:
            raise TrapError("an address is out of the memory")
        ctypes.memmove(self.address(place), content, len(content))

    def _export(self, name: str) -> Any:
        item, letters = self._ffi.wasmtime_extern_t(), name.encode()
        name_buffer = ctypes.create_string_buffer(letters)
        if not self._ffi.wasmtime_instance_export_get(
            self._context, byref(self._instance), name_buffer, len(letters), byref(item)
        ):
            raise KeyError(name)
        return item.of

    def _global(self, name: str) -> Any:
        exported = self._globals.get(name)
        if exported is None:
            exported = self._globals[name] = self._export(name).global_
        return exported

    def _called(self, function: Any) -> int:
        words, trap = self._words, self._trap
        error = self._ffi.wasmtime_func_call_unchecked(
            self._context, byref(function), words, _MOST_WORDS, byref(trap)
        )
        if error or trap:
            self._fail(error)
        return int(words[0].i32)

    def _fail(self, error: Any) -> None:
        """Raise what a function of Python raised, or else TrapError."""
        if self._trap:
            self._ffi.wasm_trap_delete(self._trap)
            self._trap = ctypes.POINTER(self._ffi.wasm_trap_t)()
        if error:
            self._ffi.wasmtime_error_delete(error)
        raised, self._raised = self._raised, None
        if raised is not None:
            raise raised
        raise TrapError("the code of the instance was stopped")

    def _function(self, kind: Any, act: Callable[[Any], int | None]) -> Any:
        """Return a function of Python as one of the instance."""
        import wasmtime as w

        ffi = self._ffi

        def answer(_: Any, __: Any, words: Any, ___: Any) -> int:
            try:
                result = act(words)
            except BaseException as error:  # noqa: BLE001 - it crosses foreign frames
                self._raised = error
                message = b"python"
                trap = ffi.wasmtime_trap_new(ctypes.create_string_buffer(message), len(message))
                return ctypes.cast(trap, ctypes.c_void_p).value or _OK
            if result is not None:
                words[0].i64 = result
            return _OK

        called = ffi.wasmtime_func_unchecked_callback_t(answer)
        self._kept.append(called)
        made = ffi.wasmtime_func_t()
        no_finalizer = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(0)
        ffi.wasmtime_func_new_unchecked(
            self._store._context(), kind.ptr(), called, None, no_finalizer, byref(made)
        )
        return w.Func._from_raw(made)
