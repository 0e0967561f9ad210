"""Lock of a nest, which one thread of one process uses at a time."""

from threading import RLock

from beliefnest.owned import Owned


class Turn(Owned):
    """Lock that a thread holds while it uses a nest: a reentrant context manager.

    Raises:
        ForkedError: Another process opened the nest.
    """

    def __init__(self) -> None:
        super().__init__()
        self._lock = RLock()

    def __enter__(self) -> None:
        # Check the process first: after a fork the lock may be held by a thread that the child
        # does not have.
        self.check_own("the nest")
        self._lock.acquire()

    def __exit__(self, *_: object) -> None:
        if self.is_own:
            self._lock.release()
