"""What a belief says about one element, and what it rests on (semantics, section 2)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from beliefnest.world.paths import BeliefPath
from beliefnest.world.values import Block, EventKind, Items, Point, Position

__all__ = [
    "SOURCES",
    "AgentBelief",
    "Basis",
    "ContainerBelief",
    "InitialBelief",
    "PerceivedEvent",
    "Source",
]


class Source(StrEnum):
    """The kind of ground a belief entry rests on."""

    PRIOR = "prior"
    SEEN = "seen"
    WITNESSED = "witnessed"
    HEARD = "heard"
    EDITED = "edited"


SOURCES = tuple(Source)
"""Source of each code that arrays hold."""


@dataclass(frozen=True, slots=True)
class Basis:
    """The ground of an entry.

    Attributes:
        observed_at: The last tick at which the value was current: now, while it still is.
        source: Kind of ground.
        event: The kind of the event that was witnessed or heard, if it was one.
        speaker: Who said it, if it was heard.
    """

    observed_at: int
    source: Source
    event: EventKind | None = None
    speaker: str | None = None


@dataclass(frozen=True, slots=True)
class ContainerBelief:
    """What is believed to be in a container.

    Attributes:
        items: Known items, name to count.
        complete: Whether these are known to be all.
        basis: What the entry rests on.
        current: Whether a perception in this tick backs it.
    """

    items: Items
    complete: bool
    basis: Basis
    current: bool


@dataclass(frozen=True, slots=True)
class AgentBelief:
    """What is believed of an agent.

    Attributes:
        position: Middle of the feet when last perceived, blocks; None: unknown.
        yaw: Radians, Mineflayer's convention; 0 where the position is unknown.
        pitch: Radians, positive upwards; 0 where the position is unknown.
        on_ground: Whether it stood on something.
        equipment: Slot to item name as last seen; None: never seen.
        inventory: Known possessions, item name to count.
        inventory_complete: Whether these are known to be all.
        health: Half hearts; None: unknown.
        food: Half drumsticks; None: unknown.
        basis: What the pose rests on; None where it is unknown.
        current: Whether a perception in this tick backs the pose.
    """

    position: Point | None = None
    yaw: float = 0.0
    pitch: float = 0.0
    on_ground: bool = True
    equipment: Mapping[str, str] | None = None
    inventory: Items = field(default_factory=dict)
    inventory_complete: bool = False
    health: float | None = None
    food: float | None = None
    basis: Basis | None = None
    current: bool = False


@dataclass(frozen=True, slots=True)
class PerceivedEvent:
    """An event as it was perceived: who did what, and when."""

    tick: int
    kind: EventKind
    actor: str | None
    detail: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class InitialBelief:
    """What a node of the nest holds before anything happens.

    Attributes:
        path: Agent names from the outermost believer inwards; `**` at the end means that node and
            everything below it, `**` alone what everybody takes for granted, and takes it for
            granted that everybody does. Where several speak of the same, the longer path counts,
            and of these the one without `**`.
        containers: Position to (items, complete).
        blocks: Position to block; -1 makes one unknown.
        agents: Agent name to believed feet position.
    """

    path: BeliefPath
    containers: Mapping[Position, tuple[Items, bool]] = field(default_factory=dict)
    blocks: Mapping[Position, Block] = field(default_factory=dict)
    agents: Mapping[str, Point] = field(default_factory=dict)
