"""Changes of the blocks of nodes from entry to entry."""

from collections.abc import Iterable, Mapping

import numpy as np
import numpy.typing as npt

from beliefnest.belief.node_table import NodeTable

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
        self._at = {number: at for at, number in enumerate(dict.fromkeys(numbers))}
        self._held: States = np.stack([table.flat_blocks(number) for number in self._at])
        self._versions = table.versions().copy()

    def grid(self, number: int) -> States:
        """Return all blocks of a node at the last call, flat. Do not change them."""
        held: States = self._held[self._at[number]]
        return held

    def states(self, number: int, cells: Cells) -> States:
        """Return the blocks of a node at some cells at the last call."""
        held: States = self._held[self._at[number], cells]
        return held

    def found(self) -> Mapping[int, Cells]:
        """Return the cells that changed since the last call, by number of the node."""
        versions, found = self._table.versions(), {}
        for number, at in self._at.items():
            if versions[number] == self._versions[number]:
                continue
            blocks = self._table.flat_blocks(number)
            cells = np.flatnonzero(blocks != self._held[at])
            if len(cells):
                self._held[at, cells] = blocks[cells]
                found[number] = cells
        self._versions = versions.copy()
        return found
