"""`beliefnest study`: play all cells of a study, write its tables, figure and page."""

import json
import re
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

from rich.table import Table

from beliefnest.cli.console import Printed, print_report, progress_on, result_table
from beliefnest.cli.options import StudyOptions
from beliefnest.cli.playing import status_of, write_tables
from beliefnest.cli.report import cost_text
from beliefnest.cli.streams import noted_warnings
from beliefnest.cli.terminal_text import printable
from beliefnest.errors import InputError
from beliefnest.plan.jobs import StudyProgress
from beliefnest.scenarios.judging import OUTCOMES, unanswered_words
from beliefnest.studies.checking import checked_columns
from beliefnest.studies.copies import text_of_copies
from beliefnest.studies.result import StudyResult
from beliefnest.studies.study import Study, checked_shard
from beliefnest.world.words import counted

_MOST_TOLD = 10
_MANY = 100
"""Number of variations whose check takes no time that needs a report."""
_REPORTS = 10
"""Number of progress lines of commands that play studies of their own."""


def run_study(options: StudyOptions) -> int:
    """Play a study, write its files, and print its table.

    Returns:
        Exit status: 0 if all rows are as expected, else 1.

    Raises:
        BeliefNestError: The input is wrong, or cells have no result.
    """
    shard = _shard(options.shard)
    options_of_model = options.requests
    if options.system is not None:
        options_of_model["system"] = str(options.system)
    study = Study.load(options.study, options.claims_from, **options_of_model)
    now = datetime.now()
    folder = options.out or Path("studies", f"{options.study.stem}-{now:%Y%m%d-%H%M%S}")
    with noted_warnings() as warned, progress_on(options.study.stem) as on_progress:
        on_progress("checking all variations", 0, 0)

        def checked(what: str, done: int, total: int) -> None:
            if done * _REPORTS // total > (done - 1) * _REPORTS // total and total > _MANY:
                on_progress(what, done, total)

        study.plan(checked)
        if options.merge:
            taken = study.take_over(folder, options.merge)
            on_progress(f"took over {taken} cells", 0, 0)
        checked_columns(options.by or (), study.columns)

        def told(progress: StudyProgress) -> None:
            on_progress(_progress_text(progress), progress.done, progress.total)

        try:
            result = study.run(
                folder,
                options.jobs,
                options.backend,
                shard=shard,
                record=options.record,
                on_progress=told,
            )
        except KeyboardInterrupt:
            sys.stderr.write(f"finished cells are in {folder}; run the same command to continue\n")
            raise
    by = options.by or result.groups
    write_files(result, by)
    print_report(_report(result, by), _parts(result, by, warned), as_json=options.json)
    return status_of(result)


def _shard(text: str | None) -> tuple[int, int] | None:
    if text is None:
        return None
    match = re.fullmatch(r"(\d{1,6})/(\d{1,6})", text)
    if match is None:
        raise InputError(f"--shard is {text!r}; give it as I/N, such as 1/4")
    return checked_shard((int(match[1]), int(match[2])))


def _progress_text(progress: StudyProgress) -> str:
    parts = [f"{counted(progress.left, 'cell')} left"]
    if progress.failed:
        parts.append(f"{progress.failed} failed")
    if progress.spent.requests:
        parts.append(f"{progress.spent.tokens:,} tokens, {cost_text(progress.spent.cost)}")
    return ", ".join(parts)


def write_files(result: StudyResult, by: Sequence[str]) -> None:
    """Write the tables and the page into the study's folder."""
    write_tables(result)
    result.write_page(result.folder.path / "study.html", by)


def _report(result: StudyResult, by: Sequence[str]) -> dict[str, Any]:
    return {
        "study_dir": str(result.folder.path),
        "cells": len(result.plan["cells"]),
        "summary": result.counted(by),
        "rows": result.rows,
        "invalid": result.invalid,
    }


def _parts(result: StudyResult, by: Sequence[str], warned: Mapping[str, str]) -> Iterator[Printed]:
    yield _table(by, result.counted(by))
    lines = [f"no answer: {why}" for why in dict.fromkeys(result.failed.values())]
    lines += [f"left out: {_invalid_text(each)}" for each in result.invalid]
    lines += [*_lost_rounds(result.rows), *_not_read(result.rows), *warned.values()]
    yield from lines[:_MOST_TOLD]
    if len(lines) > _MOST_TOLD:
        yield f"and {len(lines) - _MOST_TOLD} more"
    copies = sum(row["copy_of"] is not None for row in result.rows)
    if copies:
        yield text_of_copies(copies)
    yield f"all rows, intervals and differences: {result.folder.path / 'study.html'}"


def _lost_rounds(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield a line for each policy that failed in rounds of its episodes."""
    lost: dict[str, list[Mapping[str, Any]]] = {}
    for row in rows:
        if row.get("lost_rounds"):
            lost.setdefault(row["policy"], []).append(row)
    for policy, own in lost.items():
        rounds = counted(sum(row["lost_rounds"] for row in own), "round")
        first = json.loads(own[0]["failures"])[0]
        episodes = counted(len(own), "episode")
        outcomes = [name for row in own for name in json.loads(row["not_answered"] or "[]")]
        why = unanswered_words(Counter(outcomes))
        rounds += f" ({why})" if why else ""
        yield f"{policy} gave no program in {rounds} of {episodes}; the first failure: {first}"


def _not_read(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield a line for each model of whose answers none could be read."""
    outcomes: dict[str, set[str]] = {}
    for row in rows:
        outcomes.setdefault(row.get("model", ""), set()).add(row["outcome"])
    for model in (name for name, kinds in outcomes.items() if kinds == {"unread"}):
        first = next(row for row in rows if row["model"] == model)
        yield f"{model} gave no answer that could be read; the first: {first['why_not']}"


def _invalid_text(invalid: Mapping[str, Any]) -> str:
    condition = "" if invalid["condition"] is None else f", condition {invalid['condition']}"
    varied = json.dumps(invalid["variation"])
    return f"{invalid['scenario']}{condition}, {varied}: {invalid['why']}"


def _table(by: Sequence[str], groups: Sequence[Mapping[str, Any]]) -> Table:
    numbers = ("variations", "right", "accuracy", "95 % interval", "not ok", "tokens", "cost")
    table = result_table(*by, *numbers, right=numbers)
    for group in groups:
        counts = [(name, group[name]) for name in OUTCOMES[1:] if group[name]]
        faults = [f"{count} {name.replace('_', ' ')}" for name, count in counts]
        judged = group["judged"]
        table.add_row(
            *(printable("-" if group[name] is None else str(group[name])) for name in by),
            str(group["variations"]),
            f"{group['right']} of {judged}",
            f"{group['accuracy']:.0%}" if judged else "-",
            f"{group['low']:.0%} to {group['high']:.0%}" if judged else "-",
            ", ".join(faults),
            f"{group['tokens']:,}",
            cost_text(group["cost"]),
        )
    return table
