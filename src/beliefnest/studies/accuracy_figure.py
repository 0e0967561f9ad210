"""Figure of a study: accuracies with their intervals."""

import io
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from beliefnest.errors import MissingExtraError
from beliefnest.scenarios.judging import LOST, unanswered_words

if TYPE_CHECKING:  # matplotlib is optional, and imported when something is plotted.
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLOURS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#000000")
"""Palette of Okabe and Ito, which colour-blind people can distinguish."""

_LETTER = 0.085
"""Width of a letter in inches."""
_WIDEST = 1.6
"""Greatest spacing of bars in inches to make room for texts below; longer texts are rotated."""
_MM = 25.4
"""Millimetres per inch."""


def plot_accuracy(
    groups: Sequence[Mapping[str, Any]], by: Sequence[str], size: tuple[float, float] | None = None
) -> "Figure":
    """Draw bars from 0 to 1 with 95 % intervals, and dashed lines at the chance level of choices.

    If rows have no answer or no result, the caption below the axis tells how many of each outcome.
    The figure fits its texts into its size each time it is drawn, also after a change of size.

    Args:
        groups: Groups as `count_rows` returns them.
        by: Columns of the groups: the first is drawn along the axis, the others by colour.
        size: Width and height in millimetres; None: as much as bars and texts need.

    Raises:
        MissingExtraError: matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ModuleNotFoundError:
        raise MissingExtraError("figures of studies need matplotlib", "plot") from None
    from beliefnest.studies.fitting import Fitting

    judged = with_short_names([group for group in groups if group["accuracy"] is not None])
    along = list(dict.fromkeys(_told(group[by[0]]) for group in judged))
    colours = list(dict.fromkeys(_legend(group, by) for group in judged))
    title = ", ".join(by[1:])
    wanted = _inches(along, colours, title)
    figure = Figure(figsize=wanted if size is None else (size[0] / _MM, size[1] / _MM))
    axes = figure.add_subplot()
    width = 0.8 / max(1, len(colours))
    chances: list[tuple[float, float | None]] = []
    for number, name in enumerate(colours):
        own = [group for group in judged if _legend(group, by) == name]
        middles = [along.index(_told(g[by[0]])) + (number + 0.5) * width - 0.4 for g in own]
        heights = [group["accuracy"] for group in own]
        below = [max(0.0, group["accuracy"] - group["low"]) for group in own]
        above = [max(0.0, group["high"] - group["accuracy"]) for group in own]
        colour = COLOURS[number % len(COLOURS)]
        axes.bar(middles, heights, width * 0.9, color=colour, label=name or None)
        axes.errorbar(middles, heights, [below, above], fmt="none", ecolor="#333333", capsize=3)
        chances += zip(middles, (group.get("chance") for group in own), strict=True)
    _draw_chance(axes, chances, width, in_legend=len(colours) > 1)
    axes.set_xticks(range(len(along)), along)
    axes.set_xlabel("\n".join([by[0], *_not_answered(judged)]))
    axes.set_ylim(0, 1.02)
    axes.spines[["top", "right"]].set_visible(False)
    if len(colours) > 1:
        axes.legend(title=title, frameon=False)
    figure.set_layout_engine(Fitting(along))
    return figure


def _not_answered(groups: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the line of the caption about rows without an answer; empty: there are none."""
    counts = {name: sum(group.get(name) or 0 for group in groups) for name in LOST}
    reasons = unanswered_words(counts)
    if not reasons:
        return []
    return [f"not answered, of {sum(group['judged'] for group in groups)}: {reasons}"]


def _draw_chance(
    axes: "Axes", bars: Sequence[tuple[float, float | None]], width: float, *, in_legend: bool
) -> None:
    """Draw the accuracy of blind guesses at each bar, or one line if all have the same.

    Args:
        axes: The plot.
        bars: Middle of each bar on the axis, and its chance level; None: it has none.
        width: Width of a bar with the space around it.
        in_legend: True if the figure has a legend; otherwise the line is named at its end.
    """
    chances = [(middle, level) for middle, level in bars if level is not None]
    if not chances:
        return
    ends = [(middle - width / 2, middle + width / 2) for middle, _ in chances]
    levels = [level for _, level in chances]
    if len({round(level, 9) for level in levels}) == 1 and len(chances) == len(bars):
        ends = [(min(left for left, _ in ends), max(right for _, right in ends))]
    drawn = axes.hlines(
        levels[: len(ends)],
        [left for left, _ in ends],
        [right for _, right in ends],
        colors="#333333",
        linestyles="dashed",
        linewidths=1,
        label="chance level" if in_legend else "",
    )
    drawn.set_gid("chance")
    if not in_legend:
        axes.annotate("chance level", (ends[-1][1], levels[-1]), (3, 0), textcoords="offset points",
            va="center", fontsize=7)  # fmt: skip


def with_short_names(groups: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Return groups whose models have the shortest names that tell them apart.

    `openai:gpt-5-mini` becomes `gpt-5-mini`, and a path its last part.
    """
    names = list(dict.fromkeys(group["model"] for group in groups if group.get("model")))
    short = {name: name.rpartition(":")[2].rstrip("/").rpartition("/")[2] for name in names}
    clear = {name: each for name, each in short.items() if list(short.values()).count(each) == 1}
    return [
        {**group, "model": clear.get(group["model"], group["model"])} if "model" in group else group
        for group in groups
    ]


def _inches(along: Sequence[str], colours: Sequence[str], title: str) -> tuple[float, float]:
    """Return width and height of a figure with room for bars, texts below and the legend."""
    width = 0.6 + max(2.6, len(along) * _slot(along, colours))
    if len(colours) < 2:
        return width, 2.8
    return width + 0.7 + _LETTER * _longest([*colours, title]), max(2.8, 0.6 + 0.22 * len(colours))


def _slot(along: Sequence[str], colours: Sequence[str]) -> float:
    """Return the width of one group of bars along the axis, in inches."""
    return max(0.5 * max(1, len(colours)), min(_label(along), _WIDEST))


def _label(along: Sequence[str]) -> float:
    """Return the width of the longest text below bars, in inches."""
    return 0.2 + _LETTER * _longest(along)


def _longest(texts: Sequence[str]) -> int:
    return max(map(len, texts), default=0)


def _legend(group: Mapping[str, Any], by: Sequence[str]) -> str:
    return ", ".join(_told(group[name]) for name in by[1:])


def _told(value: Any) -> str:
    return "-" if value is None else str(value)


def svg_of(figure: "Figure") -> str:
    """Return a figure as SVG; the same figure gives the same text."""
    import matplotlib as mpl

    drawn = io.StringIO()
    with mpl.rc_context({"svg.hashsalt": "beliefnest", "svg.fonttype": "none"}):
        figure.savefig(drawn, format="svg", metadata={"Date": None, "Creator": None})
    return drawn.getvalue()
