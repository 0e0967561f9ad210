"""`beliefnest reproduce SUPPLEMENT`: play a study or run again without models, and compare."""

import contextlib
import io
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from beliefnest.cli.console import print_report, progress_on
from beliefnest.cli.options import RunOptions
from beliefnest.cli.run import run_scenarios
from beliefnest.cli.terminal_text import printable
from beliefnest.errors import InputError, ModelError
from beliefnest.files import replace_file
from beliefnest.llm.stored_exchange import encode_exchange
from beliefnest.nest.past.versions import own_versions
from beliefnest.plan.jobs import StudyProgress
from beliefnest.scenarios.sources import read_document
from beliefnest.studies.archive import damaged_files, unpack
from beliefnest.studies.bundling import opened
from beliefnest.studies.comparing import ERROR, PairedDifference, differing_contents
from beliefnest.studies.foreign_code import Code, check_trust, code_of, functions_in
from beliefnest.studies.methods import facts_of
from beliefnest.studies.reproducing import (
    Reproduction,
    check_templates,
    code_in_study,
    differing_table,
    reproduce_study,
)
from beliefnest.studies.study_record import StudyRecord
from beliefnest.world.words import counted
from beliefnest.worlds.names import is_address

_MOST_TOLD = 20
_OF_MACHINE = ("seconds", "run_dir", "key", "model", "table")
"""Keys of results that differ between machines, name the model that replays answers, or repeat
other keys for people."""


def reproduce_supplement(supplement: Path, jobs: int, *, trust: bool, as_json: bool) -> int:
    """Play a study or run again, without any model, and compare all rows.

    Args:
        supplement: ZIP file of `beliefnest bundle`, its folder, or a folder of a study or run.
        jobs: Number of cells to play in parallel.
        trust: Run the Python code of the supplement's makers, if there is any.
        as_json: Print one JSON object.

    Returns:
        Exit status: 0 if everything is equal, else 1.

    Raises:
        BeliefNestError: There are no results, they cannot be played again, or there is code that is
            not trusted, or that is not what was bundled.
    """
    with tempfile.TemporaryDirectory() as scratch:
        folder = supplement
        if not supplement.is_dir():
            folder = unpack(supplement, Path(scratch, "unpacked"))
        result = opened(folder)
        damaged = damaged_files(folder, result.folder.of)
        if damaged and trust:
            raise InputError(
                f"{supplement} is not what was bundled: {damaged[0].text}"
                f"{f', and {len(damaged) - 1} more' if len(damaged) > 1 else ''}; no code of it is "
                "run. Without --trust the rest of it is compared"
            )
        codes = sorted({code.text for code in _code_of(result)})
        if codes:
            listed = "".join(f"runs Python code: {text}\n" for text in codes)
            sys.stderr.write(printable(listed) + "\n")
        again = Path(scratch, "again")
        with progress_on("reproduce") as on_progress:

            def told(progress: StudyProgress) -> None:
                on_progress("playing", progress.done + progress.failed, progress.total)

            if result.folder.of == "run":
                on_progress("playing", 0, 0)
                reproduction = _reproduce_run(result, again, trust=trust)
            else:
                reproduction = reproduce_study(folder, again, jobs, told, trust=trust)
        differences = [*damaged, *reproduction.differences]
        other = _other_versions(result.plan["versions"])
    lines = _lines(reproduction, differences, other)
    print_report(_report(reproduction, differences, other), lines, as_json=as_json)
    return 1 if differences else 0


def _code_of(result: StudyRecord) -> list[Code]:
    """Return the Python code that playing a study or run again runs."""
    folder = result.folder
    if folder.of == "study":
        return code_in_study(folder.path)
    document = read_document(str(folder.path / "scenario.yaml"))
    check_templates(document)
    return [code_of(name) for name in functions_in(document.root)]


def _report(
    reproduction: Reproduction, differences: Sequence[PairedDifference], other: Mapping[str, Any]
) -> dict[str, Any]:
    return {
        "equal": not differences,
        "cells": reproduction.cells,
        "left_out": reproduction.left_out,
        "rows": reproduction.rows,
        "compared": list(_compared(reproduction)),
        "not_compared": list(_not_compared(reproduction)),
        "differences": [each.plain() for each in differences],
        "other_versions": other,
    }


def _lines(
    reproduction: Reproduction, differences: Sequence[PairedDifference], other: Mapping[str, Any]
) -> Iterator[str]:
    for name, (before, now) in other.items():
        yield f"other version: {name} {before}, now {now}"
    for each in differences[:_MOST_TOLD]:
        yield each.text
    if len(differences) > _MOST_TOLD:
        yield f"and {len(differences) - _MOST_TOLD} more differences"
    played = f"{counted(reproduction.cells, 'cell')} played again without a model"
    if reproduction.left_out:
        played += f" ({counted(reproduction.left_out, 'cell')} without a recorded result left out)"
    rows = counted(reproduction.rows, "row")
    if differences:
        yield f"NOT EQUAL: {counted(len(differences), 'difference')} in {rows}; {played}"
    else:
        yield f"equal: all of {rows}; {played}"
    yield f"compared: {'; '.join(_compared(reproduction))}"
    yield f"not compared: {'; '.join(_not_compared(reproduction))}"


