"""Lines of sight inside the state of a node, compiled."""

from typing import Any

import numpy as np
import numpy.typing as npt

from beliefnest.belief.arrays import UNKNOWN, Nodes, Poses, Space
from beliefnest.perception.compiling import allocating, compiled, inlined, inner
from beliefnest.perception.eyes import Eye, eye_at, eye_sees_agent, eye_sees_block, eye_sees_point
from beliefnest.perception.rays import Cell, Codes, Scene
from beliefnest.world.values import EYE_HEIGHT

__all__ = [
    "eye_of",
    "grid_cell",
    "sees_agent",
    "sees_cell",
    "sees_cells",
    "sees_place",
    "sees_point",
    "whole",
]

_Number = int | np.signedinteger[Any]


@inlined
def whole(number: _Number) -> int:
    """Return the number as int64, so that kernels are compiled for one kind of integer only."""
    return np.int64(number)  # type: ignore[return-value]  # Python's int, once compiled


@inlined
def grid_cell(space: Space, cell: int) -> Cell:
    """Return the grid coordinates (with margin) of a flat cell."""
    ny, nz = space.sizes[1] - 2, space.sizes[2] - 2
    return cell // (ny * nz) + 1, cell // nz % ny + 1, cell % nz + 1


@inlined
def eye_of(space: Space, poses: Poses, pose: int) -> Eye:
    """Return the eye of an agent at a pose, in grid coordinates."""
    x, y, z = poses.feet[pose]
    yaw, pitch = poses.angles[pose]
    place = (
        x + space.origin[0],
        y + EYE_HEIGHT + space.origin[1],
        z + space.origin[2],
    )
    return eye_at(place, yaw, pitch, space.senses.cos_half, space.senses.far)


@inlined
def _scene(space: Space, codes: Codes) -> Scene:
    return Scene(codes, space.sizes, space.starts, space.boxes)


@inner
def sees_agent(space: Space, poses: Poses, codes: Codes, eye: Eye, pose: int) -> bool:
    """Return True if an eye sees an agent at a pose, through the blocks of a row of codes."""
    x, y, z = poses.feet[pose]
    feet = (x + space.origin[0], y + space.origin[1], z + space.origin[2])
    return eye_sees_agent(_scene(space, codes), eye, feet)


@inner
def sees_cell(space: Space, codes: Codes, eye: Eye, cell: int) -> bool:
    """Return True if an eye sees a cell, through the blocks of a row of codes."""
    return eye_sees_block(_scene(space, codes), eye, grid_cell(space, cell), space.beam)


@allocating
def sees_place(
    space: Space,
    poses: Poses,
    nodes: Nodes,
    which: npt.NDArray[np.int64],
    pose: int,
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
            seen[number] = sees_agent(space, poses, nodes.codes[parent], look, whole(pose))
    return seen


@allocating
def sees_cells(
    space: Space,
    poses: Poses,
    codes: Codes,
    pose: int,
    cells: npt.NDArray[np.int64],
) -> npt.NDArray[np.bool_]:
    """Return, by cell of `cells`, if an eye at a pose sees it, through a row of codes."""
    eye = eye_of(space, poses, pose)
    seen = np.zeros(len(cells), dtype=np.bool_)
    for number in range(len(cells)):
        seen[number] = sees_cell(space, codes, eye, cells[number])
    return seen


@compiled
def sees_point(
    space: Space,
    poses: Poses,
    codes: Codes,
    pose: int,
    point: tuple[float, float, float],
) -> bool:
    """Return True if an eye at a pose sees a point (scenario coordinates)."""
    eye = eye_of(space, poses, pose)
    x, y, z = point
    place = (x + space.origin[0], y + space.origin[1], z + space.origin[2])
    return eye_sees_point(_scene(space, codes), eye, place)
