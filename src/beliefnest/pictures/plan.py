"""Plan of a scene: ground, walls, sight, containers, devices, agents, and their names."""

import math
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import NamedTuple

import numpy as np

from beliefnest.belief.grounds import Source, age_text, told_text
from beliefnest.pictures import icons
from beliefnest.pictures.labels import LINE, Label, PlacedLabel, leader, put_labels
from beliefnest.pictures.lettering import ASCENT, text_width
from beliefnest.pictures.marks import XY, Bounds, Lines, Pixels, Polygon, Rectangle, Text
from beliefnest.pictures.marks import DrawnMark as Drawn
from beliefnest.pictures.palette import INK, MARKS, PAPER, QUIET, AgentLook, Mark, mix, parts
from beliefnest.pictures.relief import UNKNOWN, Relief, standing_columns
from beliefnest.pictures.room import Room
from beliefnest.pictures.scene import DEVICES, Device, DrawnAgent, PlanColumn, Scene, Store
from beliefnest.world.registry import Registry, block_name
from beliefnest.world.signs import is_sign

LEAST_HEAT = 0.005
"""Least probability that is drawn."""

_NOWHERE = "#dfdbd2"
_GROUND = "#f0ece3"
_GRID = "#e4dfd4"
_WALL = "#706c6a"
_HEAT = "#4a1486"
_HATCH = 4.2
_MOST_DOTS = 40
"""Greatest number of dots for unknown blocks along the longer side of a relief."""
_STEEP = 0.1
_SLOPES = 3
"""Light on the ground by block that it rises to the south, and the greatest rise that counts."""
_THINNEST = 0.75
"""Least thickness of a wall in a relief, in points: more than a pixel of a screen or printer."""
_SMALLEST = 3.9
"""Least radius of an agent, in points, at which its letters can be read."""
_WIDE_SYMBOLS = 0.6
"""Size of symbols on the ground of a wide world, relative to those on other plans. Their places
count there: a symbol covers several blocks."""
_KINDS: Mapping[str, str] = {
    "glass": "#b8d8e2",
    "ice": "#b0ceec",
    "water": "#78a8dc",
    "lava": "#e08040",
    "grass": "#96ba6e",
    "leaves": "#6e9e56",
    "planks": "#bc9868",
    "log": "#96744c",
    "sand": "#e0d2a0",
    "gold_block": "#dcae1c",
    "emerald_block": "#1f9e4c",
    "diamond_block": "#35b8c4",
    "redstone_block": "#a8261c",
    "lapis_block": "#2f4fa2",
}
_DYES: Mapping[str, str] = {
    "white": "#e6e4df",
    "orange": "#dc8a4a",
    "magenta": "#b866b0",
    "light_blue": "#82b4d2",
    "yellow": "#e0c860",
    "lime": "#9cbe5a",
    "pink": "#dca0b0",
    "gray": "#5e6064",
    "light_gray": "#a8a8a4",
    "cyan": "#5a9aa0",
    "purple": "#8064a0",
    "blue": "#5068a8",
    "brown": "#7a5a44",
    "green": "#64864a",
    "red": "#b0504c",
    "black": "#33323a",
}
_DYED = ("_wool", "_concrete", "_concrete_powder", "_terracotta", "_carpet")
_MOST_QUOTED = 24
_MANY = 16
"""Number of agents above which lines to distant names would cross."""
_STORES = ("chest", "barrel", "furnace", "smoker")


class SightSign(NamedTuple):
    """Sign for what an agent sees; the first agent of a plan has number 0."""

    number: int
    name: str


class HeatSign(NamedTuple):
    """Sign for the probability of columns, with the words for it."""

    words: str


SignKind = str | SightSign | HeatSign
"""Sign of a plan. Those that need no further facts are words."""


@dataclass
class DrawnPlan:
    """A finished plan.

    Attributes:
        marks: Marks of the plan.
        bottom: Lower end, in points.
        unnamed: Names that had no room.
        kinds: Signs that the legend has to explain.
    """

    marks: list[Drawn]
    bottom: float
    unnamed: list[str] = field(default_factory=list)
    kinds: set[SignKind] = field(default_factory=set)


