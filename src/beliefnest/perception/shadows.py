"""Shadow casting: compiled bounds on the cells that an eye can and cannot see.

Each cell of a code grid (as in `rays`) gets a mark. `CLEAR`: the eye certainly sees the middle of
the cell. `HIDDEN`: the eye sees no point of the closed cell. `UNSURE`: anything else. For each cell
that is not hidden, the suspects are the blocks that may hide parts of it. The suspect that hides
the middle comes first, the others follow by layer, nearest first. Up to `ROOM` suspects are
stored; their count goes up to `ROOM` + 1, which means "too many".
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from beliefnest.perception.codes import EMPTY, FIRST_SHAPE, FULL, OWN, Reaches
from beliefnest.perception.compiling import allocating, compiled, inlined, inlined_allocating
from beliefnest.perception.rays import Cell, Scene, Vector, at, sloped, span, turned, turned_back

__all__ = [
    "CLEAR",
    "HIDDEN",
    "ROOM",
    "UNSURE",
    "Shadows",
    "cast_shadows",
    "no_shadows",
]


class Shadows(NamedTuple):
    """Result of shadow casting for the cells of a grid; empty arrays if none was done.

    Attributes:
        marks: int8 (cells,), `CLEAR`, `HIDDEN` or `UNSURE`.
        counts: uint8 (cells,), number of blocks that may hide parts of the cell.
        suspects: int32 (cells, `ROOM`), cell indices of these blocks.
    """

    marks: npt.NDArray[np.int8]
    counts: npt.NDArray[np.uint8]
    suspects: npt.NDArray[np.int32]


CLEAR = 0
UNSURE = 1
HIDDEN = 2
ROOM = 8

# Full shadows are made this much smaller and partial shadows larger. Rays that barely enter a box
# or lie in the plane of a face thus stay `UNSURE`, and the exact test decides them.
_SHRINK = 1e-4
_GROW = 1e-6
# An eye nearer than this to a box counts as inside it.
_TOUCHING = 1e-3


@inlined
def _is_enclosed(scene: Scene, shadows: Shadows, sides: Cell, index: int) -> bool:
    """Return True if every ray to a cell passes a full cube or a hidden cell just before it.

    `sides` are the index steps to the neighbours nearer to the eye, 0 along an axis where the
    eye is level with the cell. Neighbours across edges and corners count too, because a ray may
    come through an edge without entering the neighbours beside it.
    """
    if sides[0] == 0 and sides[1] == 0 and sides[2] == 0:
        return False
    for n in range(1, 8):
        if (n & 1 and sides[0] == 0) or (n & 2 and sides[1] == 0) or (n & 4 and sides[2] == 0):
            continue
        before = index
        before += sides[0] if n & 1 else 0
        before += sides[1] if n & 2 else 0
        before += sides[2] if n & 4 else 0
        if shadows.marks[before] != HIDDEN and scene.codes[before] & OWN != FULL:
            return False
    return True


@inlined
def _side(e: float, cell: int, stride: int) -> int:
    if e < cell:
        return -stride
    return stride if e > cell + 1 else 0


@inlined
def _cells_touched(
    e: float, edge0: float, edge1: float, d0: float, d1: float, size: int
) -> tuple[int, int]:
    """Return the first and last cell, without margin, in partial shadow between two distances."""
    low = e + edge0 * (d1 if edge0 < 0 else d0) - _GROW
    high = e + edge1 * (d1 if edge1 > 0 else d0) + _GROW
    return max(math.floor(low), 1), min(math.floor(high), size - 2)


@inlined
def _cells_within(
    e: float, edge0: float, edge1: float, d0: float, d1: float, size: int
) -> tuple[int, int]:
    """Return the first and last cell, without margin, in full shadow between two distances."""
    low = e + edge0 * (d1 if edge0 > 0 else d0)
    high = e + edge1 * (d0 if edge1 > 0 else d1)
    return max(math.ceil(low), 1), min(math.floor(high) - 1, size - 2)


@inlined
def _may_enter(eye: Vector, cell: Cell, low: Vector, high: Vector) -> bool:
    """Return True if the ray to a cell's middle enters a box or may lie in a plane of it."""
    d = (cell[0] + 0.5 - eye[0], cell[1] + 0.5 - eye[1], cell[2] + 0.5 - eye[2])
    if d[0] == 0.0 or d[1] == 0.0 or d[2] == 0.0:
        return True
    ray = sloped(eye, d)
    t0, t1 = span(ray, low, high)
    return t1 - t0 > ray[3]


