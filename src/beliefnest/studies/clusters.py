"""Intervals and tests for rows that come in clusters, such as the rows of one variation.

Rows of one variation are not independent: they share the scene. What is independent is the
variation, so that intervals resample variations, and tests exchange the levels of whole variations.
"""

from collections.abc import Sequence

import numpy as np

from beliefnest.scenarios.scoring import wilson_interval

__all__ = ["exchange_p", "mean_interval", "rate_interval"]

_DRAWS = 2_000


def mean_interval(
    clusters: Sequence[Sequence[float]],
) -> tuple[float, float] | tuple[None, None]:
    """Compute the 95 % interval of the mean of all values, the same each time.

    Args:
        clusters: Values by cluster, at least one in each.

    Returns:
        Lowest and highest mean; None for both where there are fewer than two clusters. Source:
        Field and Welsh (2007), the cluster bootstrap: clusters are drawn with replacement, and
        the interval is given by the percentiles of the means (Efron, 1979).
    """
    if len(clusters) < 2:
        return None, None
    sums = np.array([sum(values) for values in clusters], dtype=float)
    counts = np.array([len(values) for values in clusters], dtype=float)
    draws = np.random.default_rng(0).integers(0, len(clusters), (_DRAWS, len(clusters)))
    means = sums[draws].sum(axis=1) / counts[draws].sum(axis=1)
    low, high = np.percentile(means, [2.5, 97.5])
    return float(low), float(high)


def rate_interval(clusters: Sequence[Sequence[bool]]) -> tuple[float, float, str]:
    """Compute the 95 % interval of the share of True, and name the method.

    Args:
        clusters: Values by cluster, at least one cluster with at least one value in each.

    Returns:
        Lowest share, highest share, and `wilson` or `bootstrap`. It is the interval of Wilson
        where each cluster has one value. It is that of the cluster bootstrap where a cluster has
        several. Where all clusters have the same share the bootstrap has nothing to draw from;
        then it is Wilson's for as many values as there are clusters.
    """
    shares = {sum(values) / len(values) for values in clusters}
    if all(len(values) == 1 for values in clusters) or len(shares) == 1:
        mean = sum(map(sum, clusters)) / sum(map(len, clusters))
        return *wilson_interval(mean * len(clusters), len(clusters)), "wilson"
    low, high = mean_interval(clusters)
    assert low is not None and high is not None
    return low, high, "bootstrap"


def exchange_p(differences: Sequence[int]) -> float:
    """Compute the two-sided p of an exact permutation test on paired clusters.

    In each cluster the two levels are exchanged or not, which turns the sign of its difference.
    With one pair in each cluster this is McNemar's exact test.

    Args:
        differences: For each cluster, how many pairs are right with one level only, less those
            that are right with the other only.

    Returns:
        Share of all exchanges with a total that is as far from zero as the one found.
    """
    sizes = [abs(each) for each in differences if each]
    reach = sum(sizes)
    # Share of exchanges by total; the total 0 is in the middle.
    shares = np.zeros(2 * reach + 1)
    shares[reach] = 1.0
    for size in sizes:
        shares = (np.roll(shares, size) + np.roll(shares, -size)) / 2
    far = np.abs(np.arange(-reach, reach + 1)) >= abs(sum(differences))
    return float(min(1.0, shares[far].sum()))
