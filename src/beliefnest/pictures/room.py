"""Where there is room for icons and labels on a plan."""

import math
from collections.abc import Iterator

from beliefnest.pictures.marks import XY, Bounds

__all__ = ["Room"]

_GAP = 0.6


class Room:
    """What of an area is taken.

    Args:
        bounds: The area.
    """

    def __init__(self, bounds: Bounds) -> None:
        self._bounds = bounds
        self._taken: list[Bounds] = []

    def take(self, bounds: Bounds) -> None:
        """Let nothing else be where this is."""
        self._taken.append(bounds)

    def is_free(self, bounds: Bounds) -> bool:
        """Whether something is inside the area and touches nothing."""
        x0, y0, x1, y1 = bounds
        a0, b0, a1, b1 = self._bounds
        if x0 < a0 or y0 < b0 or x1 > a1 or y1 > b1:
            return False
        return all(
            x1 + _GAP <= c0 or c1 + _GAP <= x0 or y1 + _GAP <= d0 or d1 + _GAP <= y0
            for c0, d0, c1, d1 in self._taken
        )

    def spot(self, at: XY, width: float, height: float) -> XY | None:
        """The nearest middle for something of that size, which is then taken."""
        for x, y in _around(at, max(width, height) / 2):
            bounds = (x - width / 2, y - height / 2, x + width / 2, y + height / 2)
            if self.is_free(bounds):
                self.take(bounds)
                return x, y
        return None

    def beside(self, icon: Bounds, width: float, height: float) -> XY | None:
        """The left upper corner of a label near an icon, which is then taken."""
        x0, y0, x1, y1 = icon
        middle, level = (x0 + x1) / 2, (y0 + y1) / 2
        gap = 1.2
        corners = [
            (middle - width / 2, y1 + gap),
            (middle - width / 2, y0 - gap - height),
            (x1 + gap, level - height / 2),
            (x0 - gap - width, level - height / 2),
            (x1 + gap, y1 - height / 2),
            (x0 - gap - width, y1 - height / 2),
            (x1 + gap, y0 - height / 2),
            (x0 - gap - width, y0 - height / 2),
        ]
        # At the edge of the area a label may stand further aside.
        a0, _, a1, _ = self._bounds
        inner = max(a0, min(a1 - width, middle - width / 2))
        corners += [(inner, y1 + gap), (inner, y0 - gap - height)]
        for x, y in corners:
            bounds = (x, y, x + width, y + height)
            if self.is_free(bounds):
                self.take(bounds)
                return x, y
        found = self.spot((middle, level), width, height)
        return None if found is None else (found[0] - width / 2, found[1] - height / 2)


def _around(at: XY, step: float) -> Iterator[XY]:
    """Places at and around a place, the nearest first."""
    yield at
    for ring in range(1, 24):
        radius = ring * step * 0.75
        count = 8 + 4 * ring
        for number in range(count):
            angle = 2 * math.pi * number / count
            yield at[0] + radius * math.sin(angle), at[1] + radius * math.cos(angle)
