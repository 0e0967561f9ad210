"""What is wrong with what a study is asked to combine, by its key."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from beliefnest.errors import InputError
from beliefnest.llm.budget import RunLimits

__all__ = ["StudyKeyError", "checked_limits", "checked_lists", "is_count", "several"]


class StudyKeyError(InputError):
    """What is asked for under a key of a study is wrong.

    Args:
        key: The key, which is also the name of the argument.
        message: What was found, and what to do.
    """

    def __init__(self, key: str, message: str) -> None:
        super().__init__(message)
        self.key = key


def several(names: Sequence[str] | str) -> tuple[str, ...]:
    """A name alone is a list of one."""
    return (names,) if isinstance(names, str) else tuple(str(name) for name in names)


def is_count(number: object) -> bool:
    """Whether it is a whole number, at least 1."""
    return isinstance(number, int) and not isinstance(number, bool) and number >= 1


def checked_limits(max_tokens: int | None, max_cost: float | None) -> RunLimits:
    """What a study may spend; None: no limit.

    Raises:
        StudyKeyError: It is no amount.
    """
    if max_tokens is not None and not is_count(max_tokens):
        raise StudyKeyError(
            "max_tokens", f"max_tokens is {max_tokens!r}; give at least 1, or no limit"
        )
    is_number = isinstance(max_cost, int | float) and not isinstance(max_cost, bool)
    if max_cost is not None and (not is_number or math.isnan(max_cost) or max_cost < 0):
        raise StudyKeyError("max_cost", f"max_cost is {max_cost!r}; give US dollars, or no limit")
    return RunLimits(max_tokens, max_cost)


def checked_lists(variations: Mapping[str, Sequence[Any]]) -> None:
    """Refuse what is no list of values.

    Raises:
        StudyKeyError: It is none, or empty.
    """
    for name, values in variations.items():
        if isinstance(values, str) or not isinstance(values, Sequence) or not values:
            raise StudyKeyError(
                "variations",
                f"variations of {name!r} are {values!r}; give a list of at least one value",
            )
