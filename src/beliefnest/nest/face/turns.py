"""Turns of threads in a nest: one call at a time, whichever thread it comes from.

A nest's timelines, forests and bodies change together, and Node.js does one thing at a time.
Several threads may run programs of different simulators: each call runs in its turn. Simulators do
not disturb each other, so the order of the turns does not change their results.
"""

from collections.abc import Callable
from functools import wraps
from typing import Concatenate, ParamSpec, Protocol, TypeVar

from beliefnest.nest.past.recording import Recording


class _InNest(Protocol):
    _recording: Recording


S = TypeVar("S", bound=_InNest)
P = ParamSpec("P")
R = TypeVar("R")


def in_turn(method: Callable[Concatenate[S, P], R]) -> Callable[Concatenate[S, P], R]:
    """Make a method wait until no other thread uses the nest."""

    @wraps(method)
    def waiting(self: S, /, *args: P.args, **kwargs: P.kwargs) -> R:
        with self._recording.turn:
            return method(self, *args, **kwargs)

    return waiting
