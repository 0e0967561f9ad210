"""Benchmarks of the Sally-Anne experiment: the whole command, and its script alone."""

import statistics
import time
from collections.abc import Sequence

from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.scenario import Scenario
from beliefnest.world.values import TICKS_PER_SECOND
from beliefnest.worlds.by_name import Worlds
from beliefnest_benchmarks.children import play_scenario
from beliefnest_benchmarks.figures import Metric, median_seconds

__all__ = ["measure"]

_RUNS = 5


def measure() -> Sequence[Metric]:
    """Return the time of the command with all conditions, and the speed of the script."""
    play_scenario("sally-anne")
    whole = median_seconds(lambda: play_scenario("sally-anne"), _RUNS)
    return [
        Metric("all conditions, process start included", whole, "s", 2.0),
        Metric("Minecraft seconds per second of the script", _speed(), "x", 50.0, at_least=True),
    ]


def _speed() -> float:
    """Return the median speed of the three conditions, which share one world as in a run."""
    ratios = []
    with Worlds(0) as worlds:
        for scenario in Scenario.load_all("sally-anne"):
            with Nest.open(scenario, worlds=worlds) as nest:
                started = time.perf_counter()
                nest.play()
                ratios.append(nest.tick / TICKS_PER_SECOND / (time.perf_counter() - started))
    return statistics.median(ratios)
