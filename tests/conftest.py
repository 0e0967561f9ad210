"""Profiles of the property tests: few examples by default, many at night."""

import os
import signal

from hypothesis import HealthCheck, settings
from tests.profiles import NIGHTLY

_SLOW_TO_MAKE = [HealthCheck.too_slow, HealthCheck.data_too_large]

settings.register_profile(
    "default",
    max_examples=8,
    deadline=None,
    derandomize=bool(os.environ.get("CI")),
    suppress_health_check=_SLOW_TO_MAKE,
)
settings.register_profile(
    "nightly", max_examples=2000, deadline=None, suppress_health_check=_SLOW_TO_MAKE
)
settings.load_profile("nightly" if NIGHTLY else "default")

# Tables are as wide as where there is no terminal, whoever runs the tests.
os.environ.pop("COLUMNS", None)

# Tests interrupt what they start; a shell that starts the tests in the background makes all of
# them deaf to that.
signal.signal(signal.SIGINT, signal.default_int_handler)
