"""Agreement of a model's judgments with those of people: correlations with intervals."""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from beliefnest.suites.films.film import FilmRow, JudgedPart
from beliefnest.world.array_types import Floats

PUBLISHED = {
    None: {"desires": 0.908, "beliefs": 0.783},
    "true_belief": {"desires": 0.72, "beliefs": -0.02},
    "no_cost": {"desires": 0.75, "beliefs": 0.10},
}
"""Correlations with people in experiment 1 of Baker and others 2017, by lesion."""

_SHARE = 0.95
_RESAMPLES = 10_000
_CHUNK = 1_000
_FEWEST = 3


@dataclass(frozen=True)
class JudgesAgreement:
    """Pairs of judgments: of the model, and of people.

    Attributes:
        about: What they are about.
        names: Goal or event of each pair.
        model: float64 (pairs,).
        people: float64 (pairs,).
        errors: float64 (pairs,), standard errors of people's means; nan: not known.
        films: int64 (pairs,), index of the film that each pair belongs to.
    """

    about: JudgedPart
    names: tuple[str, ...] = field(repr=False)
    model: Floats = field(repr=False)
    people: Floats = field(repr=False)
    errors: Floats = field(repr=False)
    films: npt.NDArray[np.int64] = field(repr=False)

    @property
    def r(self) -> float:
        """Pearson's coefficient; nan where one side does not vary."""
        return float(_pearson(_sums(self.model, self.people).sum(axis=0)))


def agreement(rows: Iterable[FilmRow], about: JudgedPart) -> JudgesAgreement:
    """Put a model's judgments of scored films beside people's.

    Films with a step that no hypothesis explains are left out.
    """
    names, pairs = [], []
    numbers: dict[str, int] = {}
    for row in rows:
        number = numbers.setdefault(row.film, len(numbers))
        counts = row.scored and row.impossible is None
        if counts and row.about == about and row.people is not None:
            names.append(row.name)
            error = np.nan if row.people_se is None else row.people_se
            pairs.append((row.model, row.people, error, number))
    columns = np.array(pairs, dtype=np.float64).reshape(-1, 4).T
    return JudgesAgreement(
        about, tuple(names), columns[0], columns[1], columns[2], columns[3].astype(np.int64)
    )


def interval(pairs: JudgesAgreement, seed: int = 0) -> tuple[float, float] | None:
    """Return the 95 % bootstrap interval of Pearson's coefficient, by percentiles.

    Films are drawn with replacement, each with all its judgments, since those of one film depend
    on each other.

    Returns:
        Its ends; None: there are fewer than three films.
    """
    films, which = np.unique(pairs.films, return_inverse=True)
    if len(films) < _FEWEST:
        return None
    sums = np.zeros((len(films), 6))
    np.add.at(sums, which, _sums(pairs.model, pairs.people))
    rng = np.random.default_rng(seed)
    drawn = []
    for start in range(0, _RESAMPLES, _CHUNK):
        count = min(_CHUNK, _RESAMPLES - start)
        times = rng.multinomial(len(films), np.full(len(films), 1 / len(films)), count)
        drawn.append(_pearson(times @ sums))
    coefficients = np.concatenate(drawn)
    if np.isnan(coefficients).all():
        return None
    tail = 50 * (1 - _SHARE)
    low, high = np.nanpercentile(coefficients, [tail, 100 - tail])
    return float(low), float(high)


def _sums(model: Floats, people: Floats) -> Floats:
    """Return the terms of the sums in Pearson's coefficient, for each pair (pairs, 6)."""
    x, y = _standardised(model), _standardised(people)
    return np.stack([np.ones_like(x), x, y, x * x, y * y, x * y], axis=-1)


def _standardised(values: Floats) -> Floats:
    """Return values around 0, of a size around 1, so that sums of squares lose no digits."""
    if not len(values):
        return values
    centred: Floats = values - values.mean()
    size = float(np.abs(centred).max())
    # If all values are equal, their mean may differ from them by rounding: return zeros.
    return centred / size if size > 1e-12 * float(np.abs(values).max()) else centred * 0


def _pearson(sums: Floats) -> Floats:
    n, x, y, xx, yy, xy = np.moveaxis(sums, -1, 0)
    spread = (n * xx - x * x) * (n * yy - y * y)
    # A resample that contains only one film may have a spread that is only a rounding error.
    variance = np.where(spread > 1e-20, spread, np.nan)
    with np.errstate(invalid="ignore"):
        coefficients: Floats = (n * xy - x * y) / np.sqrt(variance)
    return coefficients
