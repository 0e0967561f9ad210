"""Compiled loops over the blocks, agents and points that one eye may see.

Coordinates are those of `rays`; `Eye` is defined in `beams`.
"""

import numpy as np
import numpy.typing as npt

from beliefnest.perception.beams import Eye, aim_along, in_field, in_reach, new_beam, sees_past
from beliefnest.perception.compiling import allocating
from beliefnest.perception.eyes import eye_sees_agent, eye_sees_block, eye_sees_point
from beliefnest.perception.rays import RayScene, at
from beliefnest.perception.shadows import CLEAR, HIDDEN, Shadows


@allocating
def seen_grid(scene: RayScene, eye: Eye, shadows: Shadows) -> npt.NDArray[np.bool_]:
    """Return a mask of the blocks of the grid that are seen, from the shadows in it.

    The margin of the grid is never seen.
    """
    sizes, marks = scene.sizes, shadows.marks
    seen = np.zeros(sizes, dtype=np.bool_)
    beam = new_beam()
    px, py, pz = eye[0]
    for i in range(1, sizes[0] - 1):
        aim_along(eye, (i, 0, 0), beam, 0)
        for j in range(1, sizes[1] - 1):
            aim_along(eye, (i, j, 0), beam, 1)
            for k in range(1, sizes[2] - 1):
                n = at(sizes, (i, j, k))
                x, y, z = i + 0.5 - px, j + 0.5 - py, k + 0.5 - pz
                if marks[n] == HIDDEN or not in_reach(eye, x, y, z):
                    continue
                is_clear = marks[n] == CLEAR and in_field(eye, x, y, z)
                seen[i, j, k] = is_clear or sees_past(scene, eye, (i, j, k), beam, shadows, n)
    return seen


@allocating
def seen_blocks(scene: RayScene, eye: Eye, cells: npt.NDArray[np.int64]) -> npt.NDArray[np.bool_]:
    """Return a mask of the cells (n, 3), inside or outside the grid, whose blocks are seen."""
    seen = np.zeros(len(cells), dtype=np.bool_)
    beam = new_beam()
    for n in range(len(cells)):
        seen[n] = eye_sees_block(scene, eye, (cells[n, 0], cells[n, 1], cells[n, 2]), beam)
    return seen


@allocating
def seen_agents(scene: RayScene, eye: Eye, feet: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
    """Return a mask of the agents, with feet at (n, 3), that are seen."""
    seen = np.zeros(len(feet), dtype=np.bool_)
    for n in range(len(feet)):
        seen[n] = eye_sees_agent(scene, eye, (feet[n, 0], feet[n, 1], feet[n, 2]))
    return seen


@allocating
def seen_points(
    scene: RayScene, eye: Eye, points: npt.NDArray[np.float64]
) -> npt.NDArray[np.bool_]:
    """Return a mask of the points (n, 3) that are seen."""
    seen = np.zeros(len(points), dtype=np.bool_)
    for n in range(len(points)):
        seen[n] = eye_sees_point(scene, eye, (points[n, 0], points[n, 1], points[n, 2]))
    return seen
