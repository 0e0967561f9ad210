"""Distribution of the tests, their surroundings, and profiles of the property tests."""

import gc
import os
import signal
import sys
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings
from tests.browsing import browser, chromium
from tests.marks import add_ci, require_packages
from tests.profiles import NIGHTLY
from tests.quick import add_quick, is_left_out
from tests.shared_worlds import kept_worlds, lent
from tests.sharing import ByFile, rank
from xdist.remote import Producer

__all__ = ["browser", "chromium", "kept_worlds", "lent"]

_SLOW_TO_MAKE = [HealthCheck.too_slow, HealthCheck.data_too_large]

# The same few examples in every run, so that what fails is what was changed; at night any.
settings.register_profile(
    "default",
    max_examples=3,
    deadline=None,
    derandomize=True,
    suppress_health_check=_SLOW_TO_MAKE,
)
settings.register_profile(
    "nightly", max_examples=2000, deadline=None, suppress_health_check=_SLOW_TO_MAKE
)
settings.load_profile("nightly" if NIGHTLY else "default")

# Tables are as wide as where there is no terminal, whoever runs the tests.
os.environ.pop("COLUMNS", None)

# Images of containers often forbid bytecode; each process that tests start would then compile all
# modules anew, which takes longer than most tests.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# Nobody cuts the power while tests run, and a disk that others use keeps each file waiting.
os.fsync = lambda descriptor: None

# Tests interrupt what they start; a shell that starts the tests in the background makes all of
# them deaf to that.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> ByFile | None:
    """Share out the tests by file, if nothing else is asked for."""
    return ByFile(config, log) if config.getoption("dist") == "loadfile" else None


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Read only the files that have the tests asked for: reading all takes long."""
    return True if is_left_out(collection_path, config) else None


# First, so that `-m` finds the mark.
@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with what takes longest, so that at the end no process waits for another."""
    for item in items:
        add_ci(item)
        add_quick(item)
    items.sort(key=lambda item: rank(item.nodeid))


def pytest_collection_finish(session: pytest.Session) -> None:
    """Leave what was collected out of searches for cycles."""
    gc.freeze()


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Find out what a test lacks before its fixtures do."""
    require_packages(item)