def _compared(reproduction: Reproduction) -> Iterator[str]:
    """Yield words for what was compared."""
    yield "the digest of each file with the manifest, if there is one"
    yield "rows.csv with the recorded results"
    yield f"{counted(reproduction.cells, 'cell')} with the same played again from the inputs inside"


def _not_compared(reproduction: Reproduction) -> Iterator[str]:
    """Yield words for what was not compared."""
    yield "answers of models with models: they are taken as recorded"
    yield "figures, pages and paragraphs with the rows: only their digests are checked"
    yield "wall times and costs"
    if reproduction.left_out:
        yield f"{counted(reproduction.left_out, 'cell')} without a recorded result"


def _other_versions(recorded: Mapping[str, str]) -> dict[str, tuple[str, str]]:
    """Return the programs whose version differs from the recorded one, with both versions."""
    now = own_versions()
    return {
        name: (version, now[name])
        for name, version in recorded.items()
        if name in now and now[name] != version
    }


def _reproduce_run(result: StudyRecord, again: Path, *, trust: bool) -> Reproduction:
    """Run the conditions of a run again, with its recorded answers, and compare the results."""
    folder, settings = result.folder.path, result.plan["cells"][0]["key"]["setting"]
    check_trust(_code_of(result), trust=trust)
    models = _replaying(result, again.with_name("answers"))
    if is_address(settings["world"]):
        raise InputError(
            f"{folder} was run in the world {settings['world']}, which is in real time and cannot "
            f"be repeated; runs in other worlds can"
        )
    system = None
    if "system" in settings:
        system = again.with_name("system.txt")
        replace_file(system, str(settings["system"]))
    options = RunOptions(
        scenario=str(folder / "scenario.yaml"),
        condition=list(settings["conditions"]),
        world=settings["world"],
        models=",".join(models[name] for name in settings["models"]),
        repeat=settings["repeat"],
        out=again,
        seed=settings["seed"],
        cache="off",
        attempts=settings["attempts"],
        temperature=settings["temperature"],
        claims_from=models.get(settings.get("claims_from", "")),
        json=True,
        # Limits of time have no effect on recorded answers.
        system=system,
        skills=settings.get("skills"),
        max_output_tokens=settings.get("max_output_tokens"),
    )
    # The result is in the folder's cells, so that the command's print is dropped.
    with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(ModelError):
        run_scenarios(options)
    ended = [cell for cell, content in _contents(result) if content["error"] is None]
    return Reproduction(
        cells=len(ended),
        left_out=len(result.plan["cells"]) - len(ended),
        rows=sum(row["outcome"] != "error" for row in result.rows),
        differences=(
            *differing_table(result),
            *_differences(result, StudyRecord.read(again), models),
        ),
    )


def _replaying(result: StudyRecord, folder: Path) -> dict[str, str]:
    """Return by name of a model the model that replays its answers, from files that are written."""
    folder.mkdir(parents=True, exist_ok=True)
    models = {"offline": "offline"}
    exchanges = result.folder.exchanges()
    for number, name in enumerate(each.name for each in facts_of(result).models):
        if name != "offline":
            file = folder / f"{number}.jsonl"
            own = [encode_exchange(each) for each in exchanges if each.model == name]
            replace_file(file, b"".join(line + b"\n" for line in own))
            models[name] = f"replay:{file}"
    return models


def _contents(run: StudyRecord) -> Iterator[tuple[Mapping[str, Any], Mapping[str, Any]]]:
    """Yield the cells that were tried, each with the content of its file."""
    for cell in run.plan["cells"]:
        content = run.folder.cell(cell["name"])
        if content is not None:
            yield cell, content


def _differences(
    recorded: StudyRecord, again: StudyRecord, models: Mapping[str, str]
) -> Iterator[PairedDifference]:
    def key(cell: Mapping[str, Any], model: str) -> tuple[Any, ...]:
        return cell["key"]["condition"], cell["seed"], model

    after = {key(cell, cell["key"]["model"]): content for cell, content in _contents(again)}
    for cell, before in _contents(recorded):
        where = f"cells/{cell['name']}.json"
        now = after.get(key(cell, models[cell["key"]["model"]]), {})
        if before["error"] is None and now.get("error") is not None:
            yield PairedDifference(where, ERROR, None, now["error"])
        elif before["error"] is None:
            yield from differing_contents(before, now, where, _OF_MACHINE)
