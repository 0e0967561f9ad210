"""The read-only view of one simulator's state that users, prompts and pictures get."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from beliefnest.belief.entries import AgentBelief, Basis, ContainerBelief, PerceivedEvent
from beliefnest.world.frames import BlockGrid
from beliefnest.world.paths import BeliefPath
from beliefnest.world.values import Box, DroppedItem, Position

__all__ = ["BlockView", "FixedState", "State"]


class BlockView(Protocol):
    """Believed blocks of a box: a mapping from position to block state text or None."""

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
        """Block state ids, shape of the box, -1 where unknown; not to be written to."""

    def named(self, names: frozenset[str]) -> dict[Position, str]:
        """Return known blocks whose name is one of `names`, in order of position."""

    def current(self, position: Position) -> bool:
        """Return True if the block is backed by a perception in this tick."""

    def basis(self, position: Position) -> Basis | None:
        """What the block rests on; None where it is unknown."""


class State(Protocol):
    """One simulator at one tick."""

    @property
    def path(self) -> tuple[str, ...]:
        """Normalised belief path, agent names from the outermost believer inwards.

        Empty for the real world.
        """

    @property
    def tick(self) -> int:
        """The tick it is the state of."""

    @property
    def box(self) -> Box:
        """The part of space it covers."""

    @property
    def blocks(self) -> BlockView:
        """Believed blocks."""

    @property
    def signs(self) -> Mapping[Position, str]:
        """Text of each known sign, in order of position; empty where nothing is written."""

    @property
    def containers(self) -> Mapping[Position, ContainerBelief]:
        """Known containers by position."""

    @property
    def agents(self) -> Mapping[str, AgentBelief]:
        """Every agent of the scenario by name, unknown pose included."""

    @property
    def items(self) -> Mapping[int, DroppedItem]:
        """Dropped items last seen."""

    @property
    def events(self) -> tuple[PerceivedEvent, ...]:
        """Perceived events other than speech and thought, in order."""

    @property
    def chat(self) -> Sequence[tuple[int, str, str]]:
        """What was heard: (tick, speaker, text)."""

    @property
    def thoughts(self) -> Sequence[tuple[int, str, str]]:
        """What the owner thought: (tick, thinker, text)."""

    @property
    def addressees(self) -> Sequence[str | None]:
        """By line of `chat`, to whom it was whispered; None: it was said aloud."""

    @property
    def owner(self) -> str | None:
        """The agent whose belief this is; None in the real world."""


@dataclass(frozen=True)
class FixedState:
    """A state whose parts are all at hand; attributes as those of `State`."""

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
    signs: Mapping[Position, str] = field(default_factory=dict)

    @property
    def owner(self) -> str | None:
        """The agent whose belief this is; None in the real world."""
        return self.path[-1] if self.path else None
