"""Plot of posteriors over time, with a panel for each question."""

import itertools
from collections.abc import Mapping, Sequence

import msgspec

from beliefnest.pictures.bars import number_text
from beliefnest.pictures.figure import MARGIN, TEXT_SIZE, Figure
from beliefnest.pictures.lettering import ASCENT, ellipsis, text_width
from beliefnest.pictures.marks import XY, Drawing, Lines, Polygon, Rectangle, Text
from beliefnest.pictures.marks import DrawnMark as Drawn
from beliefnest.pictures.palette import INK, PAPER, QUIET, mix
from beliefnest.pictures.panel import PanelBlock, paragraph
from beliefnest.pictures.time_axis import NotedAct, TimeAxis

_HIGH = 46.0
"""Least height of a panel, in points."""
_LINE = TEXT_SIZE * 1.22
_SWATCH = 11.0
_DASHES = (0.0, 4.0, 1.4, 7.0)
_MOST_KEYS = 8


class PosteriorPanel(msgspec.Struct, frozen=True):
    """Curves or shares over time.

    Attributes:
        title: Question that they answer.
        low: Lower end of the scale.
        high: Upper end of the scale.
        ticks: Ticks at which values change.
        series: Values from each tick on, by name.
        colours: Colour of each series.
        stacked: True if the values are shares of a whole, drawn on top of each other.
        ordered: True if the names are numbers, shaded from light to dark.
    """

    title: str
    low: float
    high: float
    ticks: tuple[int, ...]
    series: Mapping[str, tuple[float, ...]]
    colours: Mapping[str, str]
    stacked: bool = False
    ordered: bool = False


def posterior_plot(
    panels: Sequence[PosteriorPanel], end: int, notes: Sequence[NotedAct], title: str
) -> Figure:
    """Return the figure of a posterior over time.

    Args:
        panels: Panels from the top downwards, all with the same first tick.
        end: First tick after the plot.
        notes: Acts to mark in all panels.
        title: Title of the figure.
    """
    return Figure(lambda width: _draw(panels, end, notes, title, width), 174.0, title)


def _draw(
    panels: Sequence[PosteriorPanel], end: int, notes: Sequence[NotedAct], title: str, width: float
) -> Drawing:
    head = PanelBlock(bottom=MARGIN)
    paragraph(head, title, MARGIN, width - 2 * MARGIN, TEXT_SIZE * 1.2, bold=True)
    marks: list[Drawn] = list(head.marks)
    scales = [number_text(value) for panel in panels for value in (panel.low, panel.high)]
    left = MARGIN + max(text_width(text, TEXT_SIZE) for text in scales) + 4
    key_texts = [_key_text(panel, name) for panel in panels for name in _keyed(panel)]
    keys = _SWATCH + 4 + max(text_width(text, TEXT_SIZE) for text in key_texts)
    keys = min(keys, width * 0.32)
    span = (left, width - MARGIN - keys - 4)
    axis = TimeAxis(panels[0].ticks[0], max(end, panels[0].ticks[0] + 1), span)
    top = axis.note(notes, head.bottom + 2, marks)
    first, bottom = top, top
    drawn: list[Drawn] = []
    titles: list[Drawn] = []
    for panel in panels:
        words = ellipsis(panel.title, TEXT_SIZE, width - MARGIN - left, bold=True)
        base = top + ASCENT * TEXT_SIZE
        titles.append(Text(left, base, words, TEXT_SIZE, INK, bold=True, halo=PAPER))
        top += _LINE + 2
        high = max(_HIGH, len(_keyed(panel)) * _LINE)
        drawn += _Panel(panel, axis, (top, top + high), _looks(panel)).marks(keys)
        bottom = top + high
        top = bottom + 7
    marks += drawn
    if notes:
        lines = tuple(((axis.x(n.tick), first - 1.5), (axis.x(n.tick), bottom)) for n in notes)
        marks.append(Lines(lines, INK, 0.4))
    # Draw titles last, so that lines do not cross them out.
    marks += titles
    return Drawing(width, axis.draw(bottom + 2, marks) + MARGIN, tuple(marks), title)


class _Look(msgspec.Struct, frozen=True):
    colour: str
    dash: float


def _looks(panel: PosteriorPanel) -> dict[str, _Look]:
    """Return the look of each series."""
    return {
        name: _Look(panel.colours[name], 0.0 if panel.ordered else _DASHES[number % len(_DASHES)])
        for number, name in enumerate(panel.series)
    }


def _keyed(panel: PosteriorPanel) -> list[str]:
    """Return the series that get a name beside the panel: all, or an even choice of many."""
    names = list(panel.series)
    if len(names) <= _MOST_KEYS:
        return names
    places = {round(n * (len(names) - 1) / (_MOST_KEYS - 1)) for n in range(_MOST_KEYS)}
    return [names[place] for place in sorted(places)]


def _key_text(panel: PosteriorPanel, name: str) -> str:
    last = panel.series[name][-1]
    value = f"{100 * last:.0f} %" if panel.stacked else number_text(last, digits=1)
    return f"{name}: {value}"


