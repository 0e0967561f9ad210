"""Sources of data frames: run files, folders of runs, folders of studies."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import msgspec

from beliefnest.errors import InputError
from beliefnest.studies.result import StudyResult

FrameSource = str | Path | StudyResult
"""A run file, the folder of a run, the folder of a study, or a study's result."""

_RUN_FILE = "run.bn"


class RecordedCell(msgspec.Struct, frozen=True):
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
    """Return the study or run of a source; None if the source has no results."""
    if isinstance(source, StudyResult):
        return source
    # A run of an earlier version is refused as it is everywhere.
    has_results = any((Path(source) / name).exists() for name in ("cells", "run.json"))
    return StudyResult.read(source) if has_results else None


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
    files = sorted(path.rglob(_RUN_FILE))
    if not files:
        raise InputError(
            f"there is no run at {path}: it has no {_RUN_FILE} and is not the folder of a study"
        )
    for file in files:
        yield RecordedCell(file.parent.relative_to(path).as_posix(), {}, file)


def _cells_of_study(study: StudyResult) -> Iterator[RecordedCell]:
    folder = study.folder
    for planned in study.plan["cells"]:
        record = folder.cell(planned["name"])
        if record is None:
            continue
        run = record.get("run")
        file = folder.path / run if run else None
        about = {**planned["key"], "seed": planned["seed"], **record}
        name = Path(run).parent.as_posix() if run and folder.of == "run" else planned["name"]
        yield RecordedCell(name, about, file)
