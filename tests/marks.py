"""Marks of tests that do not run by day, and what these tests need."""

import importlib.util
from collections.abc import Callable

import pytest

__all__ = ["add_ci", "require_packages"]

_LATER = ("browser", "extra", "long")
"""Reasons why a test runs in CI only, as marks; pyproject.toml says what each means."""


def add_ci(item: pytest.Item) -> None:
    """Give the mark `ci` to a test that has a mark of `_LATER` or uses the fixture `browser`."""
    fixtures: tuple[str, ...] = getattr(item, "fixturenames", ())
    if "browser" in fixtures:
        item.add_marker("browser")
    if any(item.get_closest_marker(name) for name in _LATER):
        item.add_marker("ci")


def require_packages(
    item: pytest.Item, find: Callable[[str], object] = importlib.util.find_spec
) -> None:
    """Fail a test of packages of the extra `ci` if one is missing: nobody asked to skip it."""
    for mark in item.iter_markers("extra"):
        for package in mark.args:
            try:
                found = find(package)
            except ModuleNotFoundError:  # not even the package around it
                found = None
            if found is None:
                pytest.fail(f"{package} is not installed: pip install -e '.[ci]'", pytrace=False)