class _Panel(msgspec.Struct, frozen=True):
    """A panel with its place on the page."""

    panel: PosteriorPanel
    axis: TimeAxis
    rows: XY
    looks: Mapping[str, _Look]

    def _y(self, value: float) -> float:
        top, bottom = self.rows
        low, high = self.panel.low, self.panel.high
        return bottom - (bottom - top) * (value - low) / (high - low)

    def marks(self, keys: float) -> list[Drawn]:
        """Return all marks; `keys` is the width for names beside the panel."""
        (left, right), (top, bottom) = self.axis.span, self.rows
        marks: list[Drawn] = [Rectangle(left, top, right - left, bottom - top, "#ffffff")]
        marks += self._areas() if self.panel.stacked else self._curves()
        edge = mix(PAPER, INK, 0.45)
        marks.append(Rectangle(left, top, right - left, bottom - top, None, edge, 0.4))
        for value, y in ((self.panel.high, top), (self.panel.low, bottom)):
            base = y + TEXT_SIZE * ASCENT * 0.48
            text = number_text(value)
            marks.append(Text(left - 3, base, text, TEXT_SIZE, QUIET, anchor="end"))
        return [*marks, *self._keys(right + 4, keys)]

    def _steps(self, values: Sequence[float]) -> list[XY]:
        """Return the corners of a curve that holds each value until the next tick."""
        places = [self.axis.x(tick) for tick in (*self.panel.ticks, self.axis.end)]
        return [
            point
            for (x0, x1), value in zip(itertools.pairwise(places), values, strict=True)
            for point in ((x0, self._y(value)), (x1, self._y(value)))
        ]

    def _curves(self) -> list[Drawn]:
        marks: list[Drawn] = []
        low, high = self.panel.low, self.panel.high
        if low < 0 < high:
            left, right = self.axis.span
            zero = (((left, self._y(0)), (right, self._y(0))),)
            marks.append(Lines(zero, mix(PAPER, INK, 0.25), 0.3))
        for name, values in self.panel.series.items():
            look, points = self.looks[name], tuple(self._steps(values))
            marks.append(
                Polygon(points, None, look.colour, 1.5, look.dash, closed=False, role="line")
            )
        return marks

    def _areas(self) -> list[Drawn]:
        marks: list[Drawn] = []
        below = [0.0] * len(self.panel.ticks)
        for name, values in self.panel.series.items():
            above = [min(1.0, a + b) for a, b in zip(below, values, strict=True)]
            corners = (*self._steps(above), *reversed(self._steps(below)))
            fill = self.looks[name].colour if self.panel.ordered else self._soft(name)
            marks.append(Polygon(corners, fill, PAPER, 0.5, role="area"))
            below = above
        return marks

    def _soft(self, name: str) -> str:
        return mix(PAPER, self.looks[name].colour, 0.72)

    def _keys(self, x: float, width: float) -> list[Drawn]:
        """Return swatches and names to the right of the panel, each near the end of its series."""
        # Stacked shares grow upwards, so list the names in reverse order.
        names = _keyed(self.panel)[::-1]
        if not self.panel.stacked:
            names.sort(key=self._level)
        marks: list[Drawn] = []
        levels = _spread([self._level(name) for name in names], self.rows, _LINE)
        for name, y in zip(names, levels, strict=True):
            look = self.looks[name]
            if self.panel.stacked:
                fill = look.colour if self.panel.ordered else self._soft(name)
                edge = mix(PAPER, INK, 0.5)
                marks.append(Rectangle(x, y - 2.6, _SWATCH - 3, 5.2, fill, edge, 0.3))
            else:
                ends = ((x, y), (x + _SWATCH - 1, y))
                marks.append(
                    Polygon(ends, None, look.colour, 1.5, look.dash, closed=False, role="line")
                )
            words = ellipsis(_key_text(self.panel, name), TEXT_SIZE, width - _SWATCH - 2)
            base = y + TEXT_SIZE * ASCENT * 0.48
            marks.append(Text(x + _SWATCH + 1, base, words, TEXT_SIZE, INK))
        return marks

    def _level(self, name: str) -> float:
        """Return the y at which a series ends."""
        last = self.panel.series[name][-1]
        if not self.panel.stacked:
            return self._y(last)
        names = list(self.panel.series)
        below = sum(self.panel.series[other][-1] for other in names[: names.index(name)])
        return self._y(below + last / 2)


def _spread(levels: Sequence[float], rows: XY, step: float) -> list[float]:
    """Return ascending positions, at least a step apart and within the rows."""
    low, high = rows[0] + step / 2, rows[1] - step / 2
    placed: list[float] = []
    for level in levels:
        placed.append(max(level, low if not placed else placed[-1] + step))
    for number in range(len(placed) - 1, -1, -1):
        placed[number] = min(placed[number], high - step * (len(placed) - 1 - number))
    return placed
