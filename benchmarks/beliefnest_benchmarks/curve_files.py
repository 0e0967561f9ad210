"""Files of curves: points as CSV, drawings as SVG. Drawing needs matplotlib."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from beliefnest.errors import InputError, MissingExtraError
from beliefnest.files import make_folder, replace_file
from beliefnest.studies.accuracy_figure import COLOURS, svg_of
from beliefnest_benchmarks.curves import Aim, Curve, Point

if TYPE_CHECKING:  # matplotlib is optional, and imported when something is drawn.
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["checked_folder", "drawn", "save_curve"]

_INCHES = (10.0, 3.6)
_TEXT = 8
"""Size of texts in points."""
_LINE = 1.25 * _TEXT
"""Least distance in points between the texts at the ends of lines."""
_DOTS = 10
"""Greatest number of points that get a dot and a tick each."""
_GREY = "#666666"


def checked_folder(folder: Path) -> Path:
    """Make the folder for curves, and check that they can be drawn, before anything is measured.

    Raises:
        InputError: The folder cannot be made or written.
        MissingExtraError: matplotlib is not installed.
    """
    try:
        import matplotlib  # noqa: F401
    except ModuleNotFoundError:
        raise MissingExtraError("curves need matplotlib", "plot") from None
    make_folder(folder)
    return folder


def save_curve(curve: Curve, points: Sequence[Point], folder: Path) -> Sequence[Path]:
    """Write a curve as CSV and as SVG, and return the two files.

    Raises:
        InputError: A file cannot be written.
    """
    table, picture = folder / f"{curve.name}.csv", folder / f"{curve.name}.svg"
    try:
        written = io.StringIO(newline="")
        rows = csv.writer(written, lineterminator="\n")
        rows.writerow(("series", curve.x, curve.ms, curve.mb))
        rows.writerows((p.series, f"{p.x:g}", f"{p.ms:.4g}", f"{p.mb:.4g}") for p in points)
        replace_file(table, written.getvalue())
        replace_file(picture, svg_of(drawn(curve, points)))
    except OSError as error:
        raise InputError(
            f"--curves: {error.filename} cannot be written: {error.strerror}"
        ) from None
    return table, picture


def drawn(curve: Curve, points: Sequence[Point]) -> "Figure":
    """Draw the points of a curve as two plots, milliseconds and megabytes, with its aims."""
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    figure = Figure(figsize=_INCHES, layout=ConstrainedLayoutEngine(w_pad=0.1))
    figure.suptitle(curve.title, x=0.01, ha="left", fontsize=_TEXT + 2)
    for number, (column, label) in enumerate((("ms", curve.ms), ("mb", curve.mb))):
        axes = figure.add_subplot(1, 2, number + 1)
        axes.set_xlabel(curve.x, fontsize=_TEXT)
        axes.set_ylabel(label, fontsize=_TEXT)
        axes.tick_params(labelsize=_TEXT)
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(color="#dddddd", linewidth=0.5)
        _plot(axes, curve, points, column)
    return figure


def _plot(axes: "Axes", curve: Curve, points: Sequence[Point], column: str) -> None:
    """Draw the lines and the aims of one plot, and the axes that fit them."""
    ends = []
    for number, series in enumerate(curve.series):
        own = [point for point in points if point.series == series.name]
        if not own:
            continue
        colour, values = COLOURS[number % len(COLOURS)], [getattr(each, column) for each in own]
        dot = "o" if len(own) <= _DOTS else ""
        axes.plot([each.x for each in own], values, dot + "-", color=colour, ms=3.5, lw=1.3)
        ends.append((own[-1].x, values[-1], series.name, colour))
    aims = [aim for aim in curve.aims if aim.column == column]
    values = [_value(aim, points) for aim in aims]
    _scale(axes, curve, points, [*values, *(getattr(each, column) for each in points)])
    for aim, value in zip(aims, values, strict=True):
        _draw_aim(axes, aim, value)
    _name_ends(axes, ends)


def _value(aim: Aim, points: Sequence[Point]) -> float:
    if aim.of_first is None:
        return aim.value
    first = next(point for point in points if point.series == aim.of_first)
    return aim.value * float(getattr(first, aim.column))


def _scale(axes: "Axes", curve: Curve, points: Sequence[Point], values: Sequence[float]) -> None:
    """Set scales and limits so that all values are inside."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator

    plain = FuncFormatter(lambda value, _: f"{value:,g}")
    low, high = min(values), max(values)
    places = sorted({point.x for point in points})
    if "x" in curve.log:
        axes.set_xscale("log", base=2)
        axes.xaxis.set_minor_locator(NullLocator())
    if len(places) <= _DOTS:
        axes.set_xticks(places)
    else:
        axes.set_xlim(0, places[-1])
    axes.xaxis.set_major_formatter(plain)
    if "y" in curve.log:
        axes.set_yscale("log")
        axes.yaxis.set_major_locator(LogLocator(subs=[1, 2, 5]))
        axes.yaxis.set_minor_formatter(NullFormatter())
        # A narrower range would have too few ticks.
        axes.set_ylim(min(0.8 * low, high / 8), 1.4 * high)
    else:
        axes.set_ylim(min(0.0, low), 1.08 * high)
    axes.yaxis.set_major_formatter(plain)


def _draw_aim(axes: "Axes", aim: Aim, value: float) -> None:
    """Draw an aim as a dashed line, or as a short one at the only place where it holds."""
    if aim.at is None:
        axes.axhline(value, color=_GREY, lw=1, ls="--")
        places = (0.0, value), ("axes fraction", "data")
        shift, side = (4.0, 3.0), "left"
    else:
        axes.plot([aim.at], [value], marker="_", ms=22, mew=1.5, color=_GREY)
        places = (aim.at, value), ("data", "data")
        shift, side = (-13.0, 0.0), "right"
    axes.annotate(
        f"aim: {aim.text}",
        places[0],
        shift,
        xycoords=places[1],
        textcoords="offset points",
        ha=side,
        va="bottom" if aim.at is None else "center",
        fontsize=_TEXT,
        color=_GREY,
    )


def _name_ends(axes: "Axes", ends: Sequence[tuple[float, float, str, str]]) -> None:
    """Write the name of each line beside its end; names move apart where they would overlap."""
    if len(ends) < 2:
        return
    points = 72 / axes.get_figure(root=True).dpi  # type: ignore[union-attr]
    heights = [axes.transData.transform((x, y))[1] * points for x, y, _, _ in ends]
    below = -1e9
    for number in sorted(range(len(ends)), key=heights.__getitem__):
        x, y, name, colour = ends[number]
        height = max(heights[number], below + _LINE)
        below = height
        axes.annotate(
            name,
            (x, y),
            (6, height - heights[number]),
            textcoords="offset points",
            va="center",
            fontsize=_TEXT,
            color=colour,
            annotation_clip=False,
        )
