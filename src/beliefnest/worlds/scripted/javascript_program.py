"""Agent program of the scripted world, in a JavaScript engine of its own.

The engine is that of the bots' sandbox, inside this process. A program can use only the values it
is given. It has 64 MB of memory and at most two seconds of computing time between two ticks.
"""

import json
import re
from collections.abc import Collection, Mapping, Sequence
from typing import Any

from beliefnest.worlds.protocol import Fault
from beliefnest.worlds.scripted.engines import (
    MEMORY_BYTES,
    Engines,
    JavaScriptEngine,
    leaves_nothing,
    only_acts,
)

__all__ = ["JavaScriptProgram"]

_MOST_JOBS = 100_000
_NOTHING: Mapping[str, Any] = {"log": [], "done": None, "waiting": 0, "listens": False}
_FIRST_LINE = 1000
"""Line number of a program's first line.

The engine reports no file names, so that large line numbers mark the program.
"""
_PLACE = re.compile(r"<input>:(\d+)(?::(\d+))?")
_WHOLE = re.compile(r"\s*(?:async\s+)?function\b")


class JavaScriptProgram:
    """Program that begins with `start`.

    Args:
        username: The agent that runs it.
        skills: Names of the skills in its scope.
        code: Its text.
        seed: Seed of its random numbers.
        engines: Pool of engines to share.

    Attributes:
        reads: False if the program learns about the world only from the results of skills.
    """

    def __init__(
        self, username: str, skills: Collection[str], code: str, seed: str, engines: Engines
    ) -> None:
        self._code = code
        self._engines = engines
        self._leaves_nothing = leaves_nothing(code, skills)
        self.reads = _WHOLE.match(code) is not None or not only_acts(code, skills)
        if self._leaves_nothing:
            self._engine = engines.take(username, skills)
        else:
            self._engine = JavaScriptEngine(username, skills, seed)
        self._call = self._engine.call
        self._fault: Fault | None = None
        self._blocks: str | None = None
        self._taken: dict[str, Any] = {
            "calls": [],
            "log": [],
            "done": None,
            "waiting": 0,
            "listens": False,
        }

    def start(self) -> None:
        """Start the program, and run it until it waits."""
        code = self._code
        whole = _WHOLE.match(code) is not None
        lines = "\n" * _FIRST_LINE
        head = f"({'' if whole else 'async '}function ({self._engine.names}) {{ 'use strict'; "
        body = f"return ({lines}{code}\n)" if whole else f"{lines}{code}\n"
        try:
            main = self._engine.read(f"{head}{body}}})")
            self._call("start", main, whole)
            self._drain()
        except self._engine.failed as error:
            self._fault = _fault_of(str(error), kind="syntax")

    @property
    def draws(self) -> int:
        """Number of random numbers that it has drawn."""
        return 0 if self._leaves_nothing else self._engine.draws

    def reseed(self, seed: str) -> None:
        """Let a seed decide about its random numbers from now on."""
        if not self._leaves_nothing:
            self._engine.reseed(seed)

    def end(self) -> None:
        """Return a shareable engine to the pool; the program must not continue."""
        is_over = self._taken["done"] is not None and self._is_stuck and self._fault is None
        if self._leaves_nothing and is_over:
            self._engines.give_back(self._engine)

    def see(self, told: Mapping[str, object], blocks: str) -> None:
        """Set what the program reads of the world from now on."""
        # Convert only a new text: handing over a large map takes long.
        new = blocks != self._blocks
        self._blocks = blocks
        self._call("see", json.dumps(told), blocks if new else None)

    @property
    def listens(self) -> bool:
        """True if the program listens for speech."""
        return bool(self._taken["listens"])

    def hear(self, heard: Sequence[tuple[str, str, str | None]]) -> None:
        """Report what its agent heard: speaker, text, and the recipient of a whisper."""
        self._turn("hear", json.dumps(heard))

    def settle(self, number: int, *, ok: bool, value: object) -> None:
        """Answer a call, and run until the program waits again."""
        self._turn("settle", number, ok, json.dumps(value))

    def _turn(self, part: str, *given: object) -> None:
        """Call a part of the prelude, and run until the program waits again."""
        try:
            self._call(part, *given)
            self._drain()
        except self._engine.failed as error:
            self._fault = _fault_of(str(error), kind="error")

    def calls(self) -> list[tuple[int, str, list[Any]]]:
        """Return number, name and arguments of the skill calls since the last request."""
        called = [(number, name, args) for number, name, args in self._taken["calls"]]
        self._taken["calls"] = []
        return called

    @property
    def log(self) -> tuple[str, ...]:
        """Lines that the program wrote to its console."""
        return tuple(self._taken["log"])

    @property
    def ended(self) -> bool:
        """True if the program has ended or can never end."""
        return self._fault is not None or self._taken["done"] is not None or self._is_stuck

    @property
    def fault(self) -> Fault | None:
        """Reason of its failure; None if it has not failed."""
        if self._fault is not None:
            return self._fault
        done = self._taken["done"]
        if done is None:
            message = "the program waits for a promise that nothing will settle"
            return Fault(message, "stuck") if self._is_stuck else None
        if done["ok"]:
            return None
        kind = done["kind"] or ("error" if done["skill"] is None else "skill")
        named = done["name"] != "Error" and not done["skill"]
        message = f"{done['name']}: {done['message']}" if named else done["message"]
        line, column = _place_in(done["stack"])
        return Fault(message, kind, line, column, done["skill"], done["reason"])

    @property
    def _is_stuck(self) -> bool:
        return bool(self._taken["waiting"] == 0)

    def _drain(self) -> None:
        jobs = 0
        while self._engine.advance():
            jobs += 1
            if jobs > _MOST_JOBS:
                self._fault = Fault("the program goes on without ever waiting", "fuel")
                break
        taken = json.loads(self._call("take"))
        self._taken = {**taken, "calls": [*self._taken["calls"], *taken["calls"]]}


def _fault_of(text: str, kind: str) -> Fault:
    message = text.partition("\n")[0]
    line, column = _place_in(text)
    if "interrupted" in message:
        return Fault("the program computes without end; is there an endless loop?", "fuel", line)
    if "out of memory" in message:
        return Fault(f"the program takes more than {MEMORY_BYTES >> 20} MB", "memory", line)
    return Fault(message, kind, line, column)


def _place_in(stack: str) -> tuple[int | None, int | None]:
    for found in _PLACE.finditer(stack):
        line = int(found[1]) - _FIRST_LINE
        if line > 0:
            return line, None if found[2] is None else int(found[2])
    return None, None
