"""Report of a run: the object that `--json` prints, and the table."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

import msgspec
from rich.console import Console
from rich.markup import escape
from rich.measure import Measurement
from rich.table import Table

from beliefnest.belief.plain import state_json
from beliefnest.cli.console import result_table
from beliefnest.cli.terminal_text import printable
from beliefnest.facts.states import StateFacts
from beliefnest.llm.messages import Usage
from beliefnest.scenarios.expected_acts import Opens
from beliefnest.scenarios.expected_kinds import Infers
from beliefnest.scenarios.inferring import means_text
from beliefnest.scenarios.judging import OUTCOMES
from beliefnest.scenarios.naming import container_name
from beliefnest.scenarios.outcome import Outcome, ProbeOutcome
from beliefnest.scenarios.records import expectation_json, probe_json
from beliefnest.scenarios.scenario import Scenario
from beliefnest.world.values import Placements, Point, Position
from beliefnest.world.words import point_text

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
        "usage": asdict(outcome.usage),
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
        "form": "beliefnest run 2",
        "scenario": scenario,
        "world": settings["world"],
        "model": ",".join(models),
        "status": status,
        "settings": settings,
        "runs": list(runs),
        "failures": list(failures),
        "outcomes": count_outcomes(runs, failures),
    }


def count_outcomes(
    runs: Sequence[Mapping[str, Any]], failures: Sequence[Mapping[str, Any]]
) -> dict[str, int]:
    """Return the number of probes by outcome; a run without a result counts as one."""
    counts = Counter(probe["outcome"] for run in runs for probe in run["probes"])
    counts.update(failure["outcome"] for failure in failures)
    return {outcome: counts[outcome] for outcome in OUTCOMES}


class OutcomeRow(msgspec.Struct, frozen=True):
    """Row of the table for one condition, read from its result as `outcome_json` wrote it.

    Attributes:
        scenario: Scenario with the condition applied.
        cells: Text of each expectation and probe, by heading.
        notes: A line for each unmet expectation and each failed program.
        unmet: Names of the unmet expectations.
        usage: Tokens and cost of models.
        ticks: Length of the run in ticks.
        seconds: Wall time in seconds.
    """

    scenario: Scenario
    cells: Mapping[str, str]
    notes: Sequence[str]
    unmet: Sequence[str]
    usage: Usage
    ticks: int
    seconds: float

    @classmethod
    def of(cls, scenario: Scenario, result: Mapping[str, Any]) -> "OutcomeRow":
        """Return the row of a result."""
        beliefs = [e["label"] or e["path"] for e in result["expectations"] if not e["ok"]]
        probes = [
            f"{each['label'] or f'probe {number}'} ({each['outcome']})"
            for number, each in enumerate(result["probes"], 1)
            if each["ok"] is False
        ]
        return cls(
            scenario,
            result["table"]["cells"],
            result["table"]["notes"],
            [*beliefs, *probes],
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
    asked = any(row.usage.requests for row in rows)
    condition = ["condition"] if scenario.conditions else []
    numbers = [*condition, *(("tokens", "cost") if asked else ()), "ticks", "seconds"]
    verdict = f"as {scenario.reported_by or 'expected'}{_verb(scenario)}"
    headings = (*condition, *_headings(rows), verdict, *numbers[len(condition) :])
    table = result_table(*headings, title=scenario.name, right=numbers)
    for row in rows:
        cells = [str(row.scenario.condition)] if scenario.conditions else []
        cells += [row.cells.get(heading, "") for heading in _headings(rows)]
        spent = [f"{row.usage.tokens:,}", cost_text(row.usage.cost)] if asked else []
        table.add_row(*cells, _verdict(row), *spent, str(row.ticks), f"{row.seconds:.2f}")
    return table


def _tall_table(rows: Sequence[OutcomeRow]) -> Table:
    scenario = rows[0].scenario
    numbers = (
        "" if row.scenario.condition is None else str(row.scenario.condition) for row in rows
    )
    heading = "condition" if scenario.conditions else ""
    table = result_table(heading, *numbers, title=scenario.name)
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
    if not row.unmet:
        return "[green]yes[/green]"
    names = (escape(printable(name)) for name in row.unmet)
    return "\n".join(["[bold red]NO[/bold red]", *names])


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
        expectation, setting = each.expectation, outcome.scenario.setting
        facts = StateFacts(outcome.state(expectation.simulator))
        what, state_words = expectation.fact.found(facts, partial(container_name, setting=setting))
        heading = f"{escape(what)} in {expectation.where}"
        cells.setdefault(heading, []).append(_marked(escape(state_words), each.ok))
    for probe in outcome.probes:
        heading, text = _acted(probe, outcome.scenario)
        placed = {} if probe.trial is None else probe.trial.result.placed
        text += "".join(f"\n({escape(line)})" for line in placed_lines(placed))
        if len(outcome.probes) > 1 and probe.probe.label:
            text = f"{escape(printable(probe.probe.label))}: {text}"
        cells.setdefault(heading, []).append(text)
    return {heading: "\n".join(lines) for heading, lines in cells.items()}


def _acted(outcome: ProbeOutcome, scenario: Scenario) -> tuple[str, str]:
    probe = outcome.probe
    setting = scenario.setting
    alone = len({type(each) for each in probe.expect}) == 1
    deeds = [each.expected.told(each, outcome, setting, alone=alone) for each in outcome.verdicts]
    if not probe.expect:
        deeds = [container_name(outcome.opened[0], setting) if outcome.opened else "nothing"]
    text = "; ".join(deeds)
    if outcome.outcome not in ("ok", "wrong"):
        text += f" ({outcome.outcome.replace('_', ' ')})"
    if outcome.inferred is not None:
        return f"inferred of {probe.agent} from {probe.path}", _marked(
            escape(_means(outcome)), outcome.ok
        )
    verbs = {each.verb for each in probe.expect} or {Opens.verb}
    heading = f"predicted {probe.agent} {verbs.pop() if len(verbs) == 1 else 'does'}"
    if not probe.asks_for_program:
        heading = f"answers from {probe.path}"
    return heading, _marked(escape(text), outcome.ok)


def _means(outcome: ProbeOutcome) -> str:
    """Return the means that something was expected of, or all, in words."""
    assert outcome.inferred is not None
    factors: dict[str, None] = {}
    for each in outcome.probe.expect:
        if isinstance(each, Infers):
            factors |= dict.fromkeys(each.factors)
    return outcome.inferred.impossible or means_text(outcome.inferred.means, tuple(factors))


def _marked(text: str, ok: bool | None) -> str:
    return text if ok is not False else f"[bold red]{text}[/bold red]"
