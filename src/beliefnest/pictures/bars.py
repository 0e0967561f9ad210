"""Bar chart of a posterior at one tick."""

from collections.abc import Mapping

import msgspec

from beliefnest.pictures.lettering import ASCENT, ellipsis, text_width
from beliefnest.pictures.marks import XY, Lines, Rectangle, Text
from beliefnest.pictures.palette import INK, PAPER, QUIET, mix
from beliefnest.pictures.panel import PanelBlock, paragraph


class BarGroup(msgspec.Struct, frozen=True):
    """Bars on one scale.

    Attributes:
        title: Question that they answer.
        low: Lower end of the scale.
        high: Upper end of the scale.
        bars: Values by name.
        colours: Colour of each bar.
        is_share: True if the values are probabilities.
    """

    title: str
    low: float
    high: float
    bars: Mapping[str, float]
    colours: Mapping[str, str]
    is_share: bool = False


class BarChart(msgspec.Struct, frozen=True):
    """A posterior at one tick.

    Attributes:
        title: Name of the agent.
        note: The tick, in words.
        groups: Groups of bars, from the top downwards.
    """

    title: str
    note: str
    groups: tuple[BarGroup, ...]


def number_text(value: float, digits: int = 2) -> str:
    """Return a number with at most `digits` decimals; never a negative zero."""
    return f"{round(value, digits) + 0.0:g}"


def draw_bars(chart: BarChart, at: XY, width: float, size: float) -> PanelBlock:
    """Draw the bars of a posterior, with a name to the left and a value to the right of each.

    Args:
        chart: The posterior.
        at: Upper left corner, in points.
        width: Width in points.
        size: Size of texts in points.
    """
    left, top = at
    block = PanelBlock(bottom=top)
    paragraph(block, chart.title, left, width, size * 1.15, bold=True)
    paragraph(block, chart.note, left, width, size * 0.95, QUIET)
    names = [name for group in chart.groups for name in group.bars]
    inset = min(width * 0.4, max(text_width(name, size) for name in names)) + 3
    room = text_width("100 %", size) + 3
    span = (left + inset, left + width - room)
    for group in chart.groups:
        block.bottom += size * 0.5
        paragraph(block, group.title, left, width, size, QUIET)
        first = block.bottom
        scale = (span[1] - span[0]) / (group.high - group.low)
        zero = span[0] + (0 - group.low) * scale
        for name, value in group.bars.items():
            base = block.bottom + size * 0.6 + size * ASCENT * 0.48
            block.marks.append(Text(left, base, ellipsis(name, size, inset - 3), size, INK))
            end = zero + value * scale
            box = (min(zero, end), block.bottom + size * 0.15, abs(end - zero), size * 0.9)
            colour = group.colours[name]
            edge = mix(colour, INK, 0.4)
            block.marks.append(Rectangle(*box, mix(PAPER, colour, 0.72), edge, 0.4))
            words = f"{100 * value:.0f} %" if group.is_share else number_text(value, digits=0)
            block.marks.append(Text(left + width, base, words, size, INK, anchor="end"))
            block.bottom += size * 1.3
        block.marks.append(Lines((((zero, first), (zero, block.bottom)),), INK, 0.4))
    return block
