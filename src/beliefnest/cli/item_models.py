"""`beliefnest items --models` and `--verify-results`: models on a set of items, compared."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

from rich.table import Table

from beliefnest.cli.console import Printed, print_report, result_table
from beliefnest.cli.options import ItemsOptions
from beliefnest.cli.playing import check_all_played, playing, write_tables
from beliefnest.cli.report import cost_text
from beliefnest.errors import InputError, MissingExtraError
from beliefnest.files import replace_file
from beliefnest.llm.budget import RunLimits
from beliefnest.plan.cells import Keyed
from beliefnest.scenarios.judging import unanswered_words
from beliefnest.studies.counting import count_rows
from beliefnest.studies.items.cells import ITEM_KIND, item_cells
from beliefnest.studies.items.functional.pairing import OrderGap, read_gaps
from beliefnest.studies.items.people import people_cells
from beliefnest.studies.items.results import (
    PublishedSet,
    check_results,
    results_of,
    with_others,
)
from beliefnest.studies.result import StudyResult
from beliefnest.studies.study_folder import StudyFolder
from beliefnest.studies.suite_playing import play_suite
from beliefnest.world.texts import quoted
from beliefnest.world.words import counted

RESULTS = "results.jsonl"

_Gaps = Mapping[str, Mapping[int, OrderGap]]
"""Literal minus functional, by model and order."""


def run_models(options: ItemsOptions) -> int:
    """Ask models all items of a set, and compare them; return the exit status.

    Raises:
        BeliefNestError: The input is wrong, or an item has no result.
    """
    items, folder = PublishedSet.read(options.study), options.folder
    models = [each.strip() for each in (options.models or "").split(",")]
    if not all(models) or len({*models}) < len(models):
        raise InputError(f"--models is {options.models!r}; name each model once, with commas")
    _check_same_set(items, folder)
    gaps = _gaps(options.gap or (), models)
    people, notes = (
        people_cells(items.name, items.choices, items.held_out, options.people)
        if options.people
        else ([], [])
    )
    cells: list[Keyed] = [*item_cells(items.name, items.choices, models), *people]
    of_set = {"version": items.version, "digest": items.digest}
    about = {"suites": [items.name], "models": models, **of_set}
    limits = RunLimits(options.max_tokens, options.max_cost)
    with playing(items.name, folder) as (place, on_progress):
        result = play_suite(
            place, ITEM_KIND, cells, about, models, on_progress, limits, options.jobs
        )
    write_tables(result)
    results = folder / RESULTS
    before = results.read_bytes() if results.is_file() else b""
    replace_file(results, with_others(results_of(items, result.rows), before))
    lines = [*notes, *_left_out(items), *_figure(result, folder), f"results: {results}"]
    _print(options, {"folder": str(folder)}, result.rows, lines, gaps)
    check_all_played(result)
    return 0


def run_verify_results(options: ItemsOptions) -> int:
    """Check a file of results against the set of a folder; return the exit status.

    Raises:
        BeliefNestError: The set or the file cannot be read.
    """
    items, file = PublishedSet.read(options.study), options.verify_results
    assert file is not None
    checked = check_results(items, file)
    lines = [
        *checked.faults,
        *(
            f"{model}: {counted(count, 'item')} without a sound result, counted as not right"
            for model, count in checked.missing.items()
        ),
    ]
    report = {"results": str(file), "faults": list(checked.faults), "missing": checked.missing}
    _print(options, report, checked.rows, [*lines, *([] if lines else [f"{file}: sound"])])
    return int(bool(lines))


def _check_same_set(items: PublishedSet, folder: Path) -> None:
    """Raise InputError if a folder has results of another set."""
    place = StudyFolder(folder, ITEM_KIND)
    if not place.has_plan:
        return
    before = place.plan()
    # Folders of earlier versions have no digest, so that nothing tells what was asked.
    there = (*before["suites"], before["version"], before.get("digest", "unknown"))
    own = (items.name, items.version, items.digest)
    if there != own:
        theirs, ours = (f"{name} {version} ({key[:8]})" for name, version, key in (there, own))
        raise InputError(
            f"{folder} has results of the set {theirs}, and this one is {ours}; name another "
            f"folder (with a copy of {folder / 'answers'}, no question is asked twice)"
        )


def _gaps(folders: Sequence[Path], models: Sequence[str]) -> _Gaps:
    """Return the gaps of models by order; raise InputError if a model is none of the compared."""
    gaps: dict[str, Mapping[int, OrderGap]] = {}
    for folder in folders:
        model, own = read_gaps(folder)
        if model not in models:
            raise InputError(
                f"{folder} has episodes of {quoted(model)}, and --models is {','.join(models)}; "
                "add the model, or leave out the folder"
            )
        gaps[model] = own
    return gaps


def _left_out(items: PublishedSet) -> Iterator[str]:
    left = len(items.items) - len(items.choices)
    if left:
        yield f"not asked: {counted(left, 'item')} without options"


def _figure(result: StudyResult, folder: Path) -> Iterator[str]:
    """Draw accuracy by order and model, and tell where, or that matplotlib is missing."""
    try:
        figure = result.plot(["order", "model"])
    except MissingExtraError as error:
        yield f"no figure: {error}"
        return
    models = {str(row["model"]) for row in result.rows}
    if len(models) == 1:  # Nothing else names it.
        figure.axes[0].set_title(models.pop(), fontsize="medium")
    for ending in ("svg", "pdf", "png"):
        figure.savefig(folder / f"accuracy.{ending}")
    yield f"figure: {folder / 'accuracy.svg'}, and as PDF and PNG"


def _print(
    options: ItemsOptions,
    report: Mapping[str, Any],
    rows: Sequence[Mapping[str, Any]],
    lines: Sequence[str],
    gaps: _Gaps = MappingProxyType({}),
) -> None:
    groups = [*count_rows(rows, ["model"]), *count_rows(rows, ["model", "order"])]
    for group in groups:
        if gap := gaps.get(group["model"], {}).get(group.get("order", -1)):
            group |= {"functional": gap.functional.rate, "gap": gap.difference, "gap_p": gap.p}
    parts: list[Printed] = [_table(groups), *lines]
    print_report({**report, "models": groups}, parts, as_json=options.json)


def _table(groups: Sequence[Mapping[str, Any]]) -> Table:
    spent = ("tokens", "cost") if any(group["tokens"] for group in groups) else ()
    acted = ("functional", "gap") if any("gap" in group for group in groups) else ()
    numbers = ("order", "items", "right", "accuracy", "95 %", "chance", *acted, *spent)
    table = result_table("model", *numbers, "not answered", right=numbers)
    for group in groups:
        judged = group["judged"]
        table.add_row(
            group["model"],
            str(group.get("order", "all")),
            str(judged),
            str(group["right"]),
            f"{group['accuracy']:.1%}" if judged else "-",
            f"{group['low']:.0%} to {group['high']:.0%}" if judged else "-",
            "-" if group["chance"] is None else f"{group['chance']:.0%}",
            *(_gap_texts(group) if acted else ()),
            *(_spent_texts(group) if spent else ()),
            unanswered_words(group),
        )
    return table


def _gap_texts(group: Mapping[str, Any]) -> tuple[str, str]:
    if "gap" not in group:
        return "-", "-"
    return f"{group['functional']:.0%}", f"{group['gap']:+.0%} (p {group['gap_p']:.3f})"


def _spent_texts(group: Mapping[str, Any]) -> tuple[str, str]:
    return (f"{group['tokens']:,}", cost_text(group["cost"])) if group["tokens"] else ("-", "-")
