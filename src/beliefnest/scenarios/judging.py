"""Judging from the world: what was opened, who arrived where, what is believed to be where."""

import math
from collections.abc import Iterable

from beliefnest.belief.view import State
from beliefnest.scenarios.content import Arrives, Hears, Holds, Opens, Stands
from beliefnest.world.values import Event, EventKind, Items, Point, Position

__all__ = ["arrives", "is_held", "opened_by", "opens", "places_of"]


def opened_by(agent: str, events: Iterable[Event]) -> tuple[Position, ...]:
    """The containers that an agent opened, in order."""
    return tuple(
        _position(event.detail["position"])
        for event in events
        if event.kind is EventKind.OPEN_CONTAINER and event.actor == agent
    )


def opens(expect: Opens, opened: tuple[Position, ...]) -> bool:
    """Whether the expected container was opened before any other."""
    return opened[:1] == (expect.container,)


def arrives(expect: Arrives, arrived: Point | None) -> bool:
    """Whether an agent stands where it was expected to."""
    return arrived is not None and math.dist(expect.place, arrived) <= expect.within


def is_held(content: Holds | Stands | Hears, state: State) -> bool:
    """Whether a simulator holds what was expected of it."""
    if isinstance(content, Holds):
        # A container that was never perceived is known to hold nothing in particular.
        container = state.containers.get(content.container)
        return (dict(container.items) if container else {}) == dict(content.items)
    if isinstance(content, Hears):
        return content.ever is any(content.text in text for _, _, text in state.chat)
    position = state.agents[content.agent].position
    if content.place is None or position is None:
        return content.place is None and position is None
    return math.dist(content.place, position) <= content.within


def places_of(items: Items, state: State) -> tuple[Position, ...]:
    """The containers that are known to hold at least these items, in order of position."""
    return tuple(
        place
        for place, container in sorted(state.containers.items())
        if items and all(container.items.get(name, 0) >= n for name, n in items.items())
    )


def _position(value: Iterable[int]) -> Position:
    x, y, z = value
    return (int(x), int(y), int(z))
