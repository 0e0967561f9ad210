"""Frames and snapshots: the facts one simulator reports.

A frame is what changed in one simulator in one tick; a snapshot is everything there is
at one tick. Both say what is, never what anyone believes.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

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

__all__ = ["BlockGrid", "Frame", "PlainClaims", "Snapshot"]

PlainClaims = tuple[Mapping[str, Any], ...]
"""Claims as plain data."""

BlockGrid = npt.NDArray[np.int32]
"""Block state ids of a box, shape `Box.shape`, C order; -1 is unknown."""


_NOTHING: Mapping[object, object] = {}


@dataclass(frozen=True, slots=True)
class Frame:
    """What changed in one simulator during one tick.

    Attributes:
        tick: The tick that ended; frames of one timeline have rising ticks.
        agents: Agents whose state changed, with their new state; None: left the world.
        blocks: Positions whose block changed, or what is written on it, with the new block.
        containers: Containers whose content changed, with all they hold now; None where
            there is no container any more.
        items: Item entities that changed; None: gone.
        events: What happened, in order.
    """

    tick: int
    agents: Mapping[str, AgentState | None] = field(default_factory=dict)
    blocks: Mapping[Position, Block] = field(default_factory=dict)
    containers: Mapping[Position, Items | None] = field(default_factory=dict)
    items: Mapping[int, DroppedItem | None] = field(default_factory=dict)
    events: tuple[Event, ...] = ()

    def __post_init__(self) -> None:
        # Runs have very many frames, and most change little: nothings are one and the same.
        for name in ("agents", "blocks", "containers", "items"):
            if not getattr(self, name):
                object.__setattr__(self, name, _NOTHING)

    @property
    def is_empty(self) -> bool:
        """True if nothing changed and nothing happened."""
        return not (self.agents or self.blocks or self.containers or self.items or self.events)


@dataclass(frozen=True, slots=True)
class Snapshot:
    """All of one simulator at one tick; the grid is not to be written to.

    `signs` has the texts of those that are written on, `sign_claims` what is claimed on them, as
    plain data (see `world.claims`).

    `internal_state` is what goes on in it besides and nobody can perceive, as the speed of who
    falls or the heat of a furnace: bytes that only the simulator's world reads. Empty: nothing is
    under way.
    """

    tick: int
    box: Box
    blocks: BlockGrid
    containers: Mapping[Position, Items]
    agents: Mapping[str, AgentState]
    items: Mapping[int, DroppedItem] = field(default_factory=dict)
    internal_state: bytes = b""
    signs: Mapping[Position, str] = field(default_factory=dict)
    sign_claims: Mapping[Position, PlainClaims] = field(default_factory=dict)

    def block(self, place: Position) -> Block:
        """Return the block at a position of the box."""
        state = int(self.blocks[self.box.index(place)])
        return Sign(state, self.signs[place]) if place in self.signs else state
