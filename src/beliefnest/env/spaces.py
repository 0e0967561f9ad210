"""Spaces of observations and actions."""

from collections.abc import Mapping
from typing import Any, cast

import numpy as np
from gymnasium import spaces

from beliefnest.env.actions import MOST_ITEMS, Calls
from beliefnest.env.bounds import ArrayShape, SpaceBounds

_LONGEST_PROGRAM = 10_000
_LETTERS = frozenset(map(chr, range(32, 127))) | {"\n", "\t"}


class BeliefSpace(spaces.Space[dict[str, Any]]):
    """Space of beliefs as plain data: the objects of `beliefnest show --json`, with their bases."""

    def contains(self, x: Any) -> bool:
        """Return True if a value is such an object."""
        return isinstance(x, dict) and {"containers", "agents", "chat"} <= x.keys()

    def __eq__(self, other: object) -> bool:
        """Return True if the other one is such a space."""
        return isinstance(other, BeliefSpace)

    __hash__ = None  # type: ignore[assignment]  # as all spaces that can be compared

    def sample(self, mask: Any = None, probability: Any = None) -> dict[str, Any]:
        """Return the belief of an agent that knows nothing."""
        return {"containers": {}, "agents": {}, "chat": [], "addressees": [], "thoughts": []}

    @property
    def is_np_flattenable(self) -> bool:
        """False: the space has no fixed size."""
        return False


def space_of(shapes: Mapping[str, ArrayShape]) -> spaces.Dict:
    """Return the space of arrays by name."""
    return spaces.Dict(
        {
            name: spaces.Box(low, high, shape, cast(Any, dtype))
            for name, (shape, dtype, low, high) in shapes.items()
        }
    )


def observation_space(bounds: SpaceBounds, offers: int | None) -> spaces.Dict:
    """Return a space of observations as arrays, with a mask of as many actions as are offered."""
    shapes = dict(bounds.shapes())
    if offers is not None:
        shapes["action_mask"] = ((offers,), np.int8, 0, 1)
    return space_of(shapes)


def program_space() -> spaces.Text:
    """Return a space of programs."""
    return spaces.Text(_LONGEST_PROGRAM, min_length=0, charset=_LETTERS)


def call_space(calls: Calls, bounds: SpaceBounds) -> spaces.Dict:
    """Return the structured space of calls of skills."""
    parts: dict[str, spaces.Space[Any]] = {"skill": spaces.Discrete(len(calls.skills))}
    for part, size in calls.parts.items():
        if part == "position":
            parts[part] = spaces.MultiDiscrete(np.array(bounds.box.shape))
        elif part == "count":
            parts[part] = spaces.Discrete(MOST_ITEMS, start=1)
        else:
            parts[part] = spaces.Discrete(size)
    return spaces.Dict(parts)
