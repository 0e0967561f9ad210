"""Journal in memory on top of another journal, which it only reads."""

from collections.abc import Iterator, Mapping, Sequence

from beliefnest.timeline.journal import (
    Entry,
    EntryFilter,
    ForkPoint,
    TimelineInfo,
    TimelineKey,
    branch_taken,
)
from beliefnest.timeline.store import Journal
from beliefnest.world.values import AgentState


class SideJournal(Journal):
    """Timelines in memory whose bases may be in another journal.

    Timelines of the other journal can be read. Changes of them raise BranchError, except
    checkpoints, which are ignored.

    Args:
        other: The other journal, which is only read and must stay open.
    """

    def __init__(self, other: Journal) -> None:
        super().__init__()
        self._other = other

    def timelines(self) -> Sequence[TimelineInfo]:
        """Return all timelines, those of the other journal first."""
        return (*self._other.timelines(), *super().timelines())

    def has(self, key: TimelineKey) -> bool:
        """Return True if either journal has a timeline of that key."""
        return super().has(key) or self._other.has(key)

    def info(self, key: TimelineKey) -> TimelineInfo:
        """Return the metadata of a timeline of either journal; BranchError if there is none."""
        return super().info(key) if key in self._known else self._other.info(key)

    def create(self, key: TimelineKey, base: ForkPoint | None, start: int) -> None:
        """Begin an empty timeline; BranchError if it exists or its base does not."""
        if self._other.has(key):
            raise branch_taken(key)
        super().create(key, base, start)

    def entries(self, key: TimelineKey, start: int, stop: int) -> Iterator[Entry]:
        """Yield the entries with indexes start to stop - 1, oldest first."""
        if key in self._known:
            return super().entries(key, start, stop)
        return self._other.entries(key, start, stop)

    def entries_until(self, key: TimelineKey, tick: int) -> int:
        """Return the number of entries at `tick` or earlier."""
        if key in self._known:
            return super().entries_until(key, tick)
        return self._other.entries_until(key, tick)

    def filtered(
        self, key: TimelineKey, start: int, stop: int, what: EntryFilter
    ) -> Iterator[tuple[int, Entry]]:
        """Yield the entries from start to stop - 1 that match a filter, with their indexes."""
        if key in self._known:
            return super().filtered(key, start, stop, what)
        return self._other.filtered(key, start, stop, what)

    def events_until(self, key: TimelineKey, entries: int) -> int:
        """Return the number of events in the first `entries` entries."""
        if key in self._known:
            return super().events_until(key, entries)
        return self._other.events_until(key, entries)

    def agents_after(self, key: TimelineKey, entries: int) -> Mapping[str, AgentState | None]:
        """Return the last state of each agent that the first `entries` entries name."""
        if key in self._known:
            return super().agents_after(key, entries)
        return self._other.agents_after(key, entries)

    def put_checkpoint(self, key: TimelineKey, name: str, entries: int, body: bytes) -> None:
        """Store a checkpoint of a timeline in memory; ignore those of the other journal."""
        if key in self._known:
            super().put_checkpoint(key, name, entries, body)

    def nearest_checkpoint(
        self, key: TimelineKey, name: str, entries: int
    ) -> tuple[int, bytes] | None:
        """Return the last checkpoint of that name at or before entry `entries`, and its place."""
        if key in self._known:
            return super().nearest_checkpoint(key, name, entries)
        return self._other.nearest_checkpoint(key, name, entries)

    def body_state(self, key: TimelineKey, entries: int, tick: int) -> bytes | None:
        """Return the internal state stored for exactly this moment; None if there is none."""
        if key in self._known:
            return super().body_state(key, entries, tick)
        return self._other.body_state(key, entries, tick)
