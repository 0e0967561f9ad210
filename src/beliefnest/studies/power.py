"""Power by simulation: interval widths and detected differences by the number of variations."""

import math
from collections.abc import Callable, Iterator, Sequence
from statistics import NormalDist
from typing import Any, Protocol

import msgspec
import numpy as np
from msgspec.structs import asdict

from beliefnest.errors import InputError
from beliefnest.studies.checking import is_count, is_whole
from beliefnest.studies.clusters import FEWEST, rate_interval
from beliefnest.studies.counting import Pairs
from beliefnest.world.texts import quoted
from beliefnest.world.words import counted

_ALPHA = 0.05
_MOST = 10_000

OnPowerProgress = Callable[[int, int], None]
"""Function that receives the numbers of finished and of all sets of simulations."""

Cluster = tuple[tuple[bool, ...], tuple[tuple[bool, bool], ...]]
"""Rows of one variation (True: right), and its pairs of rows of two levels."""


class VariationSource(Protocol):
    """Source of simulated variations."""

    @property
    def note(self) -> str:
        """Return why simulations from this source say little; empty: there is no reason."""

    @property
    def accuracy(self) -> float:
        """Return the true accuracy of the simulated rows."""

    def draw(self, count: int, chance: "np.random.Generator") -> Sequence[Cluster]:
        """Draw variations."""


class AssumedRates(msgspec.Struct, frozen=True):
    """Source of variations with an assumed accuracy, difference and correlation.

    Rows are right by a probit model with a normal random intercept for each variation: a row is
    right if `t + s*z + e > 0`, with standard normal z (one for each variation) and e (one for each
    row), `s*s / (1 + s*s)` the correlation, and t such that the share of right rows is the
    accuracy.

    Attributes:
        accuracy: Accuracy with the first level.
        difference: Accuracy with the first level minus accuracy with the second one.
        correlation: Correlation of rows of one variation on the latent scale, from 0 to below 1.
        rows: Number of rows of one variation.
        pairs: Number of pairs of one variation.
    """

    accuracy: float
    difference: float
    correlation: float
    rows: int
    pairs: int

    def __post_init__(self) -> None:
        if not 0 < self.accuracy < 1:
            raise InputError(f"accuracy is {quoted(self.accuracy)}; give a number between 0 and 1")
        if not 0 <= self.correlation < 1:
            raise InputError(
                f"correlation is {quoted(self.correlation)}; give a number from 0 to below 1"
            )
        if not 0 < self.accuracy - self.difference < 1:
            raise InputError(
                f"difference is {quoted(self.difference)}, so that the other accuracy would be "
                f"{self.accuracy - self.difference:g}; it must lie between 0 and 1"
            )

    @property
    def note(self) -> str:
        """Return the empty text."""
        return ""

    def draw(self, count: int, chance: "np.random.Generator") -> Sequence[Cluster]:
        """Draw variations."""
        spread = math.sqrt(self.correlation / (1 - self.correlation))
        shared = spread * chance.standard_normal((count, 1))
        scale = math.sqrt(1 + spread**2)
        first, second = (
            scale * NormalDist().inv_cdf(each)
            for each in (self.accuracy, self.accuracy - self.difference)
        )
        rows = first + shared + chance.standard_normal((count, self.rows)) > 0
        ones = first + shared + chance.standard_normal((count, self.pairs)) > 0
        others = second + shared + chance.standard_normal((count, self.pairs)) > 0
        return [
            (tuple(own), tuple(zip(one, other, strict=True)))
            for own, one, other in zip(rows.tolist(), ones.tolist(), others.tolist(), strict=True)
        ]


class Resampled(msgspec.Struct, frozen=True):
    """Source that draws recorded variations with replacement.

    Attributes:
        clusters: Recorded variations.
    """

    clusters: tuple[Cluster, ...]

    @property
    def accuracy(self) -> float:
        """Return the recorded accuracy; 0 if there are only pairs."""
        rows = [each for own, _ in self.clusters for each in own]
        return sum(rows) / len(rows) if rows else 0.0

    @property
    def note(self) -> str:
        """Return that there are too few recorded variations, or that they are all the same."""
        if len(self.clusters) < FEWEST:
            size = counted(len(self.clusters), "variation")
            return f"{size} recorded, too few to draw from; play at least {FEWEST}"
        if len({self._shares(each) for each in self.clusters}) == 1:
            return "all recorded variations have the same result, so that draws do not vary"
        return ""

    @staticmethod
    def _shares(cluster: Cluster) -> tuple[float, ...]:
        rows, pairs = cluster
        sides = [rows, [one for one, _ in pairs], [other for _, other in pairs]]
        return tuple(sum(side) / len(side) if side else 0.0 for side in sides)

    def draw(self, count: int, chance: "np.random.Generator") -> Sequence[Cluster]:
        """Draw variations."""
        return [self.clusters[n] for n in chance.integers(0, len(self.clusters), count)]


