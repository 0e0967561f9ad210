"""One agent program of the scripted world, in a JavaScript engine of its own.

The engine is the one that the sandbox of bots has, here in this process. A program reaches nothing
but the values it is given, has 64 MB, and computes for two seconds at most between two ticks.
"""

import json
import re
from collections.abc import Iterable, Mapping
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from beliefnest.bodies.protocol import Fault

__all__ = ["JavaScriptProgram"]

_MEMORY_BYTES = 64 << 20
_STACK_BYTES = 512 << 10
_SECONDS = 2
_MOST_JOBS = 100_000
_FIRST_LINE = 1000
"""Lines before a program's own: the engine names no files, so that they tell its places apart."""
_PLACE = re.compile(r"<input>:(\d+)(?::(\d+))?")
_WHOLE = re.compile(r"\s*(?:async\s+)?function\b")


class JavaScriptProgram:
    """A program, begun with `start`.

    Args:
        username: The agent that runs it.
        skills: Names of the skills in its scope.
    """

    def __init__(self, username: str, skills: Iterable[str]) -> None:
        import quickjs  # takes 10 ms, and most nests run no such program

        self._failed: type[Exception] = quickjs.JSException
        self._context = quickjs.Context()
        self._context.set_memory_limit(_MEMORY_BYTES)
        self._context.set_max_stack_size(_STACK_BYTES)
        self._context.set_time_limit(_SECONDS)
        self._call = self._context.eval(_engine())(json.dumps([sorted(skills), username]))
        self._fault: Fault | None = None
        self._blocks: str | None = None
        self._taken: dict[str, Any] = {"calls": [], "log": [], "done": None, "waiting": 0}

    def start(self, code: str) -> None:
        """Begin a program, and run it until it waits."""
        names = ", ".join(json.loads(self._call("names")))
        whole = _WHOLE.match(code) is not None
        lines = "\n" * _FIRST_LINE
        head = f"({'' if whole else 'async '}function ({names}) {{ 'use strict'; "
        body = f"return ({lines}{code}\n)" if whole else f"{lines}{code}\n"
        try:
            main = self._context.eval(f"{head}{body}}})")
            self._call("start", main, whole)
            self._drain()
        except self._failed as error:
            self._fault = _fault_of(str(error), kind="syntax")

    def see(self, told: Mapping[str, object], blocks: str) -> None:
        """Tell what the program reads of the world from now on."""
        # A text that is a map of the world takes long to hand over.
        new = blocks != self._blocks
        self._blocks = blocks
        self._call("see", json.dumps(told), blocks if new else None)

    def settle(self, number: int, *, ok: bool, value: object) -> None:
        """Answer a call, and run until the program waits again."""
        try:
            self._call("settle", number, ok, json.dumps(value))
            self._drain()
        except self._failed as error:
            self._fault = _fault_of(str(error), kind="error")

    def calls(self) -> list[tuple[int, str, list[Any]]]:
        """Number, name and arguments of the skills it has called since this was asked last."""
        called = [(number, name, args) for number, name, args in self._taken["calls"]]
        self._taken["calls"] = []
        return called

    @property
    def log(self) -> tuple[str, ...]:
        """What it wrote to its console."""
        return tuple(self._taken["log"])

    @property
    def ended(self) -> bool:
        """Whether it has ended, well or not, or can never end."""
        return self._fault is not None or self._taken["done"] is not None or self._is_stuck

    @property
    def fault(self) -> Fault | None:
        """Why it failed; None if it did not, or goes on."""
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
        while self._context.execute_pending_job():
            jobs += 1
            if jobs > _MOST_JOBS:
                self._fault = Fault("the program goes on without ever waiting", "fuel")
                break
        taken = json.loads(self._call("take"))
        self._taken = {**taken, "calls": [*self._taken["calls"], *taken["calls"]]}


@cache
def _engine() -> str:
    """A function of skills and username, as JSON, that gives what calls a part of the prelude.

    No function is in brackets: those that open with one are read twice, to see whether an arrow
    comes after them.
    """
    prelude = (files("beliefnest.bodies") / "scripted_prelude.js").read_text(encoding="utf-8")
    return f"""{{
const vec3 = {_shared("vec3", "env.Vec3")}
const hints = {_shared("hints", "module.exports")}
const prelude = {prelude}
given => {{
  const parts = prelude(vec3(), hints(), ...JSON.parse(given))
  return (part, one, two, three) => parts[part](one, two, three)
}} }}"""


def _shared(name: str, given: str) -> str:
    """A function that gives what a module of the bots' sandbox does, too."""
    built = Path(str(files("beliefnest"))) / "_bundle" / f"{name}.js"
    text = built.read_text(encoding="utf-8")
    made = "if (typeof module.exports === 'function') module.exports(env)"
    return f"() => {{ const module = {{}}, env = {{}};\n{text}\n{made}\nreturn {given} }}"


def _fault_of(text: str, kind: str) -> Fault:
    message = text.partition("\n")[0]
    line, column = _place_in(text)
    if "interrupted" in message:
        return Fault("the program computes without end; is there an endless loop?", "fuel", line)
    if "out of memory" in message:
        return Fault(f"the program takes more than {_MEMORY_BYTES >> 20} MB", "memory", line)
    return Fault(message, kind, line, column)


def _place_in(stack: str) -> tuple[int | None, int | None]:
    for found in _PLACE.finditer(stack):
        line = int(found[1]) - _FIRST_LINE
        if line > 0:
            return line, None if found[2] is None else int(found[2])
    return None, None
