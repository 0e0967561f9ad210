"""Single looks, compiled, for kernels of other rooms: one eye, one block or one agent.

Coordinates and codes are those of `rays`, an `Eye` is that of `beams`.
"""

import math

import numpy as np

from beliefnest.perception.beams import Beam, Eye, in_field, in_reach, sees_block
from beliefnest.perception.codes import EMPTY, FIRST_SHAPE, FULL, INTRUDED, OWN, Reaches
from beliefnest.perception.compiling import inlined, inner, merged
from beliefnest.perception.rays import (
    GridCell,
    RayScene,
    Vector,
    at,
    code_at,
    hidden_by,
    is_inside,
    lower,
    neighbour,
    turned,
    turned_back,
    upper,
)
from beliefnest.world.array_types import Codes
from beliefnest.world.values import AGENT_SAMPLE_HEIGHTS, BODY_CENTRE_HEIGHT

_MARGIN = 1e-3
_THINNEST = 1 / 32
"""Least depth of what closes a layer: rays pass that are inside for less than 1e-9 blocks."""
_HEIGHTS = np.array(AGENT_SAMPLE_HEIGHTS)


@inlined
def _side(e: float, low: int) -> int:
    """Return the side of a cell, along one axis, on which an eye is: -1, 0 (level with it), or 1.

    2: the eye is so near to the plane of a face that rays in this plane might count.
    """
    if e < low - _MARGIN:
        return -1
    if e > low + 1 + _MARGIN:
        return 1
    return 0 if low + _MARGIN < e < low + 1 - _MARGIN else 2


# Merged into its caller, it makes a tick in unknown ground four times as long.
@inner
def _is_enclosed(scene: RayScene, eye: Vector, cell: GridCell) -> bool:
    """Return True if full cubes hide a cell from the eye; False if that is not certain.

    These are the neighbours on the eye's side, across faces, edges and corners, because a ray may
    come through an edge without entering the neighbours beside it. The test takes few looks at the
    grid. It spares the rays to what lies inside the ground, which nobody sees.
    """
    i, j, k = _side(eye[0], cell[0]), _side(eye[1], cell[1]), _side(eye[2], cell[2])
    if i == 2 or j == 2 or k == 2 or (i == 0 and j == 0 and k == 0):
        return False
    for n in range(1, 8):
        if (n & 1 and i == 0) or (n & 2 and j == 0) or (n & 4 and k == 0):
            continue
        by = (i if n & 1 else 0, j if n & 2 else 0, k if n & 4 else 0)
        other = (cell[0] + by[0], cell[1] + by[1], cell[2] + by[2])
        if not is_inside(scene.sizes, other) or code_at(scene, other) & OWN != FULL:
            return False
    return True


@inner
def _is_closed(scene: RayScene, axis: int, layer: int) -> bool:
    """Return True if no ray gets through a layer of the box, from one side to the other.

    So it is if all its blocks fill one and the same part of its depth.
    """
    _, size_b, size_c = turned(scene.sizes, axis)
    boxes, low, high = scene.boxes, 0.0, 1.0
    for b in range(1, size_b - 1):
        for c in range(1, size_c - 1):
            code = code_at(scene, turned_back(layer, b, c, axis)) & OWN
            if code == EMPTY:
                return False
            if code != FULL:
                row = scene.starts[code - FIRST_SHAPE]
                a0, b0, c0 = turned((boxes[row, 0], boxes[row, 1], boxes[row, 2]), axis)
                a1, b1, c1 = turned((boxes[row, 3], boxes[row, 4], boxes[row, 5]), axis)
                low, high = upper(low, a0), lower(high, a1)
                if upper(b0, c0) > 0.0 or lower(b1, c1) < 1.0 or high - low < _THINNEST:
                    return False
    return True


