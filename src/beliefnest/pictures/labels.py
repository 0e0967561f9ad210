"""Placement of names on a plan: beside their icons, or elsewhere with a line to the icon."""

from collections.abc import Sequence

import msgspec

from beliefnest.pictures.lettering import ASCENT, DESCENT
from beliefnest.pictures.marks import XY, Bounds
from beliefnest.pictures.room import Room, near

LINE = ASCENT + DESCENT
"""Distance between the lines of a label, relative to the text size."""
_MANY = 1000
_TRIES = 4


class Label(msgspec.Struct, frozen=True):
    """A name with further lines, before it has a place.

    Attributes:
        icon: Bounds of the icon that it belongs to.
        lines: Texts, with True for bold ones.
        sizes: Sizes of the lines, in points.
        size: Width and height of the whole label.
    """

    icon: Bounds
    lines: tuple[tuple[str, bool], ...]
    sizes: tuple[float, ...]
    size: tuple[float, float]


class PlacedLabel(msgspec.Struct, frozen=True):
    """A placed label.

    Attributes:
        label: The label.
        at: Upper left corner; None if there is no room for it.
        beside: True if it is beside its icon.
    """

    label: Label
    at: XY | None
    beside: bool


def put_labels(labels: Sequence[Label], room: Room, *, only_beside: bool) -> list[PlacedLabel]:
    """Place labels, as many as possible beside their icons.

    A label without room at its icon goes to the nearest free place, or nowhere if `only_beside` is
    True. The search is greedy and
    runs several times: labels that found no room beside their icons are placed first in the next
    try. The best try wins.
    """
    best: list[PlacedLabel] = []
    first: list[Label] = []
    for number in range(_TRIES):
        put = _arranged(labels, first, room, only_beside=only_beside)
        away = [each.label for each in put if not each.beside]
        if not number or len(away) < sum(not each.beside for each in best):
            best = put
        if not away:
            break
        first = [*away, *(label for label in first if label not in away)]
    return best


def _arranged(
    labels: Sequence[Label], first: Sequence[Label], free: Room, *, only_beside: bool
) -> list[PlacedLabel]:
    """Place labels greedily: those in `first`, then always the label with the fewest places."""
    room = free.copy()
    waiting = [*first, *(label for label in labels if label not in first)]
    # Places only ever become fewer, so each label keeps its list.
    left = [room.beside(label.icon, *label.size) for label in waiting]
    put: list[PlacedLabel] = []
    while waiting:
        chooses = len(put) >= len(first)
        number = (
            min(range(len(waiting)), key=lambda n: (len(left[n]) or _MANY, n)) if chooses else 0
        )
        label, positions = waiting.pop(number), left.pop(number)
        wide, high = label.size
        at: XY | None = None
        if positions:
            at = positions[0]
            room.take((*at, at[0] + wide, at[1] + high))
        elif not only_beside:
            x0, y0, x1, y1 = label.icon
            spot = room.spot(((x0 + x1) / 2, (y0 + y1) / 2), wide, high)
            at = None if spot is None else (spot[0] - wide / 2, spot[1] - high / 2)
        put.append(PlacedLabel(label, at, beside=bool(positions)))
        if at is not None:
            new = (*at, at[0] + wide, at[1] + high)
            left = [
                [(x, y) for x, y in places if not near((x, y, x + size[0], y + size[1]), new)]
                for places, size in zip(left, (each.size for each in waiting), strict=True)
            ]
    return put


def leader(put: PlacedLabel) -> tuple[XY, XY]:
    """Return the line from an icon to its label."""
    assert put.at is not None
    (x0, y0, x1, y1), at, size = put.label.icon, put.at, put.label.size
    end = (
        min(max((x0 + x1) / 2, at[0]), at[0] + size[0]),
        min(max((y0 + y1) / 2, at[1]), at[1] + size[1]),
    )
    return (min(max(end[0], x0), x1), min(max(end[1], y0), y1)), end
