"""Regression of right answers on columns of a study, with variations as groups.

What the rows cannot determine is said in words before anything is fitted.
"""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import msgspec
import numpy as np

from beliefnest.errors import InputError
from beliefnest.studies.allocation import PARTICIPANT
from beliefnest.studies.counting import Row, count_rows, judged_rows
from beliefnest.studies.fits import Family, Fit, bootstrap, firth, gee, mixed, statsmodels
from beliefnest.studies.plainframe import Typed, plain_frame
from beliefnest.world.array_types import Floats
from beliefnest.world.words import counted

if TYPE_CHECKING:  # pandas is optional, and imported when a table is made.
    import pandas


_FEWEST = 3
"""Least number of variations from which an error between variations can be estimated."""

_ColumnNames = tuple[str, ...]
"""Name of a column, or names of columns that interact."""


def _level_of(row: Row, name: str) -> str:
    """Return the level of a row, as text."""
    value = row.get(name)
    return "-" if value is None else str(value)


def _rows_fault(rows: Sequence[Row], names: Sequence[str]) -> str:
    """Return what prevents any regression on some columns; empty: nothing."""
    if not rows:
        return "no row is judged"
    if len({bool(row["ok"]) for row in rows}) == 1:
        side = "right" if rows[0]["ok"] else "wrong"
        return f"all {len(rows)} judged rows are {side}, so that there is nothing to explain"
    for name in names:
        levels = {_level_of(row, name) for row in rows}
        if len(levels) == 1:
            return f"{name} is {levels.pop()} in all judged rows; leave it out"
    return ""


def _support_fault(
    rows: Sequence[Row],
    effects: Sequence[_ColumnNames],
    design: Floats,
    groups: Any,
    terms: Sequence[str],
) -> str:
    """Return which coefficients rest on too few variations; empty: none.

    Args:
        rows: Judged rows.
        effects: Columns, alone or interacting.
        design: Design matrix of full rank.
        groups: Number of the variation of each row.
        terms: Names of the columns of the design matrix.
    """
    total = int(groups.max()) + 1
    if total < _FEWEST:
        return f"the judged rows have {counted(total, 'variation')}; at least {_FEWEST} are needed"
    for names, values, own in _cells(rows, effects):
        variations = len({rows[number]["variation"] for number in own})
        if variations < _FEWEST:
            return (
                f"{_told(names, values)} has judged rows of {counted(variations, 'variation')}; an "
                f"error between variations needs at least {_FEWEST}"
            )
    whole = design.T @ design
    for number in range(total):
        own = design[groups == number]
        rest = whole - own.T @ own
        if np.linalg.matrix_rank(rest, hermitian=True) < len(terms):
            _, vectors = np.linalg.eigh(rest)
            lost = [each for each, at in zip(terms, vectors[:, 0], strict=True) if abs(at) > 1e-6]
            return f"{', '.join(lost)} cannot be told apart without the rows of a single variation"
    return ""


def _certainty_fault(right: Floats, design: Floats) -> str:
    """Return that the effects leave no error to estimate; empty: they leave some."""
    patterns, codes = np.unique(design, axis=0, return_inverse=True)
    shares = np.bincount(codes.ravel(), right) / np.bincount(codes.ravel())
    if ((shares > 0) & (shares < 1)).any() or len(patterns) > design.shape[1]:
        return ""
    return "the effects explain every answer, so that there is no error to estimate"


def _one_sided_level(rows: Sequence[Row], effects: Sequence[_ColumnNames], right: Floats) -> str:
    """Return which level, or combination of levels, has right or wrong rows only; empty: none."""
    for names, values, own in _cells(rows, effects):
        sides = {float(right[number]) for number in own}
        if len(sides) == 1:
            side = "right" if sides == {1.0} else "wrong"
            return f"all {counted(len(own), 'row')} with {_told(names, values)} are {side}"
    return ""


