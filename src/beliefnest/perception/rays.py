"""Compiled, exact cast of one ray through a grid of shapes.

Results do not change if the world is mirrored. The grid is a flattened code grid (see `codes`)
with its three sizes.
Coordinates are those of the grid: cell (i, j, k) is the cube from (i, j, k) to
(i + 1, j + 1, k + 1). A ray is eye + t * d, 0 <= t <= 1.

Corners of shapes are multiples of 1/32, and a shape reaches out of its cell by at most half a
cell, along one axis. All shapes of Minecraft are so; tests/world/test_registry.py checks it.
"""

import math
from typing import NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from beliefnest.perception.chunks import Rows, index_at, part, place_at, stride
from beliefnest.perception.codes import EMPTY, FIRST_SHAPE, FULL, INTRUDED, OWN
from beliefnest.perception.compiling import compiled, inlined, inner, merged
from beliefnest.world.array_types import Codes, Ints
from beliefnest.world.terrain import ChunkCounts

N = TypeVar("N", int, float)
GridCell = tuple[int, int, int]
Vector = tuple[float, float, float]
Boxes = npt.NDArray[np.float64]
Ray = tuple[Vector, Vector, Vector, float]
"""Eye, d, 1 / d (0 where d is 0), and the length of 1e-9 blocks in units of t."""


class RayScene(NamedTuple):
    """Code grid and the shapes of its codes, as kernels take them.

    Attributes:
        codes: uint16, the flattened code grid, or the pool that holds its chunks.
        sizes: Number of cells along x, y, z.
        starts: int32 (shapes + 1,), first row of each shape in `boxes`.
        boxes: float64 (n, 6), low and high corners of the boxes of shapes, relative to the cell.
        rows: Rows of the grid's chunks in the pool; None: the grid is dense. An array that is not
            used would double the time of kernels that allocate.
        chunks: Numbers of chunks along x, y, z; None: the grid is dense.
    """

    codes: Codes
    sizes: GridCell
    starts: Ints
    boxes: Boxes
    rows: Rows | None = None
    chunks: ChunkCounts | None = None


NOWHERE = (-1, -1, -1)

MISSED = 2.0
LEAST_LENGTH = 1e-9
_NUDGE = 1e-7
# Tolerance in choosing the cells that a ray is tested against.
_SPARE = 1e-11
# No shape comes this near to the outer side of the margin.
_RIM = 1e-3


@inlined
def lower(a: N, b: N) -> N:
    """Return the lesser of two numbers; `min` is compiled anew for each kernel that calls it."""
    return b if b < a else a


@inlined
def upper(a: N, b: N) -> N:
    """Return the greater of two numbers; `max` is compiled anew for each kernel that calls it."""
    return b if b > a else a


@inlined
def is_inside(sizes: GridCell, cell: GridCell) -> bool:
    """Return True if a cell is one of the grid's."""
    nx, ny, nz = sizes
    return 0 <= cell[0] < nx and 0 <= cell[1] < ny and 0 <= cell[2] < nz


@inlined
def at(sizes: GridCell, cell: GridCell) -> int:
    """Return the index of a cell in a flat array over a grid of these sizes."""
    return (cell[0] * sizes[1] + cell[1]) * sizes[2] + cell[2]


@inlined
def cell_at(sizes: GridCell, index: int) -> GridCell:
    """Return the cell of an index in a flat array over a grid of these sizes."""
    row = index // sizes[2]
    i = row // sizes[1]
    return i, row - i * sizes[1], index - row * sizes[2]


@inlined
def code_at(scene: RayScene, cell: GridCell) -> int:
    """Return the code of a cell of the grid."""
    place = place_at(scene.chunks, scene.sizes, cell)
    code: int = scene.codes[index_at(scene.chunks, scene.rows, place)]
    return code


@inlined
def neighbour(cell: GridCell, side: int) -> GridCell:
    """Return the cell across a side: 0 and 1 are low and high x, then y, then z."""
    by = 2 * (side % 2) - 1
    axis = side // 2
    return (
        cell[0] + (by if axis == 0 else 0),
        cell[1] + (by if axis == 1 else 0),
        cell[2] + (by if axis == 2 else 0),
    )


@inlined
def sloped(eye: Vector, d: Vector) -> Ray:
    """Return the ray from the eye along d, which is not zero."""
    inverse = (
        1.0 / d[0] if d[0] != 0.0 else 0.0,
        1.0 / d[1] if d[1] != 0.0 else 0.0,
        1.0 / d[2] if d[2] != 0.0 else 0.0,
    )
    return eye, d, inverse, LEAST_LENGTH / math.sqrt(d[0] * d[0] + d[2] * d[2] + d[1] * d[1])


