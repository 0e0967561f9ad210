"""State of a node at a moment of a timeline, for users, prompts and pictures."""

from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager
from typing import Protocol

from beliefnest.belief.columns import cell_of, cells_between, place_of
from beliefnest.belief.context import BeliefContext
from beliefnest.belief.forest import Forest
from beliefnest.belief.grounds import Basis
from beliefnest.belief.node_view import NodeView, Part
from beliefnest.importing import part
from beliefnest.nest.past.shown_words import state_words
from beliefnest.timeline.journal import ForkPoint, TimelineKey
from beliefnest.world.frames import BlockGrid
from beliefnest.world.paths import BeliefPath, path_text
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Position

# After this many questions about single blocks, or in a box of at most this many cells, all blocks
# are computed at once. In a box whose nodes hold chunks it is those of a cube with this edge.
_FEW = 4
_SMALL = 1024
_AROUND = 32

_PARTS = (
    *("path", "tick", "box", "blocks", "signs", "containers", "agents", "items"),
    *("events", "chat", "thoughts", "addressees"),
)


class GroundsSource(Protocol):
    """Source of what a forest keeps of few blocks only: their bases and which are current.

    Attributes:
        turn: Lock of the thread that reads the timelines.
    """

    turn: AbstractContextManager[object]

    def block_bases(
        self, moment: ForkPoint, path: BeliefPath, cells: Sequence[int]
    ) -> dict[int, Basis | None]:
        """Return the bases of a node's blocks at some cells; None where a block is unknown."""

    def current_blocks(self, moment: ForkPoint, path: BeliefPath, cells: Iterable[int]) -> set[int]:
        """Return the cells whose block in a node is current."""


class _Grounds:
    """Grounds of a node's blocks, computed on demand."""

    def __init__(
        self, source: GroundsSource, moment: ForkPoint, path: BeliefPath, context: BeliefContext
    ) -> None:
        self._source, self._of = source, (moment, path)
        self._context = context
        self._bases: dict[int, Basis | None] = {}
        self._currents: dict[int, bool] = {}

    def is_current(self, cell: int) -> bool:
        """Return True if the block of a cell is backed by a perception in this tick."""
        if cell not in self._currents:
            cells = self._asked_with(cell, self._currents)
            with self._source.turn:
                current = self._source.current_blocks(*self._of, cells)
            self._currents.update((each, each in current) for each in cells)
        return self._currents[cell]

    def basis(self, cell: int) -> Basis | None:
        """Return the ground of the block of a cell; None where it is unknown."""
        if cell not in self._bases:
            with self._source.turn:
                cells = self._asked_with(cell, self._bases)
                self._bases.update(self._source.block_bases(*self._of, cells))
        return self._bases[cell]

    def _asked_with(self, cell: int, cells_asked: Collection[int]) -> Sequence[int]:
        """Return the cells to compute together with one.

        A caller that asked for a few will probably ask for all, and in a small box all of them cost
        little more than one. In a box whose nodes hold chunks they are all around that cell.
        """
        context = self._context
        if len(cells_asked) < _FEW and context.cells > _SMALL:
            return [cell]
        if context.is_dense:
            return range(context.cells)
        x, y, z = (part - part % _AROUND for part in place_of(context.box, cell))
        return cells_between(
            context.box, (x, y, z), (x + _AROUND - 1, y + _AROUND - 1, z + _AROUND - 1)
        )


class _Blocks:
    """Blocks of a node by position."""

    def __init__(self, view: NodeView, context: BeliefContext, grounds: _Grounds) -> None:
        self._view, self._context, self._grounds = view, context, grounds

    @property
    def grid(self) -> BlockGrid:
        """The block state ids, shape of the box, -1 unknown."""
        return self._view.grid

    @property
    def terrain(self) -> Terrain:
        """The block state ids, -1 unknown."""
        return self._view.terrain

    def __getitem__(self, position: Position) -> str | None:
        state = self.terrain[self._index(position)]
        return None if state < 0 else self._context.registry.text(state)

    def __iter__(self) -> Iterator[Position]:
        return self._context.box.positions()

    def __len__(self) -> int:
        return self._context.cells

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, _Blocks):
            return NotImplemented
        return self.terrain == other.terrain

    __hash__ = None  # type: ignore[assignment]  # compared by value, and values are large

    def named(self, names: frozenset[str]) -> dict[Position, str]:
        """Return known blocks of some names."""
        registry, terrain = self._context.registry, self.terrain
        x, y, z = self._context.box.low
        return {
            (x + i, y + j, z + k): registry.text(terrain[i, j, k])
            for i, j, k in terrain.find(registry.states_of(names)).tolist()
        }

    def current(self, position: Position) -> bool:
        """Return True if the block is backed by a perception in this tick."""
        return self._grounds.is_current(self._cell(position))

    def basis(self, position: Position) -> Basis | None:
        """Return the ground of the block; None where it is unknown."""
        return self._grounds.basis(self._cell(position))

    def _cell(self, position: Position) -> int:
        self._index(position)
        return cell_of(self._context.box, position)

    def _index(self, position: Position) -> tuple[int, int, int]:
        box = self._context.box
        box.check(position)
        return box.index(position)


class TimelineState(NodeView):
    """`State` of a node at a moment of a timeline, read in the nest's turn.

    Args:
        forest: Forest of the timeline, after the entries before the moment.
        path: Path of the node.
        tick: Tick of the moment; None: the tick of the last entry.
        key: The timeline.
        source: Source of the grounds of blocks.
    """

    def __init__(
        self,
        forest: Forest,
        path: BeliefPath,
        tick: int | None,
        key: TimelineKey,
        source: GroundsSource,
    ) -> None:
        self.turn = source.turn
        super().__init__(forest, path, tick)
        self._context, self._position = forest.context, forest.position
        self._key, self._source = key, source

    @property
    def blocks(self) -> _Blocks:
        """The believed blocks."""
        # Made anew: with a cycle of references the forest would keep a view that is gone.
        return _Blocks(self, self._context, self._grounds)

    @Part
    def _grounds(self) -> _Grounds:
        moment = ForkPoint(self._key, self._position, self.tick)
        return _Grounds(self._source, moment, self.path, self._context)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, TimelineState):
            return NotImplemented
        return all(getattr(self, part) == getattr(other, part) for part in _PARTS)

    __hash__ = None  # type: ignore[assignment]  # compared by value, and values are large

    def __repr__(self) -> str:
        return f"<state of {path_text(self.path)} at tick {self.tick}: {state_words(self)}>"

    def _repr_html_(self) -> str:
        return str(part("drawing").figure_of_state(self)._repr_html_())
