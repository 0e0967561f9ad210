"""Chunks: cubes of cells in which the code grids of large boxes are stored.

A grid is either dense, one flat array (x slowest, z fastest), or in chunks. Chunks of several grids
lie in one flat array, the pool, and each grid has a list that gives the row of the pool for each of
its chunks. So equal chunks of several grids can be one.

The *place* of a cell is a number that is the same in all grids of these sizes: in a dense grid its
index, otherwise the number of its chunk times `VOLUME` plus its index in the chunk. It is a sum of
one part for each axis, so loops along an axis compute the other two parts once.

The functions are compiled for either kind: `chunks` is None for a dense grid, and the branches for
chunks are then dropped before compilation.
"""

import numpy as np
import numpy.typing as npt

from beliefnest.perception.compiling import inlined
from beliefnest.world.terrain import SIDE, VOLUME, ChunkCounts

_EDGE = SIDE.bit_length() - 1
_INSIDE = 3 * _EDGE

Rows = npt.NDArray[np.int32]
"""By chunk of a grid (z fastest), its row in the pool; empty for a dense grid."""


@inlined
def stride(chunks: ChunkCounts | None, sizes: tuple[int, int, int], axis: int) -> int:
    """Return by how much the place grows along an axis, from cell to cell or chunk to chunk."""
    if chunks is None:
        if axis == 2:
            return 1
        return sizes[2] if axis == 1 else sizes[1] * sizes[2]
    if axis == 2:
        return VOLUME
    return VOLUME * chunks[2] if axis == 1 else VOLUME * chunks[1] * chunks[2]


@inlined
def part(chunks: ChunkCounts | None, number: int, stride: int, axis: int) -> int:
    """Return the part of a place that comes from the cell's number along an axis."""
    if chunks is None:
        return number * stride
    return (number >> _EDGE) * stride + ((number & (SIDE - 1)) << (_EDGE * (2 - axis)))


@inlined
def place_at(
    chunks: ChunkCounts | None, sizes: tuple[int, int, int], cell: tuple[int, int, int]
) -> int:
    """Return the place of a cell."""
    if chunks is None:
        return (cell[0] * sizes[1] + cell[1]) * sizes[2] + cell[2]
    i, j, k = cell
    chunk = ((i >> _EDGE) * chunks[1] + (j >> _EDGE)) * chunks[2] + (k >> _EDGE)
    within = ((i & (SIDE - 1)) << _EDGE | j & (SIDE - 1)) << _EDGE | k & (SIDE - 1)
    return chunk << _INSIDE | within


@inlined
def chunk_in(place: int) -> int:
    """Return the number of the chunk of a place in a grid in chunks."""
    return place >> _INSIDE


@inlined
def index_at(chunks: ChunkCounts | None, rows: Rows | None, place: int) -> int:
    """Return the index of a place in the array that holds the grid."""
    if chunks is None or rows is None:
        return place
    # Python's int, once compiled
    return rows[place >> _INSIDE] << _INSIDE | place & (VOLUME - 1)  # type: ignore[no-any-return]
