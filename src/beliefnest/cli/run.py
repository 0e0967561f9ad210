"""`beliefnest run`: play each condition of a scenario, record, judge, draw and score it."""

import dataclasses
import json
import math
import os
import statistics
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing, suppress
from datetime import datetime
from functools import partial
from typing import Any, Literal

from msgspec.structs import replace
from rich.table import Table
from rich.text import Text

from beliefnest.cli.console import Printed, report_text, result_table, stdout
from beliefnest.cli.folder import RunFolder, kept_scenario_file
from beliefnest.cli.gallery import Gallery, RunResults
from beliefnest.cli.kernels_ahead import kernels_ahead
from beliefnest.cli.options import RunOptions
from beliefnest.cli.report import OutcomeRow, cost_text, count_outcomes, outcome_table, report_json
from beliefnest.cli.run_cells import RunCell, plan_run_cells
from beliefnest.cli.run_report import report_html
from beliefnest.cli.streams import noted_warnings
from beliefnest.cli.visits import check_visits
from beliefnest.errors import InputError, ModelError, NotBegunError, ScenarioError
from beliefnest.llm.budget import RunLimits
from beliefnest.llm.failures import UnavailableModelError
from beliefnest.llm.resolve import Connection, check_model, open_model
from beliefnest.nest.past.versions import own_versions
from beliefnest.pictures.overview import overview
from beliefnest.plan.jobs import run_cells
from beliefnest.plan.terms import Terms
from beliefnest.plan.worker import Worker
from beliefnest.scenarios.judging import unanswered_words, without_result_words
from beliefnest.scenarios.scenario import Scenario
from beliefnest.studies.counting import count_rows
from beliefnest.studies.file import naming_other_kinds
from beliefnest.studies.kinds import RUN_KIND
from beliefnest.studies.study_folder import StudyFolder
from beliefnest.studies.table import lost
from beliefnest.timeline.store import Journal
from beliefnest.world.seeds import checked_seed
from beliefnest.world.words import counted
from beliefnest.worlds.minecraft.launching import Launch, ahead
from beliefnest.worlds.names import check_world

_MOST_TIMES = 10_000
"""Greatest number of repeats, and of attempts for one probe."""
_HOTTEST = 10.0
"""Greatest temperature; more than any provider accepts."""

_OF_CELL = ("key", "error", "run")
"""Keys of a cell's file that are not in the report."""

RunStatus = Literal["running", "done", "failed", "interrupted"]
_Ended = tuple[RunCell, dict[str, Any]]


def run_scenarios(options: RunOptions, launch: Launch | None = None) -> int:
    """Run, record and print all conditions of a scenario.

    Args:
        options: Options of the command.
        launch: Node of the embedded world, started earlier with the same seed.

    Returns:
        Exit status: 0 if all expectations hold, else 1.

    Raises:
        BeliefNestError: The input is wrong, or a world or model failed. A failing model ends only
            the condition that asked it; the error is raised after all conditions have run.
    """
    scenarios = _scenarios(options)
    check_world(options.full_world)
    check_visits(options.embody or (), options.full_world)
    _check_numbers(options)
    kept = None if options.out is None else RunFolder(options.out).results.answers
    connection = Connection(
        answer_limits=options.model_settings.answer_limits,
        cache=options.answers or kept,
        cache_mode=options.cache,
    )
    for name in options.asked_models:
        check_model(name, os.environ, connection)
    with RunFolder.open(options.out, datetime.now(), scenarios[0].name) as folder:
        return _run_in(folder, options, scenarios, launch)


def _run_in(
    folder: RunFolder, options: RunOptions, scenarios: Sequence[Scenario], launch: Launch | None
) -> int:
    """Run the conditions in an open folder; return the exit status."""
    first, settings = scenarios[0], options.settings
    gallery = Gallery()
    cells = plan_run_cells(scenarios, settings, folder.path, options.embody or (), gallery)
    # Each condition may name its own template.
    templates = {n: t for each in scenarios for n, t in each.templates.items()}
    folder.begin(settings, dataclasses.replace(first, templates=templates), cells)
    results = RunResults(folder.path, RUN_KIND, gallery)
    terms = _terms(options, results)
    status: RunStatus = "failed"
    worker = partial(Worker, launch=launch, seed=options.seed, caught=ModelError)
    try:
        with noted_warnings() as warned, kernels_ahead(), closing(gallery):
            # It is told with the other failures.
            with suppress(UnavailableModelError):
                run_cells(cells, results, terms, 1, "loky", lambda progress: None, ahead, worker)
            if len(gallery.pictures) == len(cells) > 1:
                shown = gallery.pictures[: len(scenarios)]
                overview(shown, first.description or first.name).save(folder.picture)
        status = "failed" if _failures(cells, results) else "done"
    except KeyboardInterrupt:
        status = "interrupted"
        raise
    finally:
        ended, failures = _ended(cells, results), _failures(cells, results)
        runs = [result for _, result in ended]
        report = report_json(first.name, settings, status, runs, failures)
        versions = _versions(cells)
        report |= {"versions": versions, "scores": _score_runs(runs, failures)}
        folder.write_plan(settings, first.name, cells, status, versions)
        folder.write_report(report)
        about = {"name": options.scenario, "description": first.description}
        page = report_html(report, about=about, conditions=first.conditions, versions=versions)
        folder.write_page(page)
    text = report_text(
        _parts(report, cells, ended, [*warned.values(), f"recorded in {folder.path}"])
    )
    folder.write_summary(text)
    sys.stdout.write(json.dumps(report, indent=2) + "\n" if options.json else text)
    if failures:
        missing = len(cells) - len(runs)
        raise ModelError(_failures_text(failures, missing, len(cells), folder))
    return 0 if all(result["ok"] for result in runs) else 1


