"""Single looks, compiled, for kernels of other rooms: one eye, one block or one agent."""

import numpy as np

from beliefnest.perception.rays import (
    NOWHERE,
    Boxes,
    Cell,
    Codes,
    Starts,
    Vector,
    compiled,
    hidden_by,
)
from beliefnest.perception.views import Eye, _in_field, _in_reach, _sees_block

__all__ = ["eye_sees_agent", "eye_sees_block", "eye_sees_point", "in_reach"]

# Heights of `sight.AGENT_SAMPLE_HEIGHTS` and `sight.BODY_CENTRE_HEIGHT`, as compiled constants.
_HEIGHTS = np.array([1.62, 0.9, 0.05])
_CENTRE = 0.9

eye_sees_block = _sees_block
in_reach = _in_reach


@compiled
def eye_sees_point(
    codes: Codes, sizes: Cell, starts: Starts, boxes: Boxes, eye: Eye, point: Vector
) -> bool:
    """Whether a ray inside the field of view is free from the eye to a point, however far."""
    if not _in_field(eye, point):
        return False
    place = eye[0]
    d = (point[0] - place[0], point[1] - place[1], point[2] - place[2])
    return hidden_by(codes, sizes, starts, boxes, NOWHERE, place, d)[0] < 0


@compiled
def eye_sees_agent(
    codes: Codes, sizes: Cell, starts: Starts, boxes: Boxes, eye: Eye, feet: Vector
) -> bool:
    """Whether an agent with its feet at a point is seen by one of its sample points."""
    if not _in_reach(eye, (feet[0], feet[1] + _CENTRE, feet[2])):
        return False
    for height in _HEIGHTS:
        point = (feet[0], feet[1] + height, feet[2])
        if eye_sees_point(codes, sizes, starts, boxes, eye, point):
            return True
    return False
