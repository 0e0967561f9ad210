"""Icons: agents, containers, items, doors, levers."""

import math
import zlib
from collections.abc import Mapping

from beliefnest.pictures.lettering import ASCENT, text_width
from beliefnest.pictures.marks import XY, Bounds, Circle, Lines, Polygon, Rectangle, Text
from beliefnest.pictures.marks import DrawnMark as Drawn
from beliefnest.pictures.palette import INK, MARKS, PAPER, AgentLook, Mark, mix
from beliefnest.pictures.scene import Device, Store

_WOOD, _WOOD_DARK, _WOOD_LIGHT = "#b07a42", "#704822", "#ce9c62"
_STONE, _STONE_DARK = "#8d8a88", "#4c4a4a"
_GOOD = "#007a58"
_MOST_RINGS = 2
"""Greatest number of rings of a disc; a number at the disc stands for more."""
_GEMS = ("diamond", "emerald", "amethyst_shard")
_COLOURS: Mapping[str, str] = {
    "diamond": "#52ced6",
    "emerald": "#3cb860",
    "gold": "#f0c442",
    "iron": "#cececf",
    "apple": "#ce3c38",
}


def letters(at: XY, text: str, room: float, colour: str, *, halo: str | None = None) -> Text:
    """Return letters in the middle of an icon, as large as fit into `room`."""
    size = min(room * 0.8, room * 0.88 / max(text_width(text, 1.0, bold=True), 0.1))
    x, y = at
    return Text(x, y + size * ASCENT * 0.48, text, size, colour, True, "middle", halo, "part")


def agent(at: XY, radius: float, look: AgentLook, yaw: float | None, mark: Mark) -> list[Drawn]:
    """Return a disc with a nose in the direction of the look; dashed for a memory.

    Rings, or a number at the lower right in place of many rings, tell agents of one colour apart.

    Args:
        at: Middle of the disc.
        radius: Radius of the disc.
        look: Look of the agent.
        yaw: Direction of its look, 0 up, pi/2 left; None to leave the nose out.
        mark: Mark for its position.
    """
    x, y = at
    drawn: list[Drawn] = []
    if yaw is not None:
        a, b = -math.sin(yaw), -math.cos(yaw)
        nose = (
            (x + a * radius * 1.7, y + b * radius * 1.7),
            (x - b * radius * 0.75, y + a * radius * 0.75),
            (x + b * radius * 0.75, y - a * radius * 0.75),
        )
        drawn.append(Polygon(nose, mix(look.colour, INK, 0.35)))
    thick = radius * 0.13
    if mark is Mark.CURRENT:
        drawn.append(Circle(x, y, radius, look.colour, INK, thick, role="icon"))
        drawn.append(letters(at, look.badge, radius * 1.6, look.ink))
    else:
        fill = mix(PAPER, look.colour, 0.3)
        drawn.append(Circle(x, y, radius, fill, INK, thick * 1.3, radius * 0.45, "icon"))
        drawn.append(letters(at, look.badge, radius * 1.6, INK))
    if look.rings <= _MOST_RINGS:
        drawn += [
            Circle(x, y, radius * (0.9 - 0.16 * ring), None, PAPER, thick * 0.7)
            for ring in range(look.rings)
        ]
    else:
        # More rings would cover the letters.
        base = (x + radius * 0.8, y + radius * 1.05)
        drawn.append(Text(*base, str(look.rings), radius * 0.8, INK, True, "middle", PAPER, "part"))
    if mark is Mark.FALSE:
        drawn += false_sign((x + radius * 0.86, y - radius * 0.86), radius * 0.42)
    return drawn


def false_sign(at: XY, radius: float) -> list[Drawn]:
    """Return a cross on a diamond, the sign for a false entry."""
    x, y = at
    colour = MARKS[Mark.FALSE].colour
    r, c = radius * 1.35, radius * 0.42
    diamond = ((x, y - r), (x + r, y), (x, y + r), (x - r, y))
    arms = (((x - c, y - c), (x + c, y + c)), ((x - c, y + c), (x + c, y - c)))
    return [
        Polygon(diamond, colour, PAPER, radius * 0.2),
        Lines(arms, PAPER, radius * 0.32, "part"),
    ]


