"""Search for free room for icons and labels on a plan."""

import math
from collections.abc import Iterator

from beliefnest.pictures.marks import XY, Bounds

_GAP = 1.1
_BESIDE = 1.2
"""Distance between an icon and its label, in points."""
_FURTHER = 3.0
_SHIFTS = (0.0, -0.75, 0.75, -0.5, 0.5, -0.25, 0.25)


class Room:
    """Record of the taken parts of an area.

    Args:
        bounds: The area.
    """

    def __init__(self, bounds: Bounds) -> None:
        self._bounds = bounds
        self._taken: list[Bounds] = []
        self._avoided: list[Bounds] = []

    def copy(self) -> "Room":
        """Return a copy for a trial."""
        copied = Room(self._bounds)
        copied._taken, copied._avoided = [*self._taken], [*self._avoided]
        return copied

    def take(self, bounds: Bounds) -> None:
        """Mark a rectangle as taken."""
        self._taken.append(bounds)

    def avoid(self, bounds: Bounds) -> None:
        """Mark a rectangle that labels should avoid if they can."""
        self._avoided.append(bounds)

    def _troubles(self, bounds: Bounds) -> int:
        return sum(_touch(bounds, each, 0) for each in self._avoided)

    def is_free(self, bounds: Bounds) -> bool:
        """Return True if a rectangle is inside the area and touches no taken rectangle."""
        x0, y0, x1, y1 = bounds
        a0, b0, a1, b1 = self._bounds
        if x0 < a0 or y0 < b0 or x1 > a1 or y1 > b1:
            return False
        return not any(near(bounds, each) for each in self._taken)

    def spot(self, at: XY, width: float, height: float, reach: float = math.inf) -> XY | None:
        """Take the nearest free rectangle of a size; return its middle, None if there is none.

        Args:
            at: Middle that it should have.
            width: Its width.
            height: Its height.
            reach: Greatest distance between the two middles.
        """
        for x, y in _around(at, max(width, height) / 2):
            if math.dist(at, (x, y)) > reach:
                break
            bounds = (x - width / 2, y - height / 2, x + width / 2, y + height / 2)
            if self.is_free(bounds):
                self.take(bounds)
                return x, y
        return None

    def beside(self, icon: Bounds, width: float, height: float) -> list[XY]:
        """Return free upper left corners for a label at an icon, the best first."""
        x0, y0, x1, y1 = icon
        middle, level = (x0 + x1) / 2, (y0 + y1) / 2
        gap = _BESIDE
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
        # At the edge of the area, shift the label inwards.
        a0, _, a1, _ = self._bounds
        inner = max(a0, min(a1 - width, middle - width / 2))
        # Otherwise shift it sideways while it still overlaps the icon's width, or put it a little
        # further off.
        half = (width + x1 - x0) / 2 - gap
        shifted = [inner, *(middle - width / 2 + shift * half for shift in _SHIFTS)]
        corners += [
            (x, y)
            for more in (gap, gap + _FURTHER)
            for x in shifted
            for y in (y1 + more, y0 - more - height)
        ]
        free = [(x, y) for x, y in corners if self.is_free((x, y, x + width, y + height))]
        return sorted(free, key=lambda at: self._troubles((*at, at[0] + width, at[1] + height)))


def near(a: Bounds, b: Bounds) -> bool:
    """Return True if two rectangles are too near each other for both to be taken."""
    return _touch(a, b, _GAP)


def _touch(a: Bounds, b: Bounds, gap: float) -> bool:
    """Return True if the distance between two rectangles is less than a gap."""
    return a[0] < b[2] + gap and b[0] < a[2] + gap and a[1] < b[3] + gap and b[1] < a[3] + gap


def _around(at: XY, step: float) -> Iterator[XY]:
    """Yield points at and around a point, the nearest first."""
    yield at
    for ring in range(1, 24):
        radius = ring * step * 0.75
        count = 8 + 4 * ring
        for number in range(count):
            angle = 2 * math.pi * number / count
            yield at[0] + radius * math.sin(angle), at[1] + radius * math.cos(angle)