class Power(msgspec.Struct, frozen=True):
    """Result of simulations with one number of variations.

    Attributes:
        variations: Number of variations in each simulated study.
        simulations: Number of simulated studies.
        width: Mean width of the 95 % interval of the accuracy; None: the source has no rows.
        width_90: Width that nine of ten studies do not exceed.
        coverage: Share of studies whose interval contains the true accuracy.
        difference_width: Mean width of the 95 % interval of the difference; None: no pairs.
        power: Share of studies that find a difference with p < 0.05; None: no pairs.
        note: Reason why the simulations say little; empty: there is none.
    """

    variations: int
    simulations: int
    width: float | None
    width_90: float | None
    coverage: float | None
    difference_width: float | None
    power: float | None
    note: str


def _simulated(
    sources: Sequence[tuple[str, VariationSource]],
    sizes: Sequence[int],
    simulations: int,
    seed: int,
    on_progress: OnPowerProgress,
) -> Iterator[tuple[str, Power]]:
    """Yield the result of each source and size; raise InputError if a number is wrong."""
    for name, number in (*(("sizes", each) for each in sizes), ("simulations", simulations)):
        if not is_count(number) or not number <= _MOST:
            raise InputError(f"{name} has {quoted(number)}; give whole numbers from 1 to {_MOST}")
    if not is_whole(seed) or seed < 0:
        raise InputError(f"seed is {quoted(seed)}; it must be a whole number, at least 0")
    if not sizes:
        raise InputError("sizes is empty; give at least one number of variations")
    done, total = 0, len(sources) * len(sizes)
    for name, source in sources:
        for size in sizes:
            studies = []
            for number in range(simulations):
                # Each size has its own sequence, so that more sizes change no numbers.
                chance = np.random.default_rng([seed, size, number])
                studies.append(_analysed(source.draw(size, chance)))
            done += 1
            on_progress(done, total)
            yield name, _power(source, size, studies)


def power_rows(
    sources: Sequence[tuple[str, VariationSource]],
    sizes: Sequence[int],
    simulations: int,
    seed: int,
    on_progress: OnPowerProgress = lambda done, total: None,
) -> list[dict[str, Any]]:
    """Simulate studies of different numbers of variations, and analyse each as results are.

    Args:
        sources: Sources of variations, with what they stand for.
        sizes: Numbers of variations.
        simulations: Number of simulated studies of each size.
        seed: Seed; the same seed gives the same numbers.
        on_progress: Function that receives the progress.

    Returns:
        For each source and size, the source's name as `of`, and the values of `Power`.

    Raises:
        InputError: A number is wrong.
    """
    simulated = _simulated(sources, sizes, simulations, seed, on_progress)
    return [{"of": name, **asdict(power)} for name, power in simulated]


class _Study(msgspec.Struct, frozen=True):
    """Analysis of one simulated study: interval of the accuracy, and of the difference with p."""

    accuracy: tuple[float, float] | None
    difference: tuple[float, float, float] | None


def _analysed(clusters: Sequence[Cluster]) -> _Study:
    rows = [own for own, _ in clusters if own]
    pairs = Pairs("one", "other", tuple(pairs for _, pairs in clusters if pairs))
    return _Study(
        accuracy=rate_interval(rows)[:2] if rows else None,
        difference=(*pairs.interval, pairs.p) if pairs.clusters else None,
    )


def _power(source: VariationSource, size: int, studies: Sequence[_Study]) -> Power:
    intervals = [each.accuracy for each in studies if each.accuracy is not None]
    widths = [high - low for low, high in intervals]
    covering = [low <= source.accuracy <= high for low, high in intervals]
    differences = [each.difference for each in studies if each.difference is not None]
    return Power(
        variations=size,
        simulations=len(studies),
        width=float(np.mean(widths)) if widths else None,
        width_90=float(np.percentile(widths, 90)) if widths else None,
        coverage=sum(covering) / len(covering) if covering else None,
        difference_width=float(np.mean([high - low for low, high, _ in differences]))
        if differences
        else None,
        power=sum(p < _ALPHA for _, _, p in differences) / len(differences)
        if differences
        else None,
        note=source.note,
    )
