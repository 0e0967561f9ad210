"""Registry of benchmarks."""

import importlib
from collections.abc import Mapping, Sequence

from beliefnest.cli.bench.figures import Metric
from beliefnest.errors import UnknownNameError

__all__ = ["BENCHES", "checked", "measure"]

BENCHES: Mapping[str, str] = {
    "sally-anne": "beliefnest.cli.bench.sally_anne",
    "startup": "beliefnest.cli.bench.startup",
    "body": "beliefnest.cli.bench.body",
    "size": "beliefnest.cli.bench.size",
    "programs": "beliefnest.cli.bench.programs",
    "timelines": "beliefnest.cli.bench.timelines",
    "prompts": "beliefnest.cli.bench.prompts",
    "beliefs": "beliefnest.cli.bench.beliefs",
    "stories": "beliefnest.cli.bench.stories",
    "pictures": "beliefnest.cli.bench.pictures",
    "viewer": "beliefnest.cli.bench.viewer",
    "studies": "beliefnest.cli.bench.studies",
    "episodes": "beliefnest.cli.bench.episodes",
    "minecraft": "beliefnest.cli.bench.minecraft",
    "pettingzoo": "beliefnest.cli.bench.pettingzoo",
}
"""Modules of benchmarks by name; a module is imported when its `measure()` is needed."""


NEEDING_MORE = frozenset({"minecraft"})
"""Benchmarks that need something not installed, such as a server; they run only if named."""


def checked(names: Sequence[str]) -> Sequence[str]:
    """Return the names of benchmarks to run; if none is given, all that need nothing more.

    Raises:
        UnknownNameError: A benchmark does not exist.
    """
    for name in names:
        if name not in BENCHES:
            raise UnknownNameError(f"there is no bench {name!r}; there are {', '.join(BENCHES)}")
    return names or [name for name in BENCHES if name not in NEEDING_MORE]


def measure(name: str) -> Sequence[Metric]:
    """Run a benchmark of the registry."""
    figures: Sequence[Metric] = importlib.import_module(BENCHES[name]).measure()
    return figures
