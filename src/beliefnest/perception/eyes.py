"""Single looks, compiled, for kernels of other rooms: one eye, one block or one agent.

Coordinates and codes are those of `rays`, an `Eye` is that of `beams`.
"""

import numpy as np

from beliefnest.perception.beams import Beam, Eye, eye_at, in_field, in_reach, sees_block
from beliefnest.perception.codes import INTRUDED, OWN, Reaches
from beliefnest.perception.compiling import compiled, inlined, merged
from beliefnest.perception.rays import (
    Cell,
    Codes,
    Scene,
    Vector,
    at,
    hidden_by,
    is_inside,
    neighbour,
)
from beliefnest.world.values import AGENT_SAMPLE_HEIGHTS, BODY_CENTRE_HEIGHT

__all__ = ["Eye", "eye_at", "eye_sees_agent", "eye_sees_block", "eye_sees_point", "set_code"]

_HEIGHTS = np.array(AGENT_SAMPLE_HEIGHTS)


@merged
def eye_sees_block(scene: Scene, eye: Eye, cell: Cell, beam: Beam) -> bool:
    """Return True if a block is seen; `beam` is scratch memory."""
    x, y, z = eye[0]
    if not in_reach(eye, cell[0] + 0.5 - x, cell[1] + 0.5 - y, cell[2] + 0.5 - z):
        return False
    return sees_block(scene, eye, cell, beam)


@merged
def _sees_sample(scene: Scene, eye: Eye, d: Vector) -> bool:
    if not in_field(eye, d[0], d[1], d[2]):
        return False
    # Not the constant: a tuple of literals would have the ray compiled a second time.
    nowhere = (-len(_HEIGHTS), -len(_HEIGHTS), -len(_HEIGHTS))
    return hidden_by(scene, nowhere, eye[0], d)[0] < 0


@inlined
def eye_sees_point(scene: Scene, eye: Eye, point: Vector) -> bool:
    """Return True if a point is within the visible distance and seen."""
    place = eye[0]
    d = (point[0] - place[0], point[1] - place[1], point[2] - place[2])
    return in_reach(eye, d[0], d[1], d[2]) and _sees_sample(scene, eye, d)


@merged
def eye_sees_agent(scene: Scene, eye: Eye, feet: Vector) -> bool:
    """Return True if an agent with its feet at a point is seen by one of its sample points."""
    place = eye[0]
    x, y, z = feet[0] - place[0], feet[1] - place[1], feet[2] - place[2]
    if not in_reach(eye, x, y + BODY_CENTRE_HEIGHT, z):
        return False
    for height in _HEIGHTS:  # noqa: SIM110 - kernels know no generators
        if _sees_sample(scene, eye, (x, y + height, z)):
            return True
    return False


@merged
def _update_intruded(codes: Codes, sizes: Cell, reaches: Reaches, cell: Cell) -> None:
    """Set or clear a cell's `INTRUDED` from the shapes of its neighbours."""
    intruded = False
    for side in range(6):
        other = neighbour(cell, side)
        if is_inside(sizes, other):
            # The neighbour across a low side reaches in through its own high side.
            intruded |= (reaches[codes[at(sizes, other)] & OWN] >> (side ^ 1)) & 1 != 0
    own = codes[at(sizes, cell)] & OWN
    codes[at(sizes, cell)] = own | INTRUDED if intruded else own


@compiled
def set_code(codes: Codes, sizes: Cell, reaches: Reaches, cell: Cell, code: int) -> None:
    """Put the code of another block into a cell of the grid; the margin stays as it is."""
    codes[at(sizes, cell)] = codes[at(sizes, cell)] & INTRUDED | code
    for side in range(6):
        _update_intruded(codes, sizes, reaches, neighbour(cell, side))
