"""Values and grounds of beliefs about single elements (semantics, section 2)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

import msgspec

from beliefnest.world.event_kinds import EventKind
from beliefnest.world.paths import BeliefPath
from beliefnest.world.values import Block, Items, Point, Position
from beliefnest.world.words import counted


class Source(StrEnum):
    """The kind of ground a belief entry rests on."""

    PRIOR = "prior"
    SEEN = "seen"
    WITNESSED = "witnessed"
    HEARD = "heard"
    EDITED = "edited"


SOURCES = tuple(Source)
"""The sources in order of the codes that stand for them in arrays."""


class Basis(msgspec.Struct, frozen=True):
    """The ground of an entry.

    Attributes:
        observed_at: The last tick at which the value was current; if it still is, the present tick.
        source: Kind of ground.
        event: The kind of the event that was witnessed or heard, if it was one.
        speaker: Name of the speaker, if the value was heard from somebody known.
    """

    observed_at: int
    source: Source
    event: EventKind | None = None
    speaker: str | None = None


class ContainerBelief(msgspec.Struct, frozen=True):
    """Believed content of a container.

    Attributes:
        items: Known items, name to count.
        complete: True if the container is known to hold nothing else.
        basis: Ground of the entry.
        current: True if a perception in this tick backs the entry.
    """

    items: Items
    complete: bool
    basis: Basis
    current: bool


class AgentBelief(msgspec.Struct, frozen=True):
    """Believed pose and possessions of an agent.

    Attributes:
        position: Middle of the feet when last perceived, blocks; None: unknown.
        yaw: Radians, Mineflayer's convention; 0 where the position is unknown.
        pitch: Radians, positive upwards; 0 where the position is unknown.
        on_ground: True if the agent stood on something.
        equipment: Slot to item name as last seen; None: never seen.
        inventory: Known possessions, item name to count.
        inventory_complete: True if the agent is known to have nothing else.
        health: Half hearts; None: unknown.
        food: Half drumsticks; None: unknown.
        basis: Ground of the pose; None where the position is unknown.
        current: True if a perception in this tick backs the pose.
    """

    position: Point | None = None
    yaw: float = 0.0
    pitch: float = 0.0
    on_ground: bool = True
    equipment: Mapping[str, str] | None = None
    inventory: Items = msgspec.field(default_factory=dict)
    inventory_complete: bool = False
    health: float | None = None
    food: float | None = None
    basis: Basis | None = None
    current: bool = False


class PerceivedEvent(msgspec.Struct, frozen=True):
    """Event as an observer perceived it: tick, kind, actor and details."""

    tick: int
    kind: EventKind
    actor: str | None
    detail: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class InitialBelief:
    """Prior beliefs of a node, or of a node and all nodes below it.

    Attributes:
        path: Agent names from the outermost believer inwards. `**` at the end means the node and
            everything below it. `**` alone means all beliefs: common knowledge. If several initial
            beliefs set the same element, the longest path counts, and among equals the one
            without `**`.
        containers: Position to (items, complete).
        blocks: Position to block; -1 makes one unknown.
        agents: Agent name to believed feet position.
        inventories: Agent name to items that it is known to have, perhaps among others. What an
            agent itself has it always knows, so that its own entry has no effect.
    """

    path: BeliefPath
    containers: Mapping[Position, tuple[Items, bool]] = field(default_factory=dict)
    blocks: Mapping[Position, Block] = field(default_factory=dict)
    agents: Mapping[str, Point] = field(default_factory=dict)
    inventories: Mapping[str, Items] = field(default_factory=dict)


def age_text(ticks: int) -> str:
    """Return the age of a memory in words."""
    return f"{counted(ticks, 'tick')} ago"


def told_text(source: Source | None, teller: str, ticks: int) -> str:
    """Return the source and the age of hearsay in words, or the age of a memory.

    It is empty for what has been perceived at this tick.

    Args:
        source: Source of an entry that is not perceived now; None: it is, or it is not known.
        teller: The speaker, if it is hearsay.
        ticks: The age.
    """
    match source:
        case Source.PRIOR:
            return "believed from the start"
        case Source.HEARD:
            return f"told by {teller}{f' {age_text(ticks)}' if ticks else ''}"
        case Source.EDITED:
            return f"edited{f' {age_text(ticks)}' if ticks else ''}"
        case _:
            return age_text(ticks) if ticks else ""


def seen_text(source: Source | None, teller: str, ticks: int) -> str:
    """Return the same with `seen` before the age of a memory that was perceived."""
    if source is None:
        return "seen now"
    text = told_text(source, teller, ticks)
    return f"seen {text or 'now'}" if source in (Source.SEEN, Source.WITNESSED) else text
