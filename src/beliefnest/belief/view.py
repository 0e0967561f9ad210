"""The read-only view of one simulator's state that users, prompts and pictures get."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from beliefnest.belief.entries import AgentBelief, Basis, ContainerBelief, PerceivedEvent
from beliefnest.world.values import Box, DroppedItem, Position

__all__ = ["BlockView", "State"]


class BlockView(Protocol):
    """Believed blocks of a box: a mapping from position to block state text or None."""

    def __getitem__(self, position: Position) -> str | None:
        """Canonical block state text, `air`, or None where unknown.

        Raises:
            PositionError: The position is outside the box.
        """

    def __iter__(self) -> Iterator[Position]:
        """All positions of the box."""

    def __len__(self) -> int:
        """Number of positions in the box."""

    def named(self, names: frozenset[str]) -> dict[Position, str]:
        """Known blocks whose name is one of `names`, in order of position."""

    def current(self, position: Position) -> bool:
        """Whether the block is backed by a perception in this tick."""

    def basis(self, position: Position) -> Basis | None:
        """What the block rests on; None where it is unknown."""


@dataclass(frozen=True)
class State:
    """One simulator at one tick.

    Attributes:
        path: Normalised belief path, agent names from the outermost believer inwards;
            empty for the real world.
        tick: The tick it is the state of.
        box: The part of space it covers.
        blocks: Believed blocks.
        containers: Known containers by position.
        agents: Every agent of the scenario by name, unknown pose included.
        items: Dropped items last seen.
        events: Perceived events other than speech and thought, in order.
        chat: What was heard: (tick, speaker, text).
        thoughts: What the owner thought: (tick, thinker, text).
        addressees: By line of `chat`, to whom it was whispered; None: it was said aloud.
    """

    path: tuple[str, ...]
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

    @property
    def owner(self) -> str | None:
        """The agent whose belief this is; None in the real world."""
        return self.path[-1] if self.path else None
