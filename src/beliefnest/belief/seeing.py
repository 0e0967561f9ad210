"""Lines of sight inside the state of a node, compiled."""

import numpy as np
import numpy.typing as npt

from beliefnest.belief.arrays import UNKNOWN, Nodes, Poses, Space
from beliefnest.belief.cells import grid_cell, line_of, scene_of, whole
from beliefnest.perception.beams import Eye, eye_at
from beliefnest.perception.chunks import Rows
from beliefnest.perception.compiling import allocating, compiled, inlined, inner
from beliefnest.perception.eyes import eye_sees_agent, eye_sees_block, eye_sees_point
from beliefnest.perception.rays import GridCell, RayScene
from beliefnest.world.array_types import Codes
from beliefnest.world.values import EYE_HEIGHT


@inlined
def eye_of(space: Space, poses: Poses, pose: int) -> Eye:
    """Return the eye of an agent at a pose, in grid coordinates."""
    x, y, z = poses.feet[pose]
    yaw, pitch = poses.angles[pose]
    place = (x + space.origin[0], y + EYE_HEIGHT + space.origin[1], z + space.origin[2])
    return eye_at(place, yaw, pitch, space.senses.cos_half, space.senses.far)


@inner
def sees_agent(space: Space, poses: Poses, scene: RayScene, eye: Eye, pose: int) -> bool:
    """Return True if an eye sees an agent at a pose, through the shapes of a node."""
    x, y, z = poses.feet[pose]
    feet = (x + space.origin[0], y + space.origin[1], z + space.origin[2])
    return eye_sees_agent(scene, eye, feet)


@inner
def sees_cell(space: Space, scene: RayScene, eye: Eye, cell: GridCell) -> bool:
    """Return True if an eye sees a cell of the grid, through the shapes of a node."""
    return eye_sees_block(scene, eye, cell, space.beam)


# Kernels that allocate count references to arrays. No other kernel may return an array to them.
@inner
def _sees_agent_past(
    space: Space, poses: Poses, codes: Codes, rows: Rows, eye: Eye, pose: int
) -> bool:
    """Return `sees_agent` through the shapes with these codes and rows (`cells.scene_of`)."""
    return sees_agent(space, poses, scene_of(space.chunks, space, codes, rows), eye, pose)


@inner
def _sees_cell_past(space: Space, codes: Codes, rows: Rows, eye: Eye, cell: int) -> bool:
    """Return `sees_cell` for a flat cell, through the shapes with these codes and rows."""
    return sees_cell(space, scene_of(space.chunks, space, codes, rows), eye, grid_cell(space, cell))


@allocating
def sees_place(
    space: Space, poses: Poses, nodes: Nodes, which: npt.NDArray[np.int64], pose: int
) -> npt.NDArray[np.bool_]:
    """Return, by node of `which`, if its owner would see an agent at a pose.

    The owner looks through the blocks of the parent. It is False if the owner is not present.
    """
    seen = np.zeros(len(which), dtype=np.bool_)
    for number in range(len(which)):
        node = which[number]
        parent, eye = whole(nodes.parent[node]), whole(nodes.eye[node])
        if eye != UNKNOWN:
            look = eye_of(space, poses, eye)
            codes, rows = nodes.codes[line_of(space.chunks, parent)], nodes.rows[parent]
            seen[number] = _sees_agent_past(space, poses, codes, rows, look, whole(pose))
    return seen


@allocating
def sees_cells(
    space: Space, poses: Poses, codes: Codes, rows: Rows, pose: int, cells: npt.NDArray[np.int64]
) -> npt.NDArray[np.bool_]:
    """Return, by cell of `cells`, if an eye at a pose sees it.

    `codes` and `rows` are those of the node that it looks through (`cells.scene_of`).
    """
    eye = eye_of(space, poses, pose)
    seen = np.zeros(len(cells), dtype=np.bool_)
    for number in range(len(cells)):
        seen[number] = _sees_cell_past(space, codes, rows, eye, cells[number])
    return seen


@compiled
def sees_point(
    space: Space,
    poses: Poses,
    codes: Codes,
    rows: Rows,
    pose: int,
    point: tuple[float, float, float],
) -> bool:
    """Return True if an eye at a pose sees a point (scenario coordinates)."""
    eye = eye_of(space, poses, pose)
    x, y, z = point
    place = (x + space.origin[0], y + space.origin[1], z + space.origin[2])
    return eye_sees_point(scene_of(space.chunks, space, codes, rows), eye, place)
