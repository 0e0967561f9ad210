"""What an eye sees of a grid of shapes: compiled loops over blocks and points.

Coordinates and codes are those of `rays`, an `Eye` is that of `beams`.
"""

import numpy as np
import numpy.typing as npt

from beliefnest.perception.beams import Eye, in_field, in_reach, new_beam, sees_block
from beliefnest.perception.rays import (
    INTRUDED,
    NOWHERE,
    OWN,
    Boxes,
    Cell,
    Codes,
    Starts,
    at,
    compiled,
    hidden_by,
    is_inside,
    neighbour,
)
from beliefnest.perception.shadows import CLEAR, HIDDEN, ROOM, cast_shadows

__all__ = [
    "Eye",
    "mark_intruded",
    "near_points",
    "seen_blocks",
    "seen_points",
    "set_code",
    "visible_blocks",
]


@compiled
def visible_blocks(
    codes: Codes,
    sizes: Cell,
    starts: Starts,
    boxes: Boxes,
    reaches: npt.NDArray[np.uint8],
    eye: Eye,
) -> npt.NDArray[np.bool_]:
    """Which blocks of the grid (without its margin) are seen."""
    nx, ny, nz = sizes[0] - 2, sizes[1] - 2, sizes[2] - 2
    px, py, pz = eye[0]
    seen = np.zeros((nx, ny, nz), dtype=np.bool_)
    slopes, opens = new_beam()
    marks, counts, suspects = cast_shadows(codes, sizes, starts, boxes, reaches, eye[0])
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                cell = (i + 1, j + 1, k + 1)
                mark = marks[at(sizes, cell)]
                if mark == HIDDEN:
                    continue
                d = (i + 1.5 - px, j + 1.5 - py, k + 1.5 - pz)
                if mark == CLEAR and in_field(eye, d[0], d[1], d[2]):
                    seen[i, j, k] = in_reach(eye, d[0], d[1], d[2])
                else:
                    seen[i, j, k] = sees_block(
                        codes,
                        sizes,
                        starts,
                        boxes,
                        eye,
                        cell,
                        slopes,
                        opens,
                        counts,
                        suspects,
                        at(sizes, cell),
                    )
    return seen


@compiled
def seen_blocks(
    codes: Codes, sizes: Cell, starts: Starts, boxes: Boxes, eye: Eye, cells: npt.NDArray[np.int64]
) -> npt.NDArray[np.bool_]:
    """Which of the cells (n, 3), in or out of the grid, are seen."""
    seen = np.zeros(len(cells), dtype=np.bool_)
    slopes, opens = new_beam()
    counts, suspects = np.zeros(1, dtype=np.uint8), np.zeros((1, ROOM), dtype=np.int32)
    for n in range(len(cells)):
        cell = (cells[n, 0], cells[n, 1], cells[n, 2])
        seen[n] = sees_block(
            codes, sizes, starts, boxes, eye, cell, slopes, opens, counts, suspects, 0
        )
    return seen


@compiled
def seen_points(
    codes: Codes,
    sizes: Cell,
    starts: Starts,
    boxes: Boxes,
    eye: Eye,
    points: npt.NDArray[np.float64],
) -> npt.NDArray[np.bool_]:
    """To which of the points (n, 3) a ray inside the field of view is free, however far."""
    seen = np.zeros(len(points), dtype=np.bool_)
    x, y, z = eye[0]
    for n in range(len(points)):
        d = (points[n, 0] - x, points[n, 1] - y, points[n, 2] - z)
        if in_field(eye, d[0], d[1], d[2]):
            hit = hidden_by(codes, sizes, starts, boxes, NOWHERE, eye[0], d)
            seen[n] = hit[0] < 0
    return seen


@compiled
def near_points(eye: Eye, points: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
    """Which of the points (n, 3) are no farther away than the eye sees."""
    near = np.zeros(len(points), dtype=np.bool_)
    x, y, z = eye[0]
    for n in range(len(points)):
        near[n] = in_reach(eye, points[n, 0] - x, points[n, 1] - y, points[n, 2] - z)
    return near


@compiled
def _update_intruded(codes: Codes, sizes: Cell, reaches: npt.NDArray[np.uint8], cell: Cell) -> None:
    """Set or clear a cell's `INTRUDED` from the shapes of its neighbours."""
    intruded = False
    for side in range(6):
        other = neighbour(cell, side)
        if is_inside(sizes, other):
            # The neighbour across a low side reaches in through its own high side.
            intruded |= (reaches[codes[at(sizes, other)] & OWN] >> (side ^ 1)) & 1 != 0
    own = codes[at(sizes, cell)] & OWN
    codes[at(sizes, cell)] = own | INTRUDED if intruded else own


@compiled
def set_code(
    codes: Codes, sizes: Cell, reaches: npt.NDArray[np.uint8], cell: Cell, code: int
) -> None:
    """Put another block into a cell of the grid.

    Bit s of reaches[code] says that a code's shape reaches out of its cell at side s.
    """
    codes[at(sizes, cell)] = codes[at(sizes, cell)] & INTRUDED | code
    for side in range(6):
        _update_intruded(codes, sizes, reaches, neighbour(cell, side))


@compiled
def mark_intruded(codes: Codes, sizes: Cell, reaches: npt.NDArray[np.uint8]) -> None:
    """Set `INTRUDED` in a grid of codes without it; reaches is that of `set_code`."""
    for i in range(1, sizes[0] - 1):
        for j in range(1, sizes[1] - 1):
            for k in range(1, sizes[2] - 1):
                reach = reaches[codes[at(sizes, (i, j, k))] & OWN]
                if reach != 0:
                    for side in range(6):
                        if (reach >> side) & 1:
                            codes[at(sizes, neighbour((i, j, k), side))] |= INTRUDED
