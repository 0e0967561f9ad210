"""Objects that belong to the process that opened them; a forked child may not use them.

A fork copies an open run file, the connection to Node and their locks into the child. SQLite
forbids such use (https://www.sqlite.org/howtocorrupt.html, section 2.6), and two processes that
write to one connection mix up their messages. What is in memory only would go apart: parent and
child would each see its own changes.
"""

import os
from typing import ClassVar, Self, cast
from weakref import WeakSet

from beliefnest.errors import ForkedError


def _refusal(what: str, owner: int) -> ForkedError:
    return ForkedError(
        f"{what} was opened by process {owner} and cannot be used in process {os.getpid()}, which "
        "was forked from it; open it in the process that uses it, or start processes by 'spawn'"
    )


class Owned:
    """Base class of objects that only the process that created them may use.

    Subclasses that hold a resource of the operating system override `disown`.
    """

    def __init__(self) -> None:
        self._owner = _process
        _all.add(self)

    @property
    def is_own(self) -> bool:
        """True if this process created the object; False in a forked child."""
        return self._owner == _process

    def check_own(self, what: str) -> None:
        """Refuse the use in a forked child; messages begin with `what`, the object's name.

        Raises:
            ForkedError: Another process created the object.
        """
        if not self.is_own:
            raise _refusal(what, self._owner)

    def disown(self) -> None:
        """Release inherited resources in a forked child."""


class Barred:
    """Base class of objects whose attributes are refused in a forked child, except `close`.

    The fork itself bars them in the child, so that no use needs a check. Copies are barred too.
    """

    _called: ClassVar[str]
    """Name of the object in messages."""

    _opened_by: ClassVar[int | None] = None
    """In a forked child, the process that created the object."""

    def __new__(cls, *_: object, **__: object) -> Self:
        """Create the object, and note that a fork bars it."""
        made = super().__new__(cls)
        _to_bar.add(made)
        return made


def is_own(barred: Barred) -> bool:
    """Return True if this process created an object; False in a forked child."""
    return type(barred)._opened_by is None


def _refuse(barred: Barred, name: str) -> object:
    if name == "close" or name.startswith("__"):
        return object.__getattribute__(barred, name)
    kind = type(barred)
    raise _refusal(kind._called, cast(int, kind._opened_by))


_all: WeakSet[Owned] = WeakSet()
_to_bar: WeakSet[Barred] = WeakSet()
_process = os.getpid()


def _disown_all() -> None:
    global _process  # each process has its own
    parent, _process = _process, os.getpid()
    for each in list(_all):
        each.disown()
    for barred in filter(is_own, list(_to_bar)):
        kind = type(barred)
        barring = {"__getattribute__": _refuse, "_opened_by": parent}
        barred.__class__ = type(kind.__name__, (kind,), barring)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_disown_all)
