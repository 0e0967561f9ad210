"""Division of the blocks of a box into cuboids."""

import math
from collections.abc import Iterator

import numpy as np

from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box


def distinct_cells(blocks: Terrain) -> int:
    """Return the number of cells that are left if each layer like the one before it is left out."""
    return math.prod(map(len, blocks.borders))


def cuboids(blocks: Terrain, skipped: int) -> Iterator[tuple[int, Box]]:
    """Yield cuboids of one block state each, which together are all cells of other states.

    Each cuboid extends greedily along z, then along x, then along y. Indices begin at 0. A layer
    that equals the one before it is in the same cuboids, so the work is done without it: it takes
    5 bytes for each of the `distinct_cells`.

    Args:
        blocks: The blocks.
        skipped: State of the cells that are in no cuboid.
    """
    grid = blocks.sampled(blocks.borders)
    ends = [
        np.append(layers, size) for layers, size in zip(blocks.borders, blocks.shape, strict=True)
    ]
    for state, (low, high) in _parts(grid, skipped):
        first = [int(each[i]) for each, i in zip(ends, low, strict=True)]
        last = [int(each[i + 1]) - 1 for each, i in zip(ends, high, strict=True)]
        yield state, Box((first[0], first[1], first[2]), (last[0], last[1], last[2]))


def _parts(
    grid: np.ndarray[tuple[int, ...], np.dtype[np.int32]], skipped: int
) -> Iterator[tuple[int, tuple[list[int], list[int]]]]:
    open_cells = grid != skipped
    flat, start = open_cells.reshape(-1), 0
    while start < flat.size:
        start += int(flat[start:].argmax())
        if not flat[start]:
            return
        low = [int(i) for i in np.unravel_index(start, grid.shape)]
        state, high = int(grid.reshape(-1)[start]), low.copy()
        for axis in (2, 0, 1):
            while high[axis] + 1 < grid.shape[axis]:
                part = [slice(a, b + 1) for a, b in zip(low, high, strict=True)]
                part[axis] = slice(high[axis] + 1, high[axis] + 2)
                there = tuple(part)
                if not (open_cells[there].all() and (grid[there] == state).all()):
                    break
                high[axis] += 1
        open_cells[tuple(slice(a, b + 1) for a, b in zip(low, high, strict=True))] = False
        yield state, (low, high)
