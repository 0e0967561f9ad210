"""What a bench returns."""

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass

__all__ = ["Metric", "median_seconds"]


@dataclass(frozen=True, slots=True)
class Metric:
    """One measured figure.

    Attributes:
        name: What was measured.
        value: The median, or a ratio.
        unit: Its unit.
        target: The figure to reach; None: none was set.
        at_least: Whether the target is the least and not the greatest good value.
    """

    name: str
    value: float
    unit: str
    target: float | None = None
    at_least: bool = False

    @property
    def ok(self) -> bool | None:
        """True if the target was reached; None: there is none."""
        if self.target is None:
            return None
        return self.value >= self.target if self.at_least else self.value <= self.target


def median_seconds(act: Callable[[], object], times: int) -> float:
    """Median wall time of an act."""
    spans = []
    for _ in range(times):
        started = time.perf_counter()
        act()
        spans.append(time.perf_counter() - started)
    return statistics.median(spans)
