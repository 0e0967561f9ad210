"""Benchmark of the package's size."""

from collections.abc import Sequence
from pathlib import Path

import beliefnest
from beliefnest_benchmarks.figures import Metric

__all__ = ["measure"]

_NOT_INSTALLED = frozenset({"node_modules", "__pycache__"})


def measure() -> Sequence[Metric]:
    """Return the size of the installed package without its dependencies."""
    folder = Path(beliefnest.__file__).parent
    files = (path for path in folder.rglob("*") if path.is_file())
    size = sum(path.stat().st_size for path in files if not _NOT_INSTALLED & {*path.parts})
    return [Metric("installed package without dependencies", size / 1e6, "MB", 30.0)]
