"""Compiled test for free lines between an eye and points of a block."""

import math

import numpy as np

from beliefnest.perception.compiling import compiled, inlined
from beliefnest.world.array_types import Floats, Ints
from beliefnest.world.terrain import BlockStates
from beliefnest.world.values import Point, Position

_TOUCH = 1e-9
"""Length of a line inside a box that still counts as touching, not as entering."""


Shapes = tuple[Ints, Ints, Floats]
"""Collision boxes by state: `state_shape`, `shape_start` and `shape_boxes` of a registry."""


@inlined
def _enters(cell: Position, box: Floats, eye: Point, end: Floats) -> bool:
    """Return True if a line enters a box of a block, cut at the block's top."""
    begins, leaves, square = 0.0, 1.0, 0.0
    for axis in range(3):
        way, top = end[axis] - eye[axis], min(box[axis + 3], 1.0) if axis == 1 else box[axis + 3]
        low, high = cell[axis] + box[axis] - eye[axis], cell[axis] + top - eye[axis]
        square += way * way
        if way != 0:
            begins = max(begins, min(low / way, high / way))
            leaves = min(leaves, max(low / way, high / way))
        elif not low < 0 < high:  # along this axis the line does not move
            return False
    return (leaves - begins) * math.sqrt(square) > _TOUCH


@inlined
def _is_free(
    states: BlockStates, corner: Position, shapes: Shapes, block: Position, eye: Point, end: Floats
) -> bool:
    """Return True if a line enters no block but the one to which it leads."""
    (a, b, c), (state_shape, shape_start, boxes) = corner, shapes
    for (i, j, k), state in np.ndenumerate(states):
        cell = (a + i, b + j, c + k)
        if state > 0 and cell != block:
            shape = state_shape[state]
            for row in range(shape_start[shape], shape_start[shape + 1]):
                if boxes[row, 1] < 1 and _enters(cell, boxes[row], eye, end):
                    return False
    return True


@compiled
def leads_any(
    states: BlockStates, corner: Position, shapes: Shapes, block: Position, eye: Point, ends: Floats
) -> bool:
    """Return True if a line from an eye to one of some points of a block is free.

    Args:
        states: Block states (nx, ny, nz) of all that may lie between the eye and the block.
        corner: Position of the first of them.
        shapes: Collision boxes; those that begin above a block are left out.
        block: Position of the block, which obstructs no line.
        eye: Place of the eye.
        ends: The points (n, 3).
    """
    for n in range(len(ends)):  # noqa: SIM110 - kernels have no generators
        if _is_free(states, corner, shapes, block, eye, ends[n]):
            return True
    return False
