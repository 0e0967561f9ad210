"""Pass rates of repeated runs, and how sure they are."""

import math

__all__ = ["wilson_interval"]

_Z95 = 1.959963984540054


def wilson_interval(passed: float, total: int) -> tuple[float, float]:
    """Compute the 95 % interval of a pass rate.

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
