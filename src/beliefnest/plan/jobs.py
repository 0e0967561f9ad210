"""Playing of the open cells of a plan, one by one, in processes, or on a cluster with joblib."""

import contextlib
import warnings
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Protocol

import msgspec

from beliefnest.errors import BodyError, InputError, MissingExtraError, UnknownNameError
from beliefnest.llm.failures import UnavailableModelError
from beliefnest.llm.messages import Usage
from beliefnest.plan.cells import Keyed
from beliefnest.plan.processes import Crew, Supply, processes
from beliefnest.plan.spending import spent_in
from beliefnest.plan.terms import Terms
from beliefnest.plan.worker import Ahead, CellResult, Worker, play_in_process
from beliefnest.world.texts import quoted
from beliefnest.world.words import counted

BACKENDS = ("loky", "dask", "ray")
"""Joblib backends: processes of this machine, or a Dask or Ray cluster."""


_Results = Generator[CellResult, None, None]
_ROUND = 8
"""Cells per job in a batch on Ray; results are written after each batch."""
_FEW = {"embedded": 8, "scripted": 80}
"""Most quick cells, by world, that one process has played before another one has started."""


class CellFolder(Protocol):
    """Folder that keeps the results of cells."""

    @property
    def ledger(self) -> Path:
        """File with the usage of each answer, one line each."""

    def cell(self, name: str) -> dict[str, Any] | None:
        """Return the result of a cell; None: it has none."""

    def write_cell(self, name: str, content: Mapping[str, Any]) -> None:
        """Write the result of a cell, completely or not at all."""

    def note_seconds(self, name: str, seconds: float) -> None:
        """Note the wall time of a cell."""


class StudyProgress(msgspec.Struct, frozen=True):
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
MakeWorker = Callable[[ExitStack], Worker]
Hire = Callable[[int, str, Ahead], contextlib.AbstractContextManager[Crew]]
"""Function that starts worker processes, as `processes` does."""


def run_cells(
    cells: Sequence[Keyed],
    folder: CellFolder,
    terms: Terms,
    jobs: int,
    backend: str,
    on_progress: OnStudyProgress,
    ahead: Ahead,
    worker: MakeWorker = Worker,
    hire: Hire = processes,
) -> None:
    """Play the cells without a result, and write each result as soon as it is known.

    Cells that failed before are tried again.

    Args:
        cells: The cells.
        folder: Folder of the results.
        terms: What all cells share.
        jobs: Number of cells to play in parallel.
        backend: One of `BACKENDS`.
        on_progress: Function that receives the progress.
        ahead: Function that launches the world of a process before the process plays.
        worker: Function that makes the worker of this process if no other one plays.
        hire: Function that starts the other processes of this machine.

    Raises:
        InputError: `jobs` is not a whole number, at least 1.
        UnknownNameError: The backend does not exist.
        MissingExtraError: The backend is not installed.
        BodyError: A worker process ended unexpectedly.
        UnavailableModelError: A model cannot be asked at all; the other cells are not tried.
    """
    if not isinstance(jobs, int) or isinstance(jobs, bool) or jobs < 1:
        raise InputError(f"jobs is {quoted(jobs)}; it must be a whole number, at least 1")
    if backend not in BACKENDS:
        raise UnknownNameError(f"there is no backend {backend!r}; there are {', '.join(BACKENDS)}")
    before = ((cell, folder.cell(cell.key.name)) for cell in cells)
    left = [cell for cell, record in before if record is None or record["error"] is not None]

    def progressed(done: int, failed: int) -> StudyProgress:
        progress = StudyProgress(len(cells), done, failed, spent_in(folder.ledger))
        on_progress(progress)
        return progress

    progress = progressed(len(cells) - len(left), 0)
    keys = {cell.key.name: cell.key for cell in left}
    with contextlib.closing(_results(left, terms, jobs, backend, ahead, worker, hire)) as results:
        warned: set[str] = set()
        for result in results:
            for each in result.warnings:
                if each.subject not in warned:
                    warnings.warn(each, stacklevel=2)
                warned.add(each.subject)
            key = keys[result.name]
            folder.note_seconds(result.name, result.seconds)
            record = {"key": key.content_json(), "seed": key.seed, **result.content}
            folder.write_cell(result.name, record)
            if result.unavailable:
                raise UnavailableModelError(
                    f"{result.unavailable}; {counted(progress.left, 'cell')} left to play: run it "
                    "again after that"
                )
            has_result = result.content["error"] is None
            progress = progressed(progress.done + has_result, progress.failed + (not has_result))


def _results(
    cells: Sequence[Keyed],
    terms: Terms,
    jobs: int,
    backend: str,
    ahead: Ahead,
    make_worker: MakeWorker,
    hire: Hire,
) -> _Results:
    if not cells:
        return
    # One process plays few quick cells sooner than several, which have to start.
    few = _FEW.get(_world_of(cells), 1) if all(cell.is_quick for cell in cells) else 1
    if backend == "loky" and (jobs == 1 or len(cells) <= few):
        with ExitStack() as stack:
            worker = make_worker(stack)
            for cell in cells:
                yield worker.play(cell, terms)
        return
    with _engine(backend, jobs):
        if backend == "loky":
            yield from _in_processes(cells, terms, jobs, ahead, hire)
        else:
            yield from _on_cluster(cells, terms, jobs, backend)


def _in_processes(
    cells: Sequence[Keyed], terms: Terms, jobs: int, ahead: Ahead, hire: Hire
) -> _Results:
    """Play cells in processes of this machine.

    This process plays quick cells, too: so cells are played while the others start, and one process
    less has to start. It hands on the results of the others between its own cells. If a cell may
    take long, it plays none, and hands on each result at once.
    """
    plays = all(cell.is_quick for cell in cells)
    world = _world_of(cells)
    with ExitStack() as stack:
        # Before the pool, whose library takes a moment to import.
        launch = stack.enter_context(ahead(world, 0)) if plays else None
        supply = Supply(cells, terms)
        crew = stack.enter_context(hire(min(jobs, len(cells)) - plays, world, ahead))
        stack.enter_context(supply.played_by(crew))
        if plays:
            worker = Worker(stack, launch)
            while (cell := supply.take()) is not None:
                yield worker.play(cell, terms)
                yield from supply.results(wait=False)
        yield from supply.results(wait=True)


def _world_of(cells: Sequence[Keyed]) -> str:
    """Return the name of the world in which all cells are played; empty: each has its own."""
    worlds = {cell.world for cell in cells}
    return worlds.pop() if len(worlds) == 1 else ""


def _on_cluster(cells: Sequence[Keyed], terms: Terms, jobs: int, backend: str) -> _Results:
    from joblib import Parallel, delayed, parallel_config

    # Cells take long, so dispatching them one by one costs little.
    form = "list" if backend == "ray" else "generator_unordered"
    with parallel_config(backend=backend, n_jobs=jobs):
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
            if backend == "dask":
                _enter_dask(stack, jobs)
            elif backend == "ray":
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
