"""Compiled test of all rays from an eye to the sample points of one block together.

The rays of a beam run close to each other. The kernel therefore looks up each cell on their way
once, and clips each shape there against all rays in one loop. Grids and codes are as in `rays`.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from beliefnest.perception.chunks import index_at, part, stride
from beliefnest.perception.codes import EMPTY, FIRST_SHAPE, FULL, INTRUDED, LIMIT_SLACK, OWN
from beliefnest.perception.compiling import inlined, inlined_allocating, inner, merged
from beliefnest.perception.rays import (
    LEAST_LENGTH,
    GridCell,
    RayScene,
    Vector,
    cell_at,
    code_at,
    hidden_by,
    is_inside,
    lower,
    main_axis,
    may_lie_in_face,
    neighbour,
    turned,
    turned_back,
    upper,
)
from beliefnest.perception.shadows import ROOM, Shadows

Eye = tuple[Vector, Vector, float, float]
"""Place of the eye, unit vector of its look, cosine of half its field of view (-2: all
directions), and greatest visible distance (infinite: no limit)."""


class Beam(NamedTuple):
    """The rays from an eye to the sample points of one block.

    Attributes:
        slopes: float64 (4, rays). Rows 0 to 2: 1 / d along x, y and z. First of row 3: the length
            of 1e-9 blocks in units of t, for all rays.
        opens: int64 (rays,), -1 while no block is found to hide the end of the ray, then 0.
    """

    slopes: npt.NDArray[np.float64]
    opens: npt.NDArray[np.int64]


_SAMPLES = 16
# Face corners are pulled in by 0.01. The offset is from the middle of the block, so that a
# mirrored block has exactly the mirrored sample points.
_CORNER = 0.49
# Replaces 1 / 0, because infinity times zero would be NaN.
_STEEP = 1e300
_SPARE = 1e-9


def beam_room() -> Beam:
    """Return scratch memory for one beam, to be reused for each block."""
    return Beam(np.ones((4, _SAMPLES)), np.empty(_SAMPLES, dtype=np.int64))


new_beam = inlined_allocating(beam_room)
"""Version of `beam_room` for kernels."""


def eye_of(place: Vector, yaw: float, pitch: float, cos_half: float, far: float) -> Eye:
    """Return an eye; yaw and pitch are in Mineflayer's radians, the rest is as in `Eye`."""
    level = math.cos(pitch)
    return place, (-math.sin(yaw) * level, math.sin(pitch), -math.cos(yaw) * level), cos_half, far


eye_at = inlined(eye_of)
"""Version of `eye_of` for kernels."""


@inlined
def in_field(eye: Eye, x: float, y: float, z: float) -> bool:
    """Return True if what lies at (x, y, z) from the eye's place is in the field of view."""
    _, look, cos_half, _ = eye
    if cos_half < -1.0:
        return True
    along = x * look[0] + z * look[2] + y * look[1]
    return along >= (cos_half - LIMIT_SLACK) * math.sqrt(x * x + z * z + y * y)


@inlined
def in_reach(eye: Eye, x: float, y: float, z: float) -> bool:
    """Return True if what lies at (x, y, z) from the eye's place is within the visible distance."""
    return math.sqrt(x * x + z * z + y * y) <= eye[3] + LIMIT_SLACK


@inlined
def _inverse(d: float) -> float:
    return 1.0 / d if d != 0.0 else _STEEP


@inlined
def _offset(eye: Vector, cell: GridCell, number: int) -> Vector:
    """Return a sample point's place from the middle of its cell.

    Number 0 is the middle; 1 to 5 are on the face turned to the eye along x, 6 to 10
    along y, 11 to 15 along z, each time the face's middle and its corners.
    """
    if number == 0:
        return 0.0, 0.0, 0.0
    axis, corner = (number - 1) // 5, (number - 1) % 5
    face = 0.5 if turned(eye, axis)[0] > turned(cell, axis)[0] else -0.5
    u = _CORNER * ((corner & 1) * 2 - 1) if corner > 0 else 0.0
    v = _CORNER * ((corner & 2) - 1) if corner > 0 else 0.0
    return turned((face, u, v), (3 - axis) % 3)


@merged
def _block_box(eye: Vector, low: Vector, high: Vector, beam: Beam) -> bool:
    """Close the rays that enter a box; return True if any ray is still open."""
    slopes, opens = beam
    x0, y0, z0 = low[0] - eye[0], low[1] - eye[1], low[2] - eye[2]
    x1, y1, z1 = high[0] - eye[0], high[1] - eye[1], high[2] - eye[2]
    left, least = 0, slopes[3, 0]
    for n in range(_SAMPLES):
        xa, xb = x0 * slopes[0, n], x1 * slopes[0, n]
        ya, yb = y0 * slopes[1, n], y1 * slopes[1, n]
        za, zb = z0 * slopes[2, n], z1 * slopes[2, n]
        t0 = upper(upper(lower(xa, xb), lower(za, zb)), upper(lower(ya, yb), 0.0))
        t1 = lower(lower(upper(xa, xb), upper(za, zb)), lower(upper(ya, yb), 1.0))
        opens[n] = 0 if t1 - t0 > least else opens[n]
        left |= opens[n]
    return left != 0