def _separation_fault(
    rows: Sequence[Row],
    effects: Sequence[_ColumnNames],
    right: Floats,
    design: Floats,
    terms: Sequence[str],
) -> str:
    """Return which log odds have no finite estimate; empty: all have one.

    Rows are separated, or quasi-separated, if a linear combination of the design's columns is
    nowhere on the wrong side and somewhere on the right one. A linear program finds it (Konis,
    2007).
    """
    endless = _endless(right, design)
    if not endless:
        return ""
    if level := _one_sided_level(rows, effects, right):
        return f"{level} (separation), so that its log odds have no finite estimate"
    return (
        "the levels of the effects predict some rows without an error (quasi-separation), so that "
        f"the log odds of {', '.join(terms[number] for number in endless)} have no finite estimate"
    )


def _endless(right: Floats, design: Floats) -> list[int]:
    """Return the numbers of the columns whose coefficients may grow without bound."""
    from scipy.optimize import linprog

    patterns, codes = np.unique(design, axis=0, return_inverse=True)
    shares = np.bincount(codes.ravel(), right) / np.bincount(codes.ravel())
    both = (shares > 0) & (shares < 1)
    sides = np.where(shares == 1, 1.0, -1.0)[:, None] * patterns
    equal = {"A_eq": patterns[both], "b_eq": np.zeros(both.sum())} if both.any() else {}
    if both.all():
        return []
    limits = {"A_ub": -sides[~both], "b_ub": np.zeros((~both).sum()), "bounds": (-1, 1)}
    if linprog(-sides[~both].sum(axis=0), **limits, **equal).fun > -1e-7:
        return []
    endless = []
    for number in range(design.shape[1]):
        aim = np.zeros(design.shape[1])
        aim[number] = 1.0
        if any(linprog(sign * aim, **limits, **equal).fun < -1e-7 for sign in (1, -1)):
            endless.append(number)
    return endless


def _cells(
    rows: Sequence[Row], effects: Sequence[_ColumnNames]
) -> Iterator[tuple[_ColumnNames, tuple[str, ...], list[int]]]:
    """Yield each combination of levels of each effect, and of the columns in it."""
    every = itertools.chain.from_iterable(
        itertools.combinations(names, size)
        for names in effects
        for size in range(1, len(names) + 1)
    )
    for names in sorted(dict.fromkeys(every), key=len):
        cells: dict[tuple[str, ...], list[int]] = {}
        for number, row in enumerate(rows):
            cells.setdefault(tuple(_level_of(row, name) for name in names), []).append(number)
        for values, own in cells.items():
            yield names, values, own


def _told(names: _ColumnNames, values: Sequence[str]) -> str:
    return " and ".join(f"{name} {value}" for name, value in zip(names, values, strict=True))


FitKind = Literal["gee", "mixed"]
KINDS: tuple[FitKind, ...] = ("gee", "mixed")
FAMILIES: tuple[Family, ...] = ("binomial", "gaussian")
Effect = str | tuple[str, ...]
"""Name of a column, or names of columns that interact."""

_MOST_COEFFICIENTS = 200

_COUNTED = ("variations", "judged", "right", "accuracy", "low", "high", "interval")
"""Columns of counts, after those of the effects."""


