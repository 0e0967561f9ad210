"""Objects that belong to the process that opened them; a forked child may not use them.

A fork copies an open run file, the connection to Node and their locks into the child. SQLite
forbids such use (https://www.sqlite.org/howtocorrupt.html, section 2.6), and two processes that
write to one connection mix up their messages.
"""

import os
from weakref import WeakSet

from beliefnest.errors import ForkedError

__all__ = ["Owned"]


class Owned:
    """Base class of objects that only the process that created them may use.

    Subclasses that hold a resource of the operating system override `disown`.
    """

    def __init__(self) -> None:
        self._owner = os.getpid()
        _all.add(self)

    @property
    def is_own(self) -> bool:
        """True if this process created the object; False in a forked child."""
        return self._owner == os.getpid()

    def check_own(self, what: str) -> None:
        """Refuse the use in a forked child; messages begin with `what`, the object's name.

        Raises:
            ForkedError: Another process created the object.
        """
        if not self.is_own:
            raise ForkedError(
                f"{what} was opened by process {self._owner} and cannot be used in process "
                f"{os.getpid()}, which was forked from it; open it in the process that uses it, "
                "or start processes by 'spawn'"
            )

    def disown(self) -> None:
        """Release inherited resources in a forked child."""


_all: WeakSet[Owned] = WeakSet()


def _disown_all() -> None:
    for each in list(_all):
        each.disown()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_disown_all)
