"""Nearness to named positions, for everything that people read."""

import math
from collections.abc import Mapping
from typing import Final

from beliefnest.world.values import Point, Position

__all__ = ["NEAR", "names_near"]

NEAR: Final = 3.0
"""Distance in blocks up to which an agent counts as being at a named place."""


def names_near(point: Point, names: Mapping[Position, str]) -> list[str]:
    """Return the names of the positions within `NEAR` blocks of a point, the nearest first."""
    far = {at: math.dist(point, (at[0] + 0.5, at[1], at[2] + 0.5)) for at in names}
    return [names[at] for at in sorted(names, key=lambda at: far[at]) if far[at] <= NEAR]