@inlined
def _suspect(shadows: Shadows, cell: int, block: int) -> None:
    """Add a block to the suspects of a cell; without room for it, only count it."""
    counts = shadows.counts
    if cell != block and counts[cell] <= ROOM:
        if counts[cell] < ROOM:
            shadows.suspects[cell, counts[cell]] = block
        counts[cell] += 1


@inlined
def _doubt_all(shadows: Shadows, index: int) -> None:
    """Make the block of an index, which the eye touches, a suspect of all cells."""
    marks = shadows.marks
    for n in range(len(marks)):
        _suspect(shadows, n, index)
        if marks[n] == CLEAR:
            marks[n] = UNSURE


@inlined
def _prefer(shadows: Shadows, cell: int, block: int) -> None:
    """Move the last suspect of a cell, which hides its middle, to the first place."""
    counts, suspects = shadows.counts, shadows.suspects
    if cell != block:
        if counts[cell] <= ROOM:
            suspects[cell, counts[cell] - 1] = suspects[cell, 0]
        suspects[cell, 0] = block


@inlined
def _gap(eye: Vector, low: Vector, high: Vector) -> tuple[int, float]:
    """Return the axis along which an eye is farthest from a box, and the distance."""
    axis, near = 0, -1.0
    for n in range(3):
        e = turned(eye, n)[0]
        gap = max(turned(low, n)[0] - e, e - turned(high, n)[0])
        if gap > near:
            axis, near = n, gap
    return axis, near


@compiled
def _cast_box(
    shadows: Shadows,
    sizes: Cell,
    eye: Vector,
    low: Vector,
    high: Vector,
    index: int,
    casts_full: bool,
) -> None:
    """Mark the cells in the shadow of a box, which is part of the block of that index."""
    marks = shadows.marks
    axis, near = _gap(eye, low, high)
    if near < _TOUCHING:
        _doubt_all(shadows, index)
        return
    ea, eb, ec = turned(eye, axis)
    la, lb, lc = turned(low, axis)
    ha, hb, hc = turned(high, axis)
    size_a, size_b, size_c = turned(sizes, axis)
    stride_a, stride_b, stride_c = turned((sizes[1] * sizes[2], sizes[2], 1), axis)
    far = near + ha - la
    lb, hb, lc, hc = lb - eb, hb - eb, lc - ec, hc - ec
    # Edges of the shadow, per block of distance from the eye along the axis.
    part_b0, part_b1 = lb / (near if lb < 0 else far), hb / (near if hb > 0 else far)
    part_c0, part_c1 = lc / (near if lc < 0 else far), hc / (near if hc > 0 else far)
    full_b0, full_b1 = (lb + _SHRINK) / near, (hb - _SHRINK) / near
    full_c0, full_c1 = (lc + _SHRINK) / near, (hc - _SHRINK) / near
    casts_full = casts_full and full_b0 < full_b1 and full_c0 < full_c1
    step = 1 if la > ea else -1
    layer = max(math.floor(la), 1) if la > ea else min(math.ceil(ha) - 1, size_a - 2)
    while 1 <= layer < size_a - 1:
        d = (layer + 0.5 - ea) * step
        d0, d1 = max(d - 0.5, 0.0), d + 0.5
        b0, b1 = _cells_touched(eb, part_b0, part_b1, d0, d1, size_b)
        c0, c1 = _cells_touched(ec, part_c0, part_c1, d0, d1, size_c)
        if b0 > b1 or c0 > c1:
            break
        for b in range(b0, b1 + 1):
            is_b = part_b0 * d - _GROW <= b + 0.5 - eb <= part_b1 * d + _GROW
            for c in range(c0, c1 + 1):
                n = layer * stride_a + b * stride_b + c * stride_c
                if marks[n] == HIDDEN:
                    continue
                _suspect(shadows, n, index)
                if (
                    is_b
                    and marks[n] == CLEAR
                    and part_c0 * d - _GROW <= c + 0.5 - ec <= part_c1 * d + _GROW
                    and _may_enter(eye, turned_back(layer, b, c, axis), low, high)
                ):
                    marks[n] = UNSURE
                    _prefer(shadows, n, index)
        if casts_full and d0 >= near:
            b0, b1 = _cells_within(eb, full_b0, full_b1, d0, d1, size_b)
            c0, c1 = _cells_within(ec, full_c0, full_c1, d0, d1, size_c)
            for b in range(b0, b1 + 1):
                for c in range(c0, c1 + 1):
                    marks[layer * stride_a + b * stride_b + c * stride_c] = HIDDEN
        layer += step


