"""Sources of data frames: run files, folders of runs, folders of studies."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from beliefnest.errors import InputError
from beliefnest.studies.result import StudyResult
from beliefnest.studies.run_result import REPORT, read_report

FrameSource = str | Path | StudyResult
"""A run file, the folder of a run, the folder of a study, or a study's result."""

_RUN_FILE = "run.bn"
_AGAIN = "move it away to read the recorded runs alone"


@dataclass(frozen=True)
class RecordedCell:
    """One cell: a scenario under one condition, played once.

    Attributes:
        cell: Id of the cell: in a study its name, in a run's folder the folder of its condition,
            else the name of the run file.
        about: Settings and results as plain values; empty if there is only a run file.
        file: Run file; None if nothing was recorded.
    """

    cell: str
    about: Mapping[str, Any]
    file: Path | None


def study_of(source: FrameSource) -> StudyResult | None:
    """Return the study of a source; None if the source is not a study."""
    if isinstance(source, StudyResult):
        return source
    return StudyResult.read(source) if (Path(source) / "cells").is_dir() else None


def cells_of(source: FrameSource) -> Iterator[RecordedCell]:
    """Yield the cells of a source, in order.

    Raises:
        InputError: The source holds neither a run nor a study.
    """
    study = study_of(source)
    if study is not None:
        yield from _cells_of_study(study)
        return
    path = Path(source) if not isinstance(source, StudyResult) else source.folder.path
    if path.is_file():
        yield RecordedCell(path.stem, {}, path)
        return
    report = read_report(path, _AGAIN) if (path / REPORT).is_file() else {"runs": []}
    runs = {Path(run["run_dir"]).absolute(): run for run in report["runs"]}
    files = sorted(path.rglob(_RUN_FILE))
    if not files:
        raise InputError(
            f"there is no run at {path}: it has no {_RUN_FILE} and is not the folder of a study"
        )
    for file in files:
        relative = file.parent.relative_to(path).as_posix()
        about = runs.get(file.parent.absolute(), {})
        named = {"scenario": report["scenario"], **about} if about else {}
        yield RecordedCell(relative, named, file)


def _cells_of_study(study: StudyResult) -> Iterator[RecordedCell]:
    folder = study.folder
    for planned in study.plan["cells"]:
        record = folder.cell(planned["name"])
        if record is None:
            continue
        run = record.get("run")
        file = folder.path / run if run else None
        about = {**planned["key"], "seed": planned["seed"], **record}
        yield RecordedCell(planned["name"], about, file)