def _terms(options: RunOptions, results: StudyFolder) -> Terms:
    """Return the terms of a run whose answers and usage its folder keeps."""
    terms = Terms(
        answers=options.answers or results.answers,
        ledger=results.ledger,
        runs=None,
        limits=RunLimits(options.max_tokens, options.max_cost),
        cache_mode=options.cache,
        record=results.requests,
    )
    connection = terms.connection(options.model_settings.answer_limits)
    # Answers of a file go on from cell to cell.
    models = {name: open_model(name, os.environ, connection) for name in options.asked_models}
    return replace(terms, models=models)


def _ended(cells: Sequence[RunCell], results: StudyFolder) -> list[_Ended]:
    """Return the cells that have a result, also of an earlier part of the run, each with it."""
    contents = ((cell, results.cell(cell.key.name)) for cell in cells)
    return [
        (cell, {name: value for name, value in content.items() if name not in _OF_CELL})
        for cell, content in contents
        if content is not None and content["error"] is None
    ]


def _failures(cells: Sequence[RunCell], results: StudyFolder) -> list[dict[str, object]]:
    """Return why cells that were tried have no result."""
    contents = ((cell.key, results.cell(cell.key.name)) for cell in cells)
    return [
        {
            "condition": key.condition,
            "model": key.model,
            "seed": key.seed,
            "error": content["error"],
            "kind": content["kind"],
            "outcome": lost(content, is_judged=True)["outcome"],
        }
        for key, content in contents
        if content is not None and content["error"] is not None
    ]


def _scenarios(options: RunOptions) -> tuple[Scenario, ...]:
    try:
        with naming_other_kinds(options.scenario):
            return conditions_of(options.scenario, options.condition or ())
    except ScenarioError:
        # An interrupted run continues with the scenario file that its folder keeps.
        kept = kept_scenario_file(options.out, options.scenario)
        if kept is None:
            raise
    return conditions_of(str(kept), options.condition or ())


def conditions_of(name_or_path: str, conditions: Sequence[int]) -> tuple[Scenario, ...]:
    """Return a scenario under some of its conditions; no numbers: under all of them."""
    if not conditions:
        return Scenario.load_all(name_or_path)
    return tuple(Scenario.load(name_or_path, number) for number in dict.fromkeys(conditions))


def _check_numbers(options: RunOptions) -> None:
    for name, number, low, high in (
        ("--repeat", options.repeat, 1, _MOST_TIMES),
        ("--attempts", options.attempts, 1, _MOST_TIMES),
        ("--max-tokens", options.max_tokens, 0, math.inf),
        ("--max-cost", options.max_cost, 0, math.inf),
        ("--temperature", options.temperature, 0, _HOTTEST),
    ):
        # Written so that NaN is refused, too.
        if number is not None and not low <= number <= high:
            above = f"at least {low}" if high == math.inf else f"from {low} to {high}"
            raise InputError(f"{name} is {number}; it must be {above}")
    checked_seed(options.seed, "--seed")
    checked_seed(options.seed + options.repeat, "--seed with --repeat")
    models = options.named_models
    twice = [name for name in models if models.count(name) > 1]
    if twice:
        raise InputError(f"the model {twice[0]} is named twice; use --repeat to ask it again")


def _versions(cells: Sequence[RunCell]) -> Mapping[str, str]:
    """Return versions of programs by name, from the first run file of the run.

    If no world could be opened, there is no run file: return the versions of this process.
    """
    for cell in cells:
        store = cell.place.store
        if store.is_file():
            with suppress(NotBegunError), Journal.read(store) as journal:
                return journal.records.run().versions
    return own_versions()


