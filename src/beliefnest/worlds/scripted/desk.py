"""Desk of programs: the part of the bots' sandbox that prepares, checks and describes.

It is the JavaScript of `worlds/minecraft/node/src/sandbox/desk.js` in its own interpreter, so
that no program can change it. Thus both worlds check by the same code.
"""

import json
from collections.abc import Mapping, Sequence
from typing import Any

import msgspec

from beliefnest.worlds.scripted.interpreter import GuestError, Interpreter
from beliefnest.worlds.scripted.sandbox_parts import parts
from beliefnest.worlds.scripted.wasm_machine import TrapError

_FUEL = 1_000_000_000
"""Fuel of one request; reading the longest usual program takes a twentieth."""
_MEMORY_BYTES = 64 << 20
_MOST_KEPT = 200
_LONGEST_KEPT = 2000
_RESERVE = 10_000_000


class TooIntricateError(Exception):
    """A request took more than the desk can do; only texts made for that do."""


class Prepared(msgspec.Struct, frozen=True):
    """Program that is ready to run.

    Attributes:
        code: Its text, as written.
        text: Expression of a function of marks and scope.
        marks: Length of the array that takes the numbers of executed statements.
    """

    code: str
    text: str
    marks: int


class DeskFacts(msgspec.Struct, frozen=True):
    """Facts of a world that checks of arguments need.

    Attributes:
        me: The program's agent.
        agents: All agents.
        kinds: Kinds of the game objects that the program holds, by number.
    """

    me: str
    agents: Sequence[str]
    kinds: Sequence[str]

    @property
    def plain(self) -> dict[str, object]:
        """The facts as the desk reads them."""
        return {"me": self.me, "agents": list(self.agents), "kinds": list(self.kinds)}


class Desk:
    """Desk for any number of programs; it starts with the first request."""

    def __init__(self) -> None:
        self._interpreter: Interpreter | None = None
        self._answers: dict[str, Any] = {}
        self._prepared: dict[str, Prepared | Mapping[str, Any]] = {}

    def prepare(self, code: str) -> Prepared | Mapping[str, Any]:
        """Return a program that is ready to run, or its error."""
        prepared = self._prepared.get(code)
        if prepared is None:
            answer = self._ask("prepare", code, parts().scope)
            prepared = answer["error"] if "error" in answer else Prepared(code, **answer)
            self._prepared[code] = prepared
            while len(self._prepared) > _MOST_KEPT:
                del self._prepared[next(iter(self._prepared))]
        return prepared

    def outcome(
        self, program: Prepared, outcome: Mapping[str, Any], last: int, under: Sequence[str]
    ) -> Mapping[str, Any] | None:
        """Describe how a program ended, as the sandbox does; None if it ended well."""
        limits = {"fuel": parts().limits.fuel, "memory": parts().limits.memory}
        end: Mapping[str, Any] | None = self._ask(
            "outcome", program.code, parts().scope, outcome, limits, last, under
        )
        return end

    def line(self, program: Prepared, statement: int) -> int | None:
        """Return the line of a statement of a program."""
        line: int | None = self._ask("lineOf", program.code, parts().scope, statement)
        return line

    def admit_skill(self, name: str, wires: Sequence[Any], facts: DeskFacts) -> dict[str, Any]:
        """Check a call of a skill; see `admitSkill` in desk.js."""
        return self._remembered("admitSkill", name, wires, facts.plain)

    def admit_call(
        self, kind: str, name: str, wires: Sequence[Any], facts: DeskFacts
    ) -> dict[str, Any]:
        """Check a call of a method of a game object; see `admitCall` in desk.js."""
        return self._remembered("admitCall", kind, name, wires, facts.plain)

    def _remembered(self, *request: object) -> dict[str, Any]:
        """Return the answer to a request, if possible without asking: equal ones are frequent."""
        text = json.dumps(request)
        answer: dict[str, Any] = self._answers.get(text) or self._asked(text)
        if len(text) <= _LONGEST_KEPT:
            self._answers[text] = answer
            while len(self._answers) > _MOST_KEPT:
                del self._answers[next(iter(self._answers))]
        return answer

    def _ask(self, *request: object) -> Any:
        return self._asked(json.dumps(request))

    def _asked(self, request: str) -> Any:
        interpreter = self._interpreter or self._opened()
        interpreter.fuel = _FUEL
        message = interpreter.string(request)
        try:
            answer = interpreter.call(parts().desk.functions["dispatch"], [message])
            text = interpreter.text(answer)
        except (GuestError, TrapError) as error:
            # What it did is unknown: begin anew.
            self._interpreter = None
            raise TooIntricateError(str(error)) from None
        interpreter.free(answer)
        interpreter.free(message)
        return json.loads(text)

    def _opened(self) -> Interpreter:
        made: list[Interpreter] = []
        interpreter = Interpreter(
            _MEMORY_BYTES,
            call=lambda _, __: 0,
            interrupt=lambda: made[0].fuel < _RESERVE,
            rejected=lambda _, __: None,
        )
        made.append(interpreter)
        interpreter.restore(parts().desk)
        interpreter.limit_memory(_MEMORY_BYTES)
        self._interpreter = interpreter
        return interpreter
