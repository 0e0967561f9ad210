"""Scatter plots in rows of panels: judgments of models against those of people."""

import itertools
import math
from collections.abc import Iterable, Sequence

import msgspec

from beliefnest.pictures.figure import MARGIN, TEXT_SIZE, Figure, columns_for
from beliefnest.pictures.lettering import ASCENT, text_width
from beliefnest.pictures.marks import XY, Circle, Drawing, Lines, Rectangle, Text
from beliefnest.pictures.marks import DrawnMark as Drawn
from beliefnest.pictures.palette import AGENT_COLOURS, INK, PAPER, QUIET, mix
from beliefnest.pictures.panel import PanelBlock, paragraph

_PANEL = 104.0
"""Least width of a panel, in points."""
_GAP = 12.0
_DOT = 1.7
_LINE = 1.32
_TICKS = 7
"""Greatest number of steps of an axis."""
_PAD = 0.06


class Dot(msgspec.Struct, frozen=True):
    """A dot.

    Attributes:
        x: Value of the model.
        y: Value of the people.
        kind: Subject of the judgment, which determines the colour.
        error: Half the length of the error bar; 0 for none.
    """

    x: float
    y: float
    kind: str
    error: float = 0.0


class ScatterPanel(msgspec.Struct, frozen=True):
    """A panel.

    Attributes:
        title: Title above the panel.
        note: Text below the title.
        points: Dots of the panel.
    """

    title: str
    note: str
    points: Sequence[Dot]


class ScatterRow(msgspec.Struct, frozen=True):
    """Panels with the same axes.

    Attributes:
        across: Label of the horizontal axis.
        up: Label of the vertical axis.
        panels: Panels side by side, as many as fit.
    """

    across: str
    up: str
    panels: Sequence[ScatterPanel]


def scatter_figure(rows: Sequence[ScatterRow], about: str) -> Figure:
    """Return the figure, which can be laid out for any width."""
    return Figure(lambda width: _draw(rows, width, about), 174.0, about)


def _draw(rows: Sequence[ScatterRow], width: float, about: str) -> Drawing:
    block = PanelBlock(bottom=MARGIN)
    inner = width - 2 * MARGIN
    paragraph(block, about, MARGIN, inner, TEXT_SIZE * 1.2, bold=True)
    for row in rows:
        block.bottom += TEXT_SIZE
        _row(block, row, inner)
    return Drawing(width, block.bottom + MARGIN, tuple(block.marks), about)


def _row(block: PanelBlock, row: ScatterRow, inner: float) -> None:
    points = [point for panel in row.panels for point in panel.points]
    kinds = tuple(dict.fromkeys(point.kind for point in points))
    xs = _axis(point.x for point in points)
    ys = _axis(edge for p in points for edge in (p.y - p.error, p.y + p.error))
    columns = columns_for(len(row.panels), inner, _PANEL)
    wide = (inner - _GAP * (columns - 1)) / columns
    for start in range(0, len(row.panels), columns):
        top = block.bottom + (_GAP if start else 0.0)
        shown = row.panels[start : start + columns]
        heads = []
        for number, panel in enumerate(shown):
            head = PanelBlock(bottom=top)
            left = MARGIN + number * (wide + _GAP)
            paragraph(head, panel.title, left, wide, TEXT_SIZE, bold=True)
            paragraph(head, panel.note, left, wide, TEXT_SIZE, QUIET)
            block.marks += head.marks
            heads.append(head.bottom)
        level = max(heads) + 2
        for number, panel in enumerate(shown):
            left = MARGIN + number * (wide + _GAP)
            chart = _Chart(xs, ys, (left, level, wide))
            chart.draw(block, row, panel.points, kinds)
    _legend(block, kinds, inner)


