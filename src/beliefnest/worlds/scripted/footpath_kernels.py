"""Compiled search for paths on foot: steps between cells, and A*.

A grid of cells has a margin, so that every neighbour of a cell in which agents can stand has an
index. A cell is a flat index into the grid; x is slowest, z is fastest.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from beliefnest.geometry.steps import (
    MOST_JUMPS,
    climb,
    descent,
    feet_above,
    jumps,
    landing,
    step_cost,
)
from beliefnest.perception.compiling import compiled, inlined, merged
from beliefnest.world.array_types import Ints
from beliefnest.world.values import EYE_HEIGHT

ByteFlags = npt.NDArray[np.uint8]

_DONE, AVOIDED = 1, 2
"""Marks of cells."""
MOST_STEPS = 10 + 4 * MOST_JUMPS
"""Largest number of cells that one step leads to."""
SCRATCH = MOST_STEPS + 2 * MOST_JUMPS
"""Size of the scratch memory of a search."""
WIDER = -2
"""Result of a search that needs a wider grid."""


class PathCells(NamedTuple):
    """Cells of a ground, or of a part of it.

    Attributes:
        codes: What each block is to a body, as in `geometry.bodies`.
        sizes: Number of cells along x, y and z.
        first, last: First and last cell along x, y and z from which each step stays in the part.
    """

    codes: npt.NDArray[np.uint32]
    sizes: tuple[int, int, int]
    first: tuple[int, int, int]
    last: tuple[int, int, int]


class PathAim(NamedTuple):
    """Goal of a path.

    Attributes:
        x, y, z: Indices of the block along each axis; it may be outside the grid.
        within: Greatest distance.
        by_hand: True: distance from the eyes to the middle of the block. False: distance between
            the block and the cell.
        beside: True if feet and head must be outside the block.
    """

    x: int
    y: int
    z: int
    within: float
    by_hand: bool
    beside: bool


NOWHERE = PathAim(0, 0, 0, -1.0, False, False)
"""Aim that no cell meets; a search for it finds the whole area."""


class Trail(NamedTuple):
    """Cells that a search has found.

    Attributes:
        came: By cell, 1 + the cell before it; -1: the start; 0: not found yet.
        costs: By found cell, length of the path to it.
        marks: By cell, `_DONE` if the search has left it, `AVOIDED` if paths must not contain it.
    """

    came: Ints
    costs: npt.NDArray[np.float64]
    marks: ByteFlags


class Queue(NamedTuple):
    """Binary heap of cells to continue from, least key first; of equal keys, the first one added.

    Attributes:
        keys: Length of the path to the cell, and the least length from there.
        orders: Number of cells added before.
        cells: The cells.
        counts: Number of entries, of cells added, of cells left; and the cell that met the aim
            last or waits for a wider grid, or -1.
    """

    keys: npt.NDArray[np.float64]
    orders: Ints
    cells: Ints
    counts: npt.NDArray[np.int64]


@merged
def _write_steps(cells: PathCells, cell: int, steps: Ints) -> int:
    """Write the cells that one step or jump leads to; return their number.

    `geometry.steps` has the rules. The last part of `found` is scratch memory.
    """
    codes, sizes = cells.codes, cells.sizes
    x, y, z = cell // (sizes[1] * sizes[2]), cell // sizes[2] % sizes[1], cell % sizes[2]
    count = 0
    for number in range(8):
        if number < 4:
            dx = 1 if number == 0 else (-1 if number == 2 else 0)
            dz = 1 if number == 1 else (-1 if number == 3 else 0)
        else:
            dx = 1 if number in (4, 7) else -1
            dz = 1 if number < 6 else -1
        level = landing(codes, sizes, x, y, z, dx, dz)
        if level >= 0:
            steps[count] = ((x + dx) * sizes[1] + level) * sizes[2] + z + dz
            count += 1
    scratch = steps[MOST_STEPS:]
    for number in range(4):
        dx = 1 if number == 0 else (-1 if number == 2 else 0)
        dz = 1 if number == 1 else (-1 if number == 3 else 0)
        for jump in range(jumps(codes, sizes, x, y, z, dx, dz, scratch)):
            far, up = int(scratch[2 * jump]), int(scratch[2 * jump + 1])
            steps[count] = ((x + far * dx) * sizes[1] + y + up) * sizes[2] + z + far * dz
            count += 1
    if climb(codes, sizes, x, y, z):
        steps[count] = cell + sizes[2]
        count += 1
    level = descent(codes, sizes, x, y, z)
    if level >= 0:
        steps[count] = (x * sizes[1] + level) * sizes[2] + z
        count += 1
    return count


@inlined
def _far(x: float, y: float, z: float) -> float:
    return math.sqrt(x * x + y * y + z * z)


@inlined
def _is_met(cells: PathCells, aim: PathAim, x: int, y: int, z: int) -> bool:
    """Return True if a cell meets an aim; free lines are not considered.

    Feet on a low block are in the place of that block, below the cell; either place counts.
    """
    if aim.beside and x == aim.x and z == aim.z and (y == aim.y or y == aim.y - 1):
        return False
    if aim.by_hand:
        return _far(x - aim.x, y + EYE_HEIGHT - (aim.y + 0.5), z - aim.z) <= aim.within
    if _far(x - aim.x, y - aim.y, z - aim.z) <= aim.within:
        return True
    is_low = feet_above(cells.codes, cells.sizes, x, y, z) < 0
    return is_low and _far(x - aim.x, y - 1 - aim.y, z - aim.z) <= aim.within


@compiled
def find(cells: PathCells, aim: PathAim, trail: Trail, queue: Queue, steps: Ints, most: int) -> int:
    """Continue A* to the next cell that meets an aim.

    Args:
        cells: Cells of the ground.
        aim: The aim.
        trail: Cells found so far, at first the start alone.
        queue: Cells to continue from, at first the start alone.
        steps: Scratch memory, `SCRATCH` numbers.
        most: Number of cells after which the search ends.

    Returns:
        The cell; -1: there is none; `WIDER`: steps from the cell `counts[3]` may leave the grid. If
        it does not do, or in a wider grid, call the function again.
    """
    (came, costs, marks), counts, sizes = trail, queue.counts, cells.sizes
    first, last = cells.first, cells.last
    cell = int(counts[3])
    counts[3] = -1
    while True:
        if cell < 0:
            if counts[0] == 0 or counts[2] >= most:
                return -1
            cell = _pop(queue)
            if marks[cell] & _DONE:
                cell = -1
                continue
            x, y, z = cell // (sizes[1] * sizes[2]), cell // sizes[2] % sizes[1], cell % sizes[2]
            if _is_met(cells, aim, x, y, z):
                counts[3] = cell
                return cell
        x, y, z = cell // (sizes[1] * sizes[2]), cell // sizes[2] % sizes[1], cell % sizes[2]
        if not (first[0] <= x <= last[0] and first[1] <= y <= last[1] and first[2] <= z <= last[2]):
            counts[3] = cell
            return WIDER
        marks[cell] |= _DONE
        counts[2] += 1
        for number in range(_write_steps(cells, cell, steps)):
            step = int(steps[number])
            i, j, k = step // (sizes[1] * sizes[2]), step // sizes[2] % sizes[1], step % sizes[2]
            cost = costs[cell] + step_cost(cells.codes, sizes, x, y, z, i, j, k)
            if marks[step] & AVOIDED or (came[step] and cost >= costs[step]):
                continue
            costs[step], came[step] = cost, cell + 1
            counts[1] += 1
            left = _far(i - aim.x, j - aim.y, k - aim.z) - aim.within
            _push(queue, cost + max(0.0, left), step)
        cell = -1


@merged
def _push(queue: Queue, key: float, cell: int) -> None:
    keys, orders, cells, counts = queue
    at = counts[0]
    counts[0] += 1
    while at > 0:
        above = (at - 1) // 2
        # The new entry is the youngest, and stays below entries with the same key.
        if keys[above] <= key:
            break
        keys[at], orders[at], cells[at] = keys[above], orders[above], cells[above]
        at = above
    keys[at], orders[at], cells[at] = key, counts[1], cell


@merged
def _pop(queue: Queue) -> int:
    keys, orders, cells, counts = queue
    first = int(cells[0])
    counts[0] -= 1
    size = counts[0]
    key, order, cell = keys[size], orders[size], cells[size]
    at = 0
    while 2 * at + 1 < size:
        below = 2 * at + 1
        other = below + 1
        if other < size and (
            keys[other] < keys[below]
            or (keys[other] == keys[below] and orders[other] < orders[below])
        ):
            below = other
        if key < keys[below] or (key == keys[below] and order < orders[below]):
            break
        keys[at], orders[at], cells[at] = keys[below], orders[below], cells[below]
        at = below
    keys[at], orders[at], cells[at] = key, order, cell
    return first


@compiled
def next_target(cells: PathCells, aim: PathAim, area: npt.NDArray[np.bool_], after: int) -> int:
    """Return the first cell of an area after a cell that meets an aim; -1: there is none.

    `area` is True in the cells of the area.
    """
    sizes, far = cells.sizes, int(min(aim.within, 1e6)) + 2
    for x in range(max(0, aim.x - far), min(sizes[0], aim.x + far + 1)):
        for y in range(max(0, aim.y - far), min(sizes[1], aim.y + far + 1)):
            for z in range(max(0, aim.z - far), min(sizes[2], aim.z + far + 1)):
                cell = (x * sizes[1] + y) * sizes[2] + z
                if cell > after and area[cell] and _is_met(cells, aim, x, y, z):
                    return cell
    return -1
