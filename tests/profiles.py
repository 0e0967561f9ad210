"""Number of examples: few in every run of the tests, many at night (`make nightly`)."""

import os

__all__ = ["NIGHTLY", "at_night"]

NIGHTLY = os.environ.get("BELIEFNEST_NIGHTLY") == "1"


def at_night(many: int, otherwise: int) -> int:
    """Return the number of examples to try."""
    return many if NIGHTLY else otherwise