def draw_plan(
    scene: Scene,
    looks: Mapping[str, AgentLook],
    at: XY,
    width: float,
    size: float,
    trails: Mapping[str, tuple[XY, ...]] | None = None,
) -> DrawnPlan:
    """Draw the plan of a scene.

    Args:
        scene: The scene.
        looks: Looks of all agents.
        at: Upper left corner, in points.
        width: Width in points; a plan with more rows than columns is made narrower.
        size: Size of the names, in points.
        trails: Ways that agents have gone: x and z, oldest first.
    """
    across, down = scene.size
    cell = min(width / across, width * 1.1 / down)
    left = at[0] + (width - cell * across) / 2
    sheet = _Sheet(scene, looks, (left, at[1]), cell, size)
    sheet.ground()
    sheet.sights()
    sheet.heat()
    sheet.walls()
    sheet.trails(trails or {})
    sheet.things()
    sheet.names()
    edge = Rectangle(left, at[1], cell * across, cell * down, None, mix(INK, PAPER, 0.6), 0.5)
    return DrawnPlan([*sheet.marks, edge], at[1] + cell * down, sheet.unnamed, sheet.kinds)


def heat_colour(share: float) -> str:
    """Return the tint of a probability: its root, so that small ones can be seen."""
    return mix(_GROUND, _HEAT, math.sqrt(min(1.0, share)) * 0.85)


