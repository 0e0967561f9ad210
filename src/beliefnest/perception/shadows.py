"""Shadow casting: compiled bounds on the cells that an eye can and cannot see.

Each cell of a code grid (as in `rays`) gets a mark. `CLEAR`: the eye certainly sees the middle of
the cell. `HIDDEN`: the eye sees no point of the closed cell. `UNSURE`: anything else. For each cell
that is not hidden, the suspects are the blocks that may hide parts of it. The suspect that hides
the middle comes first, the others follow by layer, nearest first. Up to `ROOM` suspects are
stored; their count goes up to `ROOM` + 1, which means "too many".
"""

import math
from typing import NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from beliefnest.perception.codes import EMPTY, FIRST_SHAPE, FULL, OWN, Reaches
from beliefnest.perception.compiling import allocating, inlined, inner
from beliefnest.perception.light import outwards, side
from beliefnest.perception.rays import GridCell, RayScene, Vector, at, turned

N = TypeVar("N", int, float)
RayPart = tuple[float, float]
"""Part of a ray, from one fraction of its length to another."""


class Shadows(NamedTuple):
    """Result of shadow casting for the cells of a grid.

    Attributes:
        marks: int8 (cells,), `CLEAR`, `HIDDEN` or `UNSURE`.
        counts: uint8 (cells,), number of blocks that may hide parts of the cell; `ROOM` + 1 for a
            hidden cell.
        suspects: int32 (cells, `ROOM` + 2), cell indices of these blocks. Only the first `ROOM` of
            a row count; the others take what there is no room for.
    """

    marks: npt.NDArray[np.int8]
    counts: npt.NDArray[np.uint8]
    suspects: npt.NDArray[np.int32]


CLEAR = 0
UNSURE = 1
HIDDEN = 2
ROOM = 14

# Full shadows are made this much smaller and partial shadows larger. Rays that barely enter a box
# or lie in the plane of a face thus stay `UNSURE`, and the exact test decides them.
_SHRINK = 1e-4
_GROW = 1e-6
# An eye nearer than this to a box counts as inside it.
_TOUCHING = 1e-3


@inlined
def _is_enclosed(scene: RayScene, shadows: Shadows, sides: GridCell, index: int) -> bool:
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
def _clipped(t: RayPart, low: float, high: float, d: float) -> RayPart:
    """Return the part (t0, t1) of a ray that is also between two planes; t0 > t1: there is none.

    `d` is the ray's component across the planes. A ray in a plane counts as between the planes,
    because it may lie in a face.
    """
    if d == 0.0:
        return t
    ta, tb = low / d, high / d
    return max(t[0], min(ta, tb)), min(t[1], max(ta, tb))


@inlined
def _suspect(shadows: Shadows, cell: int, block: int) -> None:
    """Add a block to the suspects of a cell; without room for it, only count it.

    There are no branches, because a processor could not predict them.
    """
    place = shadows.counts[cell]
    shadows.suspects[cell, place] = block
    shadows.counts[cell] = min(place + 1, ROOM + 1)


@inlined
def _prefer(shadows: Shadows, cell: int) -> None:
    """Move the last suspect of a cell, which hides its middle, to the first place."""
    suspects, last = shadows.suspects, shadows.counts[cell] - 1
    suspects[cell, last], suspects[cell, 0] = suspects[cell, 0], suspects[cell, last]


@inlined
def _hide(shadows: Shadows, cell: int) -> None:
    """Mark a cell as hidden. Nothing more is to be noted about it."""
    shadows.marks[cell] = HIDDEN
    shadows.counts[cell] = ROOM + 1


@inlined
def _doubt_all(shadows: Shadows, index: int) -> None:
    """Make the block of an index, which the eye touches, a suspect of all cells."""
    marks = shadows.marks
    for n in range(len(marks)):
        _suspect(shadows, n, index)
        if marks[n] == CLEAR:
            marks[n] = UNSURE


