"""Benchmarks of figures, and of the view of a nest in a notebook."""

import tempfile
from collections.abc import Sequence
from pathlib import Path

from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.scenario import Scenario
from beliefnest_benchmarks.figures import Metric, median_seconds

__all__ = ["measure"]

_PATHS = ("/", "/observer", "/sally", "/observer/sally")
_CHEST = (-2, -51, -4)
_TIMES = 9


def measure() -> Sequence[Metric]:
    """Return the time to make and write figures of Sally-Anne's first condition."""
    with (
        tempfile.TemporaryDirectory() as folder,
        Nest.open(Scenario.load("sally-anne", condition=1)) as nest,
    ):
        nest.play()

        def saved(ending: str) -> float:
            file = Path(folder, f"figure.{ending}")
            nest.figure(_PATHS).save(file)
            return median_seconds(lambda: nest.figure(_PATHS).save(file), _TIMES) * 1000

        shown = median_seconds(nest._repr_html_, _TIMES) * 1000
        plot = median_seconds(
            lambda: nest.plot_beliefs(_CHEST, "diamond", _PATHS)._repr_html_(), _TIMES
        )
        return [
            Metric("a figure of four simulators, SVG", saved("svg"), "ms", 300.0),
            Metric("a figure of four simulators, PDF", saved("pdf"), "ms", 300.0),
            Metric("a figure of four simulators, PNG", saved("png"), "ms", 300.0),
            Metric("what a notebook shows of a nest", shown, "ms", 50.0),
            Metric("a plot of four beliefs over time", plot * 1000, "ms"),
        ]
