"""One ray through a grid of shapes: compiled, exact, the same in a mirror.

A grid of codes has one uint16 per cell, with a margin of one cell on every side: the
shape of the cell's own block (`EMPTY`, `FULL`, or `FIRST_SHAPE` + the number of a row
range in the shape tables), plus `INTRUDED` if the shape of a neighbour reaches into the
cell. Coordinates are those of the grid: cell (i, j, k) is the cube from (i, j, k) to
(i + 1, j + 1, k + 1). A ray is eye + t * d, 0 <= t <= 1.

Shapes lie on a grid of 1/32 and reach out of their cell by less than one cell along one
axis, as all shapes of Minecraft do; tests/world/test_registry.py holds that.
"""

import math
from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
import numpy as np
import numpy.typing as npt

__all__ = [
    "EMPTY",
    "FIRST_SHAPE",
    "FULL",
    "INTRUDED",
    "NOWHERE",
    "OWN",
    "Codes",
    "Shapes",
    "compiled",
    "first_hit",
    "hidden_by",
    "is_inside",
    "neighbour",
]

F = TypeVar("F", bound=Callable[..., Any])
Codes = npt.NDArray[np.uint16]
Shapes = tuple[npt.NDArray[np.int32], npt.NDArray[np.float64]]
"""Shape k's boxes are rows starts[k] to starts[k + 1] - 1 of boxes (x0, y0, z0, x1, y1, z1)."""

EMPTY = 0
FULL = 1
FIRST_SHAPE = 2
INTRUDED = 0x8000
NOWHERE = (-1, -1, -1)

OWN = 0x7FFF
_LEAST_LENGTH = 1e-9
_NUDGE = 1e-7
_MISSED = 2.0


def compiled(function: F) -> F:
    """Compile a kernel on first use and keep the machine code for the next process."""
    return cast(F, numba.njit(cache=True, nogil=True)(function))


@compiled
def _clip(e: float, d: float, low: float, high: float) -> tuple[float, float]:
    """The part (t0, t1) of a ray strictly between two planes; t0 > t1 if there is none."""
    if d == 0.0:
        if low < e < high:
            return 0.0, 1.0
        return 1.0, 0.0
    t0 = (low - e) / d
    t1 = (high - e) / d
    if t0 > t1:
        t0, t1 = t1, t0
    return max(t0, 0.0), min(t1, 1.0)


@compiled
def _shape_entry(
    shapes: Shapes,
    shape: int,
    cell: tuple[int, int, int],
    eye: tuple[float, float, float],
    d: tuple[float, float, float],
    least: float,
) -> float:
    """Where a ray first enters a box of a shape standing in a cell; `_MISSED` if nowhere."""
    starts, boxes = shapes
    entry = _MISSED
    for row in range(starts[shape], starts[shape + 1]):
        x0, x1 = _clip(eye[0], d[0], cell[0] + boxes[row, 0], cell[0] + boxes[row, 3])
        y0, y1 = _clip(eye[1], d[1], cell[1] + boxes[row, 1], cell[1] + boxes[row, 4])
        z0, z1 = _clip(eye[2], d[2], cell[2] + boxes[row, 2], cell[2] + boxes[row, 5])
        t0 = max(x0, y0, z0)
        if min(x1, y1, z1) - t0 > least:
            entry = min(entry, t0)
    return entry


@compiled
def _shaped_cell_hit(
    codes: Codes,
    shapes: Shapes,
    cell: tuple[int, int, int],
    target: tuple[int, int, int],
    eye: tuple[float, float, float],
    d: tuple[float, float, float],
    least: float,
) -> tuple[float, int]:
    """Entry and owner of the first shape met among those in and reaching into a cell.

    The owner is 0 for the cell's own block, 1 to 6 for a neighbour; -1 if none is met.
    Full cubes are left to the caller.
    """
    entry = _MISSED
    owner = -1
    code = codes[cell]
    own = code & OWN
    if own >= FIRST_SHAPE and cell != target:
        entry = _shape_entry(shapes, own - FIRST_SHAPE, cell, eye, d, least)
        if entry != _MISSED:
            owner = 0
    if code & INTRUDED:
        for side in range(6):
            other = neighbour(cell, side)
            if other == target or not is_inside(codes, other):
                continue
            theirs = codes[other] & OWN
            if theirs >= FIRST_SHAPE:
                t = _shape_entry(shapes, theirs - FIRST_SHAPE, other, eye, d, least)
                if t < entry:
                    entry = t
                    owner = 1 + side
    return entry, owner


@compiled
def neighbour(cell: tuple[int, int, int], side: int) -> tuple[int, int, int]:
    """The cell across a side: 0 and 1 are low and high x, then y, then z."""
    by = 2 * (side % 2) - 1
    axis = side // 2
    return (
        cell[0] + (by if axis == 0 else 0),
        cell[1] + (by if axis == 1 else 0),
        cell[2] + (by if axis == 2 else 0),
    )


