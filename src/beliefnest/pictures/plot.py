"""Plot of beliefs over time: a row for each simulator, a band for each value it held."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

import msgspec

from beliefnest.pictures import icons
from beliefnest.pictures.figure import MARGIN, TEXT_SIZE, Figure
from beliefnest.pictures.lettering import ASCENT, ellipsis, text_width, wrap
from beliefnest.pictures.marks import XY, Drawing, Lines, Rectangle, Text
from beliefnest.pictures.marks import DrawnMark as Drawn
from beliefnest.pictures.palette import INK, MARKS, PAPER, QUIET, Mark, colours_of, mix
from beliefnest.pictures.panel import PanelBlock, paragraph
from beliefnest.pictures.plan import hatching
from beliefnest.pictures.time_axis import NotedAct, TimeAxis

_HIGH = 15.0
_STEP = 21.0
_BALLOON = 2.1
_SHADES = (0.45, 0.2, 0.7)
_ABOVE = 5.5
"""Room above a row for balloons, in points."""


class Band(msgspec.Struct, frozen=True):
    """A value that was held for some time.

    Attributes:
        start: First tick.
        end: First tick at which it was no longer held; for the last band the end of the plot.
        words: Value in words; empty if it was unknown.
        false: True if it differed from reality.
    """

    start: int
    end: int
    words: str
    false: bool


class PlotRow(msgspec.Struct, frozen=True):
    """Values that one simulator held.

    Attributes:
        path: Belief path.
        bands: Bands in order of time, without gaps.
        told: Claims about the value that were heard there.
    """

    path: str
    bands: tuple[Band, ...]
    told: tuple["NotedClaim", ...] = ()


class NotedClaim(msgspec.Struct, frozen=True):
    """A claim that was heard.

    Attributes:
        tick: Tick of the utterance.
        believed: True if the claim was taken up.
    """

    tick: int
    believed: bool


def belief_plot(rows: Sequence[PlotRow], acts: Sequence[NotedAct], title: str) -> Figure:
    """Return the figure of beliefs over time."""
    return Figure(lambda width: _draw(rows, acts, title, width), 174.0, title)


def _draw(rows: Sequence[PlotRow], acts: Sequence[NotedAct], title: str, width: float) -> Drawing:
    head = PanelBlock(bottom=MARGIN)
    paragraph(head, title, MARGIN, width - 2 * MARGIN, TEXT_SIZE * 1.2, bold=True)
    # Put names beside their rows if that leaves most of the width to the rows, else above.
    widest = max(text_width(row.path, TEXT_SIZE, bold=True) for row in rows)
    beside = widest < width * 0.3
    left = MARGIN + (widest + 6 if beside else 0)
    chart = _Chart(rows, (left, width - MARGIN - 8))
    marks: list[Drawn] = list(head.marks)
    top = chart.axis.note(acts, head.bottom + 3, marks)
    first = top
    bands: list[Drawn] = []
    tops: list[float] = []
    above = _ABOVE if chart.told else 0.0
    for row in rows:
        top += above if beside else 0
        if beside:
            base = top + _HIGH / 2 + TEXT_SIZE * ASCENT * 0.48
            marks.append(Text(MARGIN, base, row.path, TEXT_SIZE, INK, bold=True))
        else:
            block = PanelBlock(bottom=top)
            paragraph(block, row.path, MARGIN, width - 2 * MARGIN, TEXT_SIZE, bold=True)
            marks += block.marks
            top = block.bottom + above
        bands += _bands(chart, row, top)
        tops.append(top)
        top += _STEP
    lines = tuple(
        ((chart.axis.x(act.tick), first - 1.5), (chart.axis.x(act.tick), top - 4)) for act in acts
    )
    marks += [mark for mark in bands if not isinstance(mark, Text)]
    if lines:
        marks.append(Lines(lines, INK, 0.4))
    marks += [mark for row, at in zip(rows, tops, strict=True) for mark in _told(chart, row, at)]
    # Draw words last, so that lines do not cross them out.
    marks += [mark for mark in bands if isinstance(mark, Text)]
    bottom = chart.axis.draw(top - 3, marks)
    bottom = _legend(chart, (MARGIN, bottom + 4), width - 2 * MARGIN, marks)
    return Drawing(width, bottom + MARGIN, tuple(marks), title)


class _Chart:
    """Scales of a plot: from ticks to x positions, from values to colours."""

    def __init__(self, rows: Sequence[PlotRow], span: XY) -> None:
        start = min(row.bands[0].start for row in rows)
        end = max(start + 1, *(row.bands[-1].end for row in rows))
        self.axis = TimeAxis(start, end, span)
        words = dict.fromkeys(band.words for row in rows for band in row.bands if band.words)
        self.fills = _fills(words)
        self.false = any(band.false for row in rows for band in row.bands)
        self.told = {each.believed for row in rows for each in row.told}
        self.unknown = any(not band.words for row in rows for band in row.bands)


def _fills(words: Iterable[str]) -> Mapping[str, str]:
    """Return a fill for each value; values that name the same colour get different shades."""
    before = Counter[str]()
    fills = {}
    for value, colour in colours_of(words).items():
        fills[value] = mix(PAPER, colour, _SHADES[before[colour] % len(_SHADES)])
        before[colour] += 1
    return fills


def _bands(chart: _Chart, row: PlotRow, top: float) -> list[Drawn]:
    marks: list[Drawn] = []
    for band in row.bands:
        x0, x1 = chart.axis.x(band.start), chart.axis.x(band.end)
        wide = max(x1 - x0, 0.8)
        marks += _swatch(chart, band.words, (x0, top), wide, _HIGH)
        inner = x0 + 3.0
        if band.false:
            colour = MARKS[Mark.FALSE].colour
            marks.append(Rectangle(x0, top, wide, _HIGH, None, colour, 1.1))
            if wide > 11:
                marks += icons.false_sign((x0 + 6, top + _HIGH / 2), 3.0)
                inner = x0 + 12.5
        words = band.words or MARKS[Mark.UNKNOWN].words
        if inner + text_width(words, TEXT_SIZE) < x1 - 2:
            base = top + _HIGH / 2 + TEXT_SIZE * ASCENT * 0.48
            halo = chart.fills.get(band.words, PAPER)
            marks.append(Text(inner, base, words, TEXT_SIZE, INK, halo=halo))
    return marks


def _told(chart: _Chart, row: PlotRow, top: float) -> list[Drawn]:
    """Return a balloon above the row for each claim that was heard."""
    marks: list[Drawn] = []
    for each in row.told:
        at = (chart.axis.x(each.tick), top - _BALLOON * 1.5)
        marks += icons.hearsay(at, _BALLOON, believed=each.believed)
    return marks


def _swatch(chart: _Chart, words: str, at: XY, wide: float, high: float) -> list[Drawn]:
    """Return the marks of a value; unknown values are hatched."""
    x, y = at
    if words:
        return [Rectangle(x, y, wide, high, chart.fills[words], mix(PAPER, INK, 0.5), 0.3)]
    lines = hatching((x, y, x + wide, y + high), 1, 3.0)
    area: list[Drawn] = [Rectangle(x, y, wide, high, PAPER, mix(PAPER, INK, 0.5), 0.3)]
    return [*area, Lines(lines, mix(PAPER, INK, 0.2), 0.4)] if lines else area


def _legend(chart: _Chart, at: XY, width: float, marks: list[Drawn]) -> float:
    x, top = at
    claims = {f"told, and{'' if each else ' not'} believed": each for each in chart.told}
    wide, high = 13.0, TEXT_SIZE * 1.15
    for words in [
        *chart.fills,
        *([""] if chart.unknown else []),
        *(["false"] if chart.false else []),
        *sorted(claims),
    ]:
        label = words or MARKS[Mark.UNKNOWN].words
        false = words == "false" and words not in chart.fills
        label = "false: reality is otherwise" if false else label
        label = " ".join(wrap(ellipsis(label, TEXT_SIZE, width - wide - 3), TEXT_SIZE, width))
        taken = wide + 3 + text_width(label, TEXT_SIZE)
        if x > at[0] and x + taken > at[0] + width:
            x, top = at[0], top + high * 1.5
        if false:
            colour = MARKS[Mark.FALSE].colour
            marks.append(Rectangle(x, top, wide, high, None, colour, 1.1))
            marks += icons.false_sign((x + wide / 2, top + high / 2), 2.6)
        elif words in claims and words not in chart.fills:
            at_sign = (x + wide / 2, top + high * 0.42)
            marks += icons.hearsay(at_sign, high * 0.4, believed=claims[words])
        else:
            marks += _swatch(chart, words, (x, top), wide, high)
        base = top + high / 2 + TEXT_SIZE * ASCENT * 0.48
        marks.append(Text(x + wide + 3, base, label, TEXT_SIZE, QUIET))
        x += taken + TEXT_SIZE * 1.5
    return top + high
