"""Views of agents in nodes."""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from beliefnest.belief.node_view import NodeView
from beliefnest.perception.percept import gaze_from
from beliefnest.perception.sight import Sight
from beliefnest.world.terrain import Index

_MARGIN = 2
"""Cells beyond the greatest visible distance that a line of sight may touch."""


def visible_from(reading: NodeView, sight: Sight, agent: str) -> npt.NDArray[np.bool_]:
    """Return a mask of the blocks that an agent sees from its believed pose in a node.

    Args:
        reading: State of the node.
        sight: How agents see.
        agent: Name of the agent.

    Returns:
        bool, shape of the box; all False if the agent's pose is unknown.
    """
    part = visible_part(reading, sight, agent)
    if part is not None and part.seen.shape == reading.box.shape:
        return part.seen
    seen = np.zeros(reading.box.shape, dtype=np.bool_)
    if part is not None:
        x, y, z = (
            slice(low, low + size) for low, size in zip(part.low, part.seen.shape, strict=True)
        )
        seen[x, y, z] = part.seen
    return seen


class VisiblePart(msgspec.Struct, frozen=True):
    """Blocks that an agent sees, in the part of the box within the greatest visible distance.

    Attributes:
        low: Index of the first cell of the part.
        seen: bool, shape of the part.
    """

    low: Index
    seen: npt.NDArray[np.bool_]


def visible_part(reading: NodeView, sight: Sight, agent: str) -> VisiblePart | None:
    """Return the blocks that an agent sees from its believed pose in a node.

    Only the part of the box within the greatest visible distance is looked at, so that a look in a
    large box costs no more than one in a small one.

    Args:
        reading: State of the node.
        sight: How agents see.
        agent: Name of the agent.

    Returns:
        None if the agent's pose is unknown, or if it sees nothing of the box.
    """
    viewer, far = reading.agents[agent], sight.max_visible_distance
    if viewer.position is None:
        return None
    whole = (0, 0, 0)
    if far is None:
        return VisiblePart(whole, reading.visible_from(agent))
    gaze = gaze_from(viewer.position, viewer.yaw, viewer.pitch)
    reach = math.ceil(far) + _MARGIN
    box = reading.box
    low = [max(math.floor(at) - reach - a, 0) for at, a in zip(gaze.eye, box.low, strict=True)]
    high = [
        min(math.floor(at) + reach - a + 1, size)
        for at, a, size in zip(gaze.eye, box.low, box.shape, strict=True)
    ]
    first, last = (low[0], low[1], low[2]), (high[0], high[1], high[2])
    if (first, last) == (whole, box.shape):
        return VisiblePart(whole, reading.visible_from(agent))
    if any(end <= begin for begin, end in zip(first, last, strict=True)):
        return None
    origin = (box.low[0] + first[0], box.low[1] + first[1], box.low[2] + first[2])
    near = sight.geometry(np.ascontiguousarray(reading.terrain.cut(first, last)), origin)
    return VisiblePart(first, near.visible_blocks(*gaze))
