"""Calls of skills as values, and their conversion to programs."""

import json
from collections.abc import Mapping
from functools import cache
from typing import Any

import msgspec

from beliefnest.skills.manifests import Skill, skills

CLAIM_CALLS = {
    "located": ("located", "item", "place"),
    "absent": ("absent", "item", "place"),
    "position": ("positionOf", "agent", "place"),
    "block": ("blockAt", "place", "state"),
}
"""Function of programs that makes a claim, and names of its arguments in order, by kind."""


@cache
def callables() -> Mapping[str, Skill]:
    """Return everything that a `Call` can name."""
    return {each.name: each for each in skills()}


class Call(msgspec.Struct, frozen=True):
    """A skill with its arguments, as plain values.

    Attributes:
        skill: Name of the skill.
        args: Arguments: positions as tuples, items as mappings, claims as plain data.
    """

    skill: str
    args: tuple[Any, ...] = ()

    @property
    def is_nothing(self) -> bool:
        """True if the call begins no action, so that the current action continues."""
        return self.skill == "doNothing"

    @property
    def program(self) -> str:
        """The call as JavaScript; empty if it begins no action."""
        if self.is_nothing:
            return ""
        args = ", ".join(["bot", *map(_code, self.args)])
        return f"await {self.skill}({args})"


def program_of(calls: "tuple[Call, ...] | list[Call]") -> str:
    """Return JavaScript that makes calls one after the other; empty if there are none."""
    return "\n".join(call.program for call in calls if not call.is_nothing)


def _code(value: Any) -> str:
    """Return a value as JavaScript."""
    if isinstance(value, tuple):
        return f"new Vec3({', '.join(map(str, value))})"
    if isinstance(value, list):
        return f"[{', '.join(map(_code, value))}]"
    if isinstance(value, dict) and "kind" in value:
        return _claim_code(value)
    return json.dumps(value)


def _claim_code(claim: dict[str, Any]) -> str:
    """Return JavaScript that makes a claim, given as plain data."""
    function, *names = CLAIM_CALLS[claim["kind"]]
    parts = [tuple(claim[name]) if name == "place" else claim[name] for name in names]
    return f"{function}({', '.join(map(_code, parts))})"
