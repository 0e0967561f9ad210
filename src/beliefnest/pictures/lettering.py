"""Text measurement and line breaking, with the font of the drawings.

The font is Liberation Sans, which has the widths of Arial and Helvetica. If a viewer of an SVG
file uses one of those fonts, texts have the measured widths.
"""

import io
from functools import cache
from importlib.resources import as_file, files
from pathlib import Path

from PIL import ImageFont

from beliefnest.world.texts import on_one_line

ASCENT, DESCENT = 0.74, 0.22
"""Height of letters above and depth below the base line, relative to the text size."""

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
    """Return the font at a text size of `size` pixels."""
    stream = io.BytesIO(font_bytes(bold=bold))
    return ImageFont.truetype(stream, size, layout_engine=ImageFont.Layout.BASIC)


_LIKE = str.maketrans(
    {
        **dict.fromkeys("\u2713\u2714\u2705", "\u221a"),
        **dict.fromkeys("\u2715\u2716\u2717\u2718\u274c", "\u00d7"),
    }
)
"""Replacements for characters that the font lacks by similar ones."""


def lettered(text: str) -> str:
    """Replace characters that the font lacks, for formats without fallback fonts."""
    return text.translate(_LIKE)


@cache
def _unit_width(text: str, *, bold: bool) -> float:
    return font(_UNIT, bold=bold).getlength(lettered(text)) / _UNIT


def text_width(text: str, size: float, *, bold: bool = False) -> float:
    """Return the width of a line of text, in the unit of `size`."""
    return _unit_width(text, bold=bold) * size


def wrap(text: str, size: float, width: float, *, bold: bool = False) -> list[str]:
    """Break a text into lines that are no wider than `width`; wider words are broken.

    Control characters and marks of text direction are escaped, as in all output of foreign
    texts.
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
    """Return a text on one line; cut it and add an ellipsis if it is too wide."""
    text = on_one_line(text)
    if text_width(text, size, bold=bold) <= width:
        return text
    room = width - text_width("\u2026", size, bold=bold)
    return text[: _fitting(text, size, room, bold=bold)].rstrip() + "\u2026"


def _fitting(text: str, size: float, width: float, *, bold: bool) -> int:
    """Return the number of leading characters that fit; at least one."""
    count = len(text)
    while count > 1 and text_width(text[:count], size, bold=bold) > width:
        count -= 1
    return count
