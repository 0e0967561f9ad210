"""Regression of right answers on columns of a study, with variations as groups."""

import itertools
import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from beliefnest.errors import InputError, MissingExtraError
from beliefnest.studies.counting import Row, judged_rows
from beliefnest.studies.plainframe import Typed, plain_frame

if TYPE_CHECKING:  # pandas is optional, and imported when a table is made.
    import pandas

__all__ = ["FAMILIES", "KINDS", "Effect", "Family", "Kind", "Regression", "fit_rows"]

Kind = Literal["gee", "mixed"]
Family = Literal["binomial", "gaussian"]
KINDS: tuple[Kind, ...] = ("gee", "mixed")
FAMILIES: tuple[Family, ...] = ("binomial", "gaussian")
Effect = str | tuple[str, ...]
"""Name of a column, or names of columns that interact."""

_NODES = 31
"""Nodes of the Gauss-Hermite quadrature."""
_FARTHEST = 15.0

_Z95 = 1.959963984540054


@dataclass(frozen=True, slots=True)
class Term:
    """Coefficient of a regression.

    Attributes:
        name: `intercept`, or `COLUMN[LEVEL]`; joined by `:` for interactions.
        estimate: Estimate: of the log odds, or of the accuracy (`gaussian`).
        se: Its standard error.
        p: Two-sided p of the z test.
    """

    name: str
    estimate: float
    se: float
    p: float

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % interval."""
        return self.estimate - _Z95 * self.se, self.estimate + _Z95 * self.se


@dataclass(frozen=True)
class Regression:
    """Fitted regression of right answers.

    Attributes:
        kind: `gee` or `mixed`.
        family: `binomial` (logit) or `gaussian` (linear probability).
        terms: Coefficients; the first level of each column is the reference.
        references: Reference level of each column.
        rows: Number of judged rows; copies are left out.
        groups: Number of independent variations.
        correlation: Working correlation within variations (`gee`), or the standard deviation of
            the variations' intercepts (`mixed`).
        software: Name and version of the library.
        raw: Result object of statsmodels or SciPy.
    """

    kind: Kind
    family: Family
    terms: tuple[Term, ...]
    references: Mapping[str, Any]
    rows: int
    groups: int
    correlation: float
    software: str
    raw: Any

    @property
    def method(self) -> str:
        """Return the method in words, for a methods section."""
        link = "logit link" if self.family == "binomial" else "identity link"
        if self.kind == "gee":
            return (
                f"generalized estimating equations ({self.family}, {link}), exchangeable working "
                "correlation within variations, bias-reduced robust standard errors (Mancl and "
                f"DeRouen, 2001); {self.software}"
            )
        if self.family == "binomial":
            return (
                "logistic mixed model with a random intercept for each variation, fitted by "
                f"maximum likelihood (Gauss-Hermite quadrature with {_NODES} nodes), Wald "
                f"intervals; SciPy and {self.software}"
            )
        return (
            "linear mixed model with a random intercept for each variation, fitted by REML; "
            f"{self.software}"
        )

    def plain(self) -> list[dict[str, Any]]:
        """Return the rows of `table` as plain values."""
        odds = self.family == "binomial"
        return [
            {
                "term": each.name,
                "estimate": each.estimate,
                "low": each.interval[0],
                "high": each.interval[1],
                "se": each.se,
                "p": each.p,
                **({"odds_ratio": math.exp(each.estimate)} if odds else {}),
            }
            for each in self.terms
        ]

    def table(self) -> "pandas.DataFrame":
        """Return a row for each term: `estimate` with its 95 % interval, `se`, `p`.

        With the family `binomial`, `odds_ratio` is the exponential of the estimate.

        Raises:
            MissingExtraError: pandas is not installed.
        """
        rows = self.plain()
        return plain_frame({name: Typed([row[name] for row in rows]) for name in rows[0]})


def fit_rows(
    rows: Sequence[Row], effects: Sequence[Effect], kind: Kind, family: Family
) -> Regression:
    """Fit a regression of `ok` to the judged rows of a study, grouped by `variation`.

    Args:
        rows: Rows of a study; copies and rows without a verdict are left out.
        effects: Columns, and tuples of columns that interact; all are categories.
        kind: `gee` or `mixed`.
        family: `binomial` or `gaussian`.

    Raises:
        InputError: The rows do not determine the model; the message says why.
        MissingExtraError: statsmodels is not installed.
    """
    chosen = judged_rows(rows)
    names = list(dict.fromkeys(name for each in effects for name in _columns(each)))
    levels = {name: list(dict.fromkeys(_text(row, name) for row in chosen)) for name in names}
    _check(chosen, names, levels, kind, family)
    design, terms = _design(chosen, effects, levels)
    right = np.array([bool(row["ok"]) for row in chosen], dtype=float)
    groups = _codes([row["variation"] for row in chosen])
    fitted = _fit_gee if kind == "gee" else _fit_mixed
    estimates, errors, tests, correlation, raw = fitted(right, design, groups, family)
    if not np.isfinite([*estimates, *errors]).all():
        raise InputError(
            "the fit has no finite estimates: the data are too few or too uniform for these "
            "effects; name fewer effects, or use the family gaussian"
        )
    return Regression(
        kind=kind,
        family=family,
        terms=tuple(
            Term(name, float(estimate), float(error), p)
            for name, estimate, error, p in zip(terms, estimates, errors, tests, strict=True)
        ),
        references={name: found[0] for name, found in levels.items()},
        rows=len(chosen),
        groups=int(groups.max()) + 1,
        correlation=correlation,
        software=f"statsmodels {_statsmodels().__version__}",
        raw=raw,
    )


def _columns(effect: Effect) -> tuple[str, ...]:
    return (effect,) if isinstance(effect, str) else effect


def _text(row: Row, name: str) -> str:
    value = row.get(name)
    return "-" if value is None else str(value)


def _codes(values: Sequence[object]) -> "np.ndarray[Any, Any]":
    numbers = {value: number for number, value in enumerate(dict.fromkeys(values))}
    return np.array([numbers[value] for value in values])


def _check(
    rows: Sequence[Row],
    names: Sequence[str],
    levels: Mapping[str, Sequence[str]],
    kind: Kind,
    family: Family,
) -> None:
    """Refuse rows from which the model cannot be estimated."""
    if kind not in KINDS:
        raise InputError(f"kind is {kind!r}; give one of {', '.join(KINDS)}")
    if family not in FAMILIES:
        raise InputError(f"family is {family!r}; give one of {', '.join(FAMILIES)}")
    if len({row["variation"] for row in rows}) < 3:
        raise InputError("fewer than three variations have judged rows; play more variations")
    if len({row["ok"] for row in rows}) == 1:
        told = "right" if rows[0]["ok"] else "wrong"
        raise InputError(f"all {len(rows)} judged rows are {told}, so there is nothing to explain")
    for name in names:
        if name == "variation":
            raise InputError("variation is the group of the model; name other effects")
        if len(levels[name]) < 2:
            raise InputError(f"{name} is {levels[name][0]} in all judged rows; leave it out")
        if family == "binomial":
            for level in levels[name]:
                found = {row["ok"] for row in rows if _text(row, name) == level}
                if len(found) == 1:
                    told = "right" if found == {True} else "wrong"
                    raise InputError(
                        f"all rows with {name} {level} are {told}, so that its odds have no finite "
                        "estimate; use the family gaussian (differences of accuracies)"
                    )


def _design(
    rows: Sequence[Row], effects: Sequence[Effect], levels: Mapping[str, Sequence[str]]
) -> tuple["np.ndarray[Any, Any]", list[str]]:
    """Return the design matrix in treatment coding, and the names of its columns."""
    dummies = {
        name: {
            f"{name}[{level}]": np.array([_text(row, name) == level for row in rows], dtype=float)
            for level in found[1:]
        }
        for name, found in levels.items()
    }
    columns = {"intercept": np.ones(len(rows))}
    for effect in effects:
        for parts in itertools.product(*(dummies[name].items() for name in _columns(effect))):
            term = ":".join(name for name, _ in parts)
            columns[term] = np.prod([values for _, values in parts], axis=0)
    matrix = np.column_stack(list(columns.values()))
    if np.linalg.matrix_rank(matrix) < matrix.shape[1]:
        told = ", ".join(":".join(_columns(each)) for each in effects)
        raise InputError(
            f"the effects {told} cannot be told apart: one follows from the others, or some "
            "combination has no rows; name fewer effects"
        )
    return matrix, list(columns)


_Fit = tuple[Sequence[float], Sequence[float], Sequence[float], float, Any]


def _fit_gee(right: Any, design: Any, groups: Any, family: Family) -> _Fit:
    api = _statsmodels()
    chosen = api.families.Binomial() if family == "binomial" else api.families.Gaussian()
    single = len(set(groups)) == len(groups)
    # With one row in each group there is no correlation to estimate.
    covariance = api.cov_struct.Independence() if single else api.cov_struct.Exchangeable()
    model = api.GEE(right, design, groups=groups, family=chosen, cov_struct=covariance)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = model.fit(cov_type="bias_reduced")
    correlation = 0.0 if single else float(covariance.dep_params)
    tests = [_p(e, s) for e, s in zip(result.params, result.bse, strict=True)]
    return list(result.params), list(result.bse), tests, correlation, result


def _fit_mixed(right: Any, design: Any, groups: Any, family: Family) -> _Fit:
    if family == "binomial":
        return _fit_logistic_mixed(right, design, groups)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = _statsmodels().MixedLM(right, design, groups=groups).fit(reml=True)
    estimates, errors = list(result.fe_params), list(result.bse_fe)
    spread = math.sqrt(max(0.0, float(np.asarray(result.cov_re).ravel()[0])))
    tests = [_p(e, s) for e, s in zip(estimates, errors, strict=True)]
    return estimates, errors, tests, spread, result


def _fit_logistic_mixed(right: Any, design: Any, groups: Any) -> _Fit:
    """Fit a logistic model with a normal random intercept by maximum likelihood.

    The likelihood of a group integrates over its intercept, by Gauss-Hermite quadrature.
    statsmodels has this model only with approximations of its posterior: the mode, at which the
    variance of the intercepts collapses to 0, and mean-field variational Bayes, whose standard
    deviations are too small.
    """
    api = _statsmodels()
    from scipy.optimize import minimize
    from statsmodels.tools.numdiff import approx_hess

    nodes, weights = np.polynomial.hermite.hermgauss(_NODES)
    signs = 2 * right - 1
    starts = np.flatnonzero(np.diff(np.sort(groups), prepend=-1))
    order = np.argsort(groups, kind="stable")

    def negative(values: Any) -> float:
        fixed = design @ values[:-1]
        # One column for each node; the deviation may have any sign, as the likelihood is even.
        linear = fixed[:, None] + values[-1] * math.sqrt(2) * nodes[None, :]
        logs = -np.logaddexp(0, -signs[:, None] * linear)
        sums = np.add.reduceat(logs[order], starts, axis=0)
        return -float(
            np.logaddexp.reduce(sums + np.log(weights / math.sqrt(math.pi)), axis=1).sum()
        )

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        begin = api.Logit(right, design).fit_regularized(alpha=1e-3, disp=0).params
        result = minimize(negative, np.append(begin, 0.5), method="BFGS")
        try:
            errors = np.sqrt(np.diag(np.linalg.inv(approx_hess(result.x, negative))))
        except np.linalg.LinAlgError:
            errors = np.full(len(result.x), math.nan)
    # Beyond these log odds, the likelihood hardly changes: some level has no finite estimate.
    if not (np.abs(result.x) < _FARTHEST).all():
        errors[:] = math.nan
    estimates, own = list(result.x[:-1]), list(errors[:-1])
    tests = [_p(e, s) for e, s in zip(estimates, own, strict=True)]
    return estimates, own, tests, abs(float(result.x[-1])), result


def _p(estimate: float, error: float) -> float:
    return math.erfc(abs(estimate) / error / math.sqrt(2)) if error > 0 else math.nan


def _statsmodels() -> Any:
    try:
        from statsmodels import api
    except ModuleNotFoundError:
        raise MissingExtraError("regressions of studies need statsmodels", "stats") from None
    return api
