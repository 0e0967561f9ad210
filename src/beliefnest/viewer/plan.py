"""The ground plan: floor, walls, who sees what, chests, agents."""

import zlib
from collections.abc import Mapping

from beliefnest.viewer import icons
from beliefnest.viewer.canvas import XY, Canvas, Colour, blend
from beliefnest.viewer.icons import INK, PAPER
from beliefnest.viewer.scene import Ghost, Person, Scene, View
from beliefnest.world.values import Point, Position

__all__ = ["Plan"]

_NOWHERE: Colour = (214, 209, 199)
_FLOOR: Colour = (240, 236, 227)
_FLOOR_LINE: Colour = (228, 223, 212)
_WALL: Colour = (112, 108, 106)
_HATCH = 9.0
_KINDS: Mapping[str, Colour] = {
    "glass": (184, 216, 226),
    "ice": (176, 206, 236),
    "water": (120, 168, 220),
    "grass": (150, 186, 110),
    "leaves": (110, 158, 86),
    "planks": (188, 152, 104),
    "log": (150, 116, 76),
    "sand": (224, 210, 160),
    "lever": (170, 140, 100),
    "door": (170, 128, 80),
}


class Plan:
    """Draws the ground plan of a scene into a square of a canvas.

    Args:
        canvas: Where to draw.
        scene: What to draw.
        corner: Upper left corner.
        width: Greatest width and height, in pixels.
        colours: Agent to colour.
        brief: Leave out all words but names.
    """

    def __init__(
        self,
        canvas: Canvas,
        scene: Scene,
        corner: XY,
        width: float,
        colours: Mapping[str, Colour],
        *,
        brief: bool = False,
    ) -> None:
        self._canvas = canvas
        self._scene = scene
        self._corner = corner
        self._cell = width / max(scene.floor.size)
        self._colours = colours
        self._brief = brief

    def draw(self) -> None:
        """Draw it all."""
        self._ground()
        for number, view in enumerate(self._scene.views):
            self._view(number, view)
        self._walls()
        for person in self._scene.people:
            self._trail(person)
        for place in sorted(self._scene.containers):
            self._container(place)
        for ghost in self._scene.ghosts:
            self._ghost(ghost)
        for person in sorted(self._scene.people, key=lambda p: p.position[2]):
            self._person(person)

    def _at(self, x: float, z: float) -> XY:
        low_x, low_z = self._scene.floor.low
        return (
            self._corner[0] + (x - low_x) * self._cell,
            self._corner[1] + (z - low_z) * self._cell,
        )

    def _foot(self, point: Point) -> XY:
        return self._at(point[0], point[2])

    def _square(self, i: int, k: int) -> tuple[XY, XY]:
        x, y = self._corner[0] + i * self._cell, self._corner[1] + k * self._cell
        return (x, y), (x + self._cell, y + self._cell)

    def _ground(self) -> None:
        floor = self._scene.floor
        for i in range(floor.size[0]):
            for k in range(floor.size[1]):
                low, high = self._square(i, k)
                name = floor.ground[i][k]
                fill = _NOWHERE if name == "air" else blend(_FLOOR, _colour(name, _FLOOR), 0.5)
                self._canvas.box(low, high, fill, _FLOOR_LINE, 0.5)

    def _view(self, number: int, view: View) -> None:
        """A tint over what is seen, hatched one way or the other so that two can be told apart."""
        colour = self._colours[view.name]
        floor = self._scene.floor
        light = blend(_FLOOR, colour, 0.24)
        for i in range(floor.size[0]):
            for k in range(floor.size[1]):
                if not view.seen[i, k]:
                    continue
                (x0, y0), (x1, y1) = self._square(i, k)
                if number == 0:
                    self._canvas.box((x0, y0), (x1, y1), light, blend(light, colour, 0.08), 0.5)
                self._hatch((x0, y0), (x1, y1), blend(_FLOOR, colour, 0.55), number)

    def _hatch(self, low: XY, high: XY, colour: Colour, number: int) -> None:
        """Lines that go on from square to square; only the second and later views have them."""
        if number == 0:
            return
        sign = 1 if number % 2 else -1
        first = low[0] + sign * low[1] if sign > 0 else low[0] - high[1]
        last = high[0] + high[1] if sign > 0 else high[0] - low[1]
        offset = -(-first // _HATCH) * _HATCH
        while offset < last:
            # Points of the square on the line x + sign * y = offset.
            x0 = max(low[0], min(high[0], offset - sign * (high[1] if sign > 0 else low[1])))
            x1 = max(low[0], min(high[0], offset - sign * (low[1] if sign > 0 else high[1])))
            ends = [(x, sign * (offset - x)) for x in (x0, x1)]
            self._canvas.line(ends, colour, 1.4)
            offset += _HATCH

    def _walls(self) -> None:
        floor = self._scene.floor
        low_x, low_z = floor.low
        containers = {(x - low_x, z - low_z) for x, _, z in self._scene.containers}
        for i in range(floor.size[0]):
            for k in range(floor.size[1]):
                name = floor.standing[i][k]
                if name == "air" or (i, k) in containers:
                    continue
                low, high = self._square(i, k)
                colour = _colour(name, _WALL)
                self._canvas.box(low, high, colour, blend(colour, INK, 0.25), 1)
                middle = (low[1] + high[1]) / 2
                joint = blend(colour, PAPER, 0.22)
                self._canvas.line([(low[0] + 1, middle), (high[0] - 1, middle)], joint, 1)

    def _trail(self, person: Person) -> None:
        points = [self._foot(point) for point in person.trail]
        if len(set(points)) < 2:
            return
        self._canvas.dashes(points, blend(self._colours[person.name], PAPER, 0.15), 2.2, 5)

    def _container(self, place: Position) -> None:
        x, _, z = place
        centre = self._at(x + 0.5, z + 0.5)
        icons.chest(self._canvas, centre, self._cell * 0.94)
        held = self._scene.containers[place]
        above = (centre[0], centre[1] - self._cell * 1.05)
        for number, (name, count) in enumerate(sorted(held.items())):
            at = (above[0] + (number - (len(held) - 1) / 2) * self._cell, above[1])
            icons.item(self._canvas, at, self._cell * 0.8, name)
            if count > 1:
                self._canvas.text((at[0] + 9, at[1] + 9), str(count), 12, INK, "lm", halo=PAPER)
        label = self._scene.labels.get(place, "")
        if label and not self._brief:
            at = (centre[0], centre[1] - self._cell * (1.85 if held else 0.9))
            self._canvas.text(at, label, 15, INK, "mm", halo=PAPER)

    def _ghost(self, ghost: Ghost) -> None:
        at = self._foot(ghost.position)
        icons.ghost(
            self._canvas, at, self._cell * 0.5, self._colours[ghost.name], ghost.name[0].upper()
        )
        if self._brief:
            return
        for line, text in enumerate((f"where {ghost.believer}", f"last saw {ghost.name}")):
            place = (at[0], at[1] + self._cell * 0.5 + 12 + line * 15)
            self._canvas.text(place, text, 13, self._colours[ghost.name], "mm", halo=PAPER)

    def _person(self, person: Person) -> None:
        at = self._foot(person.position)
        colour = self._colours[person.name]
        radius = self._cell * 0.52
        icons.agent(self._canvas, at, radius, person.yaw, colour, person.name[0].upper())
        below = (at[0], at[1] + radius + 14)
        self._canvas.text(below, person.name, 16, INK, "mm", bold=True, halo=PAPER)
        if person.holds and not self._brief:
            text = f"holds {person.holds.replace('_', ' ')}"
            self._canvas.text((below[0], below[1] + 15), text, 12, INK, "mm", halo=PAPER)


def _colour(name: str, default: Colour) -> Colour:
    for part, colour in _KINDS.items():
        if part in name:
            return colour
    # Blocks of different names differ a little, always in the same way.
    shade = (zlib.crc32(name.encode()) % 17 - 8) / 100
    return blend(default, INK if shade > 0 else PAPER, abs(shade))
