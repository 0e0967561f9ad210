"""Fits of regressions: GEE, mixed models, Firth's penalised likelihood, the cluster bootstrap.

Each function takes arrays with one entry for each row: `right` (0 or 1), `design` (one column for
each term), `groups` (numbers of the variations from 0). A fit that has no sound estimates says why
in `fault` and has no other content.
"""

import math
import warnings
from collections.abc import Callable
from typing import Any, Literal

import msgspec
import numpy as np

from beliefnest.errors import MissingExtraError
from beliefnest.world.array_types import Floats

Family = Literal["binomial", "gaussian"]

Z95 = 1.959963984540054
_CHI95 = Z95**2
_NODES = 15
"""Nodes of the adaptive Gauss-Hermite quadrature."""
_FARTHEST = 15.0
"""Log odds, or standard deviation of intercepts, beyond which the likelihood hardly changes."""
_DRAWS = 2_000
_ROUNDING = 1e-12
_MOST_TERMS = 60
_TOO_MANY = f"there are more than {_MOST_TERMS} coefficients"
_ERRORS = (np.linalg.LinAlgError, ArithmeticError, ValueError)
"""Errors that numerical libraries raise if the data do not determine a model."""


class Fit(msgspec.Struct, frozen=True):
    """Estimates of one model.

    Attributes:
        estimates: Estimate of each term.
        errors: Standard errors.
        low: Lower bounds of the 95 % intervals.
        high: Upper bounds.
        tests: Two-sided p of each term.
        correlation: Working correlation, or standard deviation of the intercepts.
        told: Details of the method, in words.
        fault: Reason why there are no sound estimates; empty: they are sound.
        raw: Result object of the library; None: there is none.
    """

    estimates: Floats
    errors: Floats
    low: Floats
    high: Floats
    tests: Floats
    correlation: float = 0.0
    told: str = ""
    fault: str = ""
    raw: Any = None

    @classmethod
    def failed(cls, fault: str) -> "Fit":
        """Return a fit without estimates."""
        none = np.zeros(0)
        return cls(none, none, none, none, none, fault=fault)

    @classmethod
    def wald(
        cls, estimates: Any, errors: Any, correlation: float, how: str = "", raw: Any = None
    ) -> "Fit":
        """Return a fit with z tests; a failed one if some error is zero or not finite."""
        coefficients, own = np.asarray(estimates, dtype=float), np.asarray(errors, dtype=float)
        if not np.isfinite([*coefficients, *own]).all():
            return cls.failed("the estimates are not finite")
        if (own < 1e-7).any():
            return cls.failed("the answers do not vary between variations")
        tests = np.array([math.erfc(abs(z) / math.sqrt(2)) for z in coefficients / own])
        low, high = coefficients - Z95 * own, coefficients + Z95 * own
        return cls(coefficients, own, low, high, tests, correlation, how, raw=raw)


def gee(right: Floats, design: Floats, groups: Any, family: Family) -> Fit:
    """Fit generalized estimating equations with bias-reduced robust errors.

    The working correlation is exchangeable. If the estimated correlation makes the matrix of the
    largest variation nearly singular, or each variation has one row, it is independence.
    """
    api = statsmodels()
    sizes = np.bincount(groups)
    structures = {"exchangeable": api.cov_struct.Exchangeable()} if sizes.max() > 1 else {}
    structures["independence"] = api.cov_struct.Independence()
    for name, structure in structures.items():
        chosen = api.families.Binomial() if family == "binomial" else api.families.Gaussian()
        model = api.GEE(right, design, groups=groups, family=chosen, cov_struct=structure)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                result = model.fit(cov_type="bias_reduced", maxiter=200)
        except _ERRORS:
            continue
        shared = float(structure.dep_params or 0.0) if name == "exchangeable" else 0.0
        # Eigenvalues of the largest working correlation matrix.
        least = min(1 - shared, 1 + (int(sizes.max()) - 1) * shared)
        if result.converged and least > 1e-3 and _bounded(result.params, family):
            # Rounding can make a variance of 0 negative.
            errors = np.sqrt(np.maximum(np.diag(result.cov_robust_bc), 0.0))
            how = f"{name} working correlation"
            return Fit.wald(result.params, errors, shared, how, result)
    return Fit.failed("the generalized estimating equations do not converge")


def _bounded(estimates: Any, family: Family) -> bool:
    return family == "gaussian" or bool((np.abs(estimates) < _FARTHEST).all())


def mixed(right: Floats, design: Floats, groups: Any, family: Family) -> Fit:
    """Fit a mixed model with a random intercept for each variation."""
    fitted = _logistic_mixed if family == "binomial" else _linear_mixed
    try:
        return fitted(right, design, groups)
    except _ERRORS:
        return Fit.failed("the matrix of the mixed model is singular")