class _Chart:
    """A panel's axes and dots.

    Args:
        xs: Ticks of the horizontal axis; the first and the last are its ends.
        ys: Ticks of the vertical axis.
        at: Left, top and width, in points.
    """

    def __init__(
        self, xs: Sequence[float], ys: Sequence[float], at: tuple[float, float, float]
    ) -> None:
        left, top, wide = at
        self._xs, self._ys = xs, ys
        self._named = [(x, _number(x)) for x in xs], [(y, _number(y)) for y in ys]
        margin = max(text_width(name, TEXT_SIZE) for _, name in self._named[1]) + 4
        head = TEXT_SIZE * 1.6
        side = wide - margin
        self._corner = (left, top)
        # Leave a margin for dots at the ends of the axes.
        self._area = (left + margin, top + head, side, side * 0.8)

    def at(self, x: float, y: float) -> XY:
        """Return the position of a dot."""
        left, top, wide, high = self._area
        across = (x - self._xs[0]) / (self._xs[-1] - self._xs[0])
        up = (y - self._ys[0]) / (self._ys[-1] - self._ys[0])
        return (
            left + wide * (_PAD + across * (1 - 2 * _PAD)),
            top + high * (1 - _PAD - up * (1 - 2 * _PAD)),
        )

    def draw(
        self, block: PanelBlock, row: ScatterRow, points: Sequence[Dot], kinds: Sequence[str]
    ) -> None:
        """Append the panel to a block."""
        left, top, wide, high = self._area
        bottom = top + high
        marks: list[Drawn] = [Rectangle(left, top, wide, high, "#ffffff", mix(PAPER, INK, 0.35))]
        lines = [
            ((self.at(x, self._ys[0])[0], bottom), (self.at(x, self._ys[0])[0], bottom + 2))
            for x in self._xs
        ]
        lines += [
            ((left - 2, self.at(self._xs[0], y)[1]), (left, self.at(self._xs[0], y)[1]))
            for y in self._ys
        ]
        marks.append(Lines(tuple(lines), mix(PAPER, INK, 0.5), 0.4))
        base = bottom + 3 + ASCENT * TEXT_SIZE
        end = -math.inf
        for x, name in self._named[0]:
            label = Text(self.at(x, 0)[0], base, name, TEXT_SIZE, QUIET, anchor="middle")
            if label.left > end + 2:
                marks.append(label)
                end = label.left + label.width
        for y, name in self._named[1]:
            middle = self.at(0, y)[1] + ASCENT * TEXT_SIZE * 0.48
            marks.append(Text(left - 3, middle, name, TEXT_SIZE, QUIET, anchor="end"))
        above = self._corner[1] + ASCENT * TEXT_SIZE
        marks.append(Text(self._corner[0], above, row.up, TEXT_SIZE, QUIET))
        across = base + TEXT_SIZE * _LINE
        marks.append(Text(left + wide, across, row.across, TEXT_SIZE, QUIET, anchor="end"))
        bars = tuple(
            (self.at(p.x, p.y - p.error), self.at(p.x, p.y + p.error)) for p in points if p.error
        )
        if bars:
            marks.append(Lines(bars, mix(PAPER, INK, 0.25), 0.4))
        for point in points:
            colour = _colour(kinds, point.kind)
            marks.append(Circle(*self.at(point.x, point.y), _DOT, colour, PAPER, 0.3))
        block.marks += marks
        block.bottom = max(block.bottom, across + TEXT_SIZE * 0.5)


def _legend(block: PanelBlock, kinds: Sequence[str], inner: float) -> None:
    x, top = MARGIN, block.bottom + 2
    for kind in kinds:
        taken = 2 * _DOT + 4 + text_width(kind, TEXT_SIZE)
        if x > MARGIN and x + taken > MARGIN + inner:
            x, top = MARGIN, top + TEXT_SIZE * _LINE
        middle = top + TEXT_SIZE * 0.5
        block.marks.append(Circle(x + _DOT, middle, _DOT, _colour(kinds, kind), PAPER, 0.3))
        base = top + ASCENT * TEXT_SIZE
        block.marks.append(Text(x + 2 * _DOT + 3, base, kind, TEXT_SIZE, INK))
        x += taken + TEXT_SIZE * 1.5
    block.bottom = top + TEXT_SIZE * _LINE


def _colour(kinds: Sequence[str], kind: str) -> str:
    return next(itertools.islice(itertools.cycle(AGENT_COLOURS), kinds.index(kind), None))


def _axis(values: Iterable[float]) -> tuple[float, ...]:
    """Return ticks at round numbers that enclose all values."""
    numbers = list(values)
    low, high = min(numbers), max(numbers)
    # Equal values still need an axis of some length.
    least = (high - low or abs(high) or 1.0) / _TICKS
    power = 10.0 ** math.floor(math.log10(least))
    step = next(power * n for n in (1, 2, 5, 10) if power * n >= least * 0.999)
    first, last = math.floor(low / step + 1e-9), math.ceil(high / step - 1e-9)
    return tuple(number * step for number in range(first, max(last, first + 1) + 1))


def _number(value: float) -> str:
    return f"{round(value, 9):g}".replace("-", "\u2212")
