"""Widths and lines of texts, measured with the font that is drawn.

The font is Liberation Sans, whose widths are those of Arial and Helvetica: a text that a viewer
of an SVG file draws with one of these takes the room that was measured for it.
"""

import io
from functools import cache
from importlib.resources import as_file, files
from pathlib import Path

from PIL import ImageFont

from beliefnest.world.texts import on_one_line

__all__ = [
    "ASCENT",
    "DESCENT",
    "FAMILIES",
    "ellipsis",
    "font",
    "font_bytes",
    "lettered",
    "text_width",
    "wrap",
]

ASCENT, DESCENT = 0.74, 0.22
"""How far letters reach above and below the base line, in sizes of the text."""

FAMILIES = "'Liberation Sans', Arial, Helvetica, sans-serif"

_UNIT = 1000


@cache
def font_bytes(*, bold: bool) -> bytes:
    """Return the TrueType file of the font."""
    name = f"LiberationSans-{'Bold' if bold else 'Regular'}.ttf"
    with as_file(files("beliefnest.pictures") / "fonts" / name) as path:
        return Path(path).read_bytes()


@cache
def font(size: float, *, bold: bool) -> ImageFont.FreeTypeFont:
    """Return the font, with `size` pixels to a size of the text."""
    stream = io.BytesIO(font_bytes(bold=bold))
    return ImageFont.truetype(stream, size, layout_engine=ImageFont.Layout.BASIC)


_LIKE = str.maketrans(
    {
        **dict.fromkeys("\u2713\u2714\u2705", "\u221a"),
        **dict.fromkeys("\u2715\u2716\u2717\u2718\u274c", "\u00d7"),
    }
)
"""Signs that the font lacks, and those most like them that it has."""


def lettered(text: str) -> str:
    """Return a text as it is drawn where no other font can help out."""
    return text.translate(_LIKE)


@cache
def _unit_width(text: str, *, bold: bool) -> float:
    return font(_UNIT, bold=bold).getlength(lettered(text)) / _UNIT


def text_width(text: str, size: float, *, bold: bool = False) -> float:
    """Return the width of a line of text, in the unit of its size."""
    return _unit_width(text, bold=bold) * size


def wrap(text: str, size: float, width: float, *, bold: bool = False) -> list[str]:
    """Return a text in lines that are no wider than `width`; a word that is wider is broken.

    What controls or turns text is written out, as wherever texts of others are shown.
    """
    lines: list[str] = []
    for word in on_one_line(text).split():
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and text_width(longer, size, bold=bold) <= width:
            lines[-1] = longer
            continue
        rest = word
        while text_width(rest, size, bold=bold) > width and len(rest) > 1:
            count = _fitting(rest, size, width, bold=bold)
            lines.append(rest[:count])
            rest = rest[count:]
        lines.append(rest)
    return lines


def ellipsis(text: str, size: float, width: float, *, bold: bool = False) -> str:
    """A text on one line, or as much of its beginning as there is room for with a sign of more."""
    text = on_one_line(text)
    if text_width(text, size, bold=bold) <= width:
        return text
    room = width - text_width("\u2026", size, bold=bold)
    return text[: _fitting(text, size, room, bold=bold)].rstrip() + "\u2026"


def _fitting(text: str, size: float, width: float, *, bold: bool) -> int:
    """How many letters of a text fit; at least one."""
    count = len(text)
    while count > 1 and text_width(text[:count], size, bold=bold) > width:
        count -= 1
    return count
