"""Raster writer: a drawing as an image of pixels."""

import io
import itertools
import math
from collections.abc import Sequence
from typing import Any

from PIL import Image, ImageDraw

from beliefnest.pictures.lettering import font, lettered
from beliefnest.pictures.marks import (
    XY,
    Circle,
    Drawing,
    DrawnMark,
    Lines,
    Pixels,
    Polygon,
    Rectangle,
    Text,
)
from beliefnest.pictures.palette import PAPER

_FINER = 2
"""Factor of supersampling. Pillow draws hard edges, so the image is drawn larger and scaled
down."""


def raster(drawing: Drawing, dpi: float) -> Image.Image:
    """Return the image of a drawing with a resolution of `dpi` pixels per inch."""
    scale = dpi / 72 * _FINER
    size = (round(drawing.width * dpi / 72), round(drawing.height * dpi / 72))
    image = Image.new("RGB", (size[0] * _FINER, size[1] * _FINER), PAPER)
    pen = _Pen(image, scale)
    for mark in drawing.marks:
        pen.draw(mark)
    return image.reduce(_FINER)


def fields(mark: Pixels) -> Image.Image:
    """Return the image of a mark, one pixel for each field."""
    return Image.frombytes("RGB", (mark.columns, mark.rows), mark.colours)


def png_bytes(image: Image.Image, level: int = 4, **options: Any) -> bytes:
    """Return an image as PNG, with a level of compression from 0 to 9."""
    out = io.BytesIO()
    image.save(out, format="PNG", compress_level=level, **options)
    return out.getvalue()


class _Pen:
    """Pen that draws marks with `scale` pixels per point."""

    def __init__(self, image: Image.Image, scale: float) -> None:
        self._image = image
        self._draw = ImageDraw.Draw(image)
        self._scale = scale

    def draw(self, mark: DrawnMark) -> None:
        """Draw one mark."""
        match mark:
            case Text():
                self._text(mark)
            case Lines():
                for ends in mark.segments:
                    self._line(ends, mark.stroke, mark.thick)
            case Rectangle():
                self._rectangle(mark)
            case Circle():
                self._circle(mark)
            case Polygon():
                self._polygon(mark)
            case Pixels():
                self._pixels(mark)

    def _pixels(self, mark: Pixels) -> None:
        (x0, y0), (x1, y1) = self._at(mark.bounds[:2]), self._at(mark.bounds[2:])
        corner = round(x0), round(y0)
        size = max(1, round(x1) - corner[0]), max(1, round(y1) - corner[1])
        self._image.paste(fields(mark).resize(size, Image.Resampling.NEAREST), corner)

    def _rectangle(self, mark: Rectangle) -> None:
        low, high = mark.bounds[:2], mark.bounds[2:]
        if mark.dash and mark.stroke is not None:
            self._box(low, high, mark.fill, None, 0, mark.radius)
            (x0, y0), (x1, y1) = low, high
            ring = ((x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0))
            self._dashes(ring, mark.stroke, mark.thick, mark.dash)
        else:
            self._box(low, high, mark.fill, mark.stroke, mark.thick, mark.radius)

    def _box(
        self, low: XY, high: XY, fill: str | None, stroke: str | None, thick: float, radius: float
    ) -> None:
        # Centre the outline on the edge, as SVG and PDF do.
        out = thick / 2 if stroke is not None else 0.0
        x0, y0 = self._at((low[0] - out, low[1] - out))
        x1, y1 = self._at((high[0] + out, high[1] + out))
        corners = (
            round(x0),
            round(y0),
            max(round(x0), round(x1) - 1),
            max(round(y0), round(y1) - 1),
        )
        width = self._thick(thick) if stroke is not None else 0
        if radius:
            self._draw.rounded_rectangle(corners, (radius + out) * self._scale, fill, stroke, width)
        else:
            self._draw.rectangle(corners, fill, stroke, width)

    def _circle(self, mark: Circle) -> None:
        dashed = mark.dash and mark.stroke is not None
        out = mark.thick / 2 if mark.stroke is not None and not dashed else 0.0
        r = mark.radius + out
        x0, y0 = self._at((mark.x - r, mark.y - r))
        x1, y1 = self._at((mark.x + r, mark.y + r))
        if not dashed:
            width = self._thick(mark.thick) if mark.stroke is not None else 0
            self._draw.ellipse((x0, y0, x1, y1), mark.fill, mark.stroke, width)
            return
        self._draw.ellipse((x0, y0, x1, y1), mark.fill, None, 0)
        ring = [
            (mark.x + r * math.cos(angle), mark.y + r * math.sin(angle))
            for angle in (step * math.pi / 32 for step in range(65))
        ]
        self._dashes(ring, mark.stroke or "", mark.thick, mark.dash)

    def _polygon(self, mark: Polygon) -> None:
        if mark.fill is not None:
            self._draw.polygon([self._at(point) for point in mark.points], mark.fill)
        if mark.stroke is None:
            return
        points = [*mark.points, mark.points[0]] if mark.closed else list(mark.points)
        if mark.dash:
            self._dashes(points, mark.stroke, mark.thick, mark.dash)
        else:
            self._line(points, mark.stroke, mark.thick)

    def _text(self, mark: Text) -> None:
        place = self._at((mark.left, mark.y))
        letters, words = font(mark.size * self._scale, bold=mark.bold), lettered(mark.text)
        if mark.halo is not None:
            edge = round(mark.size * 0.14 * self._scale)
            self._draw.text(
                place, words, mark.halo, letters, "ls", stroke_width=edge, stroke_fill=mark.halo
            )
        self._draw.text(place, words, mark.colour, letters, "ls")

    def _line(self, points: Sequence[XY], colour: str, thick: float) -> None:
        places = [self._at(point) for point in points]
        self._draw.line(places, colour, self._thick(thick), joint="curve")

    def _dashes(self, points: Sequence[XY], colour: str, thick: float, length: float) -> None:
        """Draw a dashed line; dashes and gaps have the same length."""
        drawn = 0.0
        for start, end in itertools.pairwise(points):
            distance = ((end[0] - start[0]) ** 2 + (end[1] - start[1]) ** 2) ** 0.5
            at = 0.0
            while at < distance:
                to = min(distance, at + length - drawn % length)
                if int(drawn // length) % 2 == 0:
                    ends = (
                        _between(start, end, at / distance),
                        _between(start, end, to / distance),
                    )
                    self._line(ends, colour, thick)
                # Add a little to the remaining length, so that rounding cannot stall the loop.
                drawn, at = drawn + (to - at) + 1e-9, to + 1e-9

    def _at(self, point: XY) -> XY:
        return point[0] * self._scale, point[1] * self._scale

    def _thick(self, points: float) -> int:
        return max(1, round(points * self._scale))


def _between(start: XY, end: XY, share: float) -> XY:
    return start[0] + (end[0] - start[0]) * share, start[1] + (end[1] - start[1]) * share