@inlined
def _clip(e: float, inverse: float, low: float, high: float) -> tuple[float, float]:
    """Return the part (t0, t1) of a line strictly between two planes; t0 > t1 if there is none."""
    if inverse == 0.0:
        if low < e < high:
            return -math.inf, math.inf
        return math.inf, -math.inf
    ta = (low - e) * inverse
    tb = (high - e) * inverse
    return lower(ta, tb), upper(ta, tb)


@inlined
def span(ray: Ray, low: Vector, high: Vector) -> tuple[float, float]:
    """Return the part (t0, t1) of a ray inside a box; t0 > t1 if there is none."""
    eye, _, inverse, _ = ray
    x0, x1 = _clip(eye[0], inverse[0], low[0], high[0])
    y0, y1 = _clip(eye[1], inverse[1], low[1], high[1])
    z0, z1 = _clip(eye[2], inverse[2], low[2], high[2])
    return upper(upper(x0, z0), upper(y0, 0.0)), lower(lower(x1, z1), lower(y1, 1.0))


@inlined
def _block_entry(scene: RayScene, code: int, cell: GridCell, ray: Ray) -> float:
    """Return the t at which a ray first enters the block of a cell; `MISSED` if it does not."""
    i, j, k = cell
    least = ray[3]
    if code == FULL:
        t0, t1 = span(ray, (float(i), float(j), float(k)), (i + 1.0, j + 1.0, k + 1.0))
        return t0 if t1 - t0 > least else MISSED
    entry, starts, boxes = MISSED, scene.starts, scene.boxes
    for row in range(starts[code - FIRST_SHAPE], starts[code - FIRST_SHAPE + 1]):
        low = (i + boxes[row, 0], j + boxes[row, 1], k + boxes[row, 2])
        high = (i + boxes[row, 3], j + boxes[row, 4], k + boxes[row, 5])
        t0, t1 = span(ray, low, high)
        if t1 - t0 > least:
            entry = lower(entry, t0)
    return entry


@inlined
def _cell_entry(
    scene: RayScene, cell: GridCell, target: GridCell, ray: Ray
) -> tuple[float, GridCell]:
    """Return t and cell of the first block that a ray enters inside a cell.

    Candidates are the block of the cell itself and blocks of neighbours that reach into it.
    """
    sizes = scene.sizes
    entry = MISSED
    hit = NOWHERE
    code = code_at(scene, cell)
    if code & OWN != EMPTY and cell != target:
        entry = _block_entry(scene, code & OWN, cell, ray)
        if entry != MISSED:
            hit = cell
    if code & INTRUDED:
        for side in range(6):
            other = neighbour(cell, side)
            if (
                other != target
                and is_inside(sizes, other)
                and code_at(scene, other) & OWN >= FIRST_SHAPE
            ):
                t = _block_entry(scene, code_at(scene, other) & OWN, other, ray)
                if t < entry:
                    entry = t
                    hit = other
    return entry, hit


@inlined
def turned(vector: tuple[N, N, N], axis: int) -> tuple[N, N, N]:
    """Return a vector's components from an axis on: (x, y, z), (y, z, x) or (z, x, y)."""
    x, y, z = vector
    if axis == 0:
        return x, y, z
    if axis == 1:
        return y, z, x
    return z, x, y


@inlined
def turned_back(a: int, b: int, c: int, axis: int) -> GridCell:
    """Return the cell of components from an axis on; undoes `turned`."""
    if axis == 0:
        return a, b, c
    if axis == 1:
        return c, a, b
    return b, c, a


@inlined
def main_axis(d: Vector) -> int:
    """Return the axis along which d is longest."""
    x, y, z = abs(d[0]), abs(d[1]), abs(d[2])
    if x >= y and x >= z:
        return 0
    return 1 if y >= z else 2


@merged
def _part_inside(sizes: GridCell, ray: Ray) -> tuple[float, float]:
    """Return the part (t0, t1) of a ray inside the grid, short of its outer rim."""
    nx, ny, nz = sizes
    (x, y, z), d, _, _ = ray
    low, high = (_RIM, _RIM, _RIM), (nx - _RIM, ny - _RIM, nz - _RIM)
    if (
        low[0] < lower(x, x + d[0])
        and upper(x, x + d[0]) < high[0]
        and low[1] < lower(y, y + d[1])
        and upper(y, y + d[1]) < high[1]
        and low[2] < lower(z, z + d[2])
        and upper(z, z + d[2]) < high[2]
    ):
        return 0.0, 1.0
    return span(ray, low, high)


