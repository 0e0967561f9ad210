"""Actions in a structured space, which stand for calls of skills."""

import operator
from collections.abc import Mapping
from typing import Any

import numpy as np

from beliefnest.env.bounds import Phrases, SpaceBounds
from beliefnest.env.order import Things
from beliefnest.errors import BeliefNestError, InputError, UnknownNameError
from beliefnest.skills.calls import Call, callables
from beliefnest.skills.manifests import Parameter
from beliefnest.world.values import Position

_LONGEST = 200
"""Greatest number of characters of an action in a message."""

MOST_ITEMS = 64
"""Greatest number of items of one kind that one call moves."""

SPEECH = ("say", "whisper")
"""Skills that others hear."""

KIND_OF_PART = {
    "container": "containers",
    "door": "doors",
    "lever": "levers",
    "button": "buttons",
    "sign": "signs",
    "item": "items",
    "agent": "agents",
    "phrase": "phrases",
}
"""Kind of the things that each part of an action numbers."""

_OPTIONS = {"phrase": "`phrases` of the environment", "item": "`items` of the environment"}
"""Options of an environment that add values of a part."""


class NotKnownError(BeliefNestError):
    """Number in an action that stands for nothing that its agent knows."""


class NamedAction(dict[str, Any]):
    """Action of the space that was made from names.

    Attributes:
        call: The call that it stands for, whichever agent gets it.
    """

    call: Call


