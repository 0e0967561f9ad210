"""Clock for the time limits and pauses of models; tests pass their own."""

import time
from typing import Protocol


class Clock(Protocol):
    """A clock that can also wait."""

    def now(self) -> float:
        """Return seconds since a fixed moment."""

    def wait(self, seconds: float) -> None:
        """Wait for a number of seconds."""


class SystemClock:
    """Clock of the machine."""

    def now(self) -> float:
        """Return seconds since a fixed moment."""
        return time.monotonic()

    def wait(self, seconds: float) -> None:
        """Block for a number of seconds."""
        time.sleep(seconds)
