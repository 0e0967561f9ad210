"""Number of examples: few in every run of the tests, many at night (`make nightly`)."""

import os
from collections.abc import Iterable
from typing import Any

import pytest

__all__ = ["NIGHTLY", "at_night", "few_by_day"]

NIGHTLY = os.environ.get("BELIEFNEST_NIGHTLY") == "1"


def at_night(many: int, otherwise: int) -> int:
    """Return the number of examples to try."""
    return many if NIGHTLY else otherwise


def few_by_day(values: Iterable[Any], few: int = 1) -> list[Any]:
    """Return parameters of a test, of which all but the first few have the mark `long`."""
    parameters = [each if isinstance(each, tuple) else (each,) for each in values]
    later = [pytest.param(*each, marks=pytest.mark.long) for each in parameters[few:]]
    return [*(pytest.param(*each) for each in parameters[:few]), *later]
