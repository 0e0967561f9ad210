"""What a forest needs of others: who lists events, and who reads states."""

from collections.abc import Sequence
from typing import Protocol

from beliefnest.belief.entries import PerceivedEvent
from beliefnest.world.paths import BeliefPath
from beliefnest.world.values import Event

__all__ = ["EventHistory", "StateReader"]


class EventHistory(Protocol):
    """What happens on a timeline, for those who list it; folding does without."""

    def events(self, count: int) -> Sequence[tuple[int, Event]]:
        """The first events of the timeline, `count` of them or more, each with its tick."""

    def before(self, path: BeliefPath) -> Sequence[PerceivedEvent]:
        """What a node perceived before the timeline began, oldest first."""


class StateReader(Protocol):
    """Somebody who read a state and may read more of it."""

    def keep(self) -> None:
        """Read now what the forest will not know any more."""