_BOUNDARY = (
    "the variance between variations is estimated as 0 (a singular fit), so that the mixed model "
    "is not identified"
)


def _linear_mixed(right: Floats, design: Floats, groups: Any) -> Fit:
    """Fit a linear model with a normal random intercept by REML.

    The likelihood is profiled over one parameter: the ratio of the variance of the intercepts to
    that of the residuals. This finds a variance of 0, at which general optimisers fail.
    """
    from scipy.optimize import minimize_scalar

    count, terms = design.shape
    sizes = np.bincount(groups).astype(float)
    sums = np.zeros((len(sizes), terms))
    np.add.at(sums, groups, design)
    totals = np.bincount(groups, right)

    def solved(share: float) -> tuple[float, Floats, float, Floats]:
        ratio = share / (1 - share)
        weights = ratio / (1 + sizes * ratio)
        matrix = design.T @ design - (sums.T * weights) @ sums
        vector = design.T @ right - (sums.T * weights) @ totals
        fixed = np.asarray(np.linalg.solve(matrix, vector), dtype=np.float64)
        rest = max(float(right @ right - weights @ totals**2 - vector @ fixed), 0.0)
        variance = rest / (count - terms)
        deviance = (
            (count - terms) * math.log(max(variance, 1e-300))
            + float(np.log1p(sizes * ratio).sum())
            + float(np.linalg.slogdet(matrix)[1])
        )
        return deviance, fixed, variance, matrix

    if count - terms < 1:
        return Fit.failed("there are no more rows than coefficients")
    grid = np.linspace(0, 0.999, 60)
    best = int(np.argmin([solved(float(each))[0] for each in grid]))
    bounds = (float(grid[max(0, best - 1)]), float(grid[min(len(grid) - 1, best + 1)]))
    fixed = minimize_scalar(
        lambda share: solved(share)[0], bounds=bounds, method="bounded", options={"xatol": 1e-9}
    )
    deviance, estimates, variance, matrix = solved(float(fixed.x))
    if variance < 1e-10 or fixed.x > 0.998:
        return Fit.failed("the answers do not vary within variations")
    if solved(0.0)[0] - deviance < 1e-6:
        return Fit.failed(_BOUNDARY)
    errors = np.sqrt(variance * np.diag(np.linalg.inv(matrix)))
    spread = math.sqrt(variance * fixed.x / (1 - fixed.x))
    return Fit.wald(estimates, errors, spread, raw=fixed)


def _logistic_mixed(right: Floats, design: Floats, groups: Any) -> Fit:
    """Fit a logistic model with a normal random intercept by maximum likelihood.

    The likelihood of a group integrates over its intercept by adaptive Gauss-Hermite quadrature
    (Liu and Pierce, 1994). statsmodels has this model only with approximations of its posterior:
    the mode, at which the variance of the intercepts collapses to 0, and mean-field variational
    Bayes, whose standard deviations are too small.
    """
    from scipy.optimize import minimize
    from statsmodels.tools.numdiff import approx_fprime, approx_hess

    if design.shape[1] > _MOST_TERMS:
        return Fit.failed(_TOO_MANY)
    negative = _marginal(right, design, groups)
    begin = firth(right, design, groups).estimates
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = minimize(negative, np.append(begin, 0.7), method="BFGS")
        slope = approx_fprime(result.x, negative, centered=True)
        matrix = approx_hess(result.x, negative)
    if not np.isfinite(result.x).all() or not (np.abs(result.x) < _FARTHEST).all():
        return Fit.failed("the likelihood of the mixed model has no finite maximum")
    if negative(np.append(result.x[:-1], 0.0)) - result.fun < 1e-4:
        return Fit.failed(_BOUNDARY)
    eigenvalues = np.linalg.eigvalsh(matrix)
    if eigenvalues[0] < 1e-8 * eigenvalues[-1]:
        return Fit.failed("the matrix of the mixed model is nearly singular")
    inverse = np.linalg.inv(matrix)
    # Twice the distance of the log likelihood from that of the maximum.
    if float(slope @ inverse @ slope) > 1e-4:
        return Fit.failed("the fit of the mixed model does not converge")
    errors = np.sqrt(np.diag(inverse))
    return Fit.wald(result.x[:-1], errors[:-1], abs(float(result.x[-1])), raw=result)


