"""Grids of shape codes, which the compiled kernels look through.

A grid of codes is uint16 (nx + 2, ny + 2, nz + 2): the blocks and a margin of one cell on
every side. A code is the shape of the cell's own block (`EMPTY`, `FULL`, or `FIRST_SHAPE`
+ the number of a shape), plus `INTRUDED` if the shape of a neighbour reaches into the cell.
"""

from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = [
    "EMPTY",
    "FIRST_SHAPE",
    "FULL",
    "INTRUDED",
    "LIMIT_SLACK",
    "OWN",
    "CodeGrid",
    "Reaches",
    "code_grid",
]

CodeGrid = npt.NDArray[np.uint16]
Reaches = npt.NDArray[np.uint8]
"""By code without `INTRUDED`: bit s says that the shape reaches out of its cell at side s.
Sides 0 and 1 are low and high x, then y, then z."""

EMPTY = 0
FULL = 1
FIRST_SHAPE = 2
INTRUDED = 0x8000
OWN = 0x7FFF

LIMIT_SLACK = 1e-9
"""By this much limits of distance and angle are wider, so that they are inclusive whatever
the rounding of a mirrored or turned world."""


def code_grid(
    blocks: npt.NDArray[np.signedinteger[Any]], codes: npt.NDArray[np.uint16], reaches: Reaches
) -> CodeGrid:
    """The grid of codes of a grid of blocks (nx, ny, nz); `codes` are those of each block."""
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
