"""Axis of ticks below plots, and the notes of acts above them."""

import math
from collections.abc import Sequence

import msgspec

from beliefnest.pictures.figure import TEXT_SIZE
from beliefnest.pictures.lettering import ASCENT, ellipsis, text_width
from beliefnest.pictures.marks import XY, Lines, Text
from beliefnest.pictures.marks import DrawnMark as Drawn
from beliefnest.pictures.palette import INK, QUIET

_ACT = TEXT_SIZE * 0.95


class NotedAct(msgspec.Struct, frozen=True):
    """An act that mattered.

    Attributes:
        tick: Tick of the act.
        words: Actor and act in words.
    """

    tick: int
    words: str


class TimeAxis(msgspec.Struct, frozen=True):
    """Scale from ticks to the width of a plot.

    Attributes:
        start: First tick.
        end: First tick after the plot.
        span: Left and right end, in points.
    """

    start: int
    end: int
    span: XY

    def x(self, tick: int) -> float:
        """Return the x position of a tick."""
        low, high = self.span
        return low + (high - low) * (tick - self.start) / (self.end - self.start)

    def draw(self, top: float, marks: list[Drawn]) -> float:
        """Add the axis with the numbers of its ticks, `end` excluded; return its lower end."""
        low, high = self.span
        widest = text_width(str(self.end), TEXT_SIZE)
        step = _round_step((self.end - self.start) / max(1.0, (high - low) / (widest * 2.2)))
        ticks = list(range(-(-self.start // step) * step, self.end, step))
        strokes = (
            ((low, top), (high, top)),
            *(((self.x(t), top), (self.x(t), top + 2)) for t in ticks),
        )
        marks.append(Lines(tuple(strokes), INK, 0.4))
        base = top + 3.5 + TEXT_SIZE * ASCENT
        marks += [Text(self.x(t), base, str(t), TEXT_SIZE, QUIET, anchor="middle") for t in ticks]
        marks.append(Text(high, base + TEXT_SIZE * 1.2, "tick", TEXT_SIZE, QUIET, anchor="end"))
        return base + TEXT_SIZE * 1.5

    def note(self, acts: Sequence[NotedAct], top: float, marks: list[Drawn]) -> float:
        """Add the acts in words and return the end.

        Each act goes to the first line where it overlaps no other.
        """
        ends: list[float] = []
        low, high = self.span
        for act in acts:
            words = ellipsis(act.words, _ACT, high - low)
            wide = text_width(words, _ACT)
            x = max(low, min(high - wide, self.x(act.tick) - wide / 2))
            lane = next((n for n, end in enumerate(ends) if end + 3 <= x), len(ends))
            if lane == len(ends):
                ends.append(0.0)
            ends[lane] = x + wide
            marks.append(Text(x, top + lane * _ACT * 1.3 + _ACT * ASCENT, words, _ACT, QUIET))
        return top + len(ends) * _ACT * 1.3 + 3


def _round_step(least: float) -> int:
    """Return the least of 1, 2, 5, 10, 20, ... that is not below a number."""
    power = 10 ** max(0, math.floor(math.log10(max(least, 1.0))))
    return next(int(power * n) for n in (1, 2, 5, 10) if power * n >= least or n == 10)
