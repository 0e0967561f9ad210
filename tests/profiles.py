"""How much is tried: little in every run of the tests, much at night (`make nightly`)."""

import os

__all__ = ["NIGHTLY", "at_night"]

NIGHTLY = os.environ.get("BELIEFNEST_NIGHTLY") == "1"


def at_night(many: int, otherwise: int) -> int:
    """How often to try something."""
    return many if NIGHTLY else otherwise
