"""Percepts: what an agent with a pose perceives of a state; each rule once (semantics, section 3).

The belief kernel compiles `perceives`. Inference, imagined worlds and explanations call the other
functions with the blocks of one state. Lines of sight are those of `sight`.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from beliefnest.perception.options import HEAR_ALL, HEAR_SEEN, SenseLimits
from beliefnest.perception.sight import SightLines
from beliefnest.world.event_kinds import Sense
from beliefnest.world.values import EYE_HEIGHT, DroppedItem, Items, Point, Position

K = TypeVar("K")
V = TypeVar("V")

_ITEM_HEIGHT = 0.125


def perceives(
    limits: SenseLimits, sense: int, sees_actor: bool, sees_place: bool, away: float
) -> bool:
    """Return True if an agent perceives an event of somebody else.

    Args:
        limits: Options of perception.
        sense: The `Sense` by which events of this kind are perceived.
        sees_actor: True if the agent sees the actor.
        sees_place: True if it sees the place of the event; needed for `Sense.PLACE` alone.
        away: Distance between the feet of both, blocks; infinite if it does not know the actor's.
    """
    if sense == Sense.HEARING:
        return sees_actor if limits.hearing == HEAR_SEEN else away <= limits.radius
    if sense == Sense.PLACE:
        return sees_place
    return sees_actor if sense == Sense.ACTOR else False


def is_common(limits: SenseLimits, sense: int, is_own: bool) -> bool:
    """Return True if whoever perceives an event credits an agent with it, present or not.

    Args:
        limits: Options of perception.
        sense: As for `perceives`.
        is_own: True if the agent is the actor.
    """
    return sense == Sense.HEARING and (is_own or limits.hearing == HEAR_ALL)


class Gaze(NamedTuple):
    """An agent's eye; yaw and pitch in radians, as for `SightLines`."""

    eye: Point
    yaw: float
    pitch: float


def gaze_from(feet: Point, yaw: float, pitch: float) -> Gaze:
    """Return the eye of an agent with its feet at a point."""
    x, y, z = feet
    return Gaze((x, y + EYE_HEIGHT, z), yaw, pitch)


def middle_of(item: DroppedItem) -> Point:
    """Return the point at which a dropped item is seen."""
    x, y, z = item.position
    return (x, y + _ITEM_HEIGHT, z)


class Perceptibles(NamedTuple):
    """Things in a state, besides its blocks, that somebody may perceive.

    Attributes:
        contents: Contents that show from outside, by container; None: unknown.
        agents: Feet of agents, by name.
        items: Dropped items, by number.
    """

    contents: Mapping[Position, Items | None] = {}
    agents: Mapping[str, Point] = {}
    items: Mapping[int, DroppedItem] = {}


def percept(lines: SightLines, gaze: Gaze, things: Perceptibles) -> Perceptibles:
    """Return those things that an eye sees through the blocks of a state."""
    items = [middle_of(item) for item in things.items.values()]
    return Perceptibles(
        _seen(things.contents, [*things.contents], gaze, lines.sees_blocks),
        _seen(things.agents, [*things.agents.values()], gaze, lines.sees_agents),
        _seen(things.items, items, gaze, lines.sees_points),
    )


def _seen(
    things: Mapping[K, V],
    places: Sequence[tuple[float, float, float]],
    gaze: Gaze,
    sees: Callable[[Point, float, float, npt.ArrayLike], npt.NDArray[np.bool_]],
) -> Mapping[K, V]:
    if not things:
        return {}
    pairs = zip(things.items(), sees(*gaze, places).tolist(), strict=True)
    return {key: thing for (key, thing), is_seen in pairs if is_seen}
