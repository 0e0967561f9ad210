"""Small drawings: agents, chests, items, marks."""

import math
import zlib
from collections.abc import Mapping

from beliefnest.viewer.canvas import XY, Canvas, Colour, blend

__all__ = ["AGENT_COLOURS", "INK", "PAPER", "agent", "chest", "ghost", "item", "mark"]

INK: Colour = (43, 42, 51)
PAPER: Colour = (252, 251, 248)
AGENT_COLOURS: tuple[Colour, ...] = (
    (217, 119, 38),
    (46, 110, 178),
    (58, 145, 88),
    (146, 78, 160),
    (190, 62, 74),
    (64, 140, 150),
)
_WOOD: Colour = (176, 122, 66)
_WOOD_DARK: Colour = (112, 72, 34)
_WOOD_LIGHT: Colour = (206, 156, 98)
_GOOD: Colour = (46, 140, 76)
_BAD: Colour = (196, 52, 58)
_GEMS: Mapping[str, Colour] = {
    "diamond": (82, 206, 214),
    "emerald": (60, 184, 96),
    "gold": (240, 196, 66),
    "iron": (206, 206, 208),
    "apple": (206, 60, 56),
}


def agent(canvas: Canvas, at: XY, radius: float, yaw: float, colour: Colour, letter: str) -> None:
    """A disc with a nose towards where the agent looks; yaw 0 is up, pi/2 left."""
    look = (-math.sin(yaw), -math.cos(yaw))
    side = (-look[1], look[0])
    nose = [
        (at[0] + look[0] * radius * 1.75, at[1] + look[1] * radius * 1.75),
        (at[0] + side[0] * radius * 0.7, at[1] + side[1] * radius * 0.7),
        (at[0] - side[0] * radius * 0.7, at[1] - side[1] * radius * 0.7),
    ]
    canvas.polygon(nose, blend(colour, INK, 0.35))
    canvas.disc(at, radius, colour, PAPER, 2)
    canvas.text(at, letter, round(radius * 1.15), PAPER, "mm", bold=True)


def ghost(canvas: Canvas, at: XY, radius: float, colour: Colour, letter: str) -> None:
    """An agent that is believed to be where it is not: a dashed ring."""
    ring = [
        (at[0] + radius * math.cos(angle), at[1] + radius * math.sin(angle))
        for angle in (step * math.pi / 24 for step in range(49))
    ]
    canvas.disc(at, radius, blend(PAPER, colour, 0.15))
    canvas.dashes(ring, colour, 2, 4.5)
    canvas.text(at, letter, round(radius * 1.15), colour, "mm", bold=True)


def chest(canvas: Canvas, centre: XY, size: float) -> None:
    """A chest from the front."""
    x, y = centre
    half = size / 2
    canvas.box((x - half, y - half * 0.8), (x + half, y + half * 0.85), _WOOD, _WOOD_DARK, 2, 3)
    canvas.box(
        (x - half + 1, y - half * 0.75), (x + half - 1, y - half * 0.12), _WOOD_LIGHT, radius=2
    )
    canvas.line([(x - half, y - half * 0.1), (x + half, y - half * 0.1)], _WOOD_DARK, 2)
    canvas.box(
        (x - size * 0.09, y - size * 0.14),
        (x + size * 0.09, y + size * 0.1),
        (222, 214, 196),
        _WOOD_DARK,
        1,
        1,
    )


def item(canvas: Canvas, centre: XY, size: float, name: str) -> None:
    """An item: a cut stone in its colour."""
    x, y = centre
    r = size / 2
    colour = _item_colour(name)
    table = [(x - r * 0.55, y - r * 0.75), (x + r * 0.55, y - r * 0.75)]
    girdle = [(x + r, y - r * 0.2), (x - r, y - r * 0.2)]
    tip = (x, y + r * 0.95)
    canvas.polygon([*table, girdle[0], tip, girdle[1]], colour, blend(colour, INK, 0.55))
    canvas.polygon(
        [table[0], table[1], (x + r * 0.35, y - r * 0.2), (x - r * 0.35, y - r * 0.2)],
        blend(colour, PAPER, 0.6),
    )
    canvas.polygon(
        [(x - r * 0.35, y - r * 0.2), (x + r * 0.35, y - r * 0.2), tip], blend(colour, PAPER, 0.25)
    )
    outline = blend(colour, INK, 0.55)
    canvas.line([*table, girdle[0], tip, girdle[1], table[0]], outline, 1.5)


def mark(canvas: Canvas, centre: XY, size: float, good: bool) -> None:
    """A tick or a cross on a disc."""
    x, y = centre
    r = size / 2
    canvas.disc(centre, r, _GOOD if good else _BAD)
    if good:
        points = [
            (x - r * 0.45, y + r * 0.05),
            (x - r * 0.1, y + r * 0.4),
            (x + r * 0.5, y - r * 0.35),
        ]
        canvas.line(points, PAPER, size * 0.11)
    else:
        for sign in (1, -1):
            ends = [(x - r * 0.38, y - r * 0.38 * sign), (x + r * 0.38, y + r * 0.38 * sign)]
            canvas.line(ends, PAPER, size * 0.11)


def _item_colour(name: str) -> Colour:
    for part, colour in _GEMS.items():
        if part in name:
            return colour
    # Not Python's own hash, which differs from process to process.
    digest = zlib.crc32(name.encode())
    return 90 + digest % 130, 90 + digest // 256 % 130, 90 + digest // 65536 % 130
