"""All kinds of expectations about probes, and their reading from files."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from beliefnest.scenarios.checks import Checks
from beliefnest.scenarios.document import KeyPath
from beliefnest.scenarios.expected import Expected, ExpectEntry, Judgement
from beliefnest.scenarios.expected_acts import (
    Arrives,
    Awaited,
    Believes,
    Intends,
    Judge,
    Opens,
    Says,
    Takes,
)
from beliefnest.scenarios.expected_answers import Answers
from beliefnest.world.texts import quoted


@dataclass(frozen=True, slots=True)
class Infers(Expected):
    """Expectation about the posterior mean of a factor: above or below something.

    Attributes:
        factor: The factor, such as `utility.K`.
        above: A number, or another factor whose mean is lower; None: any.
        below: A number, or another factor whose mean is higher; None: any.
    """

    many = True
    factor: str
    above: float | str | None = None
    below: float | str | None = None

    @property
    def ground(self) -> str:
        return f"the posterior mean of {self.factor}"

    @property
    def factors(self) -> list[str]:
        """Return the factors that the expectation names."""
        return [each for each in (self.factor, *self._bounds.values()) if isinstance(each, str)]

    @property
    def _bounds(self) -> dict[str, float | str]:
        bounds = {"above": self.above, "below": self.below}
        return {word: bound for word, bound in bounds.items() if bound is not None}

    @classmethod
    def read(cls, entry: ExpectEntry, path: KeyPath, checks: Checks) -> Iterator["Infers"]:
        if entry.inferred is not None:
            raise checks.fault((*path, "inferred"), "is for probes that infer; give 'infer', too")
        yield from ()

    def written(self) -> dict[str, Any]:
        return {"inferred": {self.factor: self._bounds}}

    def judge(self, means: Mapping[str, float], impossible: str | None) -> Judgement:
        """Judge inferred means; `impossible` is the reason why no hypothesis explains them."""
        instead = impossible or self._instead(means)
        return self.verdict(instead is None, instead or "", by_deed=True)

    def _instead(self, means: Mapping[str, float]) -> str | None:
        mean = means[self.factor]
        for word, bound in self._bounds.items():
            number = means[bound] if isinstance(bound, str) else bound
            if not (mean > number if word == "above" else mean < number):
                bound_words = f"{bound} ({number:.3g})" if isinstance(bound, str) else f"{number:g}"
                return f"{self.factor} is {mean:.3g}, not {word} {bound_words}"
        return None


KINDS: tuple[type[Expected], ...] = (
    Infers,
    Awaited,
    Opens,
    Arrives,
    Intends,
    Takes,
    Says,
    Answers,
    Believes,
    Judge,
)
"""Kinds, in the order in which a probe's expectations are read and judged."""


def read_expected(entry: ExpectEntry, path: KeyPath, checks: Checks) -> tuple[Expected, ...]:
    """Return the expectations of a probe that asks a model.

    Raises:
        ScenarioError: The entry is not consistent; the message names file, line and key.
    """
    expected = tuple(each for kind in KINDS for each in kind.read(entry, path, checks))
    if not expected:
        keys = [key for key in entry.__struct_fields__ if key not in ("within", "inferred")]
        raise checks.fault(path, f"expects nothing; give at least one of {', '.join(keys)}")
    return expected


def read_inferred(
    entry: ExpectEntry, path: KeyPath, checks: Checks, factors: Sequence[str]
) -> tuple[Infers, ...]:
    """Return the expectations of a probe that infers.

    Args:
        entry: The entry.
        path: Its place in the document.
        checks: Checks of the document.
        factors: Factors of the model.

    Raises:
        ScenarioError: A factor is not in the model, or has no bounds, or a model is asked.
    """
    for key in entry.__struct_fields__:
        if key not in ("inferred", "within") and getattr(entry, key) is not None:
            raise checks.fault((*path, key), "is for probes that ask a model; give 'inferred'")
    path = (*path, "inferred")
    if not entry.inferred:
        raise checks.fault(path, "expects nothing; name a factor, such as utility.K")
    inferred = []
    for factor, bounds in entry.inferred.items():
        expected = Infers(factor, bounds.above, bounds.below)
        for name in expected.factors:
            if name not in factors:
                raise checks.fault(
                    (*path, factor),
                    f"there is no factor {quoted(name)}; there are {', '.join(factors)}",
                )
        if bounds.above is None and bounds.below is None:
            raise checks.fault((*path, factor), "expects nothing; give above, below or both")
        inferred.append(expected)
    return tuple(inferred)