@inlined_allocating
def _outward(e: float, size: int) -> npt.NDArray[np.int64]:
    """Return the cells of a grid along an axis, without margin, from the eye outwards."""
    order = np.empty(size - 2, dtype=np.int64)
    up = min(max(math.floor(e), 1), size - 1)
    down = up - 1
    for n in range(size - 2):
        if up < size - 1 and (down < 1 or up + 0.5 - e < e - down - 0.5):
            order[n] = up
            up += 1
        else:
            order[n] = down
            down -= 1
    return order


@allocating
def cast_shadows(scene: Scene, reaches: Reaches, eye: Vector) -> Shadows:
    """Return the shadows of all blocks.

    Blocks cast their shadows in order of distance, near ones first, so that hidden blocks need
    not cast any.
    """
    codes, sizes, starts, boxes = scene
    size = sizes[0] * sizes[1] * sizes[2]
    marks = np.zeros(size, dtype=np.int8)
    shadows = Shadows(marks, np.zeros(size, dtype=np.uint8), np.empty((size, ROOM), dtype=np.int32))
    for i in _outward(eye[0], sizes[0]):
        for j in _outward(eye[1], sizes[1]):
            for k in _outward(eye[2], sizes[2]):
                index = at(sizes, (i, j, k))
                sides = (
                    _side(eye[0], i, sizes[1] * sizes[2]),
                    _side(eye[1], j, sizes[2]),
                    _side(eye[2], k, 1),
                )
                if marks[index] != HIDDEN and _is_enclosed(scene, shadows, sides, index):
                    marks[index] = HIDDEN
                mark = marks[index]
                code = codes[index] & OWN
                if code == EMPTY or (mark == HIDDEN and reaches[code] == 0):
                    continue
                low, high = (float(i), float(j), float(k)), (i + 1.0, j + 1.0, k + 1.0)
                first, last = 0, 1
                if code != FULL:
                    first, last = starts[code - FIRST_SHAPE], starts[code - FIRST_SHAPE + 1]
                for row in range(first, last):
                    if code != FULL:
                        low = (i + boxes[row, 0], j + boxes[row, 1], k + boxes[row, 2])
                        high = (i + boxes[row, 3], j + boxes[row, 4], k + boxes[row, 5])
                    _cast_box(shadows, sizes, eye, low, high, index, reaches[code] == 0)
                # A block does not hide itself.
                marks[index] = mark
    return shadows


def no_shadows() -> Shadows:
    """Return an empty result, for lookups without shadow casting."""
    return Shadows(
        np.empty(0, dtype=np.int8),
        np.empty(0, dtype=np.uint8),
        np.empty((0, ROOM), dtype=np.int32),
    )
