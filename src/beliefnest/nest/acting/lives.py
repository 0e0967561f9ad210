"""How often the process behind a world may end under one call: the only retry there is.

When it ends, all bodies in it are lost and the call under way has not happened. It is made again
in a new process until its lives are used up.
"""

from collections.abc import Callable
from typing import TypeVar

from beliefnest.errors import BodyError, BodyLostError

__all__ = ["Lives"]

_LIVES = 3

T = TypeVar("T")


class Lives:
    """The processes that one call may use up.

    Args:
        forget_lost: Called before each attempt and after the last; drops the bodies that were lost.
    """

    def __init__(self, forget_lost: Callable[[], None] = lambda: None) -> None:
        self._forget_lost = forget_lost
        self._left = _LIVES

    def spend(self) -> bool:
        """Give up one life, because a process ended; returns whether there is another."""
        self._left -= 1
        return self._left > 0

    def call(self, act: Callable[[], T]) -> T:
        """Make a call; if the process ends under it, make it again.

        Raises:
            BodyError: It was started again and again, and each time it ended.
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
                    f"the process behind the world ended {_LIVES} times under one call; nothing "
                    "of it is kept. Run `beliefnest doctor`; if memory or time did not suffice, "
                    f"give more with limits=ProcessLimits(...). The last time: {lost}"
                ) from lost
