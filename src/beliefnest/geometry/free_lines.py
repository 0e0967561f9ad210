"""Free lines for hands: whether anything solid lies between an eye and a block.

All worlds and planners ask here.

The rules are those of the embedded world's server (`skills/code/lib/sight.js`): the collision boxes
of all blocks obstruct a hand, those of glass too. Unknown blocks obstruct nothing.
"""

import itertools
import math

import numpy as np

from beliefnest.world.array_types import Floats
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import EYE_HEIGHT, Box, Point, Position, feet_in

_TOUCH = 1e-9
"""Length of a line inside a box that still counts as touching, not as entering."""
_CUBE = ((0.0, 0.0, 0.0, 1.0, 1.0, 1.0),)
_INNER = np.array(
    [(0, 0, 0), *(tuple(0.45 * sign * (axis == n) for n in range(3))
    for axis in range(3) for sign in (1, -1))],
    dtype=np.float64,
)  # fmt: skip
"""End points of lines within a block, relative to its middle."""
_GRID = (0.01, 0.25, 0.5, 0.75, 0.99)
"""End points of lines on each face, as fractions of its edges."""


def eye_in(cell: Position) -> Point:
    """Return the place of the eye of an agent that stands in the middle of a cell."""
    x, y, z = feet_in(cell)
    return (x, y + EYE_HEIGHT, z)


def can_use(box: Box, blocks: Terrain, eye: Point, block: Position) -> bool:
    """Return True if a free line leads from an eye into a block: to its middle or near a side.

    Args:
        box: The known part of space.
        blocks: Block states in it, -1 is unknown.
        eye: Place of the eye.
        block: Position of the block.
    """
    obstacles = _between(box, blocks, eye, block)
    return not len(obstacles) or _is_free(eye, np.array(block) + 0.5 + _INNER, obstacles)


def can_touch(box: Box, blocks: Terrain, eye: Point, block: Position) -> bool:
    """Return True if a free line leads from an eye to any point of a block, also of its faces.

    Arguments as for `can_use`.
    """
    obstacles = _between(box, blocks, eye, block)
    if not len(obstacles):
        return True
    own = _boxes(box, blocks, block) or [tuple(map(float, (*block, *(n + 1 for n in block))))]
    targets = [np.array(block) + 0.5 + _INNER, *(_faces(eye, each) for each in own)]
    return _is_free(eye, np.concatenate(targets), obstacles)


def _between(box: Box, blocks: Terrain, eye: Point, block: Position) -> Floats:
    """Return the boxes (n, 6) of all blocks that a line from an eye to a block can meet."""
    ends = [sorted((math.floor(a), b)) for a, b in zip(eye, block, strict=True)]
    cells = itertools.product(*(range(low, high + 1) for low, high in ends))
    boxes = [each for cell in cells if cell != block for each in _boxes(box, blocks, cell)]
    return np.array(boxes, dtype=np.float64).reshape(-1, 6)


def _boxes(box: Box, blocks: Terrain, cell: tuple[int, ...]) -> list[tuple[float, ...]]:
    """Return the boxes of a block, cut at its top: a fence is not higher for a hand."""
    x, y, z = cell
    if (x, y, z) not in box:
        return []
    state = int(blocks[box.index((x, y, z))])
    if state <= 0:
        return []
    return [
        (x + x0, y + y0, z + z0, x + x1, y + min(y1, 1.0), z + z1)
        for x0, y0, z0, x1, y1, z1 in Registry.load().boxes(state)
        if y0 < 1
    ]


def _faces(eye: Point, bounds: tuple[float, ...]) -> Floats:
    """Return points (n, 3) on those faces of a box that are turned to an eye."""
    points = []
    for axis in range(3):
        low, high = bounds[axis], bounds[axis + 3]
        if low <= eye[axis] <= high:
            continue
        first, second = (other for other in range(3) if other != axis)
        for u, v in itertools.product(_GRID, _GRID):
            point = [0.0, 0.0, 0.0]
            point[axis] = low if eye[axis] < low else high
            point[first] = bounds[first] + u * (bounds[first + 3] - bounds[first])
            point[second] = bounds[second] + v * (bounds[second + 3] - bounds[second])
            points.append(point)
    return np.array(points, dtype=np.float64).reshape(-1, 3)


def _is_free(eye: Point, targets: Floats, obstacles: Floats) -> bool:
    """Return True if a line to one of the targets enters none of the obstacles."""
    start = np.array(eye)
    way = (targets - start)[:, None, :]
    low, high = obstacles[None, :, :3] - start, obstacles[None, :, 3:] - start
    is_flat = way == 0
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = low / way, high / way
    # Along an axis on which it does not move, a line is inside all the time or never.
    inside = (low < 0) & (high > 0)
    enters = np.where(is_flat, np.where(inside, 0.0, np.inf), np.minimum(a, b))
    leaves = np.where(is_flat, np.where(inside, 1.0, -np.inf), np.maximum(a, b))
    begin = np.maximum(enters.max(axis=2), 0.0)
    end = np.minimum(leaves.min(axis=2), 1.0)
    length = np.sqrt((way**2).sum(axis=2))
    return bool((~((end - begin) * length > _TOUCH).any(axis=1)).any())
