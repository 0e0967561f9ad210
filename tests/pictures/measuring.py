"""Faults of a drawing, measured instead of looked at."""

import itertools

from beliefnest.pictures.marks import Bounds, Drawing, Rectangle, Text

_TOUCH = 0.3


def faults(drawing: Drawing) -> list[str]:
    """Return the marks that leave the page or lie on others, and empty ones."""
    solid = [(_name(mark), mark.bounds) for mark in drawing.having("text", "icon")]
    found = [
        f"{name} leaves the page"
        for name, bounds in [(_name(mark), mark.bounds) for mark in drawing.marks]
        if not _inside(bounds, (0, 0, drawing.width, drawing.height))
    ]
    for (one, a), (other, b) in itertools.combinations(solid, 2):
        if _overlap(a, b):
            found.append(f"{one} lies on {other}")
    cards = [mark for mark in drawing.having("card") if isinstance(mark, Rectangle)]
    for card in cards:
        within = [name for name, bounds in solid if _inside(bounds, card.bounds)]
        found += [
            f"{name} crosses the edge of a card"
            for name, bounds in solid
            if _overlap(bounds, card.bounds) and name not in within
        ]
        if len(within) < 2:
            found.append(f"a card holds no more than {within}")
    return found


def texts(drawing: Drawing) -> list[str]:
    return [mark.text for mark in drawing.marks if isinstance(mark, Text) and mark.role == "text"]


def _name(mark: object) -> str:
    return repr(mark.text) if isinstance(mark, Text) else f"{type(mark).__name__} {mark}"


def _inside(inner: Bounds, outer: Bounds) -> bool:
    return (
        inner[0] >= outer[0] - 0.01
        and inner[1] >= outer[1] - 0.01
        and inner[2] <= outer[2] + 0.01
        and inner[3] <= outer[3] + 0.01
    )


def _overlap(a: Bounds, b: Bounds) -> bool:
    return (
        a[0] < b[2] - _TOUCH
        and b[0] < a[2] - _TOUCH
        and a[1] < b[3] - _TOUCH
        and b[1] < a[3] - _TOUCH
    )