def block_cell(scene: RayScene, eye: Vector, cell: GridCell, beam: Beam) -> bool:
    """Close the rays that enter the block of a cell; return True if any ray is still open."""
    i, j, k = cell
    starts, boxes = scene.starts, scene.boxes
    code = code_at(scene, cell) & OWN
    low, high = (float(i), float(j), float(k)), (i + 1.0, j + 1.0, k + 1.0)
    first, last = 0, 1
    if code != FULL:
        first, last = starts[code - FIRST_SHAPE], starts[code - FIRST_SHAPE + 1]
    left = True
    for row in range(first, last):
        if code != FULL:
            low = (i + boxes[row, 0], j + boxes[row, 1], k + boxes[row, 2])
            high = (i + boxes[row, 3], j + boxes[row, 4], k + boxes[row, 5])
        left = _block_box(eye, low, high, beam)
    return left


_block_cell = inner(block_cell)
_block_cell_at_once = inlined(block_cell)
"""Version of `_block_cell` for the loop over suspects, which a call would make twice as long."""


@inlined
def _bounds(
    e: float, low: float, slope0: float, slope1: float, d0: float, d1: float
) -> tuple[int, int]:
    """Return the first and last cell a beam can touch between two distances, along one axis."""
    first = e + slope0 * (d1 if slope0 < 0 else d0)
    last = e + slope1 * (d1 if slope1 > 0 else d0)
    first, last = upper(first, lower(e, low)), lower(last, upper(e, low + 1.0))
    return math.floor(first - _SPARE), math.floor(last + _SPARE)


@inner
def _beam_ends(scene: RayScene, eye: Vector, target: GridCell, beam: Beam) -> bool:
    """Return True if any ray of a beam reaches the target.

    The loop goes layer by layer along the longest axis of the beam. In each layer it visits the
    rectangle of cells between the beam's outermost slopes.
    """
    codes, rows, sizes, chunks = scene.codes, scene.rows, scene.sizes, scene.chunks
    axis = main_axis((target[0] + 0.5 - eye[0], target[1] + 0.5 - eye[1], target[2] + 0.5 - eye[2]))
    ea, eb, ec = turned(eye, axis)
    ta, tb, tc = turned(target, axis)
    size_a, size_b, size_c = turned(sizes, axis)
    axis_b, axis_c = (axis + 1) % 3, (axis + 2) % 3
    stride_a = stride(chunks, sizes, axis)
    stride_b, stride_c = stride(chunks, sizes, axis_b), stride(chunks, sizes, axis_c)
    step = 1 if ta + 0.5 > ea else -1
    far = abs(ta + 0.5 - ea) + 0.5
    near = upper(far - 1.0, 1e-6)
    lb, hb, lc, hc = tb - eb, tb + 1 - eb, tc - ec, tc + 1 - ec
    b_slope0, b_slope1 = lb / (near if lb < 0 else far), hb / (near if hb > 0 else far)
    c_slope0, c_slope1 = lc / (near if lc < 0 else far), hc / (near if hc > 0 else far)
    start = math.floor(ea) if step > 0 else math.ceil(ea) - 1
    for layer in range(start, ta + step, step):
        if layer < 0 or layer >= size_a:
            continue
        d = (layer + 0.5 - ea) * step
        b0, b1 = _bounds(eb, tb, b_slope0, b_slope1, upper(d - 0.5, 0.0), d + 0.5)
        c0, c1 = _bounds(ec, tc, c_slope0, c_slope1, upper(d - 0.5, 0.0), d + 0.5)
        part_a = part(chunks, layer, stride_a, axis)
        for b in range(upper(b0, 0), lower(b1, size_b - 1) + 1):
            part_ab = part_a + part(chunks, b, stride_b, axis_b)
            for c in range(upper(c0, 0), lower(c1, size_c - 1) + 1):
                place = part_ab + part(chunks, c, stride_c, axis_c)
                code = codes[index_at(chunks, rows, place)]
                if code == EMPTY:
                    continue
                cell = turned_back(layer, b, c, axis)
                for side in range(-1, 6 if code & INTRUDED else 0):
                    block = neighbour(cell, side) if side >= 0 else cell
                    if (
                        block != target
                        and is_inside(sizes, block)
                        and code_at(scene, block) & OWN > (EMPTY if side < 0 else FULL)
                        and not _block_cell(scene, eye, block, beam)
                    ):
                        return False
    return True


