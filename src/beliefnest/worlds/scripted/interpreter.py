"""Interpreter of agents' programs: the metered QuickJS of the bots' sandbox, as WebAssembly.

A program's computation is counted in the interpreter itself, so that it ends at the same point on
every machine, whatever native code it runs. Each program has a memory of its own.
"""

from collections.abc import Callable, Sequence

from beliefnest.worlds.scripted.compiled_module import compiled
from beliefnest.worlds.scripted.sandbox_parts import INTERPRETER, MachineState, bundled, parts
from beliefnest.worlds.scripted.wasm_machine import Machine

_PAGE = 65536
_LONGEST_TEXT = 4_000_000
"""Most bytes read of a text: more than a message may have, so that longer ones are refused."""
_USUAL_TEXT = 1000
_GROWTH_LIMIT = 2**31
_GROWTH_AHEAD = 100_663_296
_TIME_BYTES = 40
_FULFILLED = 1
_PENDING = 0


class GuestError(Exception):
    """Exception that code in the interpreter did not catch.

    Attributes:
        name: Its name there.
        message: Its message.
        stack: Its stack there.
    """

    def __init__(self, name: str, message: str, stack: str) -> None:
        super().__init__(message)
        self.name, self.message, self.stack = name, message, stack


class Interpreter:
    """Interpreter with an empty memory; `restore` makes it ready.

    Values in it are addresses, plain numbers here, so that a copy of the memory contains them all.

    Args:
        memory_bytes: Size to which its memory may grow, beyond the initial one.
        call: Called with the number of a host function and the address of its arguments; returns a
            value that the host no longer owns, or 0.
        interrupt: Returns True if running code is to stop. Polled now and then.
        rejected: Called with a promise (64 bits) that was rejected: with False if it has no
            handler, with True if it gets one later.
    """

    def __init__(
        self,
        memory_bytes: int,
        call: Callable[[int, int], int],
        interrupt: Callable[[], bool],
        rejected: Callable[[int, bool], None],
    ) -> None:
        names, first = parts(), parts().meter.initial_pages
        code, acts = compiled(bundled(INTERPRETER)), names.imports
        self._machine = Machine(
            code,
            (first, first - (-memory_bytes // _PAGE)),
            {
                acts["call"]: lambda words: call(words[4].i32, words[3].i32),
                acts["interrupt"]: lambda _: int(interrupt()),
                acts["grow"]: lambda words: self._grow(words[0].i32),
                acts["time"]: lambda words: self._machine.write(words[1].i32, bytes(_TIME_BYTES)),
            },
        )
        self._letters = names.exports
        # States that are restored expect the tracker at the first free index of the table.
        self._machine.add_to_table(
            "table", lambda words: rejected(words[1].i64, words[3].i32 != 0), "illii"
        )
        self._machine.call(code.start)
        self._runtime = self._context = 0

    @property
    def fuel(self) -> int:
        """Units of computation that are left."""
        return self._machine.number("fuel")

    @fuel.setter
    def fuel(self, units: int) -> None:
        self._machine.set_number("fuel", units)

    @property
    def size(self) -> int:
        """Size of the memory in bytes; it never shrinks."""
        return self._machine.size

    @property
    def depth(self) -> int:
        """Estimated bytes of the stack in use."""
        return self._machine.number("depth")

    @depth.setter
    def depth(self, size: int) -> None:
        self._machine.set_number("depth", size)

    def restore(self, state: MachineState) -> None:
        """Set a state; this interpreter must be new."""
        end = max(place + len(piece) for place, piece in state.pieces)
        more = -(-end // _PAGE) - self._machine.size // _PAGE
        self._machine.grow(max(0, more))
        for place, piece in state.pieces:
            self._machine.write(place, piece)
        self._runtime, self._context = state.runtime, state.context

    def close(self) -> None:
        """Free the memory; the interpreter must not be used any more."""
        self._machine.close()

    def limit_memory(self, size: int) -> None:
        """Set the size of everything that code in it may allocate, in bytes."""
        self._do("QTS_RuntimeSetMemoryLimit", self._runtime, size)

    def string(self, text: str) -> int:
        """Return a text as a value."""
        place = self._characters(text)
        value = self._do("QTS_NewString", self._context, place)
        self._do("free", place)
        return value

    def number(self, value: float) -> int:
        """Return a number as a value."""
        return self._machine.call_with_number(self._letters["QTS_NewFloat64"], self._context, value)

    def buffer(self, length: int) -> tuple[int, int]:
        """Return address and value of an array buffer of zeros, which the host can always read."""
        place = self._allocate(length)
        self._machine.write(place, bytes(length))
        return place, self._do("QTS_NewArrayBuffer", self._context, place, length)

    def read(self, place: int, length: int) -> bytes:
        """Return bytes of the memory."""
        return self._machine.read(place, length)

    def text(self, value: int) -> str:
        """Return a value as a text, up to a limit."""
        place = self._do("QTS_GetString", self._context, value)
        most = min(_LONGEST_TEXT, self._machine.size - place)
        memory = self._machine.read(place, min(most, _USUAL_TEXT))
        if b"\0" not in memory:
            memory = self._machine.read(place, most)
        self._do("QTS_FreeCString", self._context, place)
        return memory.partition(b"\0")[0].decode("utf-8", "replace")

    def argument(self, values: int, index: int) -> str:
        """Return an argument of a host function as a text."""
        return self.text(self._do("QTS_ArgvGetJSValueConstPointer", values, index))

    def keep(self, bits: int) -> int:
        """Return a new reference to the value that 64 bits stand for, so that it is not freed."""
        place = self._allocate(8)
        self._machine.write(place, (bits & 0xFFFF_FFFF_FFFF_FFFF).to_bytes(8, "little"))
        value = self._do("QTS_DupValuePointer", self._context, place)
        self._do("free", place)
        return value

    def free(self, value: int) -> None:
        """Give up a value."""
        self._do("QTS_FreeValuePointer", self._context, value)

    def member(self, value: int, name: str) -> int:
        """Return a property of an object."""
        key = self.string(name)
        member = self._do("QTS_GetProp", self._context, value, key)
        self.free(key)
        return member

    def evaluate(self, code: str, file: str) -> int:
        """Run a text and return its value; raises GuestError."""
        place, name = self._characters(code), self._characters(file)
        value = self._do("QTS_Eval", self._context, place, len(_bytes(code)), name, 0, 0)
        self._do("free", place)
        self._do("free", name)
        return self._checked(value)

    def call(self, callee: int, args: Sequence[int]) -> int:
        """Call a function; raises GuestError."""
        place = self._allocate(4 * len(args))
        self._machine.write(place, b"".join(each.to_bytes(4, "little") for each in args))
        nothing = self._do("QTS_GetUndefined")
        value = self._do("QTS_Call", self._context, callee, nothing, len(args), place)
        self._do("free", place)
        return self._checked(value)

    @property
    def has_jobs(self) -> bool:
        """True if jobs of promises wait."""
        return self._do("QTS_IsJobPending", self._runtime) != 0

    def run_jobs(self, most: int) -> None:
        """Run jobs of promises; raises GuestError."""
        place = self._allocate(4)
        value = self._do("QTS_ExecutePendingJob", self._runtime, most, place)
        self._do("free", place)
        self.free(self._checked(value))

    def settled(self, promise: int) -> bool | None:
        """Return True for a fulfilled promise, False for a rejected one, None for a pending one."""
        state = self._do("QTS_PromiseState", self._context, promise)
        return None if state == _PENDING else state == _FULFILLED

    def result(self, promise: int) -> int:
        """Return the value or the error of a settled promise."""
        return self._do("QTS_PromiseResult", self._context, promise)

    def _do(self, name: str, *args: int) -> int:
        return self._machine.call(self._letters[name], *args)

    def _checked(self, value: int) -> int:
        error = self._do("QTS_ResolveException", self._context, value)
        if error == 0:
            return value
        fields = (self.text(self.member(error, key)) for key in ("name", "message", "stack"))
        raise GuestError(*fields)

    def _characters(self, text: str) -> int:
        characters = _bytes(text) + b"\0"
        place = self._allocate(len(characters))
        self._machine.write(place, characters)
        return place

    def _allocate(self, length: int) -> int:
        place = self._do("malloc", max(length, 1))
        if place == 0:
            raise GuestError("InternalError", "out of memory", "")
        return place

    def _grow(self, wanted: int) -> int:
        """Grow the memory as Emscripten does: generously, or if that fails by less."""
        size, wanted = self._machine.size, wanted & 0xFFFF_FFFF
        if wanted > _GROWTH_LIMIT:
            return 0
        for part in (1, 2, 4):
            ahead = min(int(size * (1 + 0.2 / part)), wanted + _GROWTH_AHEAD)
            pages = min(_GROWTH_LIMIT // _PAGE, -(-max(wanted, ahead) // _PAGE))
            if self._machine.grow(pages - size // _PAGE):
                return 1
        return 0


def _bytes(text: str) -> bytes:
    """Return a text in UTF-8; lone surrogates, which it cannot hold, become U+FFFD."""
    return text.encode("utf-16", "surrogatepass").decode("utf-16", "replace").encode()