@compiled
def is_inside(codes: Codes, cell: tuple[int, int, int]) -> bool:
    """Whether a cell is one of the grid's."""
    return (
        0 <= cell[0] < codes.shape[0]
        and 0 <= cell[1] < codes.shape[1]
        and 0 <= cell[2] < codes.shape[2]
    )


@compiled
def _first_crossing(e: float, d: float, cell: int) -> tuple[int, float, float]:
    """Step, t of the first cell boundary, and t between boundaries, along one axis."""
    if d > 0.0:
        return 1, (cell + 1 - e) / d, 1.0 / d
    if d < 0.0:
        return -1, (cell - e) / d, -1.0 / d
    return 0, math.inf, math.inf


@compiled
def _start_cell(e: float, d: float, t: float, size: int) -> int:
    return min(max(int(math.floor(e + t * d)), 0), size - 1)


@compiled
def first_hit(
    codes: Codes,
    shapes: Shapes,
    target: tuple[int, int, int],
    eye: tuple[float, float, float],
    d: tuple[float, float, float],
) -> tuple[int, int, int]:
    """The cell of the first block whose shape a ray enters; `NOWHERE` if there is none.

    The target's own shape is passed through. Rays within a face plane are not treated
    specially (`hidden_by` does).
    """
    x0, x1 = _clip(eye[0], d[0], 0.0, float(codes.shape[0]))
    y0, y1 = _clip(eye[1], d[1], 0.0, float(codes.shape[1]))
    z0, z1 = _clip(eye[2], d[2], 0.0, float(codes.shape[2]))
    t = max(x0, y0, z0)
    if t >= min(x1, y1, z1):
        return NOWHERE
    least = _LEAST_LENGTH / math.sqrt(d[0] * d[0] + d[2] * d[2] + d[1] * d[1])
    i = _start_cell(eye[0], d[0], t, codes.shape[0])
    j = _start_cell(eye[1], d[1], t, codes.shape[1])
    k = _start_cell(eye[2], d[2], t, codes.shape[2])
    step_i, next_i, each_i = _first_crossing(eye[0], d[0], i)
    step_j, next_j, each_j = _first_crossing(eye[1], d[1], j)
    step_k, next_k, each_k = _first_crossing(eye[2], d[2], k)
    while True:
        leave = min(next_i, next_j, next_k, 1.0)
        code = codes[i, j, k]
        if code != EMPTY:
            cell = (i, j, k)
            entry = _MISSED
            owner = -1
            if code != FULL:
                entry, owner = _shaped_cell_hit(codes, shapes, cell, target, eye, d, least)
            if code & OWN == FULL and cell != target and leave - t > least and t < entry:
                return cell
            if owner >= 0:
                return neighbour(cell, owner - 1) if owner > 0 else cell
        if leave >= 1.0:
            return NOWHERE
        t = leave
        # Among crossings at the same t the order is free: a cell passed at an edge gets
        # no length, so it cannot block.
        if leave == next_i:
            i += step_i
            next_i += each_i
            if i < 0 or i >= codes.shape[0]:
                return NOWHERE
        elif leave == next_j:
            j += step_j
            next_j += each_j
            if j < 0 or j >= codes.shape[1]:
                return NOWHERE
        else:
            k += step_k
            next_k += each_k
            if k < 0 or k >= codes.shape[2]:
                return NOWHERE


@compiled
def _may_lie_in_face(e: float, d: float) -> bool:
    return d == 0.0 and e * 32.0 == math.floor(e * 32.0)


@compiled
def hidden_by(
    codes: Codes,
    shapes: Shapes,
    target: tuple[int, int, int],
    eye: tuple[float, float, float],
    sample: tuple[float, float, float],
) -> tuple[int, int, int]:
    """The cell of the first block that hides a sample; `NOWHERE` if none does.

    The target hides nothing. A ray in the plane of a face is free if it is free on one
    side of the plane: two blocks side by side leave no crack, and one may be grazed.
    """
    d = (sample[0] - eye[0], sample[1] - eye[1], sample[2] - eye[2])
    if d[0] != 0.0 and d[1] != 0.0 and d[2] != 0.0:
        return first_hit(codes, shapes, target, eye, d)
    hit = NOWHERE
    if d[0] == 0.0 and d[1] == 0.0 and d[2] == 0.0:
        return hit
    # Along an axis without such a plane there is one side, and nothing to be moved.
    sides_x = 2 if _may_lie_in_face(eye[0], d[0]) else 1
    sides_y = 2 if _may_lie_in_face(eye[1], d[1]) else 1
    sides_z = 2 if _may_lie_in_face(eye[2], d[2]) else 1
    for x in range(sides_x):
        for y in range(sides_y):
            for z in range(sides_z):
                moved = (
                    eye[0] + (sides_x - 1) * (2 * x - 1) * _NUDGE,
                    eye[1] + (sides_y - 1) * (2 * y - 1) * _NUDGE,
                    eye[2] + (sides_z - 1) * (2 * z - 1) * _NUDGE,
                )
                hit = first_hit(codes, shapes, target, moved, d)
                if hit[0] < 0:
                    return hit
    return hit
