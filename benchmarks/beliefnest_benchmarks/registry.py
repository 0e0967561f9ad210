"""Registry of benchmarks."""

import importlib
from collections.abc import Mapping, Sequence

from beliefnest.errors import UnknownNameError
from beliefnest_benchmarks.figures import Metric

__all__ = ["BENCHES", "checked", "measure"]

BENCHES: Mapping[str, str] = {
    "sally-anne": "beliefnest_benchmarks.sally_anne",
    "startup": "beliefnest_benchmarks.startup",
    "body": "beliefnest_benchmarks.body",
    "size": "beliefnest_benchmarks.size",
    "programs": "beliefnest_benchmarks.programs",
    "timelines": "beliefnest_benchmarks.timelines",
    "histories": "beliefnest_benchmarks.histories",
    "prompts": "beliefnest_benchmarks.prompts",
    "beliefs": "beliefnest_benchmarks.beliefs",
    "growth": "beliefnest_benchmarks.growth",
    "stories": "beliefnest_benchmarks.stories",
    "pictures": "beliefnest_benchmarks.pictures",
    "viewer": "beliefnest_benchmarks.viewer",
    "looking": "beliefnest_benchmarks.looking",
    "studies": "beliefnest_benchmarks.studies",
    "episodes": "beliefnest_benchmarks.episodes",
    "minecraft": "beliefnest_benchmarks.minecraft",
    "pettingzoo": "beliefnest_benchmarks.pettingzoo",
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