def _failures_text(
    failures: Sequence[Mapping[str, object]], missing: int, total: int, folder: RunFolder
) -> str:
    if total == 1:
        return str(failures[0]["error"])
    text = without_result_words(missing, total, sum(f["outcome"] == "no_answer" for f in failures))
    return f"{text}; run again with --out {folder.path} to go on; the first: {failures[0]['error']}"


def _parts(
    report: Mapping[str, Any],
    cells: Sequence[RunCell],
    ended: Sequence[_Ended],
    lines: Sequence[str],
) -> Iterator[Printed]:
    for number, about in cells[0].scenario.conditions.items():
        if any(cell.scenario.condition == number for cell in cells):
            yield Text(f"condition {number}: {about}")
    # The results of each condition, or scores if there are several models or repeats.
    if cells[0].is_flat and len(ended) == len(cells):
        rows = [OutcomeRow.of(cell.scenario, result) for cell, result in ended]
        yield outcome_table(rows, stdout())
        yield from (line for row in rows for line in row.notes)
    else:
        yield _score_table(cells[0].scenario.name, report["scores"])
    stopped = [each for result in report["runs"] for each in result.get("stopped", ())]
    if stopped:
        yield (
            f"{counted(len(stopped), 'call')} stopped at the end of programs, perhaps for lack of "
            f"`await`; the first: {stopped[0]}"
        )
    yield from (*_unread(report["runs"]), *lines)


def _unread(results: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return a line about the utterances that the model could not read for claims, if any."""
    readings = [result["readings"] for result in results if "readings" in result]
    failed = [each for each in readings if each["failed"]]
    if not failed:
        return []
    count, asked = (sum(each[key] for each in readings) for key in ("failed", "asked"))
    return [
        f"{count} of {asked} utterances could not be read for claims, and claim nothing; "
        f"the first: {failed[0]['first']}"
    ]


_BY = ("condition", "model")


def _score_runs(
    runs: Sequence[Mapping[str, Any]], failures: Sequence[Mapping[str, Any]]
) -> list[dict[str, Any]]:
    """Return the scores of reported runs, ordered by condition, then by first appearance.

    Returns:
        For each condition and model: `passed`, the number of repeats in which all expectations
        held; `total`, the number of those in which the model was asked; `failed`, the number of
        those without a result; `outcomes`, the number of probes by outcome, where a repeat without
        a result counts as one; `rate` and its 95 % `interval`, None if the model was never asked;
        `tokens`; `cost` in US dollars, None if not known; `seconds`, the mean wall time.
    """
    rows = []
    for group in count_rows([*map(_ended_of, runs), *map(_failed, failures)], _BY):
        own, without = (
            [each for each in some if all(each[name] == group[name] for name in _BY)]
            for some in (runs, failures)
        )
        seconds = statistics.mean(run["seconds"] for run in own) if own else 0.0
        rows.append(
            {
                **{name: group[name] for name in _BY},
                "passed": group["right"],
                "total": group["judged"],
                "failed": len(without),
                "outcomes": count_outcomes(own, without),
                "rate": group["accuracy"],
                "interval": (group["low"], group["high"]) if group["judged"] else None,
                "tokens": group["tokens"],
                "cost": group["cost"],
                "seconds": round(seconds, 3),
            }
        )
    return sorted(rows, key=lambda score: -1 if score["condition"] is None else score["condition"])


def _ended_of(run: Mapping[str, Any]) -> dict[str, Any]:
    """Return the row of a repeat with a result."""
    usage = run["usage"]
    tokens = usage["input_tokens"] + usage["output_tokens"]
    return {**run, "outcome": "ok", "tokens": tokens, "cost": usage["cost"]}


def _failed(failure: Mapping[str, Any]) -> dict[str, Any]:
    """Return the row of a repeat without a result."""
    return {**failure, **lost(failure, is_judged=True)}


def _score_table(name: str, scores: Sequence[Mapping[str, Any]]) -> Table:
    """Return a table with one row for each condition and model."""
    words = [unanswered_words(score["outcomes"]) for score in scores]
    unanswered = ["not answered"] if any(words) else []
    numbers = ("condition", "passed", "rate", "95 % interval", "tokens", "cost", "seconds")
    headings = (*numbers[:1], "model", *numbers[1:4], *unanswered, *numbers[4:])
    table = result_table(*headings, title=name, right=numbers)
    for score, word in zip(scores, words, strict=True):
        low, high = score["interval"] or (0.0, 1.0)
        table.add_row(
            "-" if score["condition"] is None else str(score["condition"]),
            score["model"],
            f"{score['passed']} of {score['total']}",
            "-" if score["rate"] is None else f"{score['rate']:.0%}",
            f"{low:.0%} to {high:.0%}",
            *([word] if any(words) else []),
            f"{score['tokens']:,}",
            cost_text(score["cost"]),
            f"{score['seconds']:.2f}",
        )
    return table
