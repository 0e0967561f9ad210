"""Nearness to named positions, for everything that people read."""

import math
from collections.abc import Mapping
from typing import Final

from beliefnest.world.values import Point, Position

NEAR: Final = 3.0
"""Distance in blocks up to which an agent counts as being at a named place."""


BESIDE: Final = 1.5
"""Distance in blocks up to which an agent stands next to a thing."""


def names_near(point: Point, names: Mapping[Position, str], within: float = NEAR) -> list[str]:
    """Return the names of the positions within a distance of a point, the nearest first."""
    far = {at: math.dist(point, (at[0] + 0.5, at[1], at[2] + 0.5)) for at in names}
    return [names[at] for at in sorted(names, key=lambda at: far[at]) if far[at] <= within]
