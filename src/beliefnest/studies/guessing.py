"""Chance level of questions with options: the share of right answers of a blind guess."""

import math
from collections.abc import Mapping, Sequence
from typing import Any


def chance_of(expected: Mapping[str, Any] | None) -> float | None:
    """Return the probability that guesses meet all expectations of a probe.

    Args:
        expected: Expectations with the keys of scenario files; None: there are none.

    Returns:
        The product of the shares of right options; None if anything is expected but answers to
        questions with options, or the right options are not known.
    """
    if not expected or set(expected) != {"answers"}:
        return None
    asked = expected["answers"]
    if not all(each.get("options") and isinstance(each["right"], Sequence) for each in asked):
        return None
    return math.prod(len(each["right"]) / len(each["options"]) for each in asked)


def mean_chance(rows: Sequence[Mapping[str, Any]]) -> float | None:
    """Return the mean chance level of rows; None if one has none."""
    rates = [row.get("chance") for row in rows]
    valid = [each for each in rates if each is not None]
    return sum(valid) / len(valid) if valid and len(valid) == len(rates) else None
