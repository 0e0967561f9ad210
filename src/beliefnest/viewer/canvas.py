"""A canvas with smooth lines: everything is drawn enlarged and scaled down in the end."""

import itertools
from collections.abc import Iterable, Sequence
from functools import cache

from PIL import Image, ImageDraw, ImageFont

__all__ = ["XY", "Canvas", "Colour", "blend"]

XY = tuple[float, float]
Colour = tuple[int, int, int]

_SCALE = 2


@cache
def _font(size: int) -> "ImageFont.FreeTypeFont | ImageFont.ImageFont":
    return ImageFont.load_default(size * _SCALE)


def blend(first: Colour, second: Colour, share: float) -> Colour:
    """The colour between two, `share` of the way to the second."""
    mixed = (round(a + (b - a) * share) for a, b in zip(first, second, strict=True))
    red, green, blue = mixed
    return red, green, blue


class Canvas:
    """An image to draw on; coordinates are pixels of the finished image.

    Args:
        width: Of the finished image.
        height: Of the finished image.
        background: Its colour.
    """

    def __init__(self, width: int, height: int, background: Colour) -> None:
        self._image = Image.new("RGB", (width * _SCALE, height * _SCALE), background)
        self._draw = ImageDraw.Draw(self._image)

    @property
    def height(self) -> int:
        """Height of the finished image."""
        return self._image.height // _SCALE

    @property
    def image(self) -> Image.Image:
        """The finished image."""
        return self._image.reduce(_SCALE)

    def box(
        self,
        low: XY,
        high: XY,
        fill: Colour | None = None,
        outline: Colour | None = None,
        width: float = 1,
        radius: float = 0,
    ) -> None:
        """A rectangle."""
        corners = (low[0] * _SCALE, low[1] * _SCALE, high[0] * _SCALE, high[1] * _SCALE)
        self._draw.rounded_rectangle(
            corners, radius * _SCALE, fill, outline, max(1, round(width * _SCALE))
        )

    def line(self, points: Sequence[XY], colour: Colour, width: float = 1) -> None:
        """A line through points."""
        self._draw.line(_scaled(points), colour, max(1, round(width * _SCALE)), joint="curve")

    def dashes(self, points: Sequence[XY], colour: Colour, width: float, length: float) -> None:
        """A dashed line through points; dashes and gaps are equally long."""
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
                    self.line(ends, colour, width)
                # A hair more than the rest, so that rounding never leaves it undone.
                drawn, at = drawn + (to - at) + 1e-9, to + 1e-9

    def polygon(self, points: Sequence[XY], fill: Colour, outline: Colour | None = None) -> None:
        """A filled polygon."""
        self._draw.polygon(_scaled(points), fill, outline, _SCALE)

    def disc(
        self,
        centre: XY,
        radius: float,
        fill: Colour | None,
        outline: Colour | None = None,
        width: float = 1,
    ) -> None:
        """A circle."""
        (x, y), r = (centre[0] * _SCALE, centre[1] * _SCALE), radius * _SCALE
        self._draw.ellipse(
            (x - r, y - r, x + r, y + r), fill, outline, max(1, round(width * _SCALE))
        )

    def text(
        self,
        at: XY,
        text: str,
        size: int,
        colour: Colour,
        anchor: str = "lm",
        bold: bool = False,
        halo: Colour | None = None,
    ) -> None:
        """A line of text; anchors are Pillow's."""
        place = (at[0] * _SCALE, at[1] * _SCALE)
        weight = _SCALE * 0.3 if bold else 0
        if halo is not None:
            self._draw.text(
                place, text, halo, _font(size), anchor, stroke_width=3 * _SCALE, stroke_fill=halo
            )
        self._draw.text(
            place, text, colour, _font(size), anchor, stroke_width=weight, stroke_fill=colour
        )

    def text_width(self, text: str, size: int) -> float:
        """Width of a line of text."""
        return self._draw.textlength(text, _font(size)) / _SCALE

    def wrapped(self, text: str, size: int, width: float) -> list[str]:
        """A text in lines that are no wider than `width`."""
        lines: list[str] = []
        for word in text.split():
            longer = f"{lines[-1]} {word}" if lines else word
            if lines and self.text_width(longer, size) <= width:
                lines[-1] = longer
            else:
                lines.append(word)
        return lines


def _scaled(points: Iterable[XY]) -> list[XY]:
    return [(x * _SCALE, y * _SCALE) for x, y in points]


def _between(start: XY, end: XY, share: float) -> XY:
    return (start[0] + (end[0] - start[0]) * share, start[1] + (end[1] - start[1]) * share)
