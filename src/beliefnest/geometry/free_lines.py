"""Free lines for hands: whether anything solid lies between an eye and a block.

All worlds and planners ask here.

The rules are those of the embedded world's server (`skills/code/lib/sight.js`): the collision boxes
of all blocks obstruct a hand, those of glass too. Unknown blocks obstruct nothing.
"""

import itertools
import math

import numpy as np

from beliefnest.world.array_types import Floats
from beliefnest.world.registry import AIR, Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import EYE_HEIGHT, Box, Point, Position, feet_in

_CUBE = (0.0, 0.0, 0.0, 1.0, 1.0, 1.0)
_INNER = np.array(
    [(0, 0, 0), *(tuple(0.45 * sign * (axis == n) for n in range(3))
    for axis in range(3) for sign in (1, -1))],
    dtype=np.float64,
)  # fmt: skip
"""End points of lines within a block, relative to its middle."""
_GRID = np.array([*itertools.product((0.01, 0.25, 0.5, 0.75, 0.99), repeat=2)])
"""End points of lines on each face, as fractions of its two edges."""


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
    return _is_free(box, blocks, eye, block, np.array(block) + 0.5 + _INNER)


def can_touch(box: Box, blocks: Terrain, eye: Point, block: Position) -> bool:
    """Return True if a free line leads from an eye to any point of a block, also of its faces.

    Arguments as for `can_use`.
    """
    if can_use(box, blocks, eye, block):
        return True
    state = blocks[box.index(block)] if block in box else AIR
    shape = Registry.load().boxes(state) if state > 0 else ()
    # A hand takes a fence to be as high as its block.
    tops = [(*each[:4], min(each[4], 1.0), each[5]) for each in shape if each[1] < 1] or [_CUBE]
    faces = [_faces(eye, block + np.array(top).reshape(2, 3)) for top in tops]
    return _is_free(box, blocks, eye, block, np.concatenate(faces))


def _faces(eye: Point, corners: Floats) -> Floats:
    """Return points (n, 3) on those faces of a box (2, 3) that are turned to an eye."""
    (low, high), points = corners, [np.empty((0, 3))]
    for axis in range(3):
        if not low[axis] <= eye[axis] <= high[axis]:
            face = low + np.insert(_GRID, axis, 0.0, axis=1) * (high - low)
            face[:, axis] = low[axis] if eye[axis] < low[axis] else high[axis]
            points.append(face)
    return np.concatenate(points)


def _is_free(box: Box, blocks: Terrain, eye: Point, block: Position, ends: Floats) -> bool:
    """Return True if a line from an eye to one of some points (n, 3) of a block is free."""
    from beliefnest.geometry.line_kernel import leads_any

    first = [max(low, min(math.floor(a), b)) for a, b, low in zip(eye, block, box.low, strict=True)]
    last = [min(top, max(math.floor(a), b)) for a, b, top in zip(eye, block, box.high, strict=True)]
    if any(a > b for a, b in zip(first, last, strict=True)):
        return True  # nothing is known there
    (x, y, z), (i, j, k), registry = first, last, Registry.load()
    states = blocks.cut(box.index((x, y, z)), box.index((i + 1, j + 1, k + 1)))
    # A copy has one type, whether of a view or not: the kernel is compiled once.
    between = np.array(states, dtype=np.int32, order="C")
    shapes = (registry.state_shape, registry.shape_start, registry.shape_boxes)
    return bool(leads_any(between, (x, y, z), shapes, block, eye, ends))
