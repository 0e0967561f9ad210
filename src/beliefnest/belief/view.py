"""The read-only view of one simulator's state that users, prompts and pictures get."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Protocol

import msgspec

from beliefnest.belief.grounds import AgentBelief, Basis, ContainerBelief, PerceivedEvent
from beliefnest.world.frames import BlockGrid
from beliefnest.world.paths import BeliefPath
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box, DroppedItem, Position


class BlockView(Protocol):
    """Believed blocks of a box, as a mapping from position to block state text or None."""

    def __getitem__(self, position: Position) -> str | None:
        """Return the canonical block state text, `air`, or None where unknown.

        Raises:
            PositionError: The position is outside the box.
        """

    def __iter__(self) -> Iterator[Position]:
        """Yield all positions of the box."""

    def __len__(self) -> int:
        """Return the number of positions in the box."""

    @property
    def grid(self) -> BlockGrid:
        """The block state ids, shape of the box, -1 where unknown. Do not write to it."""

    @property
    def terrain(self) -> Terrain:
        """The block state ids, -1 where unknown; in large boxes it takes less memory than `grid`.

        Its indices are those of `grid`.
        """

    def named(self, names: frozenset[str]) -> dict[Position, str]:
        """Return known blocks whose name is one of `names`, in order of position."""

    def current(self, position: Position) -> bool:
        """Return True if the block is backed by a perception in this tick."""

    def basis(self, position: Position) -> Basis | None:
        """Return the ground of the block; None where it is unknown."""


class State(Protocol):
    """State of one simulator at one tick."""

    @property
    def path(self) -> tuple[str, ...]:
        """The normalised belief path: agent names from the outermost believer inwards.

        Empty for the real world.
        """

    @property
    def tick(self) -> int:
        """The tick of the state."""

    @property
    def box(self) -> Box:
        """The part of space that the simulator covers."""

    @property
    def blocks(self) -> BlockView:
        """The believed blocks."""

    @property
    def signs(self) -> Mapping[Position, str]:
        """The texts of known signs, in order of position; empty for a blank sign."""

    @property
    def containers(self) -> Mapping[Position, ContainerBelief]:
        """The known containers by position."""

    @property
    def agents(self) -> Mapping[str, AgentBelief]:
        """All agents of the scenario by name, also those of unknown pose."""

    @property
    def items(self) -> Mapping[int, DroppedItem]:
        """The dropped items last seen, by number."""

    @property
    def events(self) -> tuple[PerceivedEvent, ...]:
        """The perceived events other than speech and thought, in order."""

    @property
    def chat(self) -> Sequence[tuple[int, str, str]]:
        """The utterances heard: (tick, speaker, text)."""

    @property
    def thoughts(self) -> Sequence[tuple[int, str, str]]:
        """The owner's thoughts: (tick, thinker, text)."""

    @property
    def addressees(self) -> Sequence[str | None]:
        """The addressee of each line of `chat` that was whispered; None: it was said aloud."""

    @property
    def owner(self) -> str | None:
        """The agent whose belief this is; None in the real world."""


class FixedState(msgspec.Struct, frozen=True):
    """State whose parts are given. The attributes are those of `State`."""

    path: BeliefPath
    tick: int
    box: Box
    blocks: BlockView
    containers: Mapping[Position, ContainerBelief]
    agents: Mapping[str, AgentBelief]
    items: Mapping[int, DroppedItem]
    events: tuple[PerceivedEvent, ...]
    chat: Sequence[tuple[int, str, str]]
    thoughts: Sequence[tuple[int, str, str]]
    addressees: Sequence[str | None]
    signs: Mapping[Position, str] = msgspec.field(default_factory=dict)

    @property
    def owner(self) -> str | None:
        """The agent whose belief this is; None in the real world."""
        return self.path[-1] if self.path else None
