"""Division of a grid of blocks into cuboids."""

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from beliefnest.world.frames import BlockGrid
from beliefnest.world.values import Box

__all__ = ["cuboids"]


def cuboids(grid: BlockGrid, skipped: npt.NDArray[np.bool_]) -> Iterator[tuple[int, Box]]:
    """Yield cuboids of one block state each, which together are all cells that are not skipped.

    Each cuboid extends greedily along z, then along x, then along y. Indices begin at 0.
    """
    open_cells = ~skipped
    for i, j, k in np.argwhere(open_cells).tolist():
        if not open_cells[i, j, k]:
            continue
        state = int(grid[i, j, k])
        low, high = [i, j, k], [i, j, k]
        for axis in (2, 0, 1):
            while high[axis] + 1 < grid.shape[axis]:
                part = [slice(a, b + 1) for a, b in zip(low, high, strict=True)]
                part[axis] = slice(high[axis] + 1, high[axis] + 2)
                there = tuple(part)
                if not (open_cells[there].all() and (grid[there] == state).all()):
                    break
                high[axis] += 1
        open_cells[tuple(slice(a, b + 1) for a, b in zip(low, high, strict=True))] = False
        yield state, Box((low[0], low[1], low[2]), (high[0], high[1], high[2]))
