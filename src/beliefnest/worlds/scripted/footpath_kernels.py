"""Compiled search for paths on foot: steps between cells, and A*.

A grid of cells has a margin, so that every neighbour of a cell in which agents can stand has an
index. A cell is a flat index into the grid; x is slowest, z is fastest.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from beliefnest.perception.compiling import compiled, inlined, merged
from beliefnest.world.values import EYE_HEIGHT

__all__ = [
    "ALONG_X",
    "ALONG_Z",
    "AVOIDED",
    "NOWHERE",
    "WIDER",
    "Aim",
    "Cells",
    "Queue",
    "Trail",
    "find",
    "holds_target",
]

Flags = npt.NDArray[np.uint8]
Ints = npt.NDArray[np.int32]

_DEEPEST_DROP = 3
_DONE, AVOIDED = 1, 2
"""Marks of cells."""
ALONG_X, ALONG_Z = 1, 2
"""Directions through doorways."""
WIDER = -2
"""Result of a search that needs a wider grid."""


class Cells(NamedTuple):
    """Cells of a ground, or of a part of it.

    Attributes:
        standing: 1 where an agent can stand.
        passing: 1 where a body passes through.
        doorways: `ALONG_X` or `ALONG_Z` for doors and gates that can be crossed, by the direction
            through them; else 0.
        sizes: Number of cells along x, y and z.
        first, last: First and last cell along x, y and z from which each step stays in the part.
    """

    standing: Flags
    passing: Flags
    doorways: Flags
    sizes: tuple[int, int, int]
    first: tuple[int, int, int]
    last: tuple[int, int, int]


class Aim(NamedTuple):
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


NOWHERE = Aim(0, 0, 0, -1.0, False, False)
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
    marks: Flags


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


@inlined
def _at(flags: Flags, sizes: tuple[int, int, int], x: int, y: int, z: int) -> bool:
    inside = 0 <= x < sizes[0] and 0 <= y < sizes[1] and 0 <= z < sizes[2]
    return inside and flags[(x * sizes[1] + y) * sizes[2] + z] != 0


@inlined
def _door(cells: Cells, x: int, y: int, z: int) -> int:
    sizes = cells.sizes
    inside = 0 <= x < sizes[0] and 0 <= y < sizes[1] and 0 <= z < sizes[2]
    return int(cells.doorways[(x * sizes[1] + y) * sizes[2] + z]) if inside else 0


@inlined
def _may_cross(door: int, dx: int, dz: int) -> bool:
    """Return True if a step leads straight through a doorway, or there is no doorway."""
    return door == 0 or (dz == 0 and door == ALONG_X) or (dx == 0 and door == ALONG_Z)


@merged
def _landing(cells: Cells, x: int, y: int, z: int, dx: int, dz: int) -> int:
    """Return the height to which a step sideways leads; -1: it leads nowhere."""
    standing, passing, sizes = cells.standing, cells.passing, cells.sizes
    i, k = x + dx, z + dz
    if _at(standing, sizes, i, y, k):
        return y
    if dx != 0 and dz != 0:
        return -1
    if _at(passing, sizes, x, y + 2, z) and _at(standing, sizes, i, y + 1, k):
        return y + 1
    if _at(passing, sizes, i, y, k) and _at(passing, sizes, i, y + 1, k):
        for depth in range(1, _DEEPEST_DROP + 1):
            if not _at(passing, sizes, i, y - depth, k):
                return -1
            if _at(standing, sizes, i, y - depth, k):
                return y - depth
    return -1


@merged
def _write_steps(cells: Cells, cell: int, found: Ints) -> int:
    """Write the cells that one step leads to; return their number.

    A step leads sideways, up one block, or down up to three. Diagonal steps need free sides, and
    lead neither up nor down. Doorways are only crossed straight.
    """
    passing, sizes = cells.passing, cells.sizes
    x, y, z = cell // (sizes[1] * sizes[2]), cell // sizes[2] % sizes[1], cell % sizes[2]
    count = 0
    for number in range(8):
        if number < 4:
            dx = 1 if number == 0 else (-1 if number == 2 else 0)
            dz = 1 if number == 1 else (-1 if number == 3 else 0)
        else:
            dx = 1 if number in (4, 7) else -1
            dz = 1 if number < 6 else -1
            is_open = True
            for up in range(2):
                is_open &= _at(passing, sizes, x + dx, y + up, z)
                is_open &= _at(passing, sizes, x, y + up, z + dz)
            if not is_open:
                continue
        landing = _landing(cells, x, y, z, dx, dz)
        if landing < 0:
            continue
        if not (
            _may_cross(_door(cells, x, y, z), dx, dz)
            and _may_cross(_door(cells, x + dx, landing, z + dz), dx, dz)
        ):
            continue
        if dx != 0 and dz != 0 and (_door(cells, x + dx, y, z) or _door(cells, x, y, z + dz)):
            continue
        found[count] = ((x + dx) * sizes[1] + landing) * sizes[2] + z + dz
        count += 1
    return count


@inlined
def _far(x: float, y: float, z: float) -> float:
    return math.sqrt(x * x + y * y + z * z)


@inlined
def _is_met(aim: Aim, x: int, y: int, z: int) -> bool:
    """Return True if a cell meets an aim; free lines are not considered."""
    if aim.beside and x == aim.x and z == aim.z and (y == aim.y or y == aim.y - 1):
        return False
    up = y + EYE_HEIGHT - (aim.y + 0.5) if aim.by_hand else float(y - aim.y)
    return _far(x - aim.x, up, z - aim.z) <= aim.within


@compiled
def find(cells: Cells, aim: Aim, trail: Trail, queue: Queue, found: Ints, most: int) -> int:
    """Continue A* to the next cell that meets an aim.

    Args:
        cells: Cells of the ground.
        aim: The aim.
        trail: Cells found so far, at first the start alone.
        queue: Cells to continue from, at first the start alone.
        found: Scratch memory for 8 cells.
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
            if _is_met(aim, x, y, z):
                counts[3] = cell
                return cell
        x, y, z = cell // (sizes[1] * sizes[2]), cell // sizes[2] % sizes[1], cell % sizes[2]
        if not (first[0] <= x <= last[0] and first[1] <= y <= last[1] and first[2] <= z <= last[2]):
            counts[3] = cell
            return WIDER
        marks[cell] |= _DONE
        counts[2] += 1
        for number in range(_write_steps(cells, cell, found)):
            step = int(found[number])
            i, j, k = step // (sizes[1] * sizes[2]), step // sizes[2] % sizes[1], step % sizes[2]
            cost = costs[cell] + _far(i - x, j - y, k - z)
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
def holds_target(cells: Cells, aim: Aim, area: npt.NDArray[np.bool_]) -> bool:
    """Return True if a cell of an area meets an aim; `area` is True in it."""
    sizes, far = cells.sizes, int(min(aim.within, 1e6)) + 2
    for x in range(max(0, aim.x - far), min(sizes[0], aim.x + far + 1)):
        for y in range(max(0, aim.y - far), min(sizes[1], aim.y + far + 1)):
            for z in range(max(0, aim.z - far), min(sizes[2], aim.z + far + 1)):
                if area[(x * sizes[1] + y) * sizes[2] + z] and _is_met(aim, x, y, z):
                    return True
    return False
