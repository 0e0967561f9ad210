"""Time as the models' limits and pauses see it; tests pass their own."""

import time
from typing import Protocol

__all__ = ["Clock", "SystemClock"]


class Clock(Protocol):
    """A clock that can be waited on."""

    def now(self) -> float:
        """Return seconds since some fixed moment."""

    def wait(self, seconds: float) -> None:
        """Let time pass."""


class SystemClock:
    """The machine's clock."""

    def now(self) -> float:
        """Return seconds since some fixed moment."""
        return time.monotonic()

    def wait(self, seconds: float) -> None:
        """Block for so many seconds."""
        time.sleep(seconds)