@inner
def aim_along(eye: Eye, cell: GridCell, beam: Beam, axis: int) -> None:
    """Write the slopes of a beam along one axis; they depend on this coordinate of the cell only.

    A loop over the cells of a grid writes those of its outer loops once.
    """
    slopes, e, low = beam.slopes, turned(eye[0], axis)[0], turned(cell, axis)[0]
    d = low + 0.5 - e
    level, inner, outer = _inverse(d), _inverse(d - _CORNER), _inverse(d + _CORNER)
    face = _inverse(d + (0.5 if e > low else -0.5))
    for n in range(_SAMPLES):
        slopes[axis, n] = level
    for corner in range(5):
        slopes[axis, 1 + 5 * axis + corner] = face
    for corner in range(1, 5):
        # The order of axes is that of `_offset`: first the one after the face's own.
        slopes[axis, 1 + 5 * ((axis + 2) % 3) + corner] = outer if corner & 1 else inner
        slopes[axis, 1 + 5 * ((axis + 1) % 3) + corner] = outer if corner & 2 else inner


@merged
def _take_middles(opens: npt.NDArray[np.int64], levels: int) -> int:
    """Close the rays that may lie in the plane of a face, and return which of them were open.

    Bit n of the result is set if ray n was open. Bit a of `levels` is set if the eye is level
    with the middle of the block along axis a and may lie in the plane of a face.
    """
    taken = 0
    for face in range(-1, 3):
        number = 1 + 5 * face if face >= 0 else 0
        others = levels & ~(1 << face) if face >= 0 else levels
        if opens[number] != 0 and others != 0:
            opens[number] = 0
            taken |= 1 << number
    return taken


@inner
def _open(eye: Eye, cell: GridCell, beam: Beam) -> int:
    """Open the rays of a beam from an eye to a block; `aim_along` writes their slopes.

    Rays in the plane of a face are not part of the beam. The result has bit n set for each such
    ray n; the caller tries them one by one.
    """
    slopes, opens = beam
    place = eye[0]
    x, y, z = cell[0] + 0.5 - place[0], cell[1] + 0.5 - place[1], cell[2] + 0.5 - place[2]
    # One length serves for all rays: lengths to the sample points differ by less than a block.
    slopes[3, 0] = LEAST_LENGTH / upper(math.sqrt(x * x + z * z + y * y), 0.5)
    for n in range(_SAMPLES):
        opens[n] = -1
    levels = 0
    for axis in range(3):
        e, low = turned(place, axis)[0], turned(cell, axis)[0]
        d = turned((x, y, z), axis)[0]
        levels |= (1 << axis) if may_lie_in_face(e, d) else 0
        if low <= e <= low + 1:
            for number in range(1 + 5 * axis, 6 + 5 * axis):
                opens[number] = 0
    if eye[2] >= -1.0:
        for number in range(_SAMPLES):
            offset = _offset(place, cell, number)
            if not in_field(eye, x + offset[0], y + offset[1], z + offset[2]):
                opens[number] = 0
    return _take_middles(opens, levels) if levels != 0 else 0


@inlined
def _is_open(beam: Beam) -> bool:
    """Return True if any ray of a beam is open."""
    left = 0
    for n in range(_SAMPLES):
        left |= beam.opens[n]
    return left != 0


@inlined
def _sees_in_plane(scene: RayScene, eye: Eye, cell: GridCell, rays: int) -> bool:
    """Return True if one of the rays, given as bits, that `_aim` left out is free."""
    place = eye[0]
    x, y, z = cell[0] + 0.5 - place[0], cell[1] + 0.5 - place[1], cell[2] + 0.5 - place[2]
    for number in range(_SAMPLES if rays != 0 else 0):
        if (rays >> number) & 1:
            offset = _offset(place, cell, number)
            d = (x + offset[0], y + offset[1], z + offset[2])
            if hidden_by(scene, cell, place, d)[0] < 0:
                return True
    return False


@inner
def sees_block(scene: RayScene, eye: Eye, cell: GridCell, beam: Beam) -> bool:
    """Return True if a block, within the visible distance, is seen; `beam` is scratch memory."""
    for axis in range(3):
        aim_along(eye, cell, beam, axis)
    in_plane = _open(eye, cell, beam)
    if _is_open(beam) and _beam_ends(scene, eye[0], cell, beam):
        return True
    return _sees_in_plane(scene, eye, cell, in_plane)


@inlined
def sees_past(
    scene: RayScene, eye: Eye, cell: GridCell, beam: Beam, shadows: Shadows, index: int
) -> bool:
    """Return what `sees_block` returns, from the suspects that `cast_shadows` noted.

    `index` is the index of the cell in `shadows`. The slopes along x and y are in the beam.
    """
    aim_along(eye, cell, beam, 2)
    in_plane = _open(eye, cell, beam)
    left = _is_open(beam)
    count = shadows.counts[index]
    for n in range(min(count, ROOM)):
        if left:
            by = cell_at(scene.sizes, shadows.suspects[index, n])
            left = _block_cell_at_once(scene, eye[0], by, beam)
    if left and (count <= ROOM or _beam_ends(scene, eye[0], cell, beam)):
        return True
    return _sees_in_plane(scene, eye, cell, in_plane)
