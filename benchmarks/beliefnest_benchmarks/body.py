"""Benchmark of making a body for a belief."""

from collections.abc import Sequence

from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.scenario import Scenario
from beliefnest_benchmarks.figures import Metric, median_seconds

__all__ = ["measure"]

_RUNS = 20


def measure() -> Sequence[Metric]:
    """Return the time of a fork of `/observer` with three agents, blocks, chests and bots."""
    scenario = Scenario.load("sally-anne")
    numbers = iter(range(_RUNS + 1))
    with Nest.open(scenario) as nest:
        nest.play()
        belief = nest["/observer"]

        def fork() -> None:
            belief.switch("follow")
            belief.switch(f"try {next(numbers)}")

        fork()
        return [
            Metric("a body for a belief with three agents", median_seconds(fork, _RUNS), "s", 0.3)
        ]