def hatching(bounds: Bounds, number: int, step: float = _HATCH) -> tuple[tuple[XY, XY], ...]:
    """Return the segments of a hatching of a rectangle; `number` selects the direction.

    The lines have fixed offsets on the page, so that they continue in neighbouring rectangles.
    """
    x0, y0, x1, y1 = bounds
    sign = 1 if number % 2 else -1
    ends = [x0 + sign * y0, x0 + sign * y1, x1 + sign * y0, x1 + sign * y1]
    segments = []
    offset = -(-min(ends) // step) * step
    while offset < max(ends):
        # Intersections of the line x + sign * y = offset with the edges of the rectangle.
        crossings = sorted(
            {
                (round(max(x0, min(x1, offset - sign * y)), 3), round(y, 3))
                for y in (
                    max(y0, min(y1, sign * (offset - x0))),
                    max(y0, min(y1, sign * (offset - x1))),
                )
            }
        )
        if len(crossings) == 2:
            segments.append((crossings[0], crossings[1]))
        offset += step
    return tuple(segments)


class _Sheet:
    """A plan under construction."""

    def __init__(
        self, scene: Scene, looks: Mapping[str, AgentLook], at: XY, cell: float, size: float
    ) -> None:
        self._scene = scene
        self._looks = looks
        self._at = at
        self._cell = cell
        self._size = size
        self._share = 1.0 if scene.relief is None else _WIDE_SYMBOLS
        across, down = scene.size
        inset = 1.0
        self._room = Room(
            (
                at[0] + inset,
                at[1] + inset,
                at[0] + across * cell - inset,
                at[1] + down * cell - inset,
            )
        )
        self._labels: list[Label] = []
        self._boards: list[Bounds] = []
        self.marks: list[Drawn] = []
        self.unnamed: list[str] = []
        self.kinds: set[SignKind] = set()

    def _place(self, x: float, z: float) -> XY:
        low_x, low_z = self._scene.low
        return self._at[0] + (x - low_x) * self._cell, self._at[1] + (z - low_z) * self._cell

    def _square(self, i: int, k: int, wide: int = 1) -> Bounds:
        x, y = self._at[0] + i * self._cell, self._at[1] + k * self._cell
        return x, y, x + wide * self._cell, y + self._cell

    def _runs(self, of: Mapping[tuple[int, int], object]) -> Iterator[tuple[int, int, int]]:
        """Yield runs of equal neighbours in a row: first column, row, length."""
        across, down = self._scene.size
        for k in range(down):
            start = 0
            for i in range(1, across + 1):
                if i == across or of.get((i, k)) != of.get((start, k)):
                    if of.get((start, k)) is not None:
                        yield start, k, i - start
                    start = i

    def _cells(self) -> Iterator[tuple[int, int, PlanColumn]]:
        for i, row in enumerate(self._scene.cells):
            for k, cell in enumerate(row):
                yield i, k, cell

    def _wrong_columns(self) -> Iterator[tuple[int, int]]:
        return ((i, k) for i, k, cell in self._cells() if cell.wrong)

    def ground(self) -> None:
        """Draw the floor, its unknown parts, and thin lines between columns; or the relief."""
        if self._scene.relief is not None:
            self._relief(self._scene.relief)
            return
        fills = {(i, k): _ground_colour(cell) for i, k, cell in self._cells()}
        for i, k, count in self._runs(fills):
            x0, y0, x1, y1 = self._square(i, k, count)
            self.marks.append(Rectangle(x0, y0, x1 - x0, y1 - y0, fills[i, k]))
        across, down = self._scene.size
        width, height = across * self._cell, down * self._cell
        x, y = self._at
        lines = [
            ((x + i * self._cell, y), (x + i * self._cell, y + height)) for i in range(1, across)
        ]
        lines += [
            ((x, y + k * self._cell), (x + width, y + k * self._cell)) for k in range(1, down)
        ]
        self.marks.append(Lines(tuple(lines), _GRID, 0.25))

    def _relief(self, relief: Relief) -> None:
        across, down = self._scene.size
        grounds = [parts(_colour(name, _GROUND)) for name in relief.names]
        other = [parts(_NOWHERE), parts(_GROUND)]
        # The last two values are those for `NOWHERE` and `UNKNOWN`, as negative numbers.
        colours = np.array([*grounds, *other], dtype=np.float64)[relief.blocks]
        is_known = relief.blocks >= 0
        rise = np.diff(relief.levels, axis=1, prepend=relief.levels[:, :1])
        light = 1 + _STEEP * np.clip(rise, -_SLOPES, _SLOPES)
        colours[is_known] *= light[is_known][:, None]
        for sight in self._scene.sights[:1]:
            tint = np.array(parts(self._looks[sight.name].colour))
            colours[sight.seen] = 0.6 * colours[sight.seen] + 0.4 * tint
        fields = np.clip(np.rint(colours), 0, 255).astype(np.uint8).transpose(1, 0, 2)
        width, height = across * self._cell, down * self._cell
        self.marks.append(Pixels(*self._at, width, height, across, fields.tobytes()))
        step = -(-max(across, down) // _MOST_DOTS)
        unknown = np.argwhere(relief.blocks == UNKNOWN).tolist()
        self._dots([(i, k) for i, k in unknown if i % step == k % step == step // 2], step)

    def _outlines(self, relief: Relief) -> None:
        """Draw walls, pillars and outlines of houses on a relief, dark at any scale."""
        columns = np.argwhere(standing_columns(relief, self._scene.height)).tolist()
        names = {(i, k): relief.names[relief.blocks[i, k]] for i, k in columns}
        fills = {
            at: mix(_colour(name, _WALL), INK, 0.35)
            for at, name in names.items()
            if _standing(name)
        }
        segments: dict[str, list[tuple[XY, XY]]] = {}
        for i, k, across, down in _strips(fills):
            x0, y0, _, _ = self._square(i, k)
            x1, y1 = x0 + across * self._cell, y0 + down * self._cell
            x, y = (x0 + x1) / 2, (y0 + y1) / 2
            ends = ((x, y0), (x, y1)) if down > 1 else ((x0, y), (x1, y))
            segments.setdefault(fills[i, k], []).append(ends)
        for colour, lines in segments.items():
            self.marks.append(Lines(tuple(lines), colour, max(self._cell, _THINNEST)))

    def sights(self) -> None:
        """Draw a tint over the blocks that the first agent sees, hatching for other agents."""
        for number, sight in enumerate(self._scene.sights):
            self.kinds.add(SightSign(number, sight.name))
            if number == 0 and self._scene.relief is not None:
                continue  # The relief has the tint.
            colour = self._looks[sight.name].colour
            seen = {(int(i), int(k)): True for i, k in zip(*sight.seen.nonzero(), strict=True)}
            segments: list[tuple[XY, XY]] = []
            for i, k, count in self._runs(seen):
                bounds = self._square(i, k, count)
                x0, y0, x1, y1 = bounds
                if number == 0:
                    tint = mix(_GROUND, colour, 0.3)
                    self.marks.append(Rectangle(x0, y0, x1 - x0, y1 - y0, tint))
                else:
                    segments += hatching(bounds, number)
            if segments:
                self.marks.append(Lines(tuple(segments), mix(_GROUND, colour, 0.8), 0.5))

    def heat(self) -> None:
        """Add a tint over columns, by their probability."""
        low_x, low_z = self._scene.low
        for (x, z), share in sorted(self._scene.heat.items()):
            if share >= LEAST_HEAT and self._holds((x + 0.5, z + 0.5)):
                x0, y0, x1, y1 = self._square(x - low_x, z - low_z)
                self.marks.append(Rectangle(x0, y0, x1 - x0, y1 - y0, heat_colour(share)))
        if self._scene.heat:
            self.kinds.add(HeatSign(self._scene.heat_words))

    def walls(self) -> None:
        """Draw blocks at this height, unknown blocks, and marks on false blocks."""
        if self._scene.relief is not None:
            self._outlines(self._scene.relief)
        dots: list[tuple[int, int]] = []
        fills: dict[tuple[int, int], str] = {}
        for i, k, cell in self._cells():
            if cell.standing is None:
                dots.append((i, k))
                continue
            x0, y0, _, _ = self._square(i, k)
            for part in _standing(cell.standing):
                if part == (0.0, 0.0, 1.0, 1.0):
                    fills[i, k] = _colour(cell.standing, _WALL)
                    continue
                left, top, right, bottom = (share * self._cell for share in part)
                fill = _colour(cell.standing, _WALL)
                box = (x0 + left, y0 + top, right - left, bottom - top)
                self.marks.append(Rectangle(*box, fill))
        for i, k, count in self._runs(fills):
            x0, y0, x1, y1 = self._square(i, k, count)
            edge = mix(fills[i, k], INK, 0.35)
            self.marks.append(Rectangle(x0, y0, x1 - x0, y1 - y0, fills[i, k], edge, 0.3))
        self._dots(dots)
        self._false_blocks()

    def _dots(self, columns: Sequence[tuple[int, int]], step: int = 1) -> None:
        """Draw a dot in each of some columns, for unknown blocks; `step` is their distance."""
        if not columns:
            return
        wide = step * self._cell
        r = min(0.8, wide * 0.09)
        lines = []
        for i, k in columns:
            x0, y0, x1, y1 = self._square(i, k)
            middle, level = (x0 + x1) / 2, (y0 + y1) / 2
            lines.append(((middle - r, level), (middle + r, level)))
        self.marks.append(Lines(tuple(lines), mix(QUIET, PAPER, 0.1), min(1.0, wide * 0.14)))
        self.kinds.add("unknown blocks")

    def _false_blocks(self) -> None:
        look = MARKS[Mark.FALSE]
        low_x, low_z = self._scene.low
        # Devices are left out here: a false device has a sign at its corner.
        signed = {
            (shown.position[0] - low_x, shown.position[2] - low_z)
            for shown in self._scene.devices
            if shown.false is not None
        }
        relief = self._scene.relief
        wrong = relief.wrong if relief is not None else self._wrong_columns()
        for i, k in wrong:
            if (i, k) in signed:
                continue
            x0, y0, x1, y1 = self._square(i, k)
            inset = self._cell * 0.12
            size = self._cell - 2 * inset
            self.marks.append(Rectangle(x0 + inset, y0 + inset, size, size, None, look.colour, 0.9))
            arms = (
                ((x0 + inset, y0 + inset), (x1 - inset, y1 - inset)),
                ((x0 + inset, y1 - inset), (x1 - inset, y0 + inset)),
            )
            self.marks.append(Lines(arms, look.colour, 0.6))
            self.kinds.add("false")

    def trails(self, trails: Mapping[str, tuple[XY, ...]]) -> None:
        """Draw the ways that agents have gone."""
        for name, points in sorted(trails.items()):
            if len(set(points)) > 1:
                line = tuple(self._place(*point) for point in points)
                colour = mix(self._looks[name].colour, INK, 0.15)
                self.marks.append(Polygon(line, None, colour, 0.9, 2.2, closed=False, role="line"))
                self.kinds.add("trail")

    def things(self) -> None:
        """Draw devices, containers, dropped items, places and agents."""
        for shown in self._scene.devices:
            x, _, z = shown.position
            if not any(store.position == shown.position for store in self._scene.stores):
                self.marks += icons.device(self._place(x, z), self._cell, shown)
                self.kinds.add(next(kind for kind in DEVICES if kind in shown.name).lstrip("_"))
                if shown.says and self._holds((x + 0.5, z + 0.5)):
                    self._quote(shown.says, self._place(x, z))
                (x0, y0), (x1, y1) = self._place(x, z), self._place(x + 1, z + 1)
                self._room.avoid((x0, y0, x1, y1))
                if is_sign(shown.name):
                    self._boards.append((x0, y0, x1, y1))
                self._marks_of((x0, y0, x1, y1), shown)
        for store in self._scene.stores:
            if self._holds((store.position[0] + 0.5, store.position[2] + 0.5)):
                self._store(store)
        for person in self._scene.people:
            if person.position is not None and self._holds(
                (person.position[0], person.position[2])
            ):
                self._person(person)
        for name, (px, _, pz) in self._scene.items:
            size = max(self._cell * 0.6, 4.0)
            spot = self._icon((px, pz), size) if self._holds((px, pz)) else None
            if spot is not None:
                box = (spot[0] - size / 2, spot[1] - size / 2, size, size)
                self.marks.append(Rectangle(*box, role="icon"))
                self.marks += icons.item(spot, size, name)
                self.kinds.add("dropped item")
        for label, (x, _, z) in self._scene.places:
            if self._holds((x + 0.5, z + 0.5)):
                self._mark_place(label, (x, z))

    def _marks_of(self, column: Bounds, shown: Device) -> None:
        """Draw signs at the corners of a device if it is false, or known from hearsay."""
        x0, y0, x1, _ = column
        radius = max(self._cell * 0.21, 1.6)
        corners = (x0 + radius * 0.4, y0 + radius * 0.4), (x1, y0)
        if shown.teller:
            self.marks += icons.hearsay(corners[0], radius)
            self.kinds.add("told")
        if shown.false is not None:
            self.marks += icons.false_sign(corners[1], radius)
            self.kinds.add("false")
        for (x, y), is_there in zip(corners, (shown.teller, shown.false), strict=True):
            if is_there:
                self._room.take((x - radius, y - radius, x + radius, y + radius))

    def _holds(self, point: XY) -> bool:
        (low_x, low_z), (across, down) = self._scene.low, self._scene.size
        return low_x <= point[0] <= low_x + across and low_z <= point[1] <= low_z + down

    def _icon(self, point: XY, size: float) -> XY | None:
        """Return room for an icon at a point, or near it with a line that leads there.

        On the ground of a wide world it is at most its size away, or else on other icons.
        """
        at = self._place(*point)
        is_wide = self._scene.relief is not None
        spot = self._room.spot(at, size, size, size if is_wide else math.inf)
        if spot is None and is_wide:
            half = size / 2
            self._room.take((at[0] - half, at[1] - half, at[0] + half, at[1] + half))
            return at
        if spot is not None and spot != at:
            self.marks.append(Lines(((at, spot),), INK, 0.5))
            if is_wide:
                self.kinds.add("moved")
        return spot

    def _store(self, store: Store) -> None:
        size = max(self._cell * 0.96, 7.5 * self._share)
        x, _, z = store.position
        spot = self._icon((x + 0.5, z + 0.5), size * (1.3 if store.mark is Mark.FALSE else 1))
        if spot is None:
            self.unnamed.append(store.label)
            return
        self.marks += icons.container(spot, size, store)
        self.kinds |= {"container", "told"} if store.teller else {"container"}
        around = size * (1.3 if store.mark is Mark.FALSE else 1)
        self._label(spot, around, ((_with_height(store.label, store.above), False),))

    def _person(self, person: DrawnAgent) -> None:
        if person.position is None:
            return
        radius = max(self._cell * 0.5, _SMALLEST * self._share)
        size = radius * (2.8 if person.mark is Mark.FALSE else 2)
        spot = self._icon((person.position[0], person.position[2]), size)
        if spot is None:
            self.unnamed.append(person.name)
            return
        yaw = person.yaw if person.mark is Mark.CURRENT else None
        look = self._looks[person.name]
        # False positions are usually remembered ones and have no look direction then.
        self.marks += icons.agent(spot, radius, look, yaw, person.mark)
        if yaw is not None:
            x, y = spot[0] - math.sin(yaw) * radius * 1.3, spot[1] - math.cos(yaw) * radius * 1.3
            self._room.avoid((x - radius / 2, y - radius / 2, x + radius / 2, y + radius / 2))
        if person.age or person.mark is Mark.STALE:
            self.kinds.add("remembered")
        if person.mark is Mark.FALSE:
            self.kinds.add("false")
        if person.teller:
            corner = (spot[0] - radius * 0.86, spot[1] - radius * 0.86)
            self.marks += icons.hearsay(corner, radius * 0.42)
            self.kinds.add("told")
        lines = [(_with_height(person.name, person.above), True)]
        if person.believer:
            lines.append((f"as {person.believer} has it", False))
        elif person.teller:
            lines.append((f"told by {person.teller}", False))
        if person.source in (Source.PRIOR, Source.EDITED) and not person.believer:
            lines.append((told_text(person.source, "", person.age), False))
        elif person.age and not person.believer:
            lines.append((age_text(person.age), False))
        self._label(spot, size, tuple(lines))

    def _mark_place(self, label: str, place: tuple[int, int]) -> None:
        """Draw a named place: its name on a dotted square."""
        x0, y0 = self._place(place[0], place[1])
        square = Rectangle(x0, y0, self._cell, self._cell, None, INK, 0.6, dash=1.2)
        self.marks.append(square)
        self._label((x0 + self._cell / 2, y0 + self._cell / 2), self._cell, ((label, True),))

    def _quote(self, says: str, corner: XY) -> None:
        """Add the text of a sign as a label, shortened if it is long."""
        short = says if len(says) <= _MOST_QUOTED else f"{says[: _MOST_QUOTED - 1]}…"
        middle = (corner[0] + self._cell / 2, corner[1] + self._cell / 2)
        self._label(middle, self._cell, ((f"“{short}”", False),))

    def _label(self, spot: XY, size: float, lines: tuple[tuple[str, bool], ...]) -> None:
        half = size / 2
        icon = (spot[0] - half, spot[1] - half, spot[0] + half, spot[1] + half)
        sizes = (self._size, *(self._size * 0.85 for _ in lines[1:]))
        width = max(
            text_width(text, high, bold=bold)
            for (text, bold), high in zip(lines, sizes, strict=True)
        )
        self._labels.append(Label(icon, lines, sizes, (width, sum(sizes) * LINE)))

    def names(self) -> None:
        """Draw the names, after all icons have their places."""
        for board in self._boards:
            self._room.take(board)
        only_beside = self._scene.relief is not None or len(self._scene.people) > _MANY
        for each in put_labels(self._labels, self._room, only_beside=only_beside):
            self._write(each)

    def _write(self, put: PlacedLabel) -> None:
        label = put.label
        if put.at is None:
            self.unnamed.append(" ".join(text for text, _ in label.lines))
            return
        if not put.beside:
            self.marks.append(Lines((leader(put),), INK, 0.5))
        x, y = put.at
        for (text, bold), size in zip(label.lines, label.sizes, strict=True):
            base, middle = y + ASCENT * size, x + label.size[0] / 2
            self.marks.append(Text(middle, base, text, size, INK, bold, "middle", halo=PAPER))
            y += LINE * size


def _strips(fills: Mapping[tuple[int, int], str]) -> Iterator[tuple[int, int, int, int]]:
    """Yield strips of equal columns, one column wide: first column, row, width, depth."""
    rest = dict(fills)
    for i, k in sorted(fills, key=lambda at: at[::-1]):
        if (i, k) not in rest:
            continue
        across = down = 1
        while rest.get((i + across, k)) == fills[i, k]:
            across += 1
        while across == 1 and rest.get((i, k + down)) == fills[i, k]:
            down += 1
        for a in range(across):
            for b in range(down):
                del rest[i + a, k + b]
        yield i, k, across, down


def _with_height(name: str, above: int) -> str:
    """Return a name with the distance of its bearer from the storey."""
    if not above:
        return name
    return f"{name}, {abs(above)} {'up' if above > 0 else 'down'}"


def _ground_colour(cell: PlanColumn) -> str:
    if cell.ground is None or cell.ground == "air":
        return _NOWHERE
    return mix(_GROUND, _colour(cell.ground, _GROUND), 0.5)


@cache
def _standing(text: str) -> tuple[tuple[float, float, float, float], ...]:
    """Return the boxes of a block in its column: left, top, right, bottom, from 0 to 1."""
    name = block_name(text)
    if name in {"air", "cave_air", "void_air"}:
        return ()
    if any(kind in name for kind in (*DEVICES, *_STORES)):
        return ()
    registry = Registry.load()
    boxes = registry.boxes(registry.state_id(text))
    # A block without a collision box is drawn as well.
    return tuple((b[0], b[2], b[3], b[5]) for b in boxes) or ((0.3, 0.3, 0.7, 0.7),)


@cache
def _colour(text: str, default: str) -> str:
    name = block_name(text)
    for dyed in _DYED:
        if name.removesuffix(dyed) in _DYES:
            return _DYES[name.removesuffix(dyed)]
    for part, colour in _KINDS.items():
        if part in name:
            return colour
    # Vary the colour a little with the block's name; the same name has always the same colour.
    shade = (zlib.crc32(name.encode()) % 17 - 8) / 100
    return mix(default, INK if shade > 0 else PAPER, abs(shade))
