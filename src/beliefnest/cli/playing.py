"""Playing of many cells by a command: progress, files, and exit status."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from beliefnest.cli.console import progress_on
from beliefnest.errors import ModelError, UnknownNameError
from beliefnest.plan.jobs import OnStudyProgress, StudyProgress
from beliefnest.scenarios.judging import without_result_words
from beliefnest.studies.allocation import PARTICIPANT
from beliefnest.studies.result import StudyResult


@contextmanager
def playing(title: str, folder: Path | None = None) -> Iterator[tuple[Path, OnStudyProgress]]:
    """Show the progress of cells; without a folder, their results end with the block.

    Yields:
        The folder to play in, and the function that receives the progress.
    """
    with TemporaryDirectory() as scratch, progress_on(title) as on_progress:

        def show(progress: StudyProgress) -> None:
            on_progress("playing", progress.done, progress.total)

        yield folder or Path(scratch), show


def write_tables(result: StudyResult) -> None:
    """Write the tables into the folder of a study or suite; without pyarrow, no Parquet file."""
    try:
        result.write_tables()
    except UnknownNameError as error:
        sys.stderr.write(f"no rows.parquet: {error}\n")


def status_of(result: StudyResult) -> int:
    """Return the exit status of a study or suite: 0 if every judged row is right, else 1.

    Raises:
        ModelError: A cell has no result.
    """
    check_all_played(result)
    rows = (row for row in result.rows if row.get(PARTICIPANT) is None)
    return 0 if all(row["ok"] is not False for row in rows) else 1


def check_all_played(result: StudyResult) -> None:
    """Raise ModelError if a cell has no result."""
    failed = result.failed
    if failed:
        counting = {row["cell"] for row in result.rows if row["ok"] is False} & failed.keys()
        summary = without_result_words(len(failed), len(result.plan["cells"]), len(counting))
        raise ModelError(
            f"{summary}; run the same command to try them again; the first: "
            f"{next(iter(failed.values()))}"
        )
