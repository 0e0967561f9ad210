"""Drawings: lists of marks of simple shapes, in points, with y pointing down.

Marks have bounds, so that a drawing can be checked by measurement. The `role` of a mark tells
its purpose: texts and icons must not touch one another, cards must not be empty; lines and areas
may lie anywhere.
"""

from collections.abc import Iterator
from typing import Any, Literal

import msgspec
from msgspec.structs import replace

from beliefnest.pictures.lettering import ASCENT, DESCENT, text_width

XY = tuple[float, float]
Bounds = tuple[float, float, float, float]
"""Left, top, right, bottom."""

MarkRole = Literal["area", "line", "icon", "part", "text", "card"]
"""Purpose of a mark. `part` is a piece of an icon, including letters inside it; `text` stands
alone."""


class Rectangle(msgspec.Struct, frozen=True):
    """A rectangle with its upper left corner at `x`, `y`."""

    x: float
    y: float
    width: float
    height: float
    fill: str | None = None
    stroke: str | None = None
    thick: float = 0.5
    radius: float = 0.0
    dash: float = 0.0
    role: MarkRole = "area"

    @property
    def bounds(self) -> Bounds:
        """Bounding box."""
        return self.x, self.y, self.x + self.width, self.y + self.height


class Circle(msgspec.Struct, frozen=True):
    """A circle around `x`, `y`."""

    x: float
    y: float
    radius: float
    fill: str | None = None
    stroke: str | None = None
    thick: float = 0.5
    dash: float = 0.0
    role: MarkRole = "part"

    @property
    def bounds(self) -> Bounds:
        """Bounding box."""
        r = self.radius
        return self.x - r, self.y - r, self.x + r, self.y + r


class Polygon(msgspec.Struct, frozen=True):
    """A filled polygon, or a line through points if `closed` is False."""

    points: tuple[XY, ...]
    fill: str | None = None
    stroke: str | None = None
    thick: float = 0.5
    dash: float = 0.0
    closed: bool = True
    role: MarkRole = "part"

    @property
    def bounds(self) -> Bounds:
        """Bounding box."""
        xs, ys = zip(*self.points, strict=True)
        return min(xs), min(ys), max(xs), max(ys)


class Lines(msgspec.Struct, frozen=True):
    """Many straight segments of one style."""

    segments: tuple[tuple[XY, XY], ...]
    stroke: str
    thick: float = 0.5
    role: MarkRole = "line"

    @property
    def bounds(self) -> Bounds:
        """Bounding box."""
        xs, ys = zip(*(point for ends in self.segments for point in ends), strict=True)
        return min(xs), min(ys), max(xs), max(ys)


class Text(msgspec.Struct, frozen=True):
    """A line of text; `y` is its base line, `x` its beginning, middle or end."""

    x: float
    y: float
    text: str
    size: float
    colour: str
    bold: bool = False
    anchor: Literal["start", "middle", "end"] = "start"
    halo: str | None = None
    role: MarkRole = "text"

    @property
    def width(self) -> float:
        """Width of the text."""
        return text_width(self.text, self.size, bold=self.bold)

    @property
    def left(self) -> float:
        """Left end of the text."""
        share = {"start": 0.0, "middle": 0.5, "end": 1.0}[self.anchor]
        return self.x - share * self.width

    @property
    def bounds(self) -> Bounds:
        """Bounding box of the letters."""
        top, bottom = self.y - ASCENT * self.size, self.y + DESCENT * self.size
        return self.left, top, self.left + self.width, bottom


class Pixels(msgspec.Struct, frozen=True):
    """A rectangle of equal coloured fields with its upper left corner at `x`, `y`.

    Attributes:
        x: Left end.
        y: Upper end.
        width: Width of all fields.
        height: Height of all fields.
        columns: Number of fields in a row.
        colours: Red, green and blue of each field, row by row.
        role: Purpose.
    """

    x: float
    y: float
    width: float
    height: float
    columns: int
    colours: bytes
    role: MarkRole = "area"

    @property
    def bounds(self) -> Bounds:
        """Bounding box."""
        return self.x, self.y, self.x + self.width, self.y + self.height

    @property
    def rows(self) -> int:
        """Number of rows of fields."""
        return len(self.colours) // (3 * self.columns)


DrawnMark = Rectangle | Circle | Polygon | Lines | Text | Pixels


class Drawing(msgspec.Struct, frozen=True):
    """Marks on a page, the lowest first.

    Attributes:
        width: Width of the page in points.
        height: Height of the page in points.
        marks: The marks.
        title: Description of the content, for readers that cannot see it.
    """

    width: float
    height: float
    marks: tuple[DrawnMark, ...]
    title: str = ""

    def having(self, *roles: MarkRole) -> Iterator[DrawnMark]:
        """Yield the marks with some roles."""
        return (mark for mark in self.marks if mark.role in roles)


def scaled(drawing: Drawing, factor: float) -> Drawing:
    """Return a drawing scaled by a factor, texts included."""
    return replace(
        drawing,
        width=drawing.width * factor,
        height=drawing.height * factor,
        marks=tuple(_scaled(mark, factor) for mark in drawing.marks),
    )


_LENGTHS = ("x", "y", "width", "height", "thick", "radius", "dash", "size")


def _scaled(mark: DrawnMark, factor: float) -> DrawnMark:
    changed: dict[str, Any] = {
        name: getattr(mark, name) * factor for name in mark.__struct_fields__ if name in _LENGTHS
    }
    if isinstance(mark, Polygon):
        changed["points"] = tuple((x * factor, y * factor) for x, y in mark.points)
    elif isinstance(mark, Lines):
        changed["segments"] = tuple(
            ((a * factor, b * factor), (c * factor, d * factor)) for (a, b), (c, d) in mark.segments
        )
    return replace(mark, **changed)
