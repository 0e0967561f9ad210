"""Retries of a call when the process behind a world ends: the only retry in the program.

When the process ends, all its bodies are lost and the call has not happened. The call is then
repeated in a new process, until its lives are used up.
"""

from collections.abc import Callable
from typing import TypeVar

from beliefnest.errors import BodyError, BodyLostError

_LIVES = 3

T = TypeVar("T")


class Lives:
    """Counter of the processes that one call may use up.

    Args:
        forget_lost: Function that drops lost bodies; called before each attempt and after the last.
    """

    def __init__(self, forget_lost: Callable[[], None] = lambda: None) -> None:
        self._forget_lost = forget_lost
        self._left = _LIVES

    def spend(self) -> bool:
        """Count one life as spent, because a process ended. Return True if one is left."""
        self._left -= 1
        return self._left > 0

    def call(self, act: Callable[[], T]) -> T:
        """Make a call, and repeat it if the process ends during it.

        Raises:
            BodyError: The process ended at each attempt.
        """
        while True:
            self._forget_lost()
            try:
                return act()
            except BodyLostError as lost:
                if self.spend():
                    continue
                self._forget_lost()
                raise BodyError(
                    f"the process behind the world ended {_LIVES} times during one call, and "
                    "nothing of the call is kept. Run `beliefnest doctor`; if memory or time ran "
                    f"out, allow more with limits=ProcessLimits(...). The last time: {lost}"
                ) from lost
