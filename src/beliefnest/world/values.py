"""Immutable values that all packages share: positions, agents, items, events.

Coordinates are scenario coordinates. A block's position is its lower corner (integers), an
agent's position is the middle of its feet (floats), and y points up. Angles are Mineflayer's
radians: yaw 0 looks along -z, pi/2 along -x; pitch is positive upwards. Time is counted in ticks
of 50 ms.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import msgspec
from msgspec.structs import replace

from beliefnest.errors import PositionError
from beliefnest.world.event_kinds import EventKind

TICKS_PER_SECOND = 20
EYE_HEIGHT = 1.62
HALF_WIDTH = 0.3
"""Distance from the middle of an agent to each side of its body, in blocks."""
BODY_CENTRE_HEIGHT = 0.9
"""Height of the middle of an agent's body above its feet, in blocks."""

AGENT_SAMPLE_HEIGHTS = (EYE_HEIGHT, BODY_CENTRE_HEIGHT, 0.05)
"""Heights above the feet of the points at which others see an agent, in blocks."""
EQUIPMENT_SLOTS = ("head", "chest", "legs", "feet", "main_hand", "off_hand")

Position = tuple[int, int, int]
"""A block position, in scenario coordinates."""

Point = tuple[float, float, float]
"""A point in space, in blocks and scenario coordinates."""

Placements = Mapping[str | Position, tuple[Point, Point] | tuple[str | None, str]]
"""Differences between a belief and its body.

Agents map to a pair of feet positions: believed and actual. Block positions map to a pair of
blocks: the believed block or None, and the actual one.
"""

Items = Mapping[str, int]
"""Item name to count; counts are positive."""


def block_at(point: Point) -> Position:
    """Return the position of the block that contains a point."""
    return (math.floor(point[0]), math.floor(point[1]), math.floor(point[2]))


def feet_in(position: Position) -> Point:
    """Return the feet of an agent that stands in the middle of a block's place."""
    return (position[0] + 0.5, float(position[1]), position[2] + 0.5)


class Sign(NamedTuple):
    """A sign with text: its block state id and the text of its front, never empty."""

    state: int
    text: str


Block = int | Sign
"""A block state id, or a sign with its text; -1 is unknown."""


@dataclass(frozen=True, slots=True)
class Box:
    """Region of a scenario: two inclusive corners of block positions."""

    low: Position
    high: Position

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of blocks along x, y and z."""
        (x0, y0, z0), (x1, y1, z1) = self.low, self.high
        return (x1 - x0 + 1, y1 - y0 + 1, z1 - z0 + 1)

    @classmethod
    def between(cls, first: Position, second: Position) -> "Box":
        """Return the box between two opposite corners in any order."""
        (x0, x1), (y0, y1), (z0, z1) = map(sorted, zip(first, second, strict=True))
        return cls((x0, y0, z0), (x1, y1, z1))

    def __contains__(self, position: Position) -> bool:
        (x0, y0, z0), (x, y, z), (x1, y1, z1) = self.low, position, self.high
        return x0 <= x <= x1 and y0 <= y <= y1 and z0 <= z <= z1

    def check(self, position: Position) -> None:
        """Raise PositionError if a position is outside the box."""
        if position not in self:
            raise PositionError(f"position {position} is outside the box {self.low}..{self.high}")

    def index(self, position: Position) -> tuple[int, int, int]:
        """Return the index of a position in a dense array of shape `shape`."""
        return (position[0] - self.low[0], position[1] - self.low[1], position[2] - self.low[2])

    def positions(self) -> Iterator[Position]:
        """Yield all block positions, x slowest, z fastest (the order of a dense array)."""
        for x in range(self.low[0], self.high[0] + 1):
            for y in range(self.low[1], self.high[1] + 1):
                for z in range(self.low[2], self.high[2] + 1):
                    yield (x, y, z)


class Event(msgspec.Struct, frozen=True):
    """An event during one tick.

    Attributes:
        kind: Kind of event.
        actor: Agent that acted; None for a block update without a known actor.
        detail: The part of the event that witnesses perceive, with fields of `EventDetail`.
    """

    kind: EventKind
    actor: str | None
    detail: Mapping[str, Any] = msgspec.field(default_factory=dict)


class AgentState(msgspec.Struct, frozen=True):
    """Actual pose and possessions of one agent (not anyone's belief about them).

    Attributes:
        position: Middle of the feet, blocks.
        yaw: Radians, Mineflayer's convention.
        pitch: Radians, positive upwards.
        on_ground: True if the agent stands on something.
        equipment: Slot of `EQUIPMENT_SLOTS` to item name; an absent slot is empty.
        inventory: Item name to count, including worn and held items.
        health: Half hearts, 0 to 20.
        food: Half drumsticks, 0 to 20.
    """

    position: Point
    yaw: float = 0.0
    pitch: float = 0.0
    on_ground: bool = True
    equipment: Mapping[str, str] = msgspec.field(default_factory=dict)
    inventory: Items = msgspec.field(default_factory=dict)
    health: float = 20.0
    food: float = 20.0

    def moved(self, position: Point, yaw: float, pitch: float) -> "AgentState":
        """Return the agent at another pose."""
        return replace(self, position=position, yaw=yaw, pitch=pitch)


class DroppedItem(msgspec.Struct, frozen=True):
    """An item entity in the world."""

    name: str
    count: int
    position: Point
