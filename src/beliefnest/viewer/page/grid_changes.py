"""Changes of the blocks of nodes from entry to entry."""

from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from beliefnest.belief.chunk_pool import ChunkPool
from beliefnest.belief.node_table import NodeTable
from beliefnest.viewer.page.runs import Runs, grid_runs, joined
from beliefnest.world.array_types import Cells, States
from beliefnest.world.terrain import SIDE, VOLUME


class GridChanges:
    """Finder of changed blocks in some nodes of a forest.

    Args:
        table: Table of the nodes.
        numbers: Numbers of the nodes, node 0 among them.
    """

    def __init__(self, table: NodeTable, numbers: Iterable[int]) -> None:
        self._table = table
        self._numbers = list(dict.fromkeys(numbers))
        self._versions = table.versions().copy()
        self._held: _Grids | _Chunks
        if table.pool is None:
            self._held = _Grids(table, self._numbers)
        else:
            self._held = _Chunks(table, table.pool, self._numbers)

    def beginnings(self, numbers: Sequence[int]) -> Iterator[tuple[Runs, Cells]]:
        """Yield the runs of each node, and the cells of its false blocks, before any change.

        The runs of node 0 are all of its blocks, those of others its blocks that differ from it.
        """
        return self._held.beginnings(numbers)

    def first_states(self, cells: Cells) -> States:
        """Return the blocks that node 0 had at some cells before any change."""
        return self._held.first_states(cells)

    def states(self, number: int, cells: Cells) -> States:
        """Return the blocks of a node at some cells now."""
        return self._table.blocks_at(number, cells)

    def found(self) -> Mapping[int, Cells]:
        """Return the cells that changed since the last call, by number of the node."""
        versions = self._table.versions()
        changed = [n for n in self._numbers if versions[n] != self._versions[n]]
        self._versions = versions.copy()
        cells = self._held.changed(changed)
        return {number: cells_found for number, cells_found in cells.items() if len(cells_found)}


class _Grids:
    """Last blocks of nodes that hold dense arrays."""

    def __init__(self, table: NodeTable, numbers: Iterable[int]) -> None:
        self._table = table
        self._held = {number: table.flat_blocks(number).copy() for number in numbers}
        self._first = self._held[0].copy()

    def beginnings(self, numbers: Sequence[int]) -> Iterator[tuple[Runs, Cells]]:
        """Yield what `GridChanges.beginnings` does."""
        for number in numbers:
            states = self._held[number]
            runs = grid_runs(states, None if number == 0 else self._first)
            yield runs, np.flatnonzero(_are_false(states, self._first))

    def first_states(self, cells: Cells) -> States:
        """Return the blocks that node 0 had at some cells at first."""
        return self._first[cells]

    def changed(self, numbers: Iterable[int]) -> Mapping[int, Cells]:
        """Return the cells of some nodes that changed since the last call."""
        cells_changed = {}
        for number in numbers:
            before, now = self._held[number], self._table.flat_blocks(number)
            cells_changed[number] = np.flatnonzero(before != now)
            before[cells_changed[number]] = now[cells_changed[number]]
        return cells_changed


