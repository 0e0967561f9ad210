"""Checks of a study's keys; each error names the key."""

import json
import math
import os
from collections.abc import Mapping, Sequence
from typing import Any, TypeGuard

from beliefnest.errors import InputError
from beliefnest.llm.budget import RunLimits
from beliefnest.scenarios.loading import condition_number
from beliefnest.world.texts import quoted
from beliefnest.world.words import nearest_or_all

_MOST_CELLS = 200_000


class StudyKeyError(InputError):
    """Error in the value of a study's key.

    Args:
        key: The key, which is also the name of the argument, or the keys down to the wrong value.
        message: What is wrong, and what to do.
    """

    def __init__(self, key: str | tuple[str | int, ...], message: str) -> None:
        super().__init__(message)
        self.path = (key,) if isinstance(key, str) else key


def several(key: str, names: object) -> tuple[str, ...]:
    """Return a name, or a list of names or paths, as a tuple.

    Raises:
        StudyKeyError: `names` is neither.
    """
    listed = [names] if isinstance(names, str | os.PathLike) else names
    if isinstance(listed, Sequence) and all(isinstance(each, str | os.PathLike) for each in listed):
        return tuple(map(os.fspath, listed))
    raise StudyKeyError(key, f"{key} is {quoted(names)}; give a name, or a list of names")


def checked_columns(names: object, columns: Sequence[str]) -> list[str]:
    """Return one or several names of columns as a list.

    Raises:
        StudyKeyError: `names` is neither a name nor a list of names.
        InputError: A column does not exist.
    """
    chosen = several("by", names)
    for name in chosen:
        if name not in columns:
            raise InputError(f"there is no column {quoted(name)}{nearest_or_all(name, columns)}")
    return list(chosen)


def checked_conditions(conditions: object) -> tuple[int, ...] | None:
    """Return one or several numbers of conditions, also given as texts; None stays None.

    Raises:
        StudyKeyError: `conditions` is neither, or an empty list.
        ScenarioError: A condition is no number.
    """
    if conditions is None:
        return None
    named = [conditions] if isinstance(conditions, int | str) else conditions
    if not isinstance(named, Sequence) or not named:
        why = f"conditions is {quoted(conditions)}; give numbers, or leave it out for all of them"
        raise StudyKeyError("conditions", why)
    numbers = tuple(number for each in named if (number := condition_number(each)) is not None)
    check_once("conditions", numbers)
    return numbers


def check_once(key: str, values: Sequence[Any], what: str = "") -> None:
    """Raise StudyKeyError if a list contains a value twice."""
    twice = [value for value in values if values.count(value) > 1]
    if twice:
        message = f"{what or key}: {quoted(twice[0])} is named twice; use repeats to do it again"
        raise StudyKeyError(key, message)


def check_cells(key: str, cells: int) -> None:
    """Raise StudyKeyError if a scenario or task would have too many cells under a condition."""
    if cells > _MOST_CELLS:
        message = f"there would be more than {_MOST_CELLS:,} cells; make several studies"
        raise StudyKeyError(key, message)


def check_count(key: str, number: object) -> None:
    """Raise StudyKeyError unless a value is a whole number, at least 1."""
    if not is_count(number):
        raise StudyKeyError(
            key, f"{key} is {quoted(number)}; it must be a whole number, at least 1"
        )


def is_whole(number: object) -> TypeGuard[int]:
    """Return True if a value is a whole number."""
    return isinstance(number, int) and not isinstance(number, bool)


def is_amount(number: object) -> TypeGuard[float]:
    """Return True if a value is a finite number that is not below 0."""
    if isinstance(number, bool) or not isinstance(number, int | float):
        return False
    return math.isfinite(number) and number >= 0


def is_count(number: object) -> bool:
    """Return True if a value is a whole number, at least 1."""
    return is_whole(number) and number >= 1


def checked_limits(max_tokens: int | None, max_cost: float | None) -> RunLimits:
    """Return the limits of a study's tokens and cost; None: no limit.

    Raises:
        StudyKeyError: A limit is no amount.
    """
    if max_tokens is not None and not is_count(max_tokens):
        raise StudyKeyError(
            "max_tokens", f"max_tokens is {quoted(max_tokens)}; give at least 1, or no limit"
        )
    is_number = isinstance(max_cost, int | float) and not isinstance(max_cost, bool)
    if max_cost is not None and (not is_number or math.isnan(max_cost) or max_cost < 0):
        raise StudyKeyError(
            "max_cost", f"max_cost is {quoted(max_cost)}; give US dollars, or no limit"
        )
    return RunLimits(max_tokens, max_cost)


def checked_lists(variations: Mapping[str, Sequence[Any]]) -> None:
    """Check that variations are lists of different plain values.

    Raises:
        StudyKeyError: A value is no such list, or is empty.
    """
    for name, values in variations.items():
        if isinstance(values, str) or not isinstance(values, Sequence) or not values:
            raise StudyKeyError(
                ("variations", name),
                f"variations of {quoted(name)} are {quoted(values)}; give a list of at least one "
                "value",
            )
        for value in values:
            if not _is_plain(value):
                message = (
                    f"variations of {quoted(name)} have {quoted(value)}; give texts, finite "
                    "numbers, and "
                )
                raise StudyKeyError(("variations", name), f"{message}lists and mappings of them")
        check_once("variations", [json.dumps(v) for v in values], f"variations of {quoted(name)}")


def _is_plain(value: object) -> bool:
    """Return True if a value consists of numbers, texts, lists and mappings, as in files."""
    if isinstance(value, Mapping):
        return all(isinstance(key, str) and _is_plain(inner) for key, inner in value.items())
    if isinstance(value, list | tuple):
        return all(map(_is_plain, value))
    if isinstance(value, float):
        return math.isfinite(value)
    return value is None or isinstance(value, str | int)
