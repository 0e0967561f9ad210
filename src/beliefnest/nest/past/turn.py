"""The lock of a nest: one thread of one process at a time."""

from threading import RLock

from beliefnest.owned import Owned

__all__ = ["Turn"]


class Turn(Owned):
    """A lock that the thread inside a nest holds; a context manager, which may be nested.

    Raises:
        ForkedError: Another process opened the nest.
    """

    def __init__(self) -> None:
        super().__init__()
        self._lock = RLock()

    def __enter__(self) -> None:
        # First: a thread that a fork did not copy may have held the lock.
        self.check_own("the nest")
        self._lock.acquire()

    def __exit__(self, *_: object) -> None:
        if self.is_own:
            self._lock.release()
