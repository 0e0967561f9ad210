"""Suites: batteries of stories with questions, and of films with judgments of people."""

from typing import Any

from beliefnest.errors import UnknownNameError
from beliefnest.importing import installed, installed_names, load

__all__ = ["AUDIT", "FILMS", "story_reader", "suite_names"]

FILMS = "food-trucks"
"""Name of the suite of films."""
AUDIT = "audit"
"""Word in place of a suite: the labels of a published file are compared with its stories."""

_GROUP = "beliefnest.suites"
"""Group of entry points by name of a suite of stories: functions of a file, and of the numbers of
its rows (None: all), that return `suites.stories.data.ReadStories`."""


def suite_names() -> tuple[str, ...]:
    """Return the names of the installed suites."""
    return (*installed_names(_GROUP), FILMS)


def story_reader(name: str) -> Any:
    """Return the function that reads the files of a suite of stories.

    Raises:
        UnknownNameError: There is no such suite.
        InputError: It cannot be imported.
    """
    entry = installed(_GROUP, name)
    if entry is None:
        # It imports NumPy, and the list of suites is to be quick.
        from beliefnest.world.words import nearest_or_all

        raise UnknownNameError(f"no suite {name!r}{nearest_or_all(name, (*suite_names(), AUDIT))}")
    return load(entry, "suite")
