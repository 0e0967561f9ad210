"""Pass rates of repeated runs and their confidence intervals."""

import math

_Z95 = 1.959963984540054


def wilson_interval(passed: float, total: int) -> tuple[float, float]:
    """Compute the 95 % interval of a pass rate.

    Args:
        passed: Number of runs that passed.
        total: Number of all runs, at least 1.

    Returns:
        Lowest and highest rate, in [0, 1]. Source: Wilson (1927), without continuity correction.
        Unlike the normal approximation, it is valid for few runs and for rates of 0 and 1.
    """
    rate = passed / total
    spread = _Z95**2 / total
    middle = (rate + spread / 2) / (1 + spread)
    half = _Z95 / (1 + spread) * math.sqrt(rate * (1 - rate) / total + spread / (4 * total))
    # Rounding must not leave the rate itself outside.
    return max(0.0, min(rate, middle - half)), min(1.0, max(rate, middle + half))
