"""HTML page of a study: its figure, summary, rows, and cells without a result."""

from collections.abc import Iterator, Mapping, Sequence
from importlib.resources import files
from typing import Any

from jinja2 import Environment, StrictUndefined

from beliefnest.errors import UnknownNameError
from beliefnest.scenarios.judging import OUTCOMES
from beliefnest.studies.accuracy_figure import plot_accuracy, svg_of
from beliefnest.studies.allocation import PARTICIPANT
from beliefnest.studies.copies import text_of_copies
from beliefnest.studies.counting import Pairs
from beliefnest.studies.study_record import StudyRecord
from beliefnest.studies.table import CellKind, variation_columns
from beliefnest.world.texts import visible
from beliefnest.world.words import counted

_MOST_ROWS = 2_000


def page_text(result: StudyRecord, by: Sequence[str]) -> str:
    """Return the page; the same study gives the same text.

    Args:
        result: Results of the study.
        by: Columns of the summary.
    """
    plan, rows, kind = result.plan, result.rows, result.kind
    table = kind.table
    groups = result.counted(by)
    people = len({row[PARTICIPANT] for row in rows if row.get(PARTICIPANT)})
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True)
    environment.filters["percent"] = _percent
    environment.filters["number"] = _number
    environment.filters["text_of_copies"] = text_of_copies
    template = environment.from_string(
        (files("beliefnest.studies") / "page.html.jinja").read_text(encoding="utf-8")
    )
    text = template.render(
        kind=kind.name,
        subjects=plan[f"{kind.subject}s"],
        players=_players(plan, kind) + (f"; {counted(people, 'participant')}" if people else ""),
        plan=plan,
        by=by,
        groups=groups,
        guessed=any(group["chance"] is not None for group in groups),
        means=[name for name in table.means if any(each[name] is not None for each in groups)],
        figure=_figure(groups, by),
        differences=list(_differences(result)),
        columns=[*(each.name for each in table.first), *variation_columns(plan), *table.shown],
        rows=rows[:_MOST_ROWS],
        left_out=max(0, len(rows) - _MOST_ROWS),
        variations=len({row["variation"] for row in rows}),
        copies=sum(row["copy_of"] is not None for row in rows),
        people=people,
        failed=[row for row in rows if row["cell"] in result.failed],
        outcomes=[n for n in OUTCOMES[1:] if n == "wrong" or any(g[n] for g in groups)],
    )
    return visible(text)


def _differences(result: StudyRecord) -> Iterator[tuple[str, str, Pairs]]:
    """Yield column, group and pairs of each comparison: overall, and in each task or scenario."""
    table = result.kind.table
    whole = table.groups[0]
    several = len({row[whole] for row in result.rows}) > 1
    for column in table.compared:
        apart = result.apart(column)
        for by in (apart, (whole, *apart)) if several else (apart,):
            for values, pairs in result.paired(column, by):
                words = [f"{name} {value}" for name, value in zip(by, values, strict=True)]
                if several and by == apart:
                    words.insert(0, f"every {whole}")
                yield column, ", ".join(words), pairs


def _players(plan: Mapping[str, Any], kind: CellKind) -> str:
    seeds = f"{len(plan['seeds'])} seeds of each" if "seeds" in plan else f"seed {plan['seed']}"
    return f"{kind.player[1]} {', '.join(plan[kind.players])}; {seeds}"


def _figure(groups: Sequence[Mapping[str, Any]], by: Sequence[str]) -> str:
    """Return the figure as an SVG element, without the XML prolog; empty without matplotlib."""
    along = [name for name in by if len({group[name] for group in groups}) > 1] or by[:1]
    try:
        drawn = svg_of(plot_accuracy(groups, along))
    except UnknownNameError:
        return ""
    return drawn[drawn.index("<svg") :]


def _percent(share: float | None) -> str:
    return "-" if share is None else f"{share:.1%}"


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"
