"""What an eye sees of a grid of shapes: compiled loops over blocks and points.

Coordinates and codes are those of `rays`. An `Eye` is (place, look, cos_half, far): the
eye's place, the unit vector it looks along, the cosine of half its field of view (-2 if
it sees all around), and how far it sees (infinite if there is no limit).
"""

import math

import numpy as np
import numpy.typing as npt

from beliefnest.perception.rays import (
    INTRUDED,
    NOWHERE,
    OWN,
    Codes,
    Shapes,
    compiled,
    hidden_by,
    is_inside,
    neighbour,
)

__all__ = [
    "Eye",
    "mark_intruded",
    "near_points",
    "seen_blocks",
    "seen_points",
    "set_code",
    "visible_blocks",
]

Eye = tuple[tuple[float, float, float], tuple[float, float, float], float, float]

# Limits are meant to be inclusive whatever the rounding of a mirrored or turned world.
_SLACK = 1e-9
# Face corners are pulled in by 0.01. Counted from the middle so that a mirrored block
# has the mirrored samples to the last bit.
_CORNER = 0.49


@compiled
def _in_field(eye: Eye, sample: tuple[float, float, float]) -> bool:
    place, look, cos_half, _ = eye
    if cos_half < -1.0:
        return True
    x, y, z = sample[0] - place[0], sample[1] - place[1], sample[2] - place[2]
    along = x * look[0] + z * look[2] + y * look[1]
    return along >= (cos_half - _SLACK) * math.sqrt(x * x + z * z + y * y)


@compiled
def _in_reach(eye: Eye, point: tuple[float, float, float]) -> bool:
    place, _, _, far = eye
    x, y, z = point[0] - place[0], point[1] - place[1], point[2] - place[2]
    return math.sqrt(x * x + z * z + y * y) <= far + _SLACK


@compiled
def _turned_face(e: float, cell: int) -> float:
    """Offset from the cell's middle of the face turned to the eye along an axis; 0 if none."""
    if e < cell:
        return -0.5
    if e > cell + 1:
        return 0.5
    return 0.0


@compiled
def _sees_sample(
    codes: Codes, shapes: Shapes, eye: Eye, cell: tuple[int, int, int], x: float, y: float, z: float
) -> bool:
    """Whether the point at an offset from a cell's middle is seen."""
    sample = (cell[0] + 0.5 + x, cell[1] + 0.5 + y, cell[2] + 0.5 + z)
    return _in_field(eye, sample) and hidden_by(codes, shapes, cell, eye[0], sample)[0] < 0


@compiled
def _sees_block(codes: Codes, shapes: Shapes, eye: Eye, cell: tuple[int, int, int]) -> bool:
    middle = (cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5)
    if not _in_reach(eye, middle):
        return False
    if _sees_sample(codes, shapes, eye, cell, 0.0, 0.0, 0.0):
        return True
    place = eye[0]
    for axis in range(3):
        face = _turned_face(place[axis], cell[axis])
        if face == 0.0:
            continue
        for corner in range(5):
            u = 0.0 if corner == 4 else _CORNER * ((corner & 1) * 2 - 1)
            v = 0.0 if corner == 4 else _CORNER * ((corner & 2) - 1)
            if axis == 0:
                seen = _sees_sample(codes, shapes, eye, cell, face, u, v)
            elif axis == 1:
                seen = _sees_sample(codes, shapes, eye, cell, u, face, v)
            else:
                seen = _sees_sample(codes, shapes, eye, cell, u, v, face)
            if seen:
                return True
    return False


@compiled
def visible_blocks(codes: Codes, shapes: Shapes, eye: Eye) -> npt.NDArray[np.bool_]:
    """Which blocks of the grid (without its margin) are seen."""
    nx, ny, nz = codes.shape[0] - 2, codes.shape[1] - 2, codes.shape[2] - 2
    seen = np.zeros((nx, ny, nz), dtype=np.bool_)
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                seen[i, j, k] = _sees_block(codes, shapes, eye, (i + 1, j + 1, k + 1))
    return seen


@compiled
def seen_blocks(
    codes: Codes, shapes: Shapes, eye: Eye, cells: npt.NDArray[np.int64]
) -> npt.NDArray[np.bool_]:
    """Which of the cells (n, 3), in or out of the grid, are seen."""
    seen = np.zeros(len(cells), dtype=np.bool_)
    for n in range(len(cells)):
        cell = (int(cells[n, 0]), int(cells[n, 1]), int(cells[n, 2]))
        seen[n] = _sees_block(codes, shapes, eye, cell)
    return seen


@compiled
def seen_points(
    codes: Codes, shapes: Shapes, eye: Eye, points: npt.NDArray[np.float64]
) -> npt.NDArray[np.bool_]:
    """To which of the points (n, 3) a ray inside the field of view is free, however far."""
    seen = np.zeros(len(points), dtype=np.bool_)
    for n in range(len(points)):
        point = (points[n, 0], points[n, 1], points[n, 2])
        seen[n] = _in_field(eye, point) and hidden_by(codes, shapes, NOWHERE, eye[0], point)[0] < 0
    return seen


@compiled
def near_points(eye: Eye, points: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
    """Which of the points (n, 3) are no farther away than the eye sees."""
    near = np.zeros(len(points), dtype=np.bool_)
    for n in range(len(points)):
        near[n] = _in_reach(eye, (points[n, 0], points[n, 1], points[n, 2]))
    return near


@compiled
def _update_intruded(
    codes: Codes, reaches: npt.NDArray[np.uint8], cell: tuple[int, int, int]
) -> None:
    """Set or clear a cell's `INTRUDED` from the shapes of its neighbours."""
    intruded = False
    for side in range(6):
        other = neighbour(cell, side)
        if is_inside(codes, other):
            # The neighbour across a low side reaches in through its own high side.
            intruded |= (reaches[codes[other] & OWN] >> (side ^ 1)) & 1 != 0
    own = codes[cell] & OWN
    codes[cell] = own | INTRUDED if intruded else own


@compiled
def set_code(
    codes: Codes, reaches: npt.NDArray[np.uint8], cell: tuple[int, int, int], code: int
) -> None:
    """Put another block into a cell of the grid.

    Bit s of reaches[code] says that a code's shape reaches out of its cell at side s.
    """
    codes[cell] = codes[cell] & INTRUDED | code
    for side in range(6):
        _update_intruded(codes, reaches, neighbour(cell, side))


@compiled
def mark_intruded(codes: Codes, reaches: npt.NDArray[np.uint8]) -> None:
    """Set `INTRUDED` in a grid of codes without it; reaches is that of `set_code`."""
    for i in range(1, codes.shape[0] - 1):
        for j in range(1, codes.shape[1] - 1):
            for k in range(1, codes.shape[2] - 1):
                reach = reaches[codes[i, j, k] & OWN]
                if reach != 0:
                    for side in range(6):
                        if (reach >> side) & 1:
                            codes[neighbour((i, j, k), side)] |= INTRUDED
