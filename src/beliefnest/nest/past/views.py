"""Views of agents in nodes."""

import math

import numpy as np
import numpy.typing as npt

from beliefnest.belief.node_view import NodeView
from beliefnest.perception.sight import Sight
from beliefnest.world.values import EYE_HEIGHT

__all__ = ["visible_from"]

_MARGIN = 2
"""Cells beyond the greatest visible distance that a line of sight may touch."""


def visible_from(reading: NodeView, sight: Sight, agent: str) -> npt.NDArray[np.bool_]:
    """Return a mask of the blocks that an agent sees from its believed pose in a node.

    Only the part of the box within the greatest visible distance is looked at, so that a look in a
    large box costs no more than one in a small one.

    Args:
        reading: State of the node.
        sight: How agents see.
        agent: Name of the agent.

    Returns:
        bool, shape of the box; all False if the agent's pose is unknown.
    """
    viewer, far = reading.agents[agent], sight.max_visible_distance
    if viewer.position is None or far is None:
        return reading.visible_from(agent)
    x, y, z = viewer.position
    eye = (x, y + EYE_HEIGHT, z)
    reach = math.ceil(far) + _MARGIN
    seen = np.zeros(reading.box.shape, dtype=np.bool_)
    first = [max(math.floor(at) - reach, low) for at, low in zip(eye, reading.box.low, strict=True)]
    last = [
        min(math.floor(at) + reach, high) for at, high in zip(eye, reading.box.high, strict=True)
    ]
    if (*first, *last) == (*reading.box.low, *reading.box.high):
        return reading.visible_from(agent)
    if any(end < begin for begin, end in zip(first, last, strict=True)):
        return seen
    cut = tuple(
        slice(begin - low, end - low + 1)
        for begin, end, low in zip(first, last, reading.box.low, strict=True)
    )
    near = sight.geometry(np.ascontiguousarray(reading.grid[cut]), (first[0], first[1], first[2]))
    seen[cut] = near.visible_blocks(eye, viewer.yaw, viewer.pitch)
    return seen
