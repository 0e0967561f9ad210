"""Figures that a benchmark returns."""

import statistics
import time
from collections.abc import Callable

import msgspec

__all__ = ["Metric", "median_seconds"]


class Metric(msgspec.Struct, frozen=True):
    """One measured figure.

    Attributes:
        name: Name of the quantity.
        value: Median of the measurements, or a ratio.
        unit: Unit of the value.
        target: Value to reach; None: no target.
        at_least: True if good values are at or above the target, False if at or below.
    """

    name: str
    value: float
    unit: str
    target: float | None = None
    at_least: bool = False

    @property
    def ok(self) -> bool | None:
        """Return True if the target is reached; None: there is no target."""
        if self.target is None:
            return None
        return self.value >= self.target if self.at_least else self.value <= self.target


def median_seconds(act: Callable[[], object], times: int) -> float:
    """Return the median wall time of a call, in seconds."""
    spans = []
    for _ in range(times):
        started = time.perf_counter()
        act()
        spans.append(time.perf_counter() - started)
    return statistics.median(spans)
