"""Scores of repeated runs: pass rates and means, and how sure they are."""

import math
from collections.abc import Sequence

import numpy as np

__all__ = ["mean_interval", "wilson_interval"]

_DRAWS = 2_000

_Z95 = 1.959963984540054


def wilson_interval(passed: int, total: int) -> tuple[float, float]:
    """The 95 % interval of a pass rate.

    Args:
        passed: Runs that passed.
        total: All runs, at least 1.

    Returns:
        Lowest and highest rate, in [0, 1]. Source: Wilson (1927), without continuity
        correction; unlike the normal one it holds for few runs and for rates of 0 and 1.
    """
    rate = passed / total
    spread = _Z95**2 / total
    middle = (rate + spread / 2) / (1 + spread)
    half = _Z95 / (1 + spread) * math.sqrt(rate * (1 - rate) / total + spread / (4 * total))
    return max(0.0, middle - half), min(1.0, middle + half)


def mean_interval(values: Sequence[float]) -> tuple[float, float] | tuple[None, None]:
    """The 95 % interval of a mean, the same each time; None: there are less than two values.

    Source: Efron (1979), the bootstrap's percentiles; it stays within the values' range.
    """
    if len(values) < 2:
        return None, None
    known = np.asarray(values, dtype=float)
    draws = np.random.default_rng(0).integers(0, len(known), (_DRAWS, len(known)))
    low, high = np.percentile(known[draws].mean(axis=1), [2.5, 97.5])
    return float(low), float(high)