@inlined
def _across(vector: tuple[N, N, N], axis: int) -> tuple[N, N, N]:
    """Return a vector's component along an axis, then the others, so that loops end with z."""
    x, y, z = vector
    if axis == 0:
        return x, y, z
    if axis == 1:
        return y, x, z
    return z, x, y


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


@inner
def _cast_box(
    shadows: Shadows,
    sizes: GridCell,
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
    ea, eb, ec = _across(eye, axis)
    la, lb, lc = _across(low, axis)
    ha, hb, hc = _across(high, axis)
    size_a, size_b, size_c = _across(sizes, axis)
    stride_a, stride_b, stride_c = _across((sizes[1] * sizes[2], sizes[2], 1), axis)
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
        # Parts inside the box of the rays to the middles of these cells, first along the axis.
        in_layer = (near / d, min(far / d, 1.0)) if d > 0.0 else (1.0, 0.0)
        for b in range(b0, b1 + 1):
            in_row = _clipped(in_layer, lb, hb, b + 0.5 - eb)
            row = layer * stride_a + b * stride_b
            for c in range(c0, c1 + 1):
                n = row + c * stride_c
                _suspect(shadows, n, index)
                if marks[n] == CLEAR and in_row[0] <= in_row[1] + _GROW:
                    inside = _clipped(in_row, lc, hc, c + 0.5 - ec)
                    if inside[0] <= inside[1] + _GROW:
                        marks[n] = UNSURE
                        _prefer(shadows, n)
        if casts_full and d0 >= near:
            b0, b1 = _cells_within(eb, full_b0, full_b1, d0, d1, size_b)
            c0, c1 = _cells_within(ec, full_c0, full_c1, d0, d1, size_c)
            for b in range(b0, b1 + 1):
                for c in range(c0, c1 + 1):
                    _hide(shadows, layer * stride_a + b * stride_b + c * stride_c)
        layer += step


@allocating
def cast_shadows(scene: RayScene, reaches: Reaches, eye: Vector) -> Shadows:
    """Return the shadows of all blocks.

    Blocks cast their shadows in order of distance, near ones first, so that hidden blocks need
    not cast any.
    """
    codes, sizes, starts, boxes = scene.codes, scene.sizes, scene.starts, scene.boxes
    size = sizes[0] * sizes[1] * sizes[2]
    marks = np.zeros(size, dtype=np.int8)
    shadows = Shadows(
        marks, np.zeros(size, dtype=np.uint8), np.empty((size, ROOM + 2), dtype=np.int32)
    )
    nx, ny, nz = sizes[0] - 2, sizes[1] - 2, sizes[2] - 2
    for number_x in range(nx):
        i = outwards(eye[0], 1, nx, number_x)
        side_x = side(eye[0], i) * sizes[1] * sizes[2]
        for number_y in range(ny):
            j = outwards(eye[1], 1, ny, number_y)
            side_y = side(eye[1], j) * sizes[2]
            for number_z in range(nz):
                k = outwards(eye[2], 1, nz, number_z)
                index = at(sizes, (i, j, k))
                sides = (side_x, side_y, side(eye[2], k))
                if marks[index] != HIDDEN and _is_enclosed(scene, shadows, sides, index):
                    _hide(shadows, index)
                mark, count = marks[index], shadows.counts[index]
                code = codes[index] & OWN
                if code == EMPTY or (mark == HIDDEN and reaches[code] == 0):
                    continue
                low, high = (float(i), float(j), float(k)), (i + 1.0, j + 1.0, k + 1.0)
                first, last = 0, 1
                if code != FULL:
                    first, last = starts[code - FIRST_SHAPE], starts[code - FIRST_SHAPE + 1]
                # A block does not hide itself: what is noted about its own cell is undone.
                marks[index] = UNSURE
                for row in range(first, last):
                    if code != FULL:
                        low = (i + boxes[row, 0], j + boxes[row, 1], k + boxes[row, 2])
                        high = (i + boxes[row, 3], j + boxes[row, 4], k + boxes[row, 5])
                    _cast_box(shadows, sizes, eye, low, high, index, reaches[code] == 0)
                marks[index], shadows.counts[index] = mark, count
    return shadows