def _marginal(right: Floats, design: Floats, groups: Any) -> Callable[[Floats], float]:
    """Return the negative log likelihood of coefficients and deviation of the intercepts."""
    # Equal rows of a group are computed once.
    table = np.column_stack([groups, right, design])
    unique, counts = np.unique(table, axis=0, return_counts=True)
    owners, signs, rows = unique[:, 0].astype(int), 2 * unique[:, 1] - 1, unique[:, 2:]
    starts = np.flatnonzero(np.diff(owners, prepend=-1))
    nodes, weights = np.polynomial.hermite.hermgauss(_NODES)

    def negative(values: Floats) -> float:
        fixed, spread = rows @ values[:-1], float(values[-1])
        middles = np.zeros(len(starts))
        for _ in range(100):
            chances = 1 / (
                1 + np.exp(np.clip(signs * (fixed + spread * middles[owners]), -500, 500))
            )
            pull = spread * np.add.reduceat(counts * signs * chances, starts) - middles
            bend = spread**2 * np.add.reduceat(counts * chances * (1 - chances), starts) + 1
            step = np.clip(pull / bend, -1, 1)
            middles = middles + step
            if np.abs(step).max() < 1e-10:
                break
        places = middles[:, None] + math.sqrt(2) * nodes / np.sqrt(bend)[:, None]
        linear = fixed[:, None] + spread * places[owners]
        logs = -np.logaddexp(0, -signs[:, None] * linear) * counts[:, None]
        sums = np.add.reduceat(logs, starts, axis=0) - places**2 / 2 + nodes**2 + np.log(weights)
        return -float((np.logaddexp.reduce(sums, axis=1) - np.log(bend * math.pi) / 2).sum())

    return negative


def firth(right: Floats, design: Floats, groups: Any) -> Fit:
    """Fit a logistic regression with Firth's penalty, whose estimates are always finite.

    A row of a variation with m rows weighs 1 / (1 + (m - 1) r), with the intraclass correlation r
    of Pearson's residuals (Rao and Scott, 1992). The same weight is computed for rows of a
    variation with equal levels; the smaller one counts. Intervals and tests are those of the
    profile penalised likelihood (Firth, 1993; Heinze and Schemper, 2002).
    """
    if design.shape[1] > _MOST_TERMS:
        return Fit.failed(_TOO_MANY)
    patterns, codes = np.unique(design, axis=0, return_inverse=True)
    codes = codes.ravel()
    _, alike = np.unique(np.column_stack([groups, codes]), axis=0, return_inverse=True)

    def penalised(weights: Floats) -> "_Penalised":
        totals, rights = (
            np.bincount(codes, each, len(patterns)).astype(np.float64)
            for each in (weights, weights * right)
        )
        return _Penalised(patterns, totals, rights)

    plain = penalised(np.ones(len(right)))
    chances = plain.chances(plain.fitted())[codes]
    residuals = (right - chances) / np.sqrt(chances * (1 - chances))
    weights = [_weights(residuals, each) for each in (groups, alike.ravel())]
    model = penalised(np.minimum(*weights))
    best = model.fitted()
    errors = np.sqrt(np.diag(np.linalg.inv(model.information(best))))
    bounds = [model.bounds(best, number, float(errors[number])) for number in range(len(best))]
    tests = [model.p(best, number) for number in range(len(best))]
    low, high = np.array(bounds).T
    return Fit(best, errors, low, high, np.array(tests))


def _weights(residuals: Floats, groups: Any) -> Floats:
    """Return the weight of each row, from the correlation of residuals of one group."""
    sizes, sums = np.bincount(groups), np.bincount(groups, residuals)
    pairs, squares = float((sizes * (sizes - 1)).sum()), float((residuals**2).sum())
    if not pairs:
        return np.ones(len(residuals))
    shared = (float((sums**2).sum()) - squares) / pairs / (squares / len(residuals))
    return np.asarray(1 / (1 + (sizes[groups] - 1) * min(1.0, max(0.0, shared))))


