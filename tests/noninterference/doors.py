"""Doors: everything that speaks or shows in somebody's name, as functions to compare.

A door takes a played world and a belief path, and returns a value that must be the same in both
worlds of a pair. To add one, decorate a function with `door` in a module that the tests import.
"""

from collections.abc import Callable
from dataclasses import dataclass

from tests.noninterference.pairs import Played

__all__ = ["DOORS", "Door", "door"]

Look = Callable[[Played, str], object]


@dataclass(frozen=True)
class Door:
    """Door with its price.

    Attributes:
        name: Its name, for messages.
        look: The function.
        every: Only one pair out of so many goes through it; by day one out of three times as many.
    """

    name: str
    look: Look
    every: int


DOORS: dict[str, Door] = {}
"""All doors by name."""


def door(*, every: int = 1) -> Callable[[Look], Look]:
    """Register a door.

    Args:
        every: Only one pair out of so many goes through it, if it takes long.
    """

    def registered(look: Look) -> Look:
        name = f"{look.__module__.rpartition('.')[2]}.{look.__name__}"
        DOORS[name] = Door(name, look, every)
        return look

    return registered
