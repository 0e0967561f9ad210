"""Compiled loops over the blocks, agents and points that one eye may see.

Coordinates are those of `rays`; `Eye` is defined in `beams`.
"""

import numpy as np
import numpy.typing as npt

from beliefnest.perception.beams import Eye, in_field, in_reach, new_beam, sees_block
from beliefnest.perception.compiling import allocating, inlined
from beliefnest.perception.eyes import eye_sees_agent, eye_sees_point
from beliefnest.perception.rays import Cell, Scene, cell_at
from beliefnest.perception.shadows import CLEAR, HIDDEN, UNSURE, Shadows

__all__ = ["seen_agents", "seen_blocks", "seen_points"]


@allocating
def seen_blocks(
    scene: Scene, eye: Eye, cells: npt.NDArray[np.int64], shadows: Shadows
) -> npt.NDArray[np.bool_]:
    """Return a mask of the blocks that are seen.

    Without shadows the mask is about the cells (n, 3), inside or outside the grid. With shadows
    from `cast_shadows` the cells are ignored and the mask is about all cells of the grid,
    including its margin, which is never seen.
    """
    sizes, marks = scene.sizes, shadows.marks
    whole = len(marks) > 0
    seen = np.zeros(len(marks) if whole else len(cells), dtype=np.bool_)
    beam = new_beam()
    px, py, pz = eye[0]
    for n in range(len(seen)):
        mark = marks[n] if whole else UNSURE
        if mark == HIDDEN:
            continue
        cell = cell_at(sizes, n) if whole else (cells[n, 0], cells[n, 1], cells[n, 2])
        x, y, z = cell[0] + 0.5 - px, cell[1] + 0.5 - py, cell[2] + 0.5 - pz
        if not in_reach(eye, x, y, z) or (whole and _is_margin(sizes, cell)):
            continue
        if mark == CLEAR and in_field(eye, x, y, z):
            seen[n] = True
        else:
            index = n if whole else -1
            seen[n] = sees_block(scene, eye, cell, beam, shadows, index)
    return seen


@inlined
def _is_margin(sizes: Cell, cell: Cell) -> bool:
    i, j, k = cell
    return i == 0 or j == 0 or k == 0 or i == sizes[0] - 1 or j == sizes[1] - 1 or k == sizes[2] - 1


@allocating
def seen_agents(scene: Scene, eye: Eye, feet: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
    """Return a mask of the agents, with feet at (n, 3), that are seen."""
    seen = np.zeros(len(feet), dtype=np.bool_)
    for n in range(len(feet)):
        seen[n] = eye_sees_agent(scene, eye, (feet[n, 0], feet[n, 1], feet[n, 2]))
    return seen


@allocating
def seen_points(scene: Scene, eye: Eye, points: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
    """Return a mask of the points (n, 3) that are seen."""
    seen = np.zeros(len(points), dtype=np.bool_)
    for n in range(len(points)):
        seen[n] = eye_sees_point(scene, eye, (points[n, 0], points[n, 1], points[n, 2]))
    return seen
