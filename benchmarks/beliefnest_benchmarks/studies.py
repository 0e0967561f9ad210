"""Benchmarks of studies: in one process, in two, and on a local Dask cluster."""

import os
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import msgspec

from beliefnest.errors import BodyError
from beliefnest.plan.jobs import StudyProgress
from beliefnest.studies.study import Study
from beliefnest_benchmarks.figures import Metric

__all__ = ["measure"]

_VARIATIONS = 200
_FIRST = 24
"""Cells after which all processes have started, and Node has compiled its hot code."""
_SMALL = 24
"""Cells of a small study, in which starting counts."""


class _Run(msgspec.Struct, frozen=True):
    """Times of a study.

    Attributes:
        whole: Seconds from the call to the end of the last process.
        first: Seconds from the call to the first result.
        rate: Cells per second, from cell number `_FIRST` to the last cell.
    """

    whole: float
    first: float
    rate: float


def measure() -> Sequence[Metric]:
    """Return figures of two hundred variations of Sally-Anne with the offline model.

    Figures `once started` begin when all processes play: each process first needs some seconds
    of a core to start Python, its kernels and Node. One job uses more than one core, because
    Node's garbage collector and compiler run beside Python. One job is therefore also measured
    on one core, to compare it with two jobs on two cores.
    """
    study = Study("sally-anne", variations=_VARIATIONS, conditions=[1])
    study.plan()
    # Compile the kernels before the measurement; later processes load them from the cache.
    _run(Study("sally-anne", variations=1, conditions=[1]), 1)
    one, two, dask = (_run(study, *how) for how in ((1, "loky"), (2, "loky"), (2, "dask")))
    with _one_core():
        confined = _run(study, 1)
    scripted = Study("sally-anne", variations=_VARIATIONS, conditions=[1], world="scripted")
    scripted.plan()
    alone = _run(scripted, 1)
    small = Study("sally-anne", variations=_SMALL, conditions=[1])
    small.plan()
    return [
        Metric(f"{_SMALL} cells, one job, start counted", _run(small, 1).whole, "s"),
        Metric(f"{_SMALL} cells, two jobs, start counted", _run(small, 2).whole, "s"),
        Metric("from the start to the first cell of two jobs", two.first, "s", 1.5),
        Metric("cells a second, two jobs", _VARIATIONS / two.whole, "1/s", 8.0, at_least=True),
        Metric(f"cells a second after {_FIRST}, two jobs", two.rate, "1/s", 8.0, at_least=True),
        Metric("two jobs against one, once started", two.rate / one.rate, "x", 1.8, at_least=True),
        Metric(
            "two jobs against one on one core", two.rate / confined.rate, "x", 1.8, at_least=True
        ),
        Metric("two jobs against one, start counted", one.whole / two.whole, "x"),
        Metric("Dask's local cluster, once started", two.rate / dask.rate, "x", 1.2),
        Metric("Dask's local cluster, start counted", dask.whole / two.whole, "x"),
        Metric("cells a second, scripted", _VARIATIONS / alone.whole, "1/s", 100.0, at_least=True),
    ]


@contextmanager
def _one_core() -> Iterator[None]:
    """Restrict child processes to one core, on systems that support it."""
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(before)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


def _run(study: Study, jobs: int, backend: str = "loky") -> _Run:
    ended: dict[int, float] = {}

    def note(progress: StudyProgress) -> None:
        ended[progress.done] = time.perf_counter()

    with tempfile.TemporaryDirectory() as folder:
        started = time.perf_counter()
        result = study.run(Path(folder), jobs, backend, on_progress=note)
        whole = time.perf_counter() - started
        wrong = [row for row in result.rows if not row["ok"]]
        if wrong:
            raise BodyError(
                f"{len(wrong)} of {len(result.rows)} rows are not ok; {wrong[0]['why_not']}"
            )
    count = max(ended)
    first = min(_FIRST, count - 1)
    rate = (count - first) / (ended[count] - ended[first])
    return _Run(whole, ended[1] - started, rate)