class _Chunks:
    """Last blocks of nodes that share chunks: their rows of the pool, and a copy of these."""

    def __init__(self, table: NodeTable, pool: ChunkPool, numbers: Iterable[int]) -> None:
        self._table, self._pool = table, pool
        self._blocks = pool.blocks[: pool.used].copy()
        rows = table.nodes().rows
        self._rows = {number: rows[number].copy() for number in numbers}
        self._first = self._rows[0]
        used, places = np.unique(self._first, return_inverse=True)
        self._first_blocks, self._first_places = self._blocks[used], places

    def beginnings(self, numbers: Sequence[int]) -> Iterator[tuple[Runs, Cells]]:
        """Yield what `GridChanges.beginnings` does.

        A slice of chunks is looked at once if it has the same rows in several nodes or places.
        """
        made: dict[tuple[bool, bytes], list[tuple[Runs, Cells]]] = {}
        slices: dict[tuple[bool, int, int, bytes, bytes], tuple[Runs, Cells]] = {}
        across = self._pool.chunks[0]
        width, height, depth = self._table.context.box.shape
        first = self._first.reshape(across, -1)
        for number in numbers:
            rows = self._rows[number].reshape(across, -1)
            key = number == 0, rows.tobytes()
            if key not in made:
                parts = []
                for at in range(across):
                    # Chunks begin one cell before the box.
                    begin, end = max(at * SIDE - 1, 0), min(at * SIDE + SIDE - 1, width)
                    layers = slice(begin + 1 - at * SIDE, end + 1 - at * SIDE)
                    whole = number == 0, layers.start, layers.stop
                    mark = (*whole, rows[at].tobytes(), first[at].tobytes())
                    if mark not in slices:
                        real = None if number == 0 else first[at]
                        slices[mark] = self._slice(layers, rows[at], real)
                    runs, cells = slices[mark]
                    skipped = begin * height * depth
                    parts.append((runs._replace(starts=runs.starts + skipped), cells + skipped))
                all_runs, all_cells = zip(*parts, strict=True)
                made[key] = [(joined(all_runs), np.concatenate(all_cells))]
            yield from made[key]

    def _slice(
        self, layers: slice, rows: npt.NDArray[np.int32], first: npt.NDArray[np.int32] | None
    ) -> tuple[Runs, Cells]:
        """Return the runs and the false cells of a slice of chunks, counted from its first cell.

        Args:
            layers: Layers of the chunks along x that are in the box.
            rows: Rows of the chunks in the pool.
            first: Those that node 0 had there at first; None: these are its own.
        """
        if first is not None and np.array_equal(rows, first):
            return _NO_RUNS, _NO_CELLS
        states = self._flat(layers, rows)
        if not len(states):
            return _NO_RUNS, _NO_CELLS
        if first is None:
            return grid_runs(states, None), _NO_CELLS
        real = self._flat(layers, first)
        return grid_runs(states, real), np.flatnonzero(_are_false(states, real))

    def _flat(self, layers: slice, rows: npt.NDArray[np.int32]) -> States:
        """Return the blocks of the cells of a slice of chunks, by their layers along x."""
        (_, height, depth), (_, high, deep) = self._table.context.box.shape, self._pool.chunks
        cubes = self._blocks[rows].reshape(high, deep, SIDE, SIDE, SIDE)
        cells = cubes.transpose(2, 0, 3, 1, 4).reshape(SIDE, high * SIDE, deep * SIDE)
        return cells[layers, 1 : height + 1, 1 : depth + 1].reshape(-1)

    def first_states(self, cells: Cells) -> States:
        """Return the blocks that node 0 had at some cells at first."""
        places = self._table.places(cells)
        row = self._first_places[places // VOLUME]
        states: States = self._first_blocks[row, places % VOLUME]
        return states

    def changed(self, numbers: Iterable[int]) -> Mapping[int, Cells]:
        """Return the cells of some nodes that changed since the last call."""
        cells_changed: dict[int, Cells] = {}
        blocks = self._pool.blocks[: self._pool.used]
        is_changed = np.ones(len(blocks), dtype=np.bool_)
        # Several blocks are compared at once, to find the few rows that differ.
        is_changed[: len(self._blocks)] = (
            _words(blocks[: len(self._blocks)]) != _words(self._blocks)
        ).any(axis=1)
        rows = self._table.nodes().rows
        for number in numbers:
            before, now = self._rows[number], rows[number].copy()
            chunks = np.flatnonzero((before != now) | is_changed[now])
            held_rows, holds = before[chunks], now[chunks]
            apart = (_words(self._blocks[held_rows]) != _words(blocks[holds])).any(axis=1)
            chunks, held_rows, holds = chunks[apart], held_rows[apart], holds[apart]
            at = np.flatnonzero(self._blocks[held_rows] != blocks[holds])
            cells_changed[number] = np.sort(self._cells(chunks[at // VOLUME], at % VOLUME))
            self._rows[number] = now
        self._keep(blocks, is_changed)
        return cells_changed

    def _keep(self, blocks: States, is_changed: npt.NDArray[np.bool_]) -> None:
        """Copy the changed rows of the pool."""
        if len(blocks) > len(self._blocks):
            longer = np.empty_like(blocks)
            longer[: len(self._blocks)] = self._blocks
            self._blocks = longer
        self._blocks[is_changed] = blocks[is_changed]

    def _cells(self, chunks: npt.NDArray[np.int64], within: npt.NDArray[np.int64]) -> Cells:
        """Return the cells at some places in chunks, as `NodeTable` numbers them."""
        (_, ny, nz), (_, high, deep) = self._table.context.box.shape, self._pool.chunks
        x = chunks // (high * deep) * SIDE + within // (SIDE * SIDE) - 1
        y = chunks // deep % high * SIDE + within // SIDE % SIDE - 1
        z = chunks % deep * SIDE + within % SIDE - 1
        cells: Cells = (x * ny + y) * nz + z
        return cells


_NO_CELLS: Cells = np.empty(0, dtype=np.int64)
_NO_RUNS = Runs(_NO_CELLS, _NO_CELLS, np.empty(0, dtype=np.int16))


def _are_false(believed: States, real: States) -> npt.NDArray[np.bool_]:
    """Return True where blocks are known and differ from the real ones."""
    are_false: npt.NDArray[np.bool_] = (believed >= 0) & (believed != real)
    return are_false


def _words(blocks: States) -> npt.NDArray[np.int64]:
    """Return rows of blocks as rows of larger integers."""
    return blocks.view(np.int64)
