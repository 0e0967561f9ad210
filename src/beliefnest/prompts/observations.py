"""Observations of a mind in the order of time: what a story is told from."""

from collections.abc import Mapping

import msgspec

from beliefnest.belief.grounds import PerceivedEvent
from beliefnest.world.values import Items, Point, Position


class Outset(msgspec.Struct, frozen=True):
    """Agents and possessions that are perceived at the first tick.

    Attributes:
        tick: The tick.
        owner: The observer; None: a narrator, who perceives everything.
        feet: Feet of the perceived agents, by name; the observer's own included.
        has: Items that each of them is known to have.
        known: Names of the others who know of these items, by name of the holder, as the observer
            believes; the observer itself and the holder are left out.
    """

    tick: int
    owner: str | None
    feet: Mapping[str, Point]
    has: Mapping[str, Items]
    known: Mapping[str, tuple[str, ...]] = msgspec.field(default_factory=dict)


class Assumed(msgspec.Struct, frozen=True):
    """Contents that the observer took for granted from the start."""

    tick: int
    place: Position
    items: Items


class AssumedAgent(msgspec.Struct, frozen=True):
    """Place and possessions of an agent that the observer took for granted from the start."""

    tick: int
    name: str
    feet: Point | None
    has: Items


class SightChange(msgspec.Struct, frozen=True):
    """Change of what a viewer can see.

    Attributes:
        tick: The tick.
        viewer: The viewer: the observer, or any agent if a narrator tells.
        agents: Agents that come into sight, with their feet.
        places: Containers and signs that come into sight.
        lost_agents: Agents that are no longer seen, with their feet when last seen.
        lost_places: Containers and signs that are no longer seen.
        kinds: Names of the blocks of `places`, as they are seen; empty if a narrator tells.
        labelled: Those of `places` that still have the label of the scenario; empty if a narrator
            tells.
    """

    tick: int
    viewer: str
    agents: Mapping[str, Point] = msgspec.field(default_factory=dict)
    places: tuple[Position, ...] = ()
    lost_agents: Mapping[str, Point] = msgspec.field(default_factory=dict)
    lost_places: tuple[Position, ...] = ()
    kinds: Mapping[Position, str] = msgspec.field(default_factory=dict)
    labelled: tuple[Position, ...] = ()


class Found(msgspec.Struct, frozen=True):
    """Complete contents that the observer perceives and could not have known before.

    Attributes:
        tick: The tick.
        place: Position of the container.
        items: Its content.
        known: Names of the agents who know of these items, if a narrator tells the contents of a
            container that nobody can see into; None: everybody who sees the container knows.
    """

    tick: int
    place: Position
    items: Items
    known: tuple[str, ...] | None = None


class Read(msgspec.Struct, frozen=True):
    """Text of a sign that the observer sees and has not seen before; empty: it is blank."""

    tick: int
    place: Position
    text: str


class Lying(msgspec.Struct, frozen=True):
    """Items that the observer sees lying on the floor for the first time."""

    tick: int
    name: str
    count: int
    position: Point


class Happened(msgspec.Struct, frozen=True):
    """Event that the observer perceives.

    Attributes:
        tick: The tick.
        event: The event.
        block: Block at its position, as the observer believes after it; None if it is unknown, or
            if a narrator tells.
        heard: Names of the others who heard an utterance, as the observer believes; its speaker and
            the observer itself are left out. None if everybody hears everything, or if it is no
            utterance.
    """

    tick: int
    event: PerceivedEvent
    block: str | None = None
    heard: tuple[str, ...] | None = None


Observation = Outset | Assumed | AssumedAgent | SightChange | Found | Read | Lying | Happened
