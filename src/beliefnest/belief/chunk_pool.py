"""Pool of the chunks of all nodes of a table, for boxes in which nodes hold no dense arrays."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from beliefnest.belief.arrays import UNKNOWN, Space
from beliefnest.perception.codes import SIDE, VOLUME, chunks_of, code_grid

__all__ = ["NOTHING", "ChunkPool", "CutGrids", "cut_grids"]

Ints = npt.NDArray[np.int32]
States = npt.NDArray[np.int16]
Codes = npt.NDArray[np.uint16]
Blocks = npt.NDArray[np.signedinteger[Any]]


@dataclass(frozen=True, slots=True)
class CutGrids:
    """Grids of the box cut into chunks, each different chunk once.

    Attributes:
        blocks: int16 (n, VOLUME), numbers of blocks of each chunk.
        codes: uint16 (n, VOLUME), their geometry.
        rows: For each grid, the index of each of its chunks.
    """

    blocks: States
    codes: Codes
    rows: Sequence[Ints]


NOTHING = 0
"""Row of the chunk of which nothing is known. The pool itself counts as one of its users."""


class ChunkPool:
    """Blocks and codes of chunks, each chunk a row; `perception.chunks` describes their order.

    Equal chunks of several nodes are one row as long as nobody changes them.

    Args:
        shape: Shape of the box.

    Attributes:
        blocks: int16 (rows, VOLUME), numbers of blocks.
        codes: uint16 (rows, VOLUME), their geometry.
        shares: int32 (rows,), see `arrays.Nodes`.
        spare: int32 (rows + 2,), see `arrays.Nodes`.
    """

    def __init__(self, shape: tuple[int, int, int]) -> None:
        self._shape = shape
        x, y, z = shape
        self.chunks = chunks_of((x + 2, y + 2, z + 2))
        self.count = int(np.prod(self.chunks))
        self.blocks: States = np.full((1, VOLUME), UNKNOWN, dtype=np.int16)
        self.codes: Codes = np.zeros((1, VOLUME), dtype=np.uint16)
        self.shares: Ints = np.ones(1, dtype=np.int32)
        self.spare: Ints = np.array([0, 1, 0], dtype=np.int32)

    def copy(self) -> "ChunkPool":
        """Return an independent copy, without room for more rows."""
        made, used = ChunkPool(self._shape), int(self.spare[1])
        made.blocks, made.codes = self.blocks[:used].copy(), self.codes[:used].copy()
        made.shares, made.spare = self.shares[:used].copy(), self.spare[: used + 2].copy()
        return made

    def reserve(self, rows: int) -> bool:
        """Make room for some more rows; return True if the arrays are new ones then."""
        used, size = int(self.spare[1]), len(self.shares)
        if int(self.spare[0]) + size - used >= rows:
            return False
        # The system gives memory to pages when they are written, so spare rows cost nothing.
        wanted = used + used // 2 + 2 * rows
        self.blocks = _longer(self.blocks, used, wanted)
        self.codes = _longer(self.codes, used, wanted)
        self.shares = _longer(self.shares, used, wanted)
        self.spare = _longer(self.spare, len(self.spare), wanted + 2)
        return True

    def use(self, rows: Ints) -> None:
        """Count one more user of each row, for each time that it is listed."""
        np.add.at(self.shares, rows, 1)

    def leave(self, rows: Ints) -> None:
        """Count one user less of each row, for each time that it is listed; free unused ones."""
        np.subtract.at(self.shares, rows, 1)
        free = np.unique(rows[self.shares[rows] == 0])
        count = int(self.spare[0])
        self.spare[2 + count : 2 + count + len(free)] = free
        self.spare[0] += len(free)

    def add(self, blocks: States, codes: Codes) -> Ints:
        """Add chunks, shape (n, VOLUME), that nobody uses yet, and return their rows."""
        self.reserve(len(blocks))
        # Rows that were freed are left to the kernel.
        first = int(self.spare[1])
        if first + len(blocks) > len(self.shares):
            self.reserve(int(self.spare[0]) + len(self.shares) - first + len(blocks))
        rows = np.arange(first, first + len(blocks), dtype=np.int32)
        self.blocks[rows], self.codes[rows], self.shares[rows] = blocks, codes, 0
        self.spare[1] += len(blocks)
        return rows

    def add_grids(self, cut: CutGrids) -> Sequence[Ints]:
        """Add the chunks of some grids, and return the rows of each grid.

        The caller counts as a user of them, and calls `leave` for each grid.
        """
        added = self.add(cut.blocks, cut.codes)
        grids = [added[rows] for rows in cut.rows]
        for rows in grids:
            self.use(rows)
        return grids

    def grid(self, rows: Ints) -> States:
        """Return a copy of the numbers of the blocks of a grid, in the shape of the box."""
        x, y, z = self.chunks
        cubes = self.blocks[rows].reshape(x, y, z, SIDE, SIDE, SIDE)
        whole = cubes.transpose(0, 3, 1, 4, 2, 5).reshape(x * SIDE, y * SIDE, z * SIDE)
        i, j, k = self._shape
        return whole[1 : i + 1, 1 : j + 1, 1 : k + 1].copy()


def cut_grids(space: Space, grids: Sequence[Blocks]) -> CutGrids:
    """Cut grids of block numbers of the box into chunks, and compute their geometry."""
    known: dict[bytes, int] = {}
    kept: list[bytes] = []
    rows: list[Ints] = []
    for grid in grids:
        # Layer by layer along x, so that little more memory is needed.
        layers = range(chunks_of(space.sizes)[0])
        found = [_cut_layer(space, grid, layer, known, kept) for layer in layers]
        rows.append(np.concatenate(found))
    size = VOLUME * np.dtype(np.int16).itemsize
    both = np.frombuffer(b"".join(kept), dtype=np.uint8).reshape(len(kept), 2 * size)
    blocks, codes = both[:, :size].copy(), both[:, size:].copy()
    return CutGrids(blocks.view(np.int16), codes.view(np.uint16), rows)


def _cut_layer(
    space: Space, grid: Blocks, layer: int, known: dict[bytes, int], kept: list[bytes]
) -> Ints:
    """Return the numbers of the chunks of a layer, and add new ones to `known` and `kept`."""
    blocks, codes = _layer(space, grid, layer)
    rows = np.empty(len(blocks), dtype=np.int32)
    for chunk in range(len(blocks)):
        content = blocks[chunk].tobytes() + codes[chunk].tobytes()
        row = known.setdefault(content, len(kept))
        if row == len(kept):
            kept.append(content)
        rows[chunk] = row
    return rows


def _layer(space: Space, grid: Blocks, layer: int) -> tuple[States, Codes]:
    """Return the blocks and the codes of a layer of chunks, shape (chunks, VOLUME) each."""
    _, y, z = chunks_of(space.sizes)
    nx, ny, nz = grid.shape
    # Coordinates of the code grid have a margin of one cell, and shapes reach into neighbours.
    first, last = layer * SIDE, min((layer + 1) * SIDE, nx + 2)
    low, high = max(first - 2, 0), min(last, nx)
    near = code_grid(grid[low:high], space.codes, space.reaches)
    codes = np.zeros((SIDE, y * SIDE, z * SIDE), dtype=np.uint16)
    codes[: last - first, : ny + 2, : nz + 2] = near[first - low : last - low]
    blocks = np.full((SIDE, y * SIDE, z * SIDE), UNKNOWN, dtype=np.int16)
    begin, end = max(first - 1, 0), min(last - 1, nx)
    blocks[begin + 1 - first : end + 1 - first, 1 : ny + 1, 1 : nz + 1] = grid[begin:end]
    return _cut(blocks), _cut(codes)


def _longer(array: npt.NDArray[Any], used: int, size: int) -> npt.NDArray[Any]:
    longer = np.empty((size, *array.shape[1:]), dtype=array.dtype)
    longer[:used] = array[:used]
    return longer


def _cut(layer: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return the cubes of a layer of chunks as rows."""
    _, y, z = layer.shape
    cubes = layer.reshape(SIDE, y // SIDE, SIDE, z // SIDE, SIDE).transpose(1, 3, 0, 2, 4)
    return cubes.reshape(-1, VOLUME)
