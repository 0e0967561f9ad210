"""Things that belong to the process that opened them, and that a forked child may not use.

A fork copies an open run file, the connection to Node and their locks into the child. SQLite does
not allow that use (https://www.sqlite.org/howtocorrupt.html, section 2.6), and two processes that
write to one connection destroy what each of them says.
"""

import os
from weakref import WeakSet

from beliefnest.errors import ForkedError

__all__ = ["Owned"]


class Owned:
    """Something that only the process that made it may use; a base class.

    A class that holds something of the operating system overrides `disown`.
    """

    def __init__(self) -> None:
        self._owner = os.getpid()
        _all.add(self)

    @property
    def is_own(self) -> bool:
        """True if this process made it, and not one that this process was forked from."""
        return self._owner == os.getpid()

    def check_own(self, what: str) -> None:
        """Refuse its use in a forked child; `what` names it at the beginning of the message.

        Raises:
            ForkedError: Another process made it.
        """
        if not self.is_own:
            raise ForkedError(
                f"{what} was opened by process {self._owner} and cannot be used in process "
                f"{os.getpid()}, which was forked from it; open it in the process that uses it, "
                "or start processes by 'spawn'"
            )

    def disown(self) -> None:
        """Let go, in a forked child, of what the child has inherited."""


_all: WeakSet[Owned] = WeakSet()


def _disown_all() -> None:
    for each in list(_all):
        each.disown()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_disown_all)
