"""Second implementation of each statistic, from its definition, without code of the package.

Each function takes plain arrays, and is written for reading, not for speed.
"""

import itertools
import math

import numpy as np
from scipy import optimize, stats

__all__ = [
    "bonett_price",
    "bootstrap_means",
    "crossed_bootstrap_means",
    "difference_width",
    "firth",
    "gee",
    "is_separated",
    "least_squares_bootstrap",
    "linear_mixed_errors",
    "logistic_mixed",
    "mcnemar_power",
    "newcombe",
    "rate_widths",
    "sign_exchange_p",
]


def bootstrap_means(clusters, seed, draws=6_000):
    """Draw clusters with replacement; return the mean of all values of each draw."""
    chance = np.random.default_rng(seed)
    means = []
    for _ in range(draws // 10):
        # Ten draws at once, of which each is a list of clusters.
        for chosen in chance.integers(0, len(clusters), (10, len(clusters))):
            values = [value for number in chosen for value in clusters[number]]
            means.append(sum(values) / len(values))
    return np.array(means)


def crossed_bootstrap_means(values, rows, columns, seed, draws=4_000):
    """Draw rows and columns with replacement; a value counts as often as both were drawn."""
    chance = np.random.default_rng(seed)
    kinds = [list(dict.fromkeys(each)) for each in (rows, columns)]
    means = []
    for _ in range(draws):
        counts = []
        for names in kinds:
            drawn = [names[n] for n in chance.integers(0, len(names), len(names))]
            counts.append({name: drawn.count(name) for name in names})
        weights = [counts[0][r] * counts[1][c] for r, c in zip(rows, columns, strict=True)]
        if sum(weights):
            means.append(np.average(values, weights=weights))
    return np.array(means)


def bonett_price(only_one, only_other, pairs):
    """Return Wald's interval of paired proportions after adding one to both discordant counts."""
    p12, p21 = (only_one + 1) / (pairs + 2), (only_other + 1) / (pairs + 2)
    half = stats.norm.ppf(0.975) * math.sqrt((p12 + p21 - (p12 - p21) ** 2) / (pairs + 2))
    return max(-1, p12 - p21 - half), min(1, p12 - p21 + half)


def newcombe(both, only_one, only_other, neither):
    """Return Newcombe's interval of paired proportions (1998, method 10)."""
    n = both + only_one + only_other + neither
    sides = [(both + only_one) / n, (both + only_other) / n]
    z = stats.norm.ppf(0.975)
    limits = []
    for p in sides:
        half = z * math.sqrt(p * (1 - p) / n + z**2 / (4 * n**2))
        limits.append([(p + z**2 / (2 * n) + side * half) / (1 + z**2 / n) for side in (-1, 1)])
    margins = [both + only_one, only_other + neither, both + only_other, only_one + neither]
    over = both * neither - only_one * only_other
    over = max(0, over - n / 2) if over > 0 else over
    phi = over / math.sqrt(math.prod(margins)) if all(margins) else 0.0
    (low, high), (below, above) = limits

    def distance(one, other):
        return math.sqrt(one**2 - 2 * phi * one * other + other**2)

    difference = sides[0] - sides[1]
    return (
        difference - distance(sides[0] - low, above - sides[1]),
        difference + distance(high - sides[0], sides[1] - below),
    )


def rate_widths(rate, count):
    """Return mean, 90th percentile of widths and coverage of Wilson's interval, by enumeration."""
    chances = stats.binom.pmf(range(count + 1), count, rate)
    z = stats.norm.ppf(0.975)
    middles = [(k + z**2 / 2) / (count + z**2) for k in range(count + 1)]
    halves = [
        z / (count + z**2) * math.sqrt(k * (count - k) / count + z**2 / 4) for k in range(count + 1)
    ]
    inside = [abs(rate - m) <= h for m, h in zip(middles, halves, strict=True)]
    widths = 2 * np.array(halves)
    order = np.argsort(widths)
    ninth = order[np.searchsorted(np.cumsum(chances[order]), 0.9)]
    return chances @ widths, widths[ninth], chances @ inside


def difference_width(one, other, pairs):
    """Return the mean width of Bonett and Price's interval of independent pairs."""
    shares = [one * (1 - other), other * (1 - one)]
    shares.append(1 - sum(shares))
    total = 0.0
    for b in range(pairs + 1):
        for c in range(pairs + 1 - b):
            low, high = bonett_price(b, c, pairs)
            total += stats.multinomial.pmf([b, c, pairs - b - c], pairs, shares) * (high - low)
    return total


def sign_exchange_p(differences):
    """Enumerate all exchanges of signs."""
    sizes = [abs(each) for each in differences if each]
    totals = [
        abs(sum(sign * size for sign, size in zip(signs, sizes, strict=True)))
        for signs in itertools.product((1, -1), repeat=len(sizes))
    ]
    return sum(total >= abs(sum(differences)) for total in totals) / len(totals)


def gee(y, x, groups, family):
    """Solve exchangeable estimating equations; return estimates, errors and correlation.

    Errors are those of Mancl and DeRouen (2001). With one row in each group the correlation is 0.
    """
    binomial = family == "binomial"
    owners = [np.flatnonzero(groups == g) for g in range(groups.max() + 1)]
    beta, shared = np.zeros(x.shape[1]), 0.0

    def pieces(beta):
        mean = 1 / (1 + np.exp(-x @ beta)) if binomial else x @ beta
        variance = mean * (1 - mean) if binomial else np.ones(len(y))
        return mean, variance

    for _ in range(500):
        mean, variance = pieces(beta)
        residual = (y - mean) / np.sqrt(variance)
        scale = (residual**2).sum() / (len(y) - x.shape[1])
        pairs = sum(len(own) * (len(own) - 1) / 2 for own in owners)
        products = sum(
            (residual[own].sum() ** 2 - (residual[own] ** 2).sum()) / 2 for own in owners
        )
        shared = products / (pairs - x.shape[1]) / scale if pairs else 0.0
        bread, score = np.zeros((x.shape[1],) * 2), np.zeros(x.shape[1])
        for own in owners:
            slope = x[own] * (variance[own][:, None] if binomial else 1)
            root = np.sqrt(variance[own])
            working = (np.full((len(own),) * 2, shared) + (1 - shared) * np.eye(len(own))) * (
                root[:, None] * root[None, :]
            )
            inverse = np.linalg.inv(working)
            bread += slope.T @ inverse @ slope
            score += slope.T @ inverse @ (y[own] - mean[own])
        step = np.linalg.solve(bread, score)
        beta = beta + step
        if np.abs(step).max() < 1e-11:
            break
    mean, variance = pieces(beta)
    meat = np.zeros_like(bread)
    for own in owners:
        slope = x[own] * (variance[own][:, None] if binomial else 1)
        root = np.sqrt(variance[own])
        working = (np.full((len(own),) * 2, shared) + (1 - shared) * np.eye(len(own))) * (
            root[:, None] * root[None, :]
        )
        inverse = np.linalg.inv(working)
        leverage = slope @ np.linalg.solve(bread, slope.T @ inverse)
        corrected = np.linalg.solve(np.eye(len(own)) - leverage, y[own] - mean[own])
        part = slope.T @ inverse @ corrected
        meat += np.outer(part, part)
    middle = np.linalg.inv(bread)
    return beta, np.sqrt(np.diag(middle @ meat @ middle)), shared


def logistic_mixed(y, x, groups):
    """Maximise the likelihood with integrals over a fine grid; return estimates and deviation."""
    grid = np.linspace(-7, 7, 281)
    density = np.log(stats.norm.pdf(grid)) + math.log(grid[1] - grid[0])
    owners = [np.flatnonzero(groups == g) for g in range(groups.max() + 1)]

    def negative(values):
        total = 0.0
        for own in owners:
            linear = (x[own] @ values[:-1])[:, None] + values[-1] * grid[None, :]
            logs = np.where(
                y[own][:, None] == 1, -np.logaddexp(0, -linear), -np.logaddexp(0, linear)
            )
            total -= np.logaddexp.reduce(logs.sum(axis=0) + density)
        return total

    begin = np.append(np.zeros(x.shape[1]), 1.0)
    found = optimize.minimize(negative, begin, method="L-BFGS-B", options={"ftol": 1e-13})
    return found.x[:-1], abs(found.x[-1])


def firth(y, x, weights):
    """Maximise the penalised likelihood; return estimates, profile intervals and tests."""

    def negative(beta):
        linear = x @ beta
        p = 1 / (1 + np.exp(-np.clip(linear, -30, 30)))
        information = x.T @ (x * (weights * p * (1 - p))[:, None])
        sign, logdet = np.linalg.slogdet(information)
        logs = (weights * (y * linear - np.logaddexp(0, linear))).sum()
        return -(logs + logdet / 2) if sign > 0 else 1e9

    def fitted(fixed=None, value=0.0):
        free = [n for n in range(x.shape[1]) if n != fixed]

        def part(values):
            beta = np.zeros(x.shape[1])
            beta[free] = values
            if fixed is not None:
                beta[fixed] = value
            return negative(beta)

        options = {"gtol": 1e-7}
        begin = np.zeros(len(free))
        found = optimize.minimize(part, begin, method="BFGS", options=options)
        return found.fun, found.x

    best, beta = fitted()
    bounds = []
    for number in range(x.shape[1]):

        def over(value, number=number):
            return 2 * (fitted(number, value)[0] - best) - stats.chi2.ppf(0.95, 1)

        bounds.append(
            [
                optimize.brentq(over, *sorted((beta[number], beta[number] + side * 25)), xtol=1e-5)
                for side in (-1, 1)
            ]
        )
    tests = [stats.chi2.sf(2 * (fitted(number)[0] - best), 1) for number in range(x.shape[1])]
    return beta, np.array(bounds), np.array(tests)


def least_squares_bootstrap(y, x, groups, seed, draws=8_000):
    """Draw groups with replacement, and fit by least squares; return the estimates."""
    chance = np.random.default_rng(seed)
    owners = [np.flatnonzero(groups == g) for g in range(groups.max() + 1)]
    found = []
    for _ in range(draws):
        rows = np.concatenate([owners[n] for n in chance.integers(0, len(owners), len(owners))])
        beta, _, rank, _ = np.linalg.lstsq(x[rows], y[rows], rcond=None)
        if rank == x.shape[1]:
            found.append(beta)
    return np.array(found)


def is_separated(y, x):
    """Return True if the likelihood of a logistic regression has no finite maximum.

    The penalty on squares of coefficients is lowered step by step: coefficients that have a finite
    maximum stay, others grow.
    """
    beta = np.zeros(x.shape[1])
    sizes = []
    for power in range(1, 13):
        penalty = 10.0**-power
        for _ in range(200):
            p = 1 / (1 + np.exp(-x @ beta))
            information = x.T @ (x * (p * (1 - p))[:, None]) + penalty * np.eye(x.shape[1])
            step = np.linalg.solve(information, x.T @ (y - p) - penalty * beta)
            beta = beta + step * min(1, 2 / max(np.abs(step).max(), 1e-12))
            if np.abs(step).max() < 1e-10:
                break
        sizes.append(np.abs(beta).max())
    return sizes[-1] - sizes[-5] > 1


def mcnemar_power(one, other, pairs):
    """Return the power of McNemar's exact test for independent pairs, by enumeration."""
    only_one, only_other = one * (1 - other), other * (1 - one)
    total = 0.0
    for b in range(pairs + 1):
        for c in range(pairs + 1 - b):
            p = 1.0 if b + c == 0 else stats.binomtest(b, b + c).pvalue
            if p < 0.05:
                shares = [only_one, only_other, 1 - only_one - only_other]
                total += stats.multinomial.pmf([b, c, pairs - b - c], pairs, shares)
    return total


def linear_mixed_errors(x, groups, residual, between):
    """Return standard errors of generalised least squares with known variances."""
    covariance = residual * np.eye(len(groups)) + between * (groups[:, None] == groups[None, :])
    return np.sqrt(np.diag(np.linalg.inv(x.T @ np.linalg.inv(covariance) @ x)))
