"""Guest: a program in an interpreter of its own, held to the sandbox's limits.

It is the twin of `worlds/minecraft/node/src/sandbox/engine.js`, whose constants it reads.
"""

import json
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from beliefnest.worlds.scripted.interpreter import GuestError, Interpreter
from beliefnest.worlds.scripted.sandbox_parts import parts
from beliefnest.worlds.scripted.wasm_machine import TrapError

_NUMBER_COST = 1000
"""Fuel for asking the host for the time or a random number; the crossing takes that long here."""
_HOST, _NOW, _RANDOM = 1, 2, 3
_SURROGATE = re.compile("[\ud800-\udfff]")
_LIMITS = {"interrupted": "fuel", "out of memory": "memory", "stack overflow": "stack"}


class GuestEndedError(Exception):
    """Reason why a guest can run no more.

    Attributes:
        kind: `fuel`, `memory`, `stack`, `internal`, or what `end` was given.
        message: Detail.
        stack: The guest's stack at that moment.
    """

    def __init__(self, kind: str, message: str, stack: str = "") -> None:
        super().__init__(message)
        self.kind, self.message, self.stack = kind, message, stack


class Guest:
    """Program that begins with `start`; after its end every call raises GuestEndedError.

    Args:
        host: Function that answers the requests of the program, texts both.
        now: Function that returns the time in milliseconds.
        random: Function that returns the next random number.
    """

    def __init__(
        self, host: Callable[[str], str], now: Callable[[], float], random: Callable[[], float]
    ) -> None:
        self._answers: dict[int, Callable[[int], int]] = {
            _HOST: lambda values: self._engine.string(host(self._engine.argument(values, 0))),
            _NOW: lambda _: self._number(now()),
            _RANDOM: lambda _: self._number(random()),
        }
        self._functions = parts().guest.functions
        self._engine = Interpreter(
            parts().limits.memory,
            call=self._call,
            interrupt=lambda: self._engine.fuel <= parts().meter.grace,
            rejected=self._rejected,
        )
        self._engine.restore(parts().guest)
        self._engine.limit_memory(parts().limits.memory)
        self._strays: dict[int, int] = {}
        self._program = 0
        self._marks = (0, 0)
        self._nesting = 0
        self.ended: GuestEndedError | None = None

    @property
    def idle(self) -> bool:
        """True if no code of the program is on the stack."""
        return self._nesting == 0

    def start(self, text: str, marks: int) -> None:
        """Start a program, as the desk prepared it."""
        engine, meter = self._engine, parts().meter
        engine.fuel = meter.unmetered
        place, value = engine.buffer(marks * 4)
        self._marks = (place, marks * 4)
        engine.fuel = parts().limits.fuel + meter.grace
        with self._entered():
            main = engine.evaluate(text, "program.js")
            self._program = engine.call(self._functions["start"], [main, value])

    @property
    def is_full(self) -> bool:
        """True if its memory has grown to its limit; it never shrinks."""
        return self._engine.size >= parts().limits.memory

    def result(self) -> dict[str, Any] | None:
        """Return how the program ended, read from the interpreter; None while it runs."""
        settled = self._engine.settled(self._program)
        if settled is None:
            return None
        return {"ok": True} if settled else {"ok": False, "error": self._reason(self._program)}

    def stray_error(self) -> Any:
        """Return the error of the first promise that was rejected without a handler, or None."""
        return next(map(self._reason, self._strays.values()), None)

    def send(self, message: list[object]) -> dict[str, Any]:
        """Send a message to the program, and run everything that can run."""
        engine = self._engine
        with self._entered():
            self.charge(parts().meter.wake_cost)
            text = engine.string(json.dumps(message))
            answer = engine.call(self._functions["dispatch"], [text])
            engine.free(text)
            reply = engine.text(answer)
            engine.free(answer)
        most = parts().limits.message
        if len(reply) > most:
            return {"ok": False, "value": {"message": too_much(most), "kind": "refused"}}
        answered: dict[str, Any] = parsed(reply)
        return answered

    def charge(self, units: int) -> None:
        """Take fuel for work that the host does for the program; it ends when none is left."""
        if self.ended is None:
            self._engine.fuel = max(self._engine.fuel - units, parts().meter.grace)

    def end(self, kind: str, message: str, stack: str = "") -> None:
        """End the program; code that is running stops soon."""
        if self.ended is None:
            self.ended = GuestEndedError(kind, message, stack)

    def close(self) -> None:
        """Free its memory, when no code of it is on the stack."""
        self._engine.close()

    def _is_over(self) -> bool:
        return self.ended is not None

    @property
    def last_statement(self) -> int:
        """Number of the statement that began last; 0 for none."""
        place, length = self._marks
        return int.from_bytes(self._engine.read(place, 4), "little") if length else 0

    def _reason(self, promise: int) -> Any:
        engine = self._engine
        with self._entered():
            try:
                description = engine.call(self._functions["describe"], [engine.result(promise)])
            except GuestError as error:
                if error.message == "interrupted":
                    raise
                return {}
            return parsed(engine.text(description))

    def _number(self, value: float) -> int:
        self.charge(_NUMBER_COST)
        return self._engine.number(value)

    def _call(self, number: int, values: int) -> int:
        """Answer a host function; the host's own frames count as stack."""
        if self._is_over():
            return 0
        engine, meter = self._engine, parts().meter
        before = engine.depth
        engine.depth = before + meter.crossing_stack_bytes
        try:
            value = self._answers[number](values)
        except (GuestError, TrapError) as error:
            self._fault(error)
            value = 0
        engine.depth = before
        if self._is_over():
            engine.fuel = meter.last_breath
        return value

    def _rejected(self, promise: int, is_handled: bool) -> None:
        if self.ended is not None:
            return
        kept = self._strays.get(promise)
        if is_handled and kept is not None:
            del self._strays[promise]
            self._engine.free(kept)
        elif not is_handled and len(self._strays) < parts().meter.most_strays:
            self._strays[promise] = self._engine.keep(promise)

    @contextmanager
    def _entered(self) -> Iterator[None]:
        """Run code of the guest, and then its jobs; raises GuestEndedError."""
        if self.ended is not None:
            raise self.ended
        self._nesting += 1
        try:
            yield
            if self._nesting == 1:
                self._drain()
        except (GuestError, TrapError) as error:
            raise self._fault(error) from None
        finally:
            self._nesting -= 1

    def _drain(self) -> None:
        engine, meter = self._engine, parts().meter
        while self.ended is None and engine.has_jobs:
            engine.run_jobs(meter.jobs_at_once)
        # A job that was interrupted leaves no error behind.
        if self.ended is None and engine.fuel <= meter.grace:
            self.end("fuel", "interrupted")
        if self.ended is not None:
            raise self.ended

    def _fault(self, error: Exception) -> GuestEndedError:
        if self.ended is None:
            limit = "fuel" if self._engine.fuel < 0 else "memory" if self.is_full else "stack"
            self.end(*(_uncaught(error) if isinstance(error, GuestError) else (limit, "trap")))
        assert self.ended is not None
        return self.ended


def _uncaught(error: GuestError) -> tuple[str, str, str]:
    """Return kind, message and stack of what the guest's own side did not catch."""
    if error.message in _LIMITS:
        return _LIMITS[error.message], error.message, error.stack
    kind = "syntax" if error.name == "SyntaxError" else "error"
    return kind, f"{error.name}: {error.message}", error.stack


def too_much(most: int) -> str:
    """Return the message about more than `most` characters in one message of a program."""
    return f"more than {most} characters leave the program at once, which is the limit"


def parsed(text: str) -> Any:
    """Return the value of JSON that a program made; lone surrogates become U+FFFD."""
    value = json.loads(text)
    return _well_formed(value) if "\\u" in text else value


def _well_formed(value: Any) -> Any:
    match value:
        case str():
            return _SURROGATE.sub("�", value)
        case list():
            return [_well_formed(each) for each in value]
        case dict():
            return {_well_formed(key): _well_formed(each) for key, each in value.items()}
        case _:
            return value