class Term(msgspec.Struct, frozen=True):
    """Coefficient of a regression.

    Attributes:
        name: `intercept`, or `COLUMN[LEVEL]`; joined by `:` for interactions.
        estimate: Estimate: of the log odds, or of the accuracy (`gaussian`).
        se: Its standard error.
        p: Two-sided p.
        low: Lower bound of the 95 % interval.
        high: Upper bound.
    """

    name: str
    estimate: float
    se: float
    p: float
    low: float
    high: float

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % interval."""
        return self.low, self.high

    def plain(self, family: Family) -> dict[str, Any]:
        """Return the values by name, with the odds ratio for the family `binomial`."""
        odds = {"odds_ratio": math.exp(self.estimate)} if family == "binomial" else {}
        return {
            "term": self.name,
            "estimate": self.estimate,
            "low": self.low,
            "high": self.high,
            "se": self.se,
            "p": self.p,
            **odds,
        }


class Substitute(msgspec.Struct, frozen=True):
    """Sound estimates of another method, in place of a fit that is not sound.

    Attributes:
        method: The method, in words.
        terms: Its coefficients, on the same scale.
    """

    method: str
    terms: tuple[Term, ...]


class Regression(msgspec.Struct, frozen=True):
    """Fitted regression of right answers.

    Attributes:
        kind: `gee` or `mixed`.
        family: `binomial` (logit) or `gaussian` (linear probability).
        sound: True if the rows determine the model, and its fit converged.
        note: Reason why the fit is not sound; empty if it is.
        terms: Coefficients; the first level of each column is the reference. Empty if the fit is
            not sound.
        substitute: Estimates of a method that is sound for these rows, in place of a fit that is
            not; None: the fit is sound, or no regression is.
        counts: Accuracy with its interval for each combination of levels, if the fit is not sound.
        references: Reference level of each column.
        rows: Number of judged rows; copies are left out.
        groups: Number of independent variations.
        correlation: Working correlation within variations (`gee`), or the standard deviation of
            the variations' intercepts (`mixed`); None if the fit is not sound.
        method: The method in words, for a methods section.
        raw: Result object of statsmodels or SciPy; None if the fit is not sound.
    """

    kind: FitKind
    family: Family
    sound: bool
    note: str
    terms: tuple[Term, ...]
    substitute: Substitute | None
    counts: tuple[Mapping[str, Any], ...]
    references: Mapping[str, Any]
    rows: int
    groups: int
    correlation: float | None
    method: str
    raw: Any

    def plain(self) -> dict[str, Any]:
        """Return everything but `raw` as plain values."""
        other = self.substitute
        return {
            "sound": self.sound,
            "note": self.note,
            "kind": self.kind,
            "family": self.family,
            "method": self.method,
            "rows": self.rows,
            "variations": self.groups,
            "correlation" if self.kind == "gee" else "intercept_sd": self.correlation,
            "references": dict(self.references),
            "terms": [each.plain(self.family) for each in self.terms],
            "substitute": other
            and {
                "method": other.method,
                "terms": [each.plain(self.family) for each in other.terms],
            },
            "counts": [dict(each) for each in self.counts],
        }

    def table(self) -> "pandas.DataFrame":
        """Return a row for each term: `estimate` with its 95 % interval, `se`, `p`.

        With the family `binomial`, `odds_ratio` is the exponential of the estimate. If the fit is
        not sound, the table has no rows.

        Raises:
            MissingExtraError: pandas is not installed.
        """
        rows = [each.plain(self.family) for each in self.terms]
        names = Term("", 0.0, 0.0, 0.0, 0.0, 0.0).plain(self.family)
        return plain_frame({name: Typed([row[name] for row in rows]) for name in names})


def fit_rows(
    rows: Sequence[Row], effects: Sequence[Effect], kind: FitKind, family: Family
) -> Regression:
    """Fit a regression of `ok` to the judged rows of a study, grouped by `variation`.

    Args:
        rows: Rows of a study; copies and rows without a verdict are left out.
        effects: Columns, and tuples of columns that interact; all are categories.
        kind: `gee` or `mixed`.
        family: `binomial` or `gaussian`.

    Returns:
        The regression; `sound` is False if the rows do not determine it, and `note` says why.

    Raises:
        InputError: The kind or family does not exist, or an effect is the column `variation`.
        MissingExtraError: statsmodels is not installed.
    """
    if kind not in KINDS:
        raise InputError(f"kind is {kind!r}; give one of {', '.join(KINDS)}")
    if family not in FAMILIES:
        raise InputError(f"family is {family!r}; give one of {', '.join(FAMILIES)}")
    wanted: list[_ColumnNames] = [
        (each,) if isinstance(each, str) else tuple(dict.fromkeys(each)) for each in effects
    ]
    names = list(dict.fromkeys(name for each in wanted for name in each))
    if "variation" in names:
        raise InputError("variation is the group of the model; name other effects")
    statsmodels()
    chosen = judged_rows(rows)
    fitted, terms, substitute = _fitted(chosen, wanted, names, kind, family)
    sound = not fitted.fault
    return Regression(
        kind=kind,
        family=family,
        sound=sound,
        note=fitted.fault,
        terms=_terms(terms, fitted),
        substitute=substitute,
        counts=() if sound else tuple(_counts(chosen, names)),
        references={name: _level_of(chosen[0], name) for name in names} if chosen else {},
        rows=len(chosen),
        groups=len({row["variation"] for row in chosen}),
        correlation=fitted.correlation if sound else None,
        method=_method(kind, family, fitted.told or "exchangeable working correlation")
        + (_PEOPLE if any(row.get(PARTICIPANT) for row in chosen) else ""),
        raw=fitted.raw,
    )


def _terms(names: Sequence[str], fit: Fit) -> tuple[Term, ...]:
    columns = (fit.estimates, fit.errors, fit.tests, fit.low, fit.high)
    estimates = zip(*(each.tolist() for each in columns), strict=True)
    return tuple(Term(name, *values) for name, values in zip(names, estimates, strict=False))


def _counts(rows: Sequence[Row], names: Sequence[str]) -> list[dict[str, Any]]:
    return [
        {name: group[name] for name in (*names, *_COUNTED)} for group in count_rows(rows, names)
    ]


def _fitted(
    rows: Sequence[Row],
    effects: Sequence[_ColumnNames],
    names: Sequence[str],
    kind: FitKind,
    family: Family,
) -> tuple[Fit, Sequence[str], Substitute | None]:
    """Return the fit, the names of its terms, and what is sound in its place."""
    fault = _rows_fault(rows, names) or _size_fault(rows, effects)
    if fault:
        return Fit.failed(fault), (), None
    design, terms = _design(rows, effects, names)
    if np.linalg.matrix_rank(design) < design.shape[1]:
        text = ", ".join(":".join(each) for each in effects)
        fault = (
            f"the effects {text} cannot be told apart: one follows from the others, or some "
            "combination has no rows; name fewer effects"
        )
        return Fit.failed(fault), (), None
    right = np.array([bool(row["ok"]) for row in rows], dtype=float)
    groups = _codes([row["variation"] for row in rows])
    thin = _support_fault(rows, effects, design, groups, terms)
    endless, level = "", ""
    if not thin and family == "gaussian":
        endless, level = _certainty_fault(right, design), _one_sided_level(rows, effects, right)
    elif not thin:
        endless = _separation_fault(rows, effects, right, design, terms)
    fault = thin or endless
    if level and kind == "gee":
        # Its robust variance would be 0, however few its rows; a mixed model has one for all rows.
        fault = fault or f"{level}, so that there is no error of theirs to estimate"
    if not fault and kind == "mixed" and int(groups.max()) + 1 == len(rows):
        fault = (
            "each variation has one judged row, so that the variance between variations cannot be "
            "told from that within them"
        )
    if not fault:
        fit = gee if kind == "gee" else mixed
        fitted = fit(right, design, groups, family)
        if not fitted.fault:
            return fitted, terms, None
        fault = fitted.fault
    solid = not (thin or endless or level)
    other = _substitute(right, design, groups, terms, kind, family, solid=solid)
    return Fit.failed(fault), (), other


def _size_fault(rows: Sequence[Row], effects: Sequence[_ColumnNames]) -> str:
    """Return that effects have more coefficients than a fit can take; empty: they have not."""
    count = 1 + sum(
        math.prod(len({_level_of(row, name) for row in rows}) - 1 for name in names)
        for names in effects
    )
    if count <= _MOST_COEFFICIENTS:
        return ""
    return (
        f"the effects have {count:,} coefficients, more than {_MOST_COEFFICIENTS}; name columns "
        "with fewer levels"
    )


def _substitute(
    right: Floats,
    design: Floats,
    groups: Any,
    terms: Sequence[str],
    kind: FitKind,
    family: Family,
    *,
    solid: bool,
) -> Substitute | None:
    """Return the estimates of the first other method that is sound.

    Args:
        right: Answers, as for a fit.
        design: Design matrix.
        groups: Numbers of variations.
        terms: Names of the coefficients.
        kind: Kind of the regression that is not sound.
        family: Its family.
        solid: True if rows of enough variations have each level, and none is right or wrong only.
    """
    if int(groups.max()) + 1 < _FEWEST:
        return None
    if solid and kind == "mixed":
        fitted = gee(right, design, groups, family)
        if not fitted.fault:
            return Substitute(_method("gee", family, fitted.told), _terms(terms, fitted))
    if family == "binomial":
        fitted = firth(right, design, groups)
        return None if fitted.fault else Substitute(_FIRTH, _terms(terms, fitted))
    if solid:
        fitted = bootstrap(right, design, groups)
        if not fitted.fault:
            # A coefficient that is the same in all draws has no error.
            bounded = tuple(each for each in _terms(terms, fitted) if each.high - each.low > 1e-9)
            return Substitute(_BOOTSTRAP, bounded) if bounded else None
    return None


_FIRTH = (
    "logistic regression with Firth's penalty (1993), profile likelihood intervals; rows weigh as "
    "many independent rows as their intraclass correlation within variations leaves (Rao and "
    "Scott, 1992)"
)
_BOOTSTRAP = (
    "linear regression by least squares with percentile intervals of the cluster bootstrap over "
    "variations (2,000 draws; Field and Welsh, 2007)"
)


_PEOPLE = (
    "; participants are no groups, so that the errors tell of other scenes and not of other people"
)


def _method(kind: FitKind, family: Family, how: str) -> str:
    """Return a method in words."""
    software = f"statsmodels {statsmodels().__version__}"
    if kind == "gee":
        link = "logit link" if family == "binomial" else "identity link"
        return (
            f"generalized estimating equations ({family}, {link}), {how} within variations, "
            f"bias-reduced robust standard errors (Mancl and DeRouen, 2001); {software}"
        )
    if family == "binomial":
        return (
            "logistic mixed model with a random intercept for each variation, fitted by maximum "
            f"likelihood (adaptive Gauss-Hermite quadrature), Wald intervals; SciPy and {software}"
        )
    return (
        "linear mixed model with a random intercept for each variation, fitted by REML, Wald "
        "intervals; SciPy"
    )


def _codes(values: Sequence[object]) -> "np.ndarray[Any, Any]":
    numbers = {value: number for number, value in enumerate(dict.fromkeys(values))}
    return np.array([numbers[value] for value in values])


def _design(
    rows: Sequence[Row], effects: Sequence[_ColumnNames], names: Sequence[str]
) -> tuple[Floats, list[str]]:
    """Return the design matrix in treatment coding, and the names of its columns."""
    levels = {name: list(dict.fromkeys(_level_of(row, name) for row in rows)) for name in names}
    dummies = {
        name: {
            f"{name}[{level}]": np.array(
                [_level_of(row, name) == level for row in rows], dtype=float
            )
            for level in factors[1:]
        }
        for name, factors in levels.items()
    }
    columns = {"intercept": np.ones(len(rows))}
    for effect in effects:
        for parts in itertools.product(*(dummies[name].items() for name in effect)):
            term = ":".join(name for name, _ in parts)
            columns[term] = np.prod([values for _, values in parts], axis=0)
    return np.column_stack(list(columns.values())), list(columns)