def hearsay(at: XY, radius: float, *, believed: bool = True) -> list[Drawn]:
    """Return a balloon with two strokes, like a line of speech, the sign for hearsay.

    Args:
        at: Middle of the balloon.
        radius: About half its height.
        believed: True if the words were believed; otherwise the balloon is struck out.
    """
    x, y = at
    wide, high = radius * 2.3, radius * 1.5
    tail = (
        (x - radius * 0.1, y + high * 0.42),
        (x + radius * 0.55, y + high * 0.42),
        (x + radius * 0.5, y + radius * 1.35),
    )
    lines = tuple(
        ((x - radius * 0.65, y + step * radius), (x + share * radius, y + step * radius))
        for step, share in ((-0.25, 0.65), (0.25, 0.3))
    )
    left, top = x - wide / 2, y - high / 2
    struck = ((x - wide * 0.62, y + high * 0.75), (x + wide * 0.62, y - high * 0.75))
    balloon: list[Drawn] = [
        Rectangle(left, top, wide, high, PAPER, INK, radius * 0.22, radius * 0.5, role="part"),
        Polygon(tail, INK),
        Lines(lines, INK, radius * 0.22, "part"),
    ]
    return balloon if believed else [*balloon, Lines((struck,), INK, radius * 0.3, "part")]


def verdict(at: XY, radius: float, *, good: bool) -> list[Drawn]:
    """Return a tick or a cross on a disc; the sign for false entries has a diamond instead."""
    x, y = at
    if not good:
        c = radius * 0.42
        arms = (((x - c, y - c), (x + c, y + c)), ((x - c, y + c), (x + c, y - c)))
        return [Circle(x, y, radius, INK), Lines(arms, PAPER, radius * 0.26, "part")]
    points = (
        (x - radius * 0.5, y + radius * 0.05),
        (x - radius * 0.1, y + radius * 0.42),
        (x + radius * 0.52, y - radius * 0.38),
    )
    return [Circle(x, y, radius, _GOOD), Polygon(points, None, PAPER, radius * 0.26, closed=False)]


def container(at: XY, size: float, store: Store) -> list[Drawn]:
    """Return a container with its known items.

    The items stand on it. It is open if it is known to be empty. `?` means unknown contents,
    `+?` means that there may be more.
    """
    x, y = at
    half = size / 2
    kiln = store.name is not None and any(k in store.name for k in ("furnace", "smoker"))
    body, dark, light = (
        (_STONE, _STONE_DARK, mix(_STONE, PAPER, 0.3)) if kiln else (_WOOD, _WOOD_DARK, _WOOD_LIGHT)
    )
    drawn: list[Drawn] = [
        Rectangle(x - half, y - half, size, size, body, dark, size * 0.05, size * 0.08, role="icon")
    ]
    empty = store.complete and not store.items
    if empty:
        inside = (x - half * 0.78, y - half * 0.78, size * 0.78, size * 0.5)
        drawn.append(Rectangle(*inside, mix(dark, INK, 0.6), light, size * 0.05, role="part"))
    else:
        lid = (x - half * 0.9, y - half * 0.9, size * 0.9, size * 0.36)
        drawn.append(Rectangle(*lid, light, role="part"))
    if kiln:
        drawn.append(
            Rectangle(x - half * 0.4, y + half * 0.2, half * 0.8, half * 0.6, INK, role="part")
        )
    else:
        drawn.append(_part(at, size, (-0.08, -0.1, 0.16, 0.2), "#ded6c4", dark, 0.03))
    if store.items:
        name, *_ = sorted(store.items)
        drawn += item((x, y - half * 0.15), size * 0.8, name)
    if not store.complete:
        sign = MARKS[Mark.INCOMPLETE if store.items else Mark.UNKNOWN].sign
        place = (x + half * 0.55, y + half * 0.55) if store.items else at
        drawn.append(letters(place, sign, size * (0.5 if store.items else 0.9), INK, halo=PAPER))
    if store.teller:
        drawn += hearsay((x - half * 0.8, y - half * 0.8), size * 0.2)
    if store.mark is Mark.FALSE:
        drawn += false_sign((x + half, y - half), size * 0.21)
    return drawn


def item(at: XY, size: float, name: str) -> list[Drawn]:
    """Return an item in its colour: a gem as a cut stone, others as a tile with an initial.

    Args:
        at: Middle of the icon.
        size: Width of the icon.
        name: Name of the item; empty: any item.
    """
    x, y = at
    r = size / 2
    colour = _item_colour(name)
    edge = mix(colour, INK, 0.55)
    if name not in _GEMS:
        box, fill = (x - r * 0.85, y - r * 0.85, r * 1.7, r * 1.7), mix(colour, PAPER, 0.3)
        tile = Rectangle(*box, fill, edge, size * 0.06, size * 0.2, role="part")
        return [tile, letters(at, name[0].upper(), size * 0.85, INK)] if name else [tile]
    table = ((x - r * 0.55, y - r * 0.75), (x + r * 0.55, y - r * 0.75))
    low, left, right, tip = y - r * 0.2, x - r, x + r, (x, y + r * 0.95)
    outline = (*table, (right, low), tip, (left, low))
    return [
        Polygon(outline, colour, edge, size * 0.06),
        Polygon((*table, (x + r * 0.35, low), (x - r * 0.35, low)), mix(colour, PAPER, 0.6)),
        Polygon(((x - r * 0.35, low), (x + r * 0.35, low), tip), mix(colour, PAPER, 0.25)),
    ]


