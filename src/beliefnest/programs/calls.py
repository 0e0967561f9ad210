"""Calls of skills as values, and their texts as programs."""

import json
from dataclasses import dataclass
from typing import Any

__all__ = ["Call", "program_of"]


@dataclass(frozen=True, slots=True)
class Call:
    """A skill with its arguments, as plain values.

    Attributes:
        skill: Its name.
        args: Positions as tuples, items as mappings, claims as plain data.
    """

    skill: str
    args: tuple[Any, ...] = ()

    @property
    def is_nothing(self) -> bool:
        """True if it begins nothing, so that what goes on goes on."""
        return self.skill == "doNothing"

    @property
    def program(self) -> str:
        """The same as an agent's program; empty if it begins nothing."""
        if self.is_nothing:
            return ""
        if self.skill == "openContainer":
            place = _code(self.args[0])
            return (
                f"await goToPosition(bot, {place}, 2)\n"
                f"const container = await bot.openContainer(bot.blockAt({place}))\n"
                "container.close()"
            )
        args = ", ".join(["bot", *map(_code, self.args)])
        return f"await {self.skill}({args})"


def program_of(calls: "tuple[Call, ...] | list[Call]") -> str:
    """Calls one after the other, as a program; empty if there are none."""
    texts = [call.program for call in calls]
    # Each in a block of its own: the names that one declares are not the next one's.
    return "\n".join(f"{{ {text} }}" if "\n" in text else text for text in texts if text)


def _code(value: Any) -> str:
    """Return a value in a program."""
    if isinstance(value, tuple):
        return f"new Vec3({', '.join(map(str, value))})"
    if isinstance(value, list):
        return f"[{', '.join(map(_code, value))}]"
    if isinstance(value, dict) and "kind" in value:
        return _claim_code(value)
    return json.dumps(value)


def _claim_code(claim: dict[str, Any]) -> str:
    """Return a claim, as plain data, made by the function that programs have for it."""
    place = _code(tuple(claim["place"]))
    match claim["kind"]:
        case "position":
            return f"positionOf({_code(claim['agent'])}, {place})"
        case "block":
            return f"blockAt({place}, {_code(claim['state'])})"
        case kind:
            return f"{kind}({_code(claim['item'])}, {place})"
