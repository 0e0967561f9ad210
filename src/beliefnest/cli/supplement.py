"""`beliefnest reproduce SUPPLEMENT`: play a study or run again without models, and compare."""

import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Any

from msgspec.structs import asdict, replace

from beliefnest.cli.console import print_report, progress_on
from beliefnest.cli.gallery import Gallery, RunResults
from beliefnest.cli.run import conditions_of
from beliefnest.cli.run_cells import plan_run_cells
from beliefnest.cli.terminal_text import printable
from beliefnest.errors import InputError, ModelError
from beliefnest.llm.budget import RunLimits
from beliefnest.llm.recorded_models import ReplayModel, replaying
from beliefnest.nest.past.versions import own_versions
from beliefnest.plan.jobs import OnStudyProgress, StudyProgress, run_cells
from beliefnest.plan.worker import Worker
from beliefnest.scenarios.sources import read_document
from beliefnest.studies.archive import damaged_files, unpack
from beliefnest.studies.bundling import opened
from beliefnest.studies.comparing import ERROR, PairedDifference, differing_contents
from beliefnest.studies.foreign_code import Code, check_trust, code_of, functions_in
from beliefnest.studies.kinds import RUN_KIND
from beliefnest.studies.reproducing import (
    Reproduction,
    check_templates,
    code_in_study,
    differing_table,
    reproduce_study,
)
from beliefnest.studies.study_folder import StudyFolder
from beliefnest.studies.study_record import StudyRecord
from beliefnest.world.words import counted
from beliefnest.worlds.minecraft.launching import ahead
from beliefnest.worlds.names import is_address

_MOST_TOLD = 20
_OF_MACHINE = ("seconds", "run_dir", "key", "table")
"""Keys of results that differ between machines, or repeat other keys for people."""


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
                reproduction = _reproduce_run(result, again, told, trust=trust)
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
        "differences": [asdict(each) for each in differences],
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


def _reproduce_run(
    result: StudyRecord, again: Path, on_progress: OnStudyProgress, *, trust: bool
) -> Reproduction:
    """Play the cells of a run again, with its recorded answers, and compare the results."""
    folder, settings = result.folder, result.plan["cells"][0]["key"]["setting"]
    check_trust(_code_of(result), trust=trust)
    if is_address(settings["world"]):
        raise InputError(
            f"{folder.path} was run in the world {settings['world']}, which is in real time and "
            f"cannot be repeated; runs in other worlds can"
        )
    scenarios = conditions_of(str(folder.path / "scenario.yaml"), settings["conditions"])
    place = StudyFolder.open(again, RUN_KIND)
    terms = replace(place.terms(RunLimits(None, None)), models=_replaying(folder, settings))
    worker = partial(Worker, seed=settings["seed"], caught=ModelError)
    with closing(Gallery()) as gallery:
        cells = plan_run_cells(scenarios, settings, again, (), gallery)
        results = RunResults(again, RUN_KIND, gallery)
        run_cells(cells, results, terms, 1, "loky", on_progress, ahead, worker)
    before = [folder.cell(cell["name"]) for cell in result.plan["cells"]]
    ended = [
        (cell["name"], content, place.cell(now.key.name))
        for cell, content, now in zip(result.plan["cells"], before, cells, strict=True)
        if content is not None and content["error"] is None
    ]
    return Reproduction(
        cells=len(ended),
        left_out=len(before) - len(ended),
        rows=sum(row["outcome"] != "error" for row in result.rows),
        differences=(*differing_table(result), *_differences(ended)),
    )


def _replaying(folder: StudyFolder, settings: Mapping[str, Any]) -> dict[str, ReplayModel]:
    """Return the models that replay the answers of those of a run, by name."""
    names = {*settings["models"], settings.get("claims_from", "offline")} - {"offline"}
    exchanges = folder.exchanges()
    return {
        name: replaying(name, (each for each in exchanges if each.model == name)) for name in names
    }


def _differences(
    ended: Sequence[tuple[str, Mapping[str, Any], Mapping[str, Any] | None]],
) -> Iterator[PairedDifference]:
    for name, before, now in ended:
        where = f"cells/{name}.json"
        assert now is not None
        if now["error"] is not None:
            yield PairedDifference(where, ERROR, None, now["error"])
        else:
            yield from differing_contents(before, now, where, _OF_MACHINE)
