"""The turn of a thread in a nest: one call at a time, whichever thread it comes from.

A nest's timelines, forests and bodies belong together, and Node does one thing at a time.
Programs of different simulators can be asked for side by side, in threads: each runs in its
turn, and since simulators do not disturb each other, the turns' order cannot be seen in them.
"""

from collections.abc import Callable
from functools import wraps
from typing import Concatenate, ParamSpec, Protocol, TypeVar

from beliefnest.nest.past.recording import Recording

__all__ = ["in_turn"]


class _InNest(Protocol):
    _recording: Recording


S = TypeVar("S", bound=_InNest)
P = ParamSpec("P")
R = TypeVar("R")


def in_turn(method: Callable[Concatenate[S, P], R]) -> Callable[Concatenate[S, P], R]:
    """Let a method wait until no other thread is in the nest."""

    @wraps(method)
    def waiting(self: S, /, *args: P.args, **kwargs: P.kwargs) -> R:
        with self._recording.turn:
            return method(self, *args, **kwargs)

    return waiting