@inner
def _open_layers(scene: RayScene, eye: Vector, axis: int) -> tuple[int, int]:
    """Return the first layer along an axis that no closed one hides, and one after the last."""
    own, size = math.floor(turned(eye, axis)[0]), turned(scene.sizes, axis)[0]
    first, end = own, own + 1
    while first > 1 and (first == own or not _is_closed(scene, axis, first)):
        first -= 1
    while end < size - 1 and (end == own + 1 or not _is_closed(scene, axis, end - 1)):
        end += 1
    return first - 1, lower(end, size - 1) - 1


@inner
def open_room(scene: RayScene, eye: Vector) -> tuple[GridCell, GridCell]:
    """Return the first cell of the part of the box that an eye may see into, and its end.

    Behind a layer that is closed from one end of the box to the other nothing is seen. Cells are
    counted from the corner of the box.
    """
    nx, ny, nz = scene.sizes
    if not (1.0 <= eye[0] <= nx - 1.0 and 1.0 <= eye[1] <= ny - 1.0 and 1.0 <= eye[2] <= nz - 1.0):
        return (0, 0, 0), (nx - 2, ny - 2, nz - 2)
    x0, x1 = _open_layers(scene, eye, 0)
    y0, y1 = _open_layers(scene, eye, 1)
    z0, z1 = _open_layers(scene, eye, 2)
    return (x0, y0, z0), (x1, y1, z1)


@merged
def eye_sees_block(scene: RayScene, eye: Eye, cell: GridCell, beam: Beam) -> bool:
    """Return True if a block is seen; `beam` is scratch memory."""
    x, y, z = eye[0]
    if not in_reach(eye, cell[0] + 0.5 - x, cell[1] + 0.5 - y, cell[2] + 0.5 - z):
        return False
    return not _is_enclosed(scene, eye[0], cell) and sees_block(scene, eye, cell, beam)


@merged
def _sees_sample(scene: RayScene, eye: Eye, d: Vector) -> bool:
    if not in_field(eye, d[0], d[1], d[2]):
        return False
    # Not the constant: a tuple of literals would have the ray compiled a second time.
    nowhere = (-len(_HEIGHTS), -len(_HEIGHTS), -len(_HEIGHTS))
    return hidden_by(scene, nowhere, eye[0], d)[0] < 0


@inlined
def eye_sees_point(scene: RayScene, eye: Eye, point: Vector) -> bool:
    """Return True if a point is within the visible distance and seen."""
    place = eye[0]
    d = (point[0] - place[0], point[1] - place[1], point[2] - place[2])
    return in_reach(eye, d[0], d[1], d[2]) and _sees_sample(scene, eye, d)


@merged
def eye_sees_agent(scene: RayScene, eye: Eye, feet: Vector) -> bool:
    """Return True if an agent with its feet at a point is seen by one of its sample points."""
    place = eye[0]
    x, y, z = feet[0] - place[0], feet[1] - place[1], feet[2] - place[2]
    if not in_reach(eye, x, y + BODY_CENTRE_HEIGHT, z):
        return False
    for height in _HEIGHTS:  # noqa: SIM110 - kernels know no generators
        if _sees_sample(scene, eye, (x, y + height, z)):
            return True
    return False


@merged
def _update_intruded(codes: Codes, sizes: GridCell, reaches: Reaches, cell: GridCell) -> None:
    """Set or clear a cell's `INTRUDED` from the shapes of its neighbours."""
    intruded = False
    for side in range(6):
        other = neighbour(cell, side)
        if is_inside(sizes, other):
            # The neighbour across a low side reaches in through its own high side.
            intruded |= (reaches[codes[at(sizes, other)] & OWN] >> (side ^ 1)) & 1 != 0
    own = codes[at(sizes, cell)] & OWN
    codes[at(sizes, cell)] = own | INTRUDED if intruded else own


@inner
def set_code(codes: Codes, sizes: GridCell, reaches: Reaches, cell: GridCell, code: int) -> None:
    """Put the code of another block into a cell of the grid; the margin stays as it is."""
    old = codes[at(sizes, cell)]
    codes[at(sizes, cell)] = old & INTRUDED | code
    if reaches[old & OWN] == 0 and reaches[code] == 0:
        return
    for side in range(6):
        _update_intruded(codes, sizes, reaches, neighbour(cell, side))