class Calls:
    """Conversion of actions to calls and of names to actions.

    Args:
        bounds: Greatest numbers of things.
        phrases: Utterances with their claims.

    Attributes:
        skills: Names of the skills that are possible here; an action's `skill` is an index into
            them.
        possible: The same skills.
        parts: Number of values of each part of an action; `position` has three numbers instead.
    """

    def __init__(self, bounds: SpaceBounds, phrases: Phrases) -> None:
        self._bounds = bounds
        self._phrases = phrases
        sizes = {
            part: bounds.most[kind] for part, kind in KIND_OF_PART.items() if kind in bounds.most
        }
        sizes |= {"position": 1, "count": MOST_ITEMS, "phrase": len(bounds.phrases)}
        # An agent cannot give or whisper to itself.
        sizes["agent"] = sizes["agent"] if sizes["agent"] > 1 else 0
        skills = callables()
        actions = [skills["doNothing"], *(each for each in skills.values() if each.parts)]
        self._lacking = {
            each.name: [part for part in each.parts if not sizes[part]] for each in actions
        }
        self.possible = [each for each in actions if not self._lacking[each.name]]
        self.skills = tuple(each.name for each in self.possible)
        used = {part for each in self.possible for part in each.parts}
        self.parts = {part: size for part, size in sizes.items() if part in used}

    def action(self, things: Things, skill: str, parts_named: Mapping[str, object]) -> NamedAction:
        """Return an action of the space from names and positions.

        Args:
            things: The things that the agent knows, in its order.
            skill: Name of the skill.
            parts_named: `position`, `container`, `door`, `lever`, `button` and `sign` as block
                positions; `item`, `agent` and `phrase` as names or texts; `count` (default 1).

        Raises:
            UnknownNameError: There is no such skill, or no such thing.
            InputError: A part is missing, invalid or not used by the skill.
        """
        if skill not in self.skills:
            lacking = self._lacking.get(skill)
            if lacking:
                given_by = f"; give {_OPTIONS[lacking[0]]}" if lacking[0] in _OPTIONS else ""
                raise UnknownNameError(f"{skill} needs a {lacking[0]}, and there is none{given_by}")
            raise UnknownNameError(
                f"there is no skill {skill!r} here; skills are {', '.join(self.skills)}"
            )
        index = self.skills.index(skill)
        needs = self.possible[index].parts
        parts = {"count": 1, **parts_named} if "count" in needs else dict(parts_named)
        if parts.keys() != set(needs):
            raise InputError(f"{skill} takes {', '.join(needs) or 'nothing'}; got {sorted(parts)}")
        action: dict[str, Any] = {
            part: np.zeros(3, np.int64) if part == "position" else np.int64(part == "count")
            for part in self.parts
        }
        for part, value in parts.items():
            action[part] = self._numbered(things, part, value)
        named = NamedAction({"skill": np.int64(index), **action})
        named.call = self.read(things, named)
        return named

    def _numbered(self, things: Things, part: str, value: Any) -> Any:
        if part == "position":
            try:
                x, y, z = map(int, value)
            except (TypeError, ValueError, OverflowError):
                raise InputError(f"position is {value!r}; give three whole numbers") from None
            place = (x, y, z)
            if place not in self._bounds.box:
                box = self._bounds.box
                raise InputError(f"{place} lies outside the box {box.low}..{box.high}")
            return np.array(self._bounds.box.index(place), dtype=np.int64)
        if part == "count":
            if not isinstance(value, int | np.integer) or not 1 <= value <= MOST_ITEMS:
                raise InputError(f"count is {value!r}; give 1 to {MOST_ITEMS}")
            return np.int64(value)
        values = self.known(things, part)
        if value not in values:
            there = ", ".join(map(str, values)) or "none"
            raise UnknownNameError(
                f"{value!r} is not among the {KIND_OF_PART[part]} that the agent knows, which are "
                f"{there}"
            )
        return np.int64(values.index(value))

    def read(self, things: Things, action: Mapping[str, Any]) -> Call:
        """Return the call that an action stands for.

        Args:
            things: The things that the agent knows, in its order.
            action: The action.

        Raises:
            InputError: The action is not in the space.
            NotKnownError: A number stands for nothing that the agent knows.
        """
        try:
            skill = self.possible[index_of(action["skill"])]
            used = [each for each in skill.parameters if each.action != ()]
            args = [self._argument(things, each, action) for each in used]
            return Call(skill.name, tuple(each for each in args if each != []))
        except (KeyError, IndexError, TypeError, ValueError, OverflowError) as error:
            raise InputError(
                f"{repr(action)[:_LONGEST]} is not in the action space ({error!r}); "
                "sample action_space() or use action()"
            ) from None

    def _argument(self, things: Things, parameter: Parameter, action: Mapping[str, Any]) -> Any:
        """Return an argument of a call; no claims are an empty list."""
        if isinstance(parameter.action, int):
            return parameter.action
        value, *count = (self._value(things, part, action[part]) for part in parameter.action)
        if parameter.type == "Claim[]":
            return [claim.plain() for claim in self._phrases[value]]
        return {value: count[0]} if count else value

    def _value(self, things: Things, part: str, value: Any) -> Any:
        if part == "position":
            return self._position(value)
        index = index_of(value)
        if part == "count":
            return index
        if index >= self.parts[part]:
            raise IndexError(f"{part} {index} of {self.parts[part]}")
        values = self.known(things, part)
        if index >= len(values):
            raise NotKnownError(f"it knows no {part} {index} so far")
        return values[index]

    def known(self, things: Things, part: str) -> tuple[Any, ...]:
        """Return the things, or the phrases, that a part of an action numbers."""
        values = self._bounds.phrases if part == "phrase" else getattr(things, KIND_OF_PART[part])
        return tuple(values)

    def _position(self, index: Any) -> Position:
        low, shape = self._bounds.box.low, self._bounds.box.shape
        x, y, z = map(operator.index, index)
        if not all(0 <= value < size for value, size in zip((x, y, z), shape, strict=True)):
            raise IndexError(f"position {(x, y, z)} of {shape}")
        return (low[0] + x, low[1] + y, low[2] + z)


def index_of(value: Any) -> int:
    """Return a whole number as an index; raises IndexError below 0, and TypeError for others."""
    if isinstance(value, bool | np.bool_):
        raise TypeError(f"{value} is a truth")
    number = operator.index(value)
    if number < 0:
        raise IndexError(f"{number} is below 0")
    return number