class _Penalised(msgspec.Struct, frozen=True):
    """Penalised likelihood of a logistic regression.

    Attributes:
        patterns: Different rows of the design matrix.
        totals: Weight of the rows of each pattern.
        rights: Weight of the right ones.
    """

    patterns: Floats
    totals: Floats
    rights: Floats

    def chances(self, values: Floats) -> Floats:
        """Return the probability of a right answer of each pattern."""
        return np.asarray(1 / (1 + np.exp(-np.clip(self.patterns @ values, -30, 30))))

    def information(self, values: Floats) -> Floats:
        """Return Fisher's information."""
        chances = self.chances(values)
        return np.asarray(
            (self.patterns.T * (self.totals * chances * (1 - chances))) @ self.patterns
        )

    def likelihood(self, values: Floats) -> float:
        """Return the penalised log likelihood."""
        linear = np.clip(self.patterns @ values, -30, 30)
        logs = self.rights @ linear - self.totals @ np.logaddexp(0, linear)
        return float(logs + np.linalg.slogdet(self.information(values))[1] / 2)

    def fitted(self, fixed: int | None = None, begin: Floats | None = None) -> Floats:
        """Return the coefficients of the maximum; that of `fixed` keeps its value in `begin`."""
        values = np.zeros(self.patterns.shape[1]) if begin is None else begin.copy()
        free = [number for number in range(len(values)) if number != fixed]
        if not free:
            return values
        best = self.likelihood(values)
        for _ in range(200):
            chances = self.chances(values)
            information = self.information(values)
            spread = self.totals * chances * (1 - chances)
            hats = spread * np.einsum(
                "ij,ji->i", self.patterns, np.linalg.solve(information, self.patterns.T)
            )
            score = self.patterns.T @ (self.rights - self.totals * chances + hats * (0.5 - chances))
            step = np.linalg.solve(information[np.ix_(free, free)], score[free])
            step *= min(1.0, 5 / max(np.abs(step).max(), 1e-12))
            for _half in range(30):
                tried = values.copy()
                tried[free] += step
                reached = self.likelihood(tried)
                if reached >= best - 1e-12:
                    break
                step = step / 2
            gained, values, best = reached - best, tried, reached
            if np.abs(step).max() < 1e-9 or gained < 1e-12:
                break
        return values

    def _distance(self, best: Floats, number: int, value: float) -> float:
        """Return twice the loss of likelihood if a coefficient has another value."""
        begin = best.copy()
        begin[number] = value
        return 2 * (self.likelihood(best) - self.likelihood(self.fitted(number, begin)))

    def p(self, best: Floats, number: int) -> float:
        """Return the p of the likelihood ratio test of a coefficient."""
        return math.erfc(math.sqrt(max(0.0, self._distance(best, number, 0.0)) / 2))

    def bounds(self, best: Floats, number: int, error: float) -> tuple[float, float]:
        """Return the 95 % interval of a coefficient by the profile likelihood."""
        from scipy.optimize import brentq

        def beyond(value: float) -> float:
            return self._distance(best, number, value) - _CHI95

        ends = []
        for side in (-1.0, 1.0):
            inside, outside = float(best[number]), float(best[number]) + side * 2 * error
            while beyond(outside) < 0 and abs(outside) < 2 * _FARTHEST:
                inside, outside = outside, outside + side * 2 * error
            is_within = beyond(outside) < 0
            ends.append(outside if is_within else float(brentq(beyond, inside, outside, xtol=1e-7)))
        return ends[0], ends[1]


def bootstrap(right: Floats, design: Floats, groups: Any) -> Fit:
    """Fit a linear regression by least squares, with intervals of the cluster bootstrap.

    Whole variations are drawn with replacement, always in the same way (Field and Welsh, 2007);
    intervals are percentiles.
    """
    terms, count = design.shape[1], int(groups.max()) + 1
    if terms > _MOST_TERMS:
        return Fit.failed(_TOO_MANY)
    matrices, vectors = np.zeros((count, terms, terms)), np.zeros((count, terms))
    np.add.at(matrices, groups, design[:, :, None] * design[:, None, :])
    np.add.at(vectors, groups, design * right[:, None])
    chance = np.random.default_rng(0)
    drawn = chance.multinomial(count, np.full(count, 1 / count), _DRAWS).astype(float)
    all_matrices = np.tensordot(drawn, matrices, 1)
    full = np.linalg.matrix_rank(all_matrices, hermitian=True) == terms
    if full.mean() < 0.95:
        return Fit.failed("too many draws of variations lack a level")
    solutions = np.linalg.solve(all_matrices[full], (drawn[full] @ vectors)[:, :, None])[:, :, 0]
    best = np.linalg.solve(matrices.sum(axis=0), vectors.sum(axis=0))
    low, high = np.percentile(solutions, [2.5, 97.5], axis=0)
    # A draw without an effect is 0 on either side, whatever its rounding.
    below = (1 + (solutions <= _ROUNDING).sum(axis=0)) / (1 + len(solutions))
    above = (1 + (solutions >= -_ROUNDING).sum(axis=0)) / (1 + len(solutions))
    tests = np.minimum(1.0, 2 * np.minimum(below, above))
    return Fit(best, solutions.std(axis=0, ddof=1), low, high, tests)


def statsmodels() -> Any:
    """Import statsmodels.

    Raises:
        MissingExtraError: It is not installed.
    """
    try:
        from statsmodels import api
    except ModuleNotFoundError:
        raise MissingExtraError("regressions of studies need statsmodels", "stats") from None
    return api