def device(at: XY, cell: float, shown: Device) -> list[Drawn]:
    """Return the icon of a door, lever, button, plate, sign or workbench.

    Args:
        at: Upper left corner of its column.
        cell: Width of a column.
        shown: The device.
    """
    x, y = at
    middle = (x + cell / 2, y + cell / 2)
    if "lever" in shown.name:
        end = (middle[0] + cell * (0.34 if shown.on else -0.34), middle[1] - cell * 0.34)
        return [
            _part(at, cell, (0.3, 0.5, 0.4, 0.3), _STONE, INK, 0.05),
            Lines(((middle, end),), _WOOD_DARK, cell * 0.13, "part"),
            Circle(*end, cell * 0.13, "#d03030" if shown.on else PAPER, INK, cell * 0.05),
        ]
    if "button" in shown.name or "plate" in shown.name:
        fill = INK if shown.on else _STONE
        return [_part(at, cell, (0.25, 0.3, 0.5, 0.4), fill, INK, 0.06, radius=0.1)]
    if "door" in shown.name or "gate" in shown.name:
        return _door(at, cell, shown)
    if shown.name.endswith("sign"):
        line = ((x + cell * 0.22, y + cell * 0.5), (x + cell * 0.78, y + cell * 0.5))
        return [
            _part(at, cell, (0.1, 0.3, 0.8, 0.4), _WOOD, INK, 0.05),
            Lines((line,), INK, cell * 0.06, "part"),
        ]
    return _table(at, cell, shown)


def _door(at: XY, cell: float, shown: Device) -> list[Drawn]:
    """Draw a door: shut, it fills its frame; open, it stands aside with an arc of its turn."""
    pale = mix(_WOOD_LIGHT, PAPER, 0.55)
    drawn: list[Drawn] = [_part(at, cell, (0, 0, 1, 1), pale, _WOOD_DARK, 0.04, dash=0.12)]
    leaves = shown.parts or ((0.0, 0.4, 0.15, 0.6), (0.85, 0.4, 1.0, 0.6))
    for left, top, right, bottom in leaves:
        leaf = (left, top, max(right - left, 0.12), max(bottom - top, 0.12))
        drawn.append(_part(at, cell, leaf, PAPER if shown.on else _WOOD, _WOOD_DARK, 0.07))
    return drawn


def _table(at: XY, cell: float, shown: Device) -> list[Drawn]:
    x, y = at
    kiln = "table" not in shown.name
    fill, dark = (_STONE, _STONE_DARK) if kiln else (_WOOD, _WOOD_DARK)
    drawn: list[Drawn] = [_part(at, cell, (0, 0, 1, 1), fill, dark, 0.06)]
    if kiln:
        mouth = "#e67e22" if shown.on else INK
        drawn.append(_part(at, cell, (0.25, 0.5, 0.5, 0.35), mouth))
    else:
        grid = [((x + cell * s, y), (x + cell * s, y + cell)) for s in (1 / 3, 2 / 3)]
        grid += [((x, y + cell * s), (x + cell, y + cell * s)) for s in (1 / 3, 2 / 3)]
        drawn.append(Lines(tuple(grid), dark, cell * 0.06, "part"))
    return drawn


def _part(
    at: XY,
    cell: float,
    box: Bounds,
    fill: str,
    stroke: str | None = None,
    thick: float = 0.0,
    *,
    radius: float = 0.0,
    dash: float = 0.0,
) -> Rectangle:
    """Return a rectangle; `box` (left, top, width, height) and the rest are shares of a cell."""
    left, top, wide, high = box
    x, y = at[0] + cell * left, at[1] + cell * top
    line = cell * thick
    return Rectangle(
        x, y, cell * wide, cell * high, fill, stroke, line, cell * radius, cell * dash, "part"
    )


def _item_colour(name: str) -> str:
    for part, colour in _COLOURS.items():
        if part in name:
            return colour
    # Python's own hash is no use here: it differs from process to process.
    digest = zlib.crc32(name.encode())
    parts = (90 + digest % 130, 90 + digest // 256 % 130, 90 + digest // 65536 % 130)
    return "#" + bytes(parts).hex()
