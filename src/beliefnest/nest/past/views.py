"""Read-only states of nodes for users, prompts and pictures."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from functools import cached_property

import numpy as np

from beliefnest.belief.columns import cell_of
from beliefnest.belief.grounds import AgentBelief, Basis, ContainerBelief, PerceivedEvent
from beliefnest.belief.node_view import NodeView
from beliefnest.nest.past.history import History
from beliefnest.pictures.words import state_words
from beliefnest.timeline.journal import ForkPoint
from beliefnest.world.frames import BlockGrid
from beliefnest.world.paths import path_text
from beliefnest.world.values import DroppedItem, EventKind, Position

__all__ = ["LiveState"]

# After this many questions about single blocks, or in a box of at most this many cells, all blocks
# are computed at once.
_FEW = 4
_SMALL = 1024


_PARTS = (
    *("path", "tick", "box", "blocks", "signs", "containers", "agents", "items"),
    *("events", "chat", "thoughts", "addressees"),
)


class _Blocks:
    """Blocks of a node at one entry of a timeline, by position."""

    def __init__(
        self,
        history: History,
        moment: ForkPoint,
        reading: NodeView,
        turn: AbstractContextManager[object],
    ) -> None:
        self._history, self._context = history, history.context
        self._moment, self._reading, self._turn = moment, reading, turn
        self._bases: dict[int, Basis | None] = {}
        self._currents: dict[int, bool] = {}

    @property
    def grid(self) -> BlockGrid:
        """The block state ids, shape of the box, -1 unknown."""
        with self._turn:
            return self._reading.blocks

    def __getitem__(self, position: Position) -> str | None:
        state = int(self.grid[self._index(position)])
        return None if state < 0 else self._context.registry.text(state)

    def __iter__(self) -> Iterator[Position]:
        return self._context.box.positions()

    def __len__(self) -> int:
        return int(self.grid.size)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, _Blocks):
            return NotImplemented
        return bool(np.array_equal(self.grid, other.grid))

    __hash__ = None  # type: ignore[assignment]  # compared by value, and values are large

    def named(self, names: frozenset[str]) -> dict[Position, str]:
        """Return known blocks of some names."""
        registry, grid = self._context.registry, self.grid
        # One place more at the end, which -1 (unknown) indexes.
        wanted = np.zeros(registry.states + 1, dtype=np.bool_)
        for name in names:
            ids = registry.state_ids(name)
            wanted[ids.start : ids.stop] = True
        x, y, z = self._context.box.low
        return {
            (x + i, y + j, z + k): registry.text(int(grid[i, j, k]))
            for i, j, k in np.argwhere(wanted[grid]).tolist()
        }

    def signs(self) -> dict[Position, str]:
        """Return the text of each known sign, in order of position; empty for a blank sign."""
        texts, states = self._reading.signs, self._context.sign_states
        x, y, z = self._context.box.low
        found = np.argwhere(np.isin(self.grid, states)).tolist()
        places = ((x + i, y + j, z + k) for i, j, k in found)
        return {place: texts.get(place, "") for place in places}

    def current(self, position: Position) -> bool:
        """Return True if the block is backed by a perception in this tick."""
        cell = self._cell(position)
        if cell not in self._currents:
            cells = self._asked_with(cell, self._currents)
            at, path = self._moment, self._reading.path
            with self._turn:
                found = self._history.current_blocks(at.timeline, path, at.entries, cells)
            self._currents.update((each, each in found) for each in cells)
        return self._currents[cell]

    def basis(self, position: Position) -> Basis | None:
        """Return the ground of the block; None where it is unknown."""
        cell = self._cell(position)
        if cell not in self._bases:
            cells = self._asked_with(cell, self._bases)
            with self._turn:
                found = self._history.block_bases(self._moment, self._reading.path, cells)
            self._bases.update(found)
        return self._bases[cell]

    def _asked_with(self, cell: int, known: Collection[int]) -> Sequence[int]:
        """Return the cells to compute together with one.

        A caller that asked for a few will probably ask for all, and in a small box all of them cost
        little more than one.
        """
        every = self._context.cells
        return range(every) if len(known) >= _FEW or every <= _SMALL else [cell]

    def _cell(self, position: Position) -> int:
        self._index(position)
        return cell_of(self._context.box, position)

    def _index(self, position: Position) -> tuple[int, int, int]:
        box = self._context.box
        box.check(position)
        return box.index(position)


class LiveState:
    """`State` whose parts are read on demand, under the nest's `turn`.

    The attributes are those of `State`.
    """

    def __init__(
        self,
        history: History,
        moment: ForkPoint,
        reading: NodeView,
        turn: AbstractContextManager[object],
    ) -> None:
        self.path, self.tick, self.box = reading.path, moment.tick, history.context.box
        self._history, self._moment, self._reading, self._turn = history, moment, reading, turn

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, LiveState):
            return NotImplemented
        return all(getattr(self, part) == getattr(other, part) for part in _PARTS)

    __hash__ = None  # type: ignore[assignment]  # compared by value, and values are large

    def __repr__(self) -> str:
        return f"<state of {path_text(self.path)} at tick {self.tick}: {state_words(self)}>"

    def _repr_html_(self) -> str:
        # Imported here because drawing takes long to import, and few states are drawn.
        from beliefnest.pictures.figure import figure_of
        from beliefnest.pictures.scene import read_scene

        return figure_of([read_scene(self)])._repr_html_()

    @property
    def owner(self) -> str | None:
        """The agent whose belief this is; None in the real world."""
        return self.path[-1] if self.path else None

    @cached_property
    def blocks(self) -> _Blocks:
        """The believed blocks."""
        return _Blocks(self._history, self._moment, self._reading, self._turn)

    @cached_property
    def signs(self) -> Mapping[Position, str]:
        """The texts of known signs, in order of position; empty for a blank sign."""
        with self._turn:
            return self.blocks.signs()

    @cached_property
    def containers(self) -> Mapping[Position, ContainerBelief]:
        """The known containers by position."""
        with self._turn:
            return self._reading.containers

    @cached_property
    def agents(self) -> Mapping[str, AgentBelief]:
        """All agents of the scenario by name."""
        with self._turn:
            return self._reading.agents

    @cached_property
    def items(self) -> Mapping[int, DroppedItem]:
        """The dropped items last seen, by number."""
        with self._turn:
            return self._reading.items

    @cached_property
    def events(self) -> tuple[PerceivedEvent, ...]:
        """The perceived events other than speech and thought, in order."""
        return tuple(event for event in self._perceived if not event.kind.is_speech)

    @cached_property
    def chat(self) -> list[tuple[int, str, str]]:
        """The utterances heard: (tick, speaker, text)."""
        return self._said(EventKind.CHAT)

    @cached_property
    def addressees(self) -> list[str | None]:
        """The addressee of each line of `chat` that was whispered; None: it was said aloud."""
        return [e.detail.get("to") for e in self._perceived if e.kind is EventKind.CHAT]

    @cached_property
    def thoughts(self) -> list[tuple[int, str, str]]:
        """The owner's thoughts: (tick, thinker, text)."""
        return self._said(EventKind.THINK)

    @cached_property
    def _perceived(self) -> tuple[PerceivedEvent, ...]:
        with self._turn:
            return self._reading.events()

    def _said(self, kind: EventKind) -> list[tuple[int, str, str]]:
        events = (event for event in self._perceived if event.kind is kind)
        return [(e.tick, e.actor or "", e.detail["text"]) for e in events]
