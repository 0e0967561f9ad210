"""Frames and snapshots: the facts that one simulator reports.

A frame holds the changes of one simulator in one tick. A snapshot holds its whole state at one
tick. Both hold facts, never beliefs.
"""

from collections.abc import Collection, Iterator, Mapping
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt
from msgspec.structs import force_setattr

from beliefnest.world.terrain import Terrain
from beliefnest.world.values import (
    AgentState,
    Block,
    Box,
    DroppedItem,
    Event,
    Items,
    Position,
    Sign,
)

PlainClaims = tuple[Mapping[str, Any], ...]
"""Claims as plain data."""

BlockGrid = npt.NDArray[np.int32]
"""Block state ids of a box, shape `Box.shape`, C order; -1 is unknown."""


_NOTHING: Mapping[object, object] = {}


def places_of(
    mask: npt.NDArray[np.bool_], box: Box
) -> Iterator[tuple[Position, tuple[int, int, int]]]:
    """Yield the position and the index of each True element of a grid of a box, in order."""
    x, y, z = box.low
    for i, j, k in np.argwhere(mask).tolist():
        yield (x + i, y + j, z + k), (i, j, k)


class Frame(msgspec.Struct, frozen=True):
    """Changes of one simulator during one tick.

    Attributes:
        tick: The tick that ended; ticks of frames rise along a timeline.
        agents: New states of the agents that changed; None if an agent left the world.
        blocks: New blocks at the positions where the block or its text changed.
        containers: Full new contents of the containers that changed; None if the container is
            gone.
        items: New states of the dropped items that changed; None if an item is gone.
        events: Events, in order.
    """

    tick: int
    agents: Mapping[str, AgentState | None] = msgspec.field(default_factory=dict)
    blocks: Mapping[Position, Block] = msgspec.field(default_factory=dict)
    containers: Mapping[Position, Items | None] = msgspec.field(default_factory=dict)
    items: Mapping[int, DroppedItem | None] = msgspec.field(default_factory=dict)
    events: tuple[Event, ...] = ()

    def __post_init__(self) -> None:
        # A run has very many frames, most of them nearly empty. Sharing one empty mapping saves
        # memory.
        for name in ("agents", "blocks", "containers", "items"):
            if not getattr(self, name):
                force_setattr(self, name, _NOTHING)

    @property
    def is_empty(self) -> bool:
        """True if nothing changed and nothing happened."""
        return not (self.agents or self.blocks or self.containers or self.items or self.events)


class Snapshot(msgspec.Struct, frozen=True):
    """State of one simulator at one tick; it must not be changed.

    Attributes:
        tick: The tick.
        box: Region of the scenario.
        blocks: Block states.
        containers: Contents of containers.
        agents: States of agents.
        items: Dropped items by entity number.
        internal_state: State that nobody can perceive, such as the speed of a falling agent or
            the heat of a furnace. Only the simulator's world can read these bytes; empty if
            there is none.
        signs: Texts of the signs that have text.
        sign_claims: Claims on signs, as plain data (see `world.claims`).
    """

    tick: int
    box: Box
    blocks: Terrain
    containers: Mapping[Position, Items]
    agents: Mapping[str, AgentState]
    items: Mapping[int, DroppedItem] = msgspec.field(default_factory=dict)
    internal_state: bytes = b""
    signs: Mapping[Position, str] = msgspec.field(default_factory=dict)
    sign_claims: Mapping[Position, PlainClaims] = msgspec.field(default_factory=dict)

    def places(self, states: Collection[int]) -> list[Position]:
        """Return the positions of the blocks with one of some states, in order."""
        x, y, z = self.box.low
        return [(x + i, y + j, z + k) for i, j, k in self.blocks.find(states).tolist()]

    def block(self, place: Position) -> Block:
        """Return the block at a position of the box."""
        state = self.blocks[self.box.index(place)]
        return Sign(state, self.signs[place]) if place in self.signs else state
