"""Cells of studies: in one process, in two, on a local Dask cluster, in the scripted world."""

import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from beliefnest.cli.bench.figures import Figure
from beliefnest.errors import BodyError
from beliefnest.studies.study import Study

__all__ = ["measure"]

_VARIATIONS = 200


def measure() -> Sequence[Figure]:
    """Two hundred variations of Sally-Anne with the offline model, worlds' start included."""
    study = Study("sally-anne", variations=_VARIATIONS, conditions=[1])
    study.plan()
    # What is compiled is kept for the processes that come.
    _seconds(Study("sally-anne", variations=1, conditions=[1]), 1, "loky")
    one, two, dask = (
        _seconds(study, jobs, backend) for jobs, backend in ((1, "loky"), (2, "loky"), (2, "dask"))
    )
    scripted = Study("sally-anne", variations=_VARIATIONS, conditions=[1], world="scripted")
    scripted.plan()
    alone = _seconds(scripted, 1, "loky")
    return [
        Figure("cells a second, two jobs", _VARIATIONS / two, "1/s", 8.0, at_least=True),
        Figure("two jobs against one", one / two, "x", 1.8, at_least=True),
        Figure("a local Dask cluster against two jobs", dask / two, "x", 1.2),
        Figure("cells a second, scripted", _VARIATIONS / alone, "1/s", 100.0, at_least=True),
    ]


def _seconds(study: Study, jobs: int, backend: str) -> float:
    with tempfile.TemporaryDirectory() as folder:
        started = time.perf_counter()
        result = study.run(Path(folder), jobs, backend)
        seconds = time.perf_counter() - started
        wrong = [row for row in result.rows if not row["ok"]]
        if wrong:
            raise BodyError(
                f"{len(wrong)} of {len(result.rows)} rows are not ok; {wrong[0]['why_not']}"
            )
        return seconds
