"""Actions: calls of skills in a structured space."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from beliefnest.env.layout import ObservationLayout, Phrases
from beliefnest.errors import InputError, UnknownNameError
from beliefnest.programs.calls import Call
from beliefnest.world.values import Position

__all__ = ["MOST_ITEMS", "Call", "Calls"]

_LONGEST = 200
"""Characters of an action in a message."""

MOST_ITEMS = 64
"""Most items of one kind that one call moves."""

_NEEDS: Mapping[str, tuple[str, ...]] = {
    "doNothing": (),
    "goToPosition": ("position",),
    "openContainer": ("container",),
    "getItemFromChest": ("container", "item", "count"),
    "depositItemIntoChest": ("container", "item", "count"),
    "openDoor": ("door",),
    "closeDoor": ("door",),
    "writeSign": ("sign", "phrase"),
    "giveItemToOther": ("agent", "item", "count"),
    "say": ("phrase",),
    "whisper": ("agent", "phrase"),
}
"""By skill, the parts of an action that it reads; all others play no part."""

_KINDS = {
    "container": "containers",
    "door": "doors",
    "sign": "signs",
    "item": "items",
    "agent": "agents",
    "phrase": "phrases",
}
"""By part of an action, what in the layout it numbers."""


class Calls:
    """From actions to calls and back.

    Args:
        layout: The order of everything.
        phrases: What can be said, with claims.

    Attributes:
        skills: Names of the skills that make sense here; an action's `skill` numbers them.
        parts: Part of an action to how many values it has; `position` has three numbers.
    """

    def __init__(self, layout: ObservationLayout, phrases: Phrases) -> None:
        self._layout = layout
        self._phrases = phrases
        sizes: dict[str, int] = {part: len(getattr(layout, kind)) for part, kind in _KINDS.items()}
        sizes |= {"position": 1, "count": MOST_ITEMS}
        # Nobody gives or whispers to himself.
        sizes["agent"] = len(layout.agents) if len(layout.agents) > 1 else 0
        self.skills = tuple(
            name for name, needs in _NEEDS.items() if all(sizes[part] for part in needs)
        )
        used = {part for name in self.skills for part in _NEEDS[name]}
        self.parts = {part: size for part, size in sizes.items() if part in used}

    def action(self, skill: str, given: Mapping[str, object]) -> dict[str, Any]:
        """Return an action of the space, from names and positions.

        Args:
            skill: Name of the skill.
            given: `position`, `container`, `door`, `sign` as block positions, `item`, `agent`,
                `phrase` as they are called, `count` (1 if it is not given).

        Raises:
            UnknownNameError: There is no such skill, or no such thing.
            InputError: A part is missing or of no use to the skill, or is none.
        """
        if skill not in self.skills:
            raise UnknownNameError(f"there is no skill {skill!r} here; {', '.join(self.skills)}")
        needs = _NEEDS[skill]
        parts = {"count": 1, **given} if "count" in needs else dict(given)
        if parts.keys() != set(needs):
            raise InputError(f"{skill} takes {', '.join(needs) or 'nothing'}; got {sorted(parts)}")
        action: dict[str, Any] = {
            part: np.zeros(3, np.int64) if part == "position" else np.int64(part == "count")
            for part in self.parts
        }
        for part, value in parts.items():
            action[part] = self._numbered(part, value)
        return {"skill": np.int64(self.skills.index(skill)), **action}

    def _numbered(self, part: str, value: Any) -> Any:
        if part == "position":
            try:
                x, y, z = map(int, value)
            except (TypeError, ValueError, OverflowError):
                raise InputError(f"position is {value!r}; give three whole numbers") from None
            place = (x, y, z)
            if place not in self._layout.box:
                box = self._layout.box
                raise InputError(f"{place} lies outside the box {box.low}..{box.high}")
            return np.array(self._layout.box.index(place), dtype=np.int64)
        if part == "count":
            if not isinstance(value, int | np.integer) or not 1 <= value <= MOST_ITEMS:
                raise InputError(f"count is {value!r}; give 1 to {MOST_ITEMS}")
            return np.int64(value)
        return np.int64(self._layout.number(_KINDS[part], value))

    def read(self, action: Mapping[str, Any]) -> Call:
        """Return the call that an action means.

        Raises:
            InputError: It is no action of the space.
        """
        try:
            skill = self.skills[_index(action["skill"])]
            return Call(skill, self._args(skill, action))
        except (KeyError, IndexError, TypeError, ValueError, OverflowError) as error:
            raise InputError(
                f"{repr(action)[:_LONGEST]} is no action here ({error!r}); "
                "sample action_space() or use action()"
            ) from None

    def _args(self, skill: str, action: Mapping[str, Any]) -> tuple[Any, ...]:
        def named(part: str) -> Any:
            return getattr(self._layout, _KINDS[part])[_index(action[part])]

        args: tuple[Any, ...] = ()
        match skill:
            case "goToPosition":
                args = (self._position(action["position"]), 0)
            case "openContainer":
                args = (named("container"),)
            case "getItemFromChest" | "depositItemIntoChest":
                args = (named("container"), {named("item"): _index(action["count"])})
            case "openDoor" | "closeDoor":
                args = (named("door"),)
            case "writeSign":
                args = (named("sign"), named("phrase"))
            case "giveItemToOther":
                args = (named("agent"), named("item"), _index(action["count"]))
            case "say" | "whisper":
                phrase = named("phrase")
                claims = [claim.plain() for claim in self._phrases[phrase]]
                whom = (named("agent"),) if skill == "whisper" else ()
                args = (*whom, phrase, *([claims] if claims else []))
        return args

    def _position(self, index: Any) -> Position:
        low, shape = self._layout.box.low, self._layout.box.shape
        x, y, z = (int(value) for value in index)
        if not all(0 <= value < size for value, size in zip((x, y, z), shape, strict=True)):
            raise IndexError(f"position {(x, y, z)} of {shape}")
        return (low[0] + x, low[1] + y, low[2] + z)


def _index(value: Any) -> int:
    number = int(value)
    if number < 0:
        raise IndexError(f"{number} is below 0")
    return number