@inner
def _first_hit(scene: RayScene, target: GridCell, ray: Ray) -> GridCell:
    """Return the cell of the first block whose shape a ray enters; `NOWHERE` if there is none.

    The loop goes layer by layer along the longest axis of the ray. In one layer the ray touches
    at most two cells along each other axis. All shapes in these cells are clipped against the
    ray and the least t wins, so rounding at edges and corners cannot change the result.
    """
    codes, rows, sizes, chunks = scene.codes, scene.rows, scene.sizes, scene.chunks
    t0, t1 = _part_inside(sizes, ray)
    if not t0 < t1:
        return NOWHERE
    eye, d, _, _ = ray
    axis = main_axis(d)
    ea, eb, ec = turned(eye, axis)
    da, db, dc = turned(d, axis)
    axis_b, axis_c = (axis + 1) % 3, (axis + 2) % 3
    stride_a = stride(chunks, sizes, axis)
    stride_b, stride_c = stride(chunks, sizes, axis_b), stride(chunks, sizes, axis_c)
    slope_b, slope_c = db / da, dc / da
    spare_b, spare_c = math.copysign(_SPARE, db), math.copysign(_SPARE, dc)
    start, end = ea + t0 * da, ea + t1 * da
    layer, last = int(start), int(end)
    step = 1 if da > 0.0 else -1
    ahead = 1 if da > 0.0 else 0
    b, c = eb + (start - ea) * slope_b, ec + (start - ea) * slope_c
    for _ in range(abs(last - layer) + 1):
        x = float(layer + ahead) if layer != last else end
        b_far, c_far = eb + (x - ea) * slope_b, ec + (x - ea) * slope_c
        b0, b1 = int(b - spare_b), int(b_far + spare_b)
        c0, c1 = int(c - spare_c), int(c_far + spare_c)
        part_a = part(chunks, layer, stride_a, axis)
        row0 = part_a + part(chunks, b0, stride_b, axis_b)
        row1 = part_a + part(chunks, b1, stride_b, axis_b)
        part0, part1 = part(chunks, c0, stride_c, axis_c), part(chunks, c1, stride_c, axis_c)
        if (
            codes[index_at(chunks, rows, row0 + part0)]
            | codes[index_at(chunks, rows, row0 + part1)]
            | codes[index_at(chunks, rows, row1 + part0)]
            | codes[index_at(chunks, rows, row1 + part1)]
            or abs(b1 - b0) > 1
            or abs(c1 - c0) > 1
        ):
            entry, hit = MISSED, NOWHERE
            for nb in range(lower(b0, b1), upper(b0, b1) + 1):
                for nc in range(lower(c0, c1), upper(c0, c1) + 1):
                    cell = turned_back(layer, nb, nc, axis)
                    if code_at(scene, cell) != EMPTY:
                        t, block = _cell_entry(scene, cell, target, ray)
                        if t < entry:
                            entry, hit = t, block
            if entry != MISSED:
                return hit
        layer += step
        b, c = b_far, c_far
    return NOWHERE


@inlined
def may_lie_in_face(e: float, d: float) -> bool:
    """Return True if a ray may lie in the plane of a face that is normal to an axis."""
    return d == 0.0 and e * 32.0 == math.floor(e * 32.0)


@inner
def hidden_by(scene: RayScene, target: GridCell, eye: Vector, d: Vector) -> GridCell:
    """Return the cell of the first block that hides eye + d; `NOWHERE` if none does.

    The target hides nothing. A ray in the plane of a face is free if it is free on one side of
    the plane. So a ray cannot pass between two adjacent blocks, but it may graze a single one.
    """
    if d[0] != 0.0 and d[1] != 0.0 and d[2] != 0.0:
        return _first_hit(scene, target, sloped(eye, d))
    hit = NOWHERE
    if d[0] == 0.0 and d[1] == 0.0 and d[2] == 0.0:
        return hit
    # Along an axis without such a plane there is only one ray, which is not moved.
    sides_x = 2 if may_lie_in_face(eye[0], d[0]) else 1
    sides_y = 2 if may_lie_in_face(eye[1], d[1]) else 1
    sides_z = 2 if may_lie_in_face(eye[2], d[2]) else 1
    for n in range(sides_x * sides_y * sides_z):
        x, y, z = n % sides_x, n // sides_x % sides_y, n // (sides_x * sides_y)
        moved = (
            eye[0] + (sides_x - 1) * (2 * x - 1) * _NUDGE,
            eye[1] + (sides_y - 1) * (2 * y - 1) * _NUDGE,
            eye[2] + (sides_z - 1) * (2 * z - 1) * _NUDGE,
        )
        hit = _first_hit(scene, target, sloped(moved, d))
        if hit[0] < 0:
            return hit
    return hit


@compiled
def blocker(scene: RayScene, target: GridCell, eye: Vector, d: Vector) -> GridCell:
    """Return `hidden_by`; kernels call that one, which has no wrapper for Python."""
    return hidden_by(scene, target, eye, d)
