"""List of a timeline's events, read from its journal on demand."""

from collections.abc import Callable, Sequence

from beliefnest.belief.columns import Columns
from beliefnest.belief.grounds import PerceivedEvent
from beliefnest.errors import StoreError
from beliefnest.timeline.journal import EntryFilter, TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.world.frames import Frame
from beliefnest.world.paths import BeliefPath
from beliefnest.world.texts import quoted
from beliefnest.world.values import Event


class EventLog:
    """Events of one timeline so far, and the events that nodes perceived before it began.

    Args:
        journal: The journal of the timeline.
        key: The timeline.
        before: Function that returns the events a node perceived before the timeline began.
    """

    def __init__(
        self,
        journal: Journal,
        key: TimelineKey,
        before: Callable[[BeliefPath], Sequence[PerceivedEvent]],
    ) -> None:
        self._journal = journal
        self._key = key
        self._work_out = before
        self._before: dict[BeliefPath, Sequence[PerceivedEvent]] = {}
        self._events: list[tuple[int, Event]] = []
        self._entries = 0

    def events(self, count: int) -> Sequence[tuple[int, Event]]:
        """Return at least the first `count` events, each with its tick.

        Raises:
            StoreError: The journal has fewer; its counts are wrong.
        """
        if len(self._events) < count:
            stop = self._journal.info(self._key).entries
            for _, entry in self._journal.filtered(
                self._key, self._entries, stop, EntryFilter.EVENTS
            ):
                if isinstance(entry, Frame):
                    self._events.extend((entry.tick, event) for event in entry.events)
            self._entries = stop
        if len(self._events) < count:
            raise StoreError(
                f"the run file is damaged: it counts {count} events of branch "
                f"{quoted(self._key.branch)} and holds {len(self._events)}; restore it from a copy"
            )
        return self._events

    def has_before(self, path: BeliefPath) -> bool:
        """Return True if `before` has been asked for a node."""
        return path in self._before

    def before(self, path: BeliefPath) -> Sequence[PerceivedEvent]:
        """Return the events that a node perceived before the timeline began, oldest first."""
        if path not in self._before:
            self._before[path] = self._work_out(path)
        return self._before[path]

    def take(self, columns: Columns) -> None:
        """Append the events of a stretch if it continues the list."""
        if columns.first <= self._entries < columns.end:
            self._events.extend(columns.events_since(self._entries))
            self._entries = columns.end
