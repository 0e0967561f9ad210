"""Playing of the open cells of a plan, one by one or in parallel with joblib."""

import contextlib
import os
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from dataclasses import dataclass, replace

from beliefnest.errors import BodyError, MissingExtraError, UnknownNameError
from beliefnest.llm.messages import Usage
from beliefnest.studies.cells import Keyed
from beliefnest.studies.checking import check_count
from beliefnest.studies.spending import spent_in
from beliefnest.studies.study_folder import StudyFolder
from beliefnest.studies.terms import Terms
from beliefnest.studies.worker import CellResult, Worker, play_in_process

__all__ = ["BACKENDS", "OnStudyProgress", "StudyProgress", "run_cells"]

BACKENDS = ("loky", "dask", "ray")
"""Joblib backends: processes of this machine, or a Dask or Ray cluster."""


_Results = Generator[CellResult, None, None]
_ROUND = 8
"""Cells per job in a batch on Ray; results are written after each batch."""


@dataclass(frozen=True, slots=True)
class StudyProgress:
    """Progress of a study.

    Attributes:
        total: Number of cells.
        done: Number of cells with a result, including those of earlier runs.
        failed: Number of cells that were tried in this run and have no result.
        spent: Tokens and cost of all answers, in all runs.
    """

    total: int
    done: int
    failed: int
    spent: Usage

    @property
    def left(self) -> int:
        """Number of cells that have not been tried."""
        return self.total - self.done - self.failed


OnStudyProgress = Callable[[StudyProgress], None]


def run_cells(
    cells: Sequence[Keyed],
    folder: StudyFolder,
    terms: Terms,
    jobs: int,
    backend: str,
    on_progress: OnStudyProgress,
) -> None:
    """Play the cells without a result, and write each result as soon as it is known.

    Cells that failed before are tried again.

    Raises:
        InputError: `jobs` is not a whole number, at least 1.
        UnknownNameError: The backend does not exist.
        MissingExtraError: The backend is not installed.
        BodyError: A worker process ended unexpectedly.
    """
    check_count("jobs", jobs)
    if backend not in BACKENDS:
        raise UnknownNameError(f"there is no backend {backend!r}; there are {', '.join(BACKENDS)}")
    left = [cell for cell in cells if _is_open(folder, cell)]
    progress = _Counting(folder, len(cells), len(cells) - len(left), on_progress)
    keys = {cell.key.name: cell.key for cell in left}
    with contextlib.closing(_results(left, terms, jobs, backend)) as results:
        for result in results:
            key = keys[result.name]
            folder.note_seconds(result.name, result.seconds)
            folder.write_cell(
                result.name, {"key": key.content_json(), "seed": key.seed, **result.content}
            )
            progress.count(result)


def _is_open(folder: StudyFolder, cell: Keyed) -> bool:
    known = folder.cell(cell.key.name)
    # An earlier version may have given the cell another seed.
    return known is None or known["error"] is not None or known["seed"] != cell.key.seed


class _Counting:
    """Counter of finished cells that reports progress."""

    def __init__(
        self, folder: StudyFolder, total: int, done: int, on_progress: OnStudyProgress
    ) -> None:
        self._folder = folder
        self._total = total
        self._done = done
        self._failed = 0
        self._tell = on_progress
        self._say()

    def count(self, result: CellResult) -> None:
        """Count one more result."""
        if result.content["error"] is None:
            self._done += 1
        else:
            self._failed += 1
        self._say()

    def _say(self) -> None:
        spent = spent_in(self._folder.ledger)
        self._tell(StudyProgress(self._total, self._done, self._failed, spent))


def _results(cells: Sequence[Keyed], terms: Terms, jobs: int, backend: str) -> _Results:
    if not cells:
        return
    if jobs == 1 and backend == "loky":
        with ExitStack() as stack:
            worker = Worker(stack)
            for cell in cells:
                yield worker.play(cell, terms)
        return
    yield from _parallel(cells, terms, jobs, backend)


def _parallel(cells: Sequence[Keyed], terms: Terms, jobs: int, backend: str) -> _Results:
    from joblib import Parallel, delayed, parallel_config

    if backend == "loky":
        terms = replace(terms, owner=os.getpid())
    # Cells take long, so dispatching them one by one costs little.
    form = "list" if backend == "ray" else "generator_unordered"
    with _engine(backend, jobs), parallel_config(backend=backend, n_jobs=jobs):
        pool = Parallel(return_as=form, batch_size="auto", pre_dispatch="2*n_jobs")
        # Ray's backend returns no result before all cells of a call are done: use batches.
        some = _ROUND * jobs if backend == "ray" else len(cells)
        for first in range(0, len(cells), some):
            chosen = cells[first : first + some]
            yield from pool(delayed(play_in_process)(cell, terms) for cell in chosen)


@contextlib.contextmanager
def _engine(backend: str, jobs: int) -> Iterator[None]:
    """Set up the backend that runs the cells, and end what was started for it."""
    try:
        with ExitStack() as stack:
            if backend == "loky":
                stack.callback(_end_processes)
            elif backend == "dask":
                _enter_dask(stack, jobs)
            else:
                from ray.util.joblib import register_ray

                register_ray()
            yield
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in ("dask", "distributed", "ray"):
            raise
        raise MissingExtraError(f"the backend {backend!r} is not installed", backend) from None
    except BrokenProcessPool:
        raise BodyError(
            "a worker process ended unexpectedly: it was killed, or the machine ran out of memory; "
            "run the study again to continue, finished cells are kept"
        ) from None


def _enter_dask(stack: ExitStack, jobs: int) -> None:
    """Use the current Dask client, or connect to the configured cluster, or start a local one."""
    import dask
    from distributed import Client, default_client

    try:
        default_client()
    except ValueError:
        if dask.config.get("scheduler-address", None):
            stack.enter_context(Client(set_as_default=True))
        else:
            # A process has one world, and plays one cell at a time in it: one thread each.
            client = Client(n_workers=jobs, threads_per_worker=1, dashboard_address=None)
            stack.enter_context(client)


def _end_processes() -> None:
    """End the worker processes of this machine and the worlds that they keep open."""
    from joblib.externals.loky import get_reusable_executor

    get_reusable_executor().shutdown(wait=True, kill_workers=True)
