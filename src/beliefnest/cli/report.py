"""Report of a run: the object that `--json` prints, and the table."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich import box
from rich.console import Console
from rich.markup import escape
from rich.measure import Measurement
from rich.table import Table

from beliefnest.belief.plain import state_json
from beliefnest.belief.view import State
from beliefnest.cli.pictures import container_name, point_text
from beliefnest.cli.text import printable
from beliefnest.llm.messages import Usage
from beliefnest.scenarios.expected import (
    Arrives,
    Believes,
    Expected,
    Hears,
    Holds,
    Infers,
    Intends,
    Is,
    Judge,
    Opens,
    Reads,
    Says,
    Takes,
)
from beliefnest.scenarios.inferring import means_text
from beliefnest.scenarios.judging import OUTCOMES, places_of
from beliefnest.scenarios.naming import items_text
from beliefnest.scenarios.outcome import ExpectationOutcome, Outcome, ProbeOutcome
from beliefnest.scenarios.records import expectation_json, probe_json, usage_json
from beliefnest.scenarios.scenario import Scenario
from beliefnest.world.signs import sign_words
from beliefnest.world.values import Placements, Point, Position

__all__ = [
    "OutcomeRow",
    "cost_text",
    "outcome_json",
    "outcome_table",
    "placed_lines",
    "report_json",
    "usage_json",
]

_WIDEST = 6


def outcome_json(
    outcome: Outcome, model: str, run_dir: Path, accounts: Sequence[Mapping[str, object]] = ()
) -> dict[str, object]:
    """Return the result of one condition as plain data.

    Args:
        outcome: Outcome of the condition.
        model: Name of the model that answered.
        run_dir: Folder of the condition.
        accounts: Further facts to add to each probe; empty: none.
    """
    probes = [probe_json(each, run_dir) for each in outcome.probes]
    for probe, account in zip(probes, accounts, strict=False):
        probe.update(account)
    return {
        "condition": outcome.scenario.condition,
        "model": model,
        "seed": outcome.seed,
        "ok": outcome.ok,
        "ticks": outcome.ticks,
        "seconds": round(outcome.seconds, 3),
        "reality": state_json(outcome.reality),
        "beliefs": {path: state_json(state) for path, state in outcome.beliefs.items()},
        "expectations": [expectation_json(each) for each in outcome.expectations],
        "probes": probes,
        "failures": list(outcome.failures),
        "usage": usage_json(outcome.usage),
        "run_dir": str(run_dir),
        "table": {"cells": _cells(outcome), "notes": _notes(outcome)},
    }


def report_json(
    scenario: str,
    settings: Mapping[str, object],
    status: str,
    runs: Sequence[Mapping[str, Any]],
    failures: Sequence[Mapping[str, Any]],
) -> dict[str, object]:
    """Return the whole report.

    Args:
        scenario: Name of the scenario.
        settings: Settings of the run, including `world` and `models`.
        status: `running`, `done`, `failed` or `interrupted`.
        runs: Result of each condition, as `outcome_json` returns it.
        failures: Conditions without a result because a model failed, and the reasons.
    """
    models = settings["models"]
    assert isinstance(models, Sequence)
    return {
        "scenario": scenario,
        "world": settings["world"],
        "model": ",".join(models),
        "status": status,
        "settings": settings,
        "runs": list(runs),
        "failures": list(failures),
        "outcomes": _counted(runs, failures),
    }


def _counted(
    runs: Sequence[Mapping[str, Any]], failures: Sequence[Mapping[str, Any]]
) -> dict[str, int]:
    """Return the number of probes by outcome; a run without a result counts as one."""
    found = Counter(probe.get("outcome") for run in runs for probe in run["probes"])
    found.update(failure.get("outcome") for failure in failures)
    return {outcome: found[outcome] for outcome in OUTCOMES}


@dataclass(frozen=True, slots=True)
class OutcomeRow:
    """Row of the table for one condition, read from its result as `outcome_json` wrote it.

    Attributes:
        scenario: Scenario with the condition applied.
        cells: Text of each expectation and probe, by heading.
        notes: A line for each unmet expectation and each failed program.
        failures: Unmet expectations.
        usage: Tokens and cost of models.
        ticks: Length of the run in ticks.
        seconds: Wall time in seconds.
    """

    scenario: Scenario
    cells: Mapping[str, str]
    notes: Sequence[str]
    failures: Sequence[str]
    usage: Usage
    ticks: int
    seconds: float

    @classmethod
    def of(cls, scenario: Scenario, result: Mapping[str, Any]) -> "OutcomeRow | None":
        """Return the row of a result; None if an earlier version wrote it without these texts."""
        if "table" not in result:
            return None
        return cls(
            scenario,
            result["table"]["cells"],
            result["table"]["notes"],
            result["failures"],
            Usage(**result["usage"]),
            result["ticks"],
            result["seconds"],
        )


def outcome_table(rows: Sequence[OutcomeRow], console: Console) -> Table:
    """Return a table of beliefs and predictions, which says if they are as expected.

    The table has one row for each condition. If rows are too wide for the console, it has one
    column for each condition.
    """
    wide = _wide_table(rows)
    # Rich limits the measured width to `max_width`.
    least = Measurement.get(console, console.options.update(max_width=10_000), wide).minimum
    if len(_headings(rows)) > _WIDEST or least > console.width:
        return _tall_table(rows)
    return wide


def _wide_table(rows: Sequence[OutcomeRow]) -> Table:
    scenario = rows[0].scenario
    table = Table(title=scenario.name, title_justify="left", box=box.SIMPLE_HEAVY)
    if scenario.conditions:
        table.add_column("condition", justify="right")
    for heading in _headings(rows):
        table.add_column(heading)
    table.add_column(f"as {scenario.reported_by or 'expected'}{_verb(scenario)}")
    asked = any(row.usage.requests for row in rows)
    for heading in ("tokens", "cost") if asked else ():
        table.add_column(heading, justify="right")
    table.add_column("ticks", justify="right")
    table.add_column("seconds", justify="right")
    for row in rows:
        cells = [str(row.scenario.condition)] if scenario.conditions else []
        cells += [row.cells.get(heading, "") for heading in _headings(rows)]
        spent = [f"{row.usage.tokens:,}", cost_text(row.usage.cost)] if asked else []
        table.add_row(*cells, _verdict(row), *spent, str(row.ticks), f"{row.seconds:.2f}")
    return table


def _tall_table(rows: Sequence[OutcomeRow]) -> Table:
    scenario = rows[0].scenario
    table = Table(title=scenario.name, title_justify="left", box=box.SIMPLE_HEAVY)
    table.add_column("condition" if scenario.conditions else "")
    for row in rows:
        number = row.scenario.condition
        table.add_column("" if number is None else str(number))
    for heading in _headings(rows):
        table.add_row(heading, *(row.cells.get(heading, "") for row in rows))
    verdicts = [_verdict(row) for row in rows]
    table.add_row(f"as {scenario.reported_by or 'expected'}{_verb(scenario)}", *verdicts)
    if any(row.usage.requests for row in rows):
        table.add_row("tokens", *(f"{row.usage.tokens:,}" for row in rows))
        table.add_row("cost", *(cost_text(row.usage.cost) for row in rows))
    table.add_row("ticks", *(str(row.ticks) for row in rows))
    table.add_row("seconds", *(f"{row.seconds:.2f}" for row in rows))
    return table


def cost_text(cost: float | None) -> str:
    """Return a cost in US dollars as text."""
    return "not known" if cost is None else f"${cost:.4f}"


def placed_lines(placed: Placements) -> list[str]:
    """Return a line for each thing that a body had to place otherwise than believed."""
    return [_placed_line(key, start, end) for key, (start, end) in placed.items()]


def _placed_line(key: str | Position, start: Point | str | None, end: Point | str) -> str:
    if isinstance(start, tuple) and isinstance(end, tuple):
        return f"{key} begins at {point_text(end)}: {point_text(start)} is not possible"
    believed = "an unknown block" if start is None else start
    return f"a {end} stands at {key} instead of {believed}, to hold the believed contents"


def _verb(scenario: Scenario) -> str:
    return " reports" if scenario.reported_by else ""


def _verdict(row: OutcomeRow) -> str:
    """Return `yes`, or `NO` with the names of the unmet expectations; the notes say why."""
    if not row.failures:
        return "[green]yes[/green]"
    names = (printable(failure.partition(": ")[0]) for failure in row.failures)
    return "\n".join(["[bold red]NO[/bold red]", *map(escape, names)])


def _notes(outcome: Outcome) -> list[str]:
    """Return a line for each unmet expectation and each failed program without expectations."""
    number = outcome.scenario.condition
    where = "" if number is None else f"condition {number}: "
    failed = [
        f"{where}{probe.probe.label or f'probe {count}'}: the program failed: {probe.error}"
        for count, probe in enumerate(outcome.probes, start=1)
        if probe.error is not None and probe.ok is None
    ]
    lines = [*(f"NO: {where}{failure}" for failure in outcome.failures), *failed]
    return [printable(line) for line in lines]


def _headings(rows: Iterable[OutcomeRow]) -> list[str]:
    return list(dict.fromkeys(heading for row in rows for heading in row.cells))


def _cells(outcome: Outcome) -> dict[str, str]:
    """Return the text of each expectation and each probe, by heading."""
    cells: dict[str, list[str]] = {}
    for each in outcome.expectations:
        state = outcome.state(each.expectation.path)
        heading, text = _found(each, state, outcome.scenario)
        cells.setdefault(heading, []).append(text)
    for probe in outcome.probes:
        heading, text = _acted(probe, outcome.scenario)
        placed = {} if probe.trial is None else probe.trial.result.placed
        text += "".join(f"\n({escape(line)})" for line in placed_lines(placed))
        if len(outcome.probes) > 1 and probe.probe.label:
            text = f"{escape(printable(probe.probe.label))}: {text}"
        cells.setdefault(heading, []).append(text)
    return {heading: "\n".join(lines) for heading, lines in cells.items()}


def _found(outcome: ExpectationOutcome, state: State, scenario: Scenario) -> tuple[str, str]:
    content = outcome.expectation.content
    if isinstance(content, Holds) and content.items:
        names = [
            escape(container_name(place, scenario)) for place in places_of(content.items, state)
        ]
        what, found = ", ".join(content.items), " and ".join(names) or "nowhere"
    elif isinstance(content, Holds):
        held = state.containers.get(content.container)
        what, found = escape(container_name(content.container, scenario)), "nothing"
        if held is not None and held.items:
            found = ", ".join(f"{count} {name}" for name, count in sorted(held.items.items()))
    elif isinstance(content, Reads):
        text = state.signs.get(content.sign)
        what = f"sign ({', '.join(map(str, content.sign))})"
        found = "unknown" if text is None else escape(sign_words(text) or "nothing")
    elif isinstance(content, Is):
        what = f"block ({', '.join(map(str, content.block))})"
        found = state.blocks[content.block] or "unknown"
    elif isinstance(content, Hears):
        heard = any(content.text in text for _, _, text in state.chat)
        what, found = f"{content.text!r}", "heard" if heard else "not heard"
    else:
        position = state.agents[content.agent].position
        what, found = content.agent, "unknown" if position is None else point_text(position)
    path = outcome.expectation.path
    return f"{what} in {'reality' if path == '/' else path}", _marked(found, outcome.ok)


def _acted(outcome: ProbeOutcome, scenario: Scenario) -> tuple[str, str]:
    probe = outcome.probe
    text = "; ".join(_deeds(outcome, scenario))
    if outcome.outcome not in ("ok", "wrong"):
        text += f" ({outcome.outcome.replace('_', ' ')})"
    if outcome.inferred is not None:
        return f"inferred of {probe.agent} from {probe.path}", _marked(
            escape(_means(outcome)), outcome.ok
        )
    kinds = {type(each) for each in probe.expect}
    verb = "opens" if kinds <= {Opens} else "arrives at" if kinds == {Arrives} else "does"
    heading = f"predicted {probe.agent} {verb}"
    if not probe.asks_for_program:
        heading = f"answers from {probe.path}"
    return heading, _marked(escape(text), outcome.ok)


def _means(outcome: ProbeOutcome) -> str:
    """Return the means that something was expected of, or all, in words."""
    assert outcome.inferred is not None
    factors: dict[str, None] = {}
    for each in outcome.probe.expect:
        if isinstance(each, Infers):
            named = [each.factor, each.above, each.below]
            factors |= dict.fromkeys(name for name in named if isinstance(name, str))
    return outcome.inferred.impossible or means_text(outcome.inferred.means, tuple(factors))


def _deeds(outcome: ProbeOutcome, scenario: Scenario) -> list[str]:
    """Return what the agent did in a probe, in words, for each kind of expectation."""
    kinds = {type(each) for each in outcome.probe.expect} or {Opens}
    told = []
    if Opens in kinds:
        opened = container_name(outcome.opened[0], scenario) if outcome.opened else "nothing"
        told.append(opened if kinds == {Opens} else f"opens {opened}")
    if Arrives in kinds:
        where = "nowhere" if outcome.arrived is None else point_text(outcome.arrived)
        told.append(where if kinds == {Arrives} else f"arrives at {where}")
    if Intends in kinds:
        told.append(f"makes for {_made_for(outcome, scenario)}")
    told += [f"answers {reply.answer or 'nothing'}" for reply in outcome.replies]
    others = [each for each in outcome.verdicts if isinstance(each.expected, _TOLD_BY_VERDICT)]
    return told + [_name(each.expected) if each.ok else each.why_not for each in others]


def _made_for(outcome: ProbeOutcome, scenario: Scenario) -> str:
    if outcome.intended is None:
        return "nothing"
    x, y, z = map(math.floor, outcome.intended)
    labelled = (x, y, z) in scenario.labels
    return container_name((x, y, z), scenario) if labelled else point_text(outcome.intended)


_TOLD_BY_VERDICT = (Takes, Says, Believes, Judge)


def _name(expected: Expected) -> str:
    match expected:
        case Takes(items):
            return f"takes {items_text(items)}"
        case Says(text):
            return f"says {text!r}"
        case Believes(expectation):
            return expectation.label or f"{expectation.path} as expected"
        case Judge(_, name):
            return name
        case _:
            return type(expected).__name__.lower()


def _marked(text: str, ok: bool | None) -> str:
    return text if ok is not False else f"[bold red]{text}[/bold red]"
