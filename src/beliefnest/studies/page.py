"""The page of a study: its figure, its summary, its rows, and what has no result."""

from collections.abc import Mapping, Sequence
from importlib.resources import files
from typing import Any

from jinja2 import Environment, StrictUndefined

from beliefnest.errors import UnknownNameError
from beliefnest.studies.counting import Pairs, count_rows, paired_rows
from beliefnest.studies.plot import plot_accuracy, svg_of

__all__ = ["page_text"]

_ROWS = (
    *("probe", "path", "expected", "intended", "opened", "arrived", "answered"),
    *("outcome", "why_not", "ticks", "tokens"),
)
_MOST_ROWS = 2_000


def page_text(plan: Mapping[str, Any], rows: Sequence[Mapping[str, Any]], by: Sequence[str]) -> str:
    """The page, the same text for the same study.

    Args:
        plan: Of the study.
        rows: Its rows.
        by: Columns of the summary.
    """
    groups = count_rows(rows, by)
    varied = [name for name in (rows[0] if rows else {}) if name not in ("seed", "task")]
    first = varied[: varied.index("probe")] if "probe" in varied else varied
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True)
    environment.filters["percent"] = _percent
    template = environment.from_string(
        (files("beliefnest.studies") / "page.html.jinja").read_text(encoding="utf-8")
    )
    return template.render(
        plan=plan,
        by=by,
        groups=groups,
        figure=_figure(groups, by),
        differences=[
            (name, each)
            for name in ("condition", "model", "template")
            for each in _pairs(rows, name)
        ],
        columns=[*first, *_ROWS],
        rows=rows[:_MOST_ROWS],
        left_out=max(0, len(rows) - _MOST_ROWS),
        failed=[row for row in rows if row["outcome"] == "error"],
    )


def _figure(groups: Sequence[Mapping[str, Any]], by: Sequence[str]) -> str:
    """The figure as SVG, without what is said before it in a file; empty without matplotlib."""
    along = [name for name in by if len({group[name] for group in groups}) > 1] or by[:1]
    try:
        drawn = svg_of(plot_accuracy(groups, along))
    except UnknownNameError:
        return ""
    return drawn[drawn.index("<svg") :]


def _pairs(rows: Sequence[Mapping[str, Any]], column: str) -> list[Pairs]:
    return paired_rows(rows, column)


def _percent(share: float | None) -> str:
    return "-" if share is None else f"{share:.1%}"
