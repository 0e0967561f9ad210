"""Grids of shape codes, the input of the compiled line-of-sight kernels.

A grid of codes is uint16 (nx + 2, ny + 2, nz + 2): the blocks and a margin of one cell on
every side. A code is the shape of the cell's own block (`EMPTY`, `FULL`, or `FIRST_SHAPE`
+ the number of a shape), plus `INTRUDED` if the shape of a neighbour reaches into the cell.
"""

from typing import Any

import numpy as np
import numpy.typing as npt

CodeGrid = npt.NDArray[np.uint16]
Reaches = npt.NDArray[np.uint8]
"""Sides at which shapes reach out of their cells, indexed by code without `INTRUDED`.
Bit s is set if the shape reaches out at side s. Sides 0 and 1 are low and high x, then y, z."""

EMPTY = 0
FULL = 1
FIRST_SHAPE = 2
INTRUDED = 0x8000
OWN = 0x7FFF

LIMIT_SLACK = 1e-9
"""Tolerance added to limits of distance and angle. It makes the limits inclusive, however a
mirrored or rotated world rounds."""


def code_grid(
    blocks: npt.NDArray[np.signedinteger[Any]], codes: npt.NDArray[np.uint16], reaches: Reaches
) -> CodeGrid:
    """Return the code grid of a grid of blocks.

    Args:
        blocks: Block state ids (nx, ny, nz), -1 where unknown.
        codes: Code of each block state; the last entry is for unknown.
        reaches: Sides at which the shape of each code reaches out of its cell.
    """
    grid = np.zeros([size + 2 for size in blocks.shape], dtype=np.uint16)
    grid[1:-1, 1:-1, 1:-1] = codes[blocks]
    flat = grid.reshape(-1)
    reaching = np.flatnonzero(reaches[flat])
    sides = reaches[flat[reaching]]
    _, ny, nz = grid.shape
    for side in range(6):
        step = (ny * nz, nz, 1)[side // 2] * (2 * (side % 2) - 1)
        flat[reaching[(sides >> side) & 1 != 0] + step] |= INTRUDED
    return grid
