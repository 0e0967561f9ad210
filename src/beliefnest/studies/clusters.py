"""Intervals and tests for rows that come in clusters, such as the rows of one variation.

Rows of one variation are not independent: they share the scene. The independent unit is the
variation. Intervals therefore resample variations, and tests exchange levels of whole variations.
"""

from collections.abc import Collection, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from beliefnest.scenarios.scoring import wilson_interval

DRAWS = 2_000
"""Draws of a bootstrap."""

FEWEST = 5
"""Least number of clusters for a bootstrap of a share; of fewer, its intervals are too narrow."""

_MOST_WEIGHTS = 4_000_000
"""Greatest number of weights that are computed at once."""


def mean_interval(clusters: Sequence[Sequence[float]]) -> tuple[float, float] | tuple[None, None]:
    """Compute the 95 % interval of the mean of all values, reproducibly.

    The method is the cluster bootstrap of Field and Welsh (2007): clusters are drawn with
    replacement, and the interval consists of percentiles of the means (Efron, 1979).

    Args:
        clusters: Values by cluster, at least one in each.

    Returns:
        Lowest and highest mean; None for both if there are fewer than two clusters, or if all have
        the same mean, so that the draws do not vary.
    """
    if len(clusters) < 2:
        return None, None
    sums = np.array([sum(values) for values in clusters], dtype=float)
    counts = np.array([len(values) for values in clusters], dtype=float)
    draws = np.random.default_rng(0).integers(0, len(clusters), (DRAWS, len(clusters)))
    means = sums[draws].sum(axis=1) / counts[draws].sum(axis=1)
    low, high = np.percentile(means, [2.5, 97.5])
    return (float(low), float(high)) if low < high else (None, None)


def rate_interval(clusters: Sequence[Sequence[float]]) -> tuple[float, float, str]:
    """Compute the 95 % interval of a rate, and name the method.

    Args:
        clusters: Values from 0 to 1 by cluster, at least one cluster with at least one value in
            each. True is 1.

    Returns:
        Lowest rate, highest rate, and the method, `wilson` or `bootstrap`. The method is
        Wilson's interval if each cluster has one value, else the cluster bootstrap. If all
        clusters have the same mean, or there are fewer than `FEWEST`, a bootstrap says nothing;
        the method then is Wilson's interval for as many values as there are clusters.
    """
    if len(clusters) >= FEWEST and any(len(values) > 1 for values in clusters):
        low, high = mean_interval(clusters)
        if low is not None and high is not None:
            return low, high, "bootstrap"
    mean = sum(map(sum, clusters)) / sum(map(len, clusters))
    return *wilson_interval(mean * len(clusters), len(clusters)), "wilson"


def crossed_interval(
    values: Sequence[float], variations: Sequence[object], people: Sequence[Collection[object]]
) -> tuple[tuple[float, float] | None, int]:
    """Compute the 95 % interval of a mean if people answered several variations.

    The method is the pigeonhole bootstrap of Owen (2007): variations and people are drawn with
    replacement, independently of each other. A value counts as often as its variation was drawn
    times each of its people.

    Args:
        values: Values, at least one.
        variations: Variation of each value.
        people: People of each value; empty: it counts as often as its variation was drawn.

    Returns:
        Lowest and highest mean, and the number of independent values. None in place of both if no
        two values share a variation or a person, or if the means of all draws are equal: the
        caller then knows a better method for this number of values.
    """
    rows = _numbers(variations)
    columns = _numbers([person for group in people for person in group])
    if len(rows) == len(values) == sum(map(len, people)) == len(columns):
        return None, len(values)
    means = _crossed_means(values, [rows[each] for each in variations], people, columns)
    low, high = np.percentile(means, [2.5, 97.5])
    if low == high:
        return None, min(len(rows), len(columns) or len(rows))
    return (float(low), float(high)), len(values)


def _crossed_means(
    values: Sequence[float],
    rows: Sequence[int],
    people: Sequence[Collection[object]],
    columns: Mapping[object, int],
) -> npt.NDArray[np.float64]:
    """Return the mean of each draw of a pigeonhole bootstrap that contains a value.

    Args:
        values: The values.
        rows: Number of the variation of each value.
        people: People of each value.
        columns: Numbers of the people.
    """
    most = max(map(len, people))
    # The last column is that of nobody.
    numbers = [[columns[each] for each in group] for group in people]
    places = np.array([each + [len(columns)] * (most - len(each)) for each in numbers], dtype=int)
    chance = np.random.default_rng(0)
    drawn = _drawn(chance, max(rows) + 1)
    weights = np.hstack([_drawn(chance, len(columns)), np.ones((DRAWS, 1))])
    step = max(1, _MOST_WEIGHTS // len(values))
    means = []
    for start in range(0, DRAWS, step):
        part = slice(start, start + step)
        own = drawn[part][:, rows]
        for place in places.T:
            own = own * weights[part][:, place]
        totals = own.sum(axis=1)
        # A draw may contain no value if few people answered few variations each.
        means.append((own @ np.asarray(values, dtype=float))[totals > 0] / totals[totals > 0])
    return np.concatenate(means)


def _numbers(names: Sequence[object]) -> dict[object, int]:
    return {name: number for number, name in enumerate(dict.fromkeys(names))}


def _drawn(chance: "np.random.Generator", count: int) -> npt.NDArray[np.float64]:
    """Return how often each of `count` clusters is drawn, for each draw of a bootstrap."""
    if not count:
        return np.zeros((DRAWS, 0))
    return chance.multinomial(count, np.full(count, 1 / count), DRAWS).astype(float)


def exchange_p(differences: Sequence[int]) -> float:
    """Compute the two-sided p of an exact permutation test on paired clusters.

    Each permutation exchanges the two levels in some clusters, which negates their differences.
    With one pair in each cluster this is McNemar's exact test.

    Args:
        differences: For each cluster, the number of pairs that are right with one level only,
            minus the number of pairs that are right with the other level only.

    Returns:
        Share of all permutations whose total is at least as far from zero as the observed total.
    """
    sizes = [abs(each) for each in differences if each]
    reach = sum(sizes)
    # Share of permutations by total; the total 0 is at the middle index.
    shares = np.zeros(2 * reach + 1)
    shares[reach] = 1.0
    for size in sizes:
        shares = (np.roll(shares, size) + np.roll(shares, -size)) / 2
    far = np.abs(np.arange(-reach, reach + 1)) >= abs(sum(differences))
    return float(min(1.0, shares[far].sum()))
