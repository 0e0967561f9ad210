"""Changes of the blocks of nodes from entry to entry."""

from collections.abc import Iterable, Mapping

import numpy as np
import numpy.typing as npt

from beliefnest.belief.chunk_pool import NOTHING, ChunkPool
from beliefnest.belief.node_table import NodeTable
from beliefnest.world.terrain import SIDE, VOLUME

__all__ = ["Cells", "GridChanges", "States"]

Cells = npt.NDArray[np.int64]
"""Flat cells of the box, rising."""

States = npt.NDArray[np.int16]
"""Numbers of blocks, -1 unknown."""


class GridChanges:
    """Finder of changed blocks in some nodes of a forest.

    Args:
        table: Table of the nodes.
        numbers: Numbers of the nodes.
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

    def grid(self, number: int) -> States:
        """Return all blocks of a node now, flat. Do not change them."""
        return self._table.flat_blocks(number)

    def states(self, number: int, cells: Cells) -> States:
        """Return the blocks of a node at some cells now."""
        return self._table.blocks_at(number, cells)

    def found(self) -> Mapping[int, Cells]:
        """Return the cells that changed since the last call, by number of the node."""
        versions = self._table.versions()
        changed = [n for n in self._numbers if versions[n] != self._versions[n]]
        self._versions = versions.copy()
        cells = self._held.changed(changed)
        return {number: found for number, found in cells.items() if len(found)}


class _Grids:
    """Last blocks of nodes that hold dense arrays."""

    def __init__(self, table: NodeTable, numbers: Iterable[int]) -> None:
        self._table = table
        self._held = {number: table.flat_blocks(number).copy() for number in numbers}

    def changed(self, numbers: Iterable[int]) -> Mapping[int, Cells]:
        """Return the cells of some nodes that changed since the last call."""
        found = {}
        for number in numbers:
            held, now = self._held[number], self._table.flat_blocks(number)
            found[number] = np.flatnonzero(held != now)
            held[found[number]] = now[found[number]]
        return found


class _Chunks:
    """Last blocks of nodes that share chunks: their rows of the pool, and a copy of these."""

    def __init__(self, table: NodeTable, pool: ChunkPool, numbers: Iterable[int]) -> None:
        self._table, self._pool = table, pool
        self._blocks = pool.blocks.copy()
        rows = table.nodes().rows
        self._rows = {number: rows[number].copy() for number in numbers}

    def changed(self, numbers: Iterable[int]) -> Mapping[int, Cells]:
        """Return the cells of some nodes that changed since the last call."""
        rows, blocks = self._table.nodes().rows, self._pool.blocks
        found, used = {}, []
        for number in numbers:
            before, now = self._rows[number], rows[number].copy()
            chunks = np.flatnonzero((before != NOTHING) | (now != NOTHING))
            # Several blocks are compared at once, to find the few chunks that differ.
            apart = (_words(self._blocks[before[chunks]]) != _words(blocks[now[chunks]])).any(
                axis=1
            )
            chunks = chunks[apart]
            at = np.flatnonzero(self._blocks[before[chunks]] != blocks[now[chunks]])
            found[number] = np.sort(self._cells(chunks[at // VOLUME], at % VOLUME))
            self._rows[number] = now
            used.append(now)
        if used:
            is_used = np.zeros(len(blocks), dtype=np.bool_)
            is_used[np.concatenate(used)] = True
            self._keep(np.flatnonzero(is_used))
        return found

    def _keep(self, rows: npt.NDArray[np.int64]) -> None:
        """Copy some rows of the pool."""
        blocks = self._pool.blocks
        if len(blocks) > len(self._blocks):
            longer = np.empty_like(blocks)
            longer[: len(self._blocks)] = self._blocks
            self._blocks = longer
        self._blocks[rows] = blocks[rows]

    def _cells(self, chunks: npt.NDArray[np.int64], within: npt.NDArray[np.int64]) -> Cells:
        """Return the cells at some places in chunks, as `NodeTable` numbers them."""
        (_, ny, nz), (_, high, deep) = self._table.context.box.shape, self._pool.chunks
        x = chunks // (high * deep) * SIDE + within // (SIDE * SIDE) - 1
        y = chunks // deep % high * SIDE + within // SIDE % SIDE - 1
        z = chunks % deep * SIDE + within % SIDE - 1
        cells: Cells = (x * ny + y) * nz + z
        return cells


def _words(blocks: States) -> npt.NDArray[np.int64]:
    """Return rows of blocks as rows of larger integers."""
    return blocks.view(np.int64)
