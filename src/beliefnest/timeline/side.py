"""Journal in memory on top of another journal, which it only reads."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager

from beliefnest.timeline.journal import (
    Entry,
    EntryFilter,
    ForkPoint,
    Journal,
    TimelineInfo,
    TimelineKey,
    branch_taken,
)
from beliefnest.timeline.memory_journal import MemoryJournal
from beliefnest.world.values import AgentState

__all__ = ["SideJournal"]


class SideJournal:
    """Timelines in memory whose bases may be in another journal.

    Args:
        other: The other journal, which is only read and must stay open.

    Attributes:
        records: Records of the timelines in memory.
    """

    def __init__(self, other: Journal) -> None:
        self._other, self._own = other, MemoryJournal()
        self.records = self._own.records

    @property
    def writable(self) -> bool:
        """Always True: changes go to the timelines in memory."""
        return True

    def timelines(self) -> Sequence[TimelineInfo]:
        """Return all timelines, those of the other journal first."""
        return (*self._other.timelines(), *self._own.timelines())

    def info(self, key: TimelineKey) -> TimelineInfo:
        """Return the metadata of a timeline of either journal; BranchError if there is none."""
        return self._of(key).info(key)

    def create(self, key: TimelineKey, base: ForkPoint | None, start: int) -> None:
        """Begin an empty timeline; BranchError if it exists or its base does not."""
        if any(info.key == key for info in self._other.timelines()):
            raise branch_taken(key)
        length = 0 if base is None else self.info(base.timeline).entries
        self._own.create_on(key, base, start, length)

    def append(self, key: TimelineKey, entries: Sequence[Entry], head: int) -> None:
        """Add entries to a timeline in memory and move its head."""
        self._own.append(key, entries, head)

    def entries(self, key: TimelineKey, start: int, stop: int) -> Iterator[Entry]:
        """Yield the entries with indexes start to stop - 1, oldest first."""
        return self._of(key).entries(key, start, stop)

    def entries_until(self, key: TimelineKey, tick: int) -> int:
        """Return the number of entries at `tick` or earlier."""
        return self._of(key).entries_until(key, tick)

    def filtered(
        self, key: TimelineKey, start: int, stop: int, what: EntryFilter
    ) -> Iterator[tuple[int, Entry]]:
        """Yield the entries from start to stop - 1 that match a filter, with their indexes."""
        return self._of(key).filtered(key, start, stop, what)

    def events_until(self, key: TimelineKey, entries: int) -> int:
        """Return the number of events in the first `entries` entries."""
        return self._of(key).events_until(key, entries)

    def agents_after(self, key: TimelineKey, entries: int) -> Mapping[str, AgentState | None]:
        """Return the last state of each agent that the first `entries` entries name."""
        return self._of(key).agents_after(key, entries)

    def rename(self, key: TimelineKey, name: str) -> None:
        """Rename the branch of a timeline in memory."""
        self._own.rename(key, name)

    def delete(self, key: TimelineKey) -> None:
        """Remove a timeline in memory; BranchError if another is based on it."""
        self._own.delete(key)

    def describe(self, key: TimelineKey, description: str) -> None:
        """Set the description of a timeline in memory."""
        self._own.describe(key, description)

    def put_checkpoint(self, key: TimelineKey, name: str, entries: int, body: bytes) -> None:
        """Store a checkpoint of a timeline in memory; ignore those of the other journal."""
        if self._own.has(key):
            self._own.put_checkpoint(key, name, entries, body)

    def nearest_checkpoint(
        self, key: TimelineKey, name: str, entries: int
    ) -> tuple[int, bytes] | None:
        """Return the last checkpoint of that name at or before entry `entries`, and its place."""
        return self._of(key).nearest_checkpoint(key, name, entries)

    def put_body_state(self, key: TimelineKey, entries: int, tick: int, state: bytes) -> None:
        """Store the internal state of the body of a timeline in memory."""
        self._own.put_body_state(key, entries, tick, state)

    def body_state(self, key: TimelineKey, entries: int, tick: int) -> bytes | None:
        """Return the internal state stored for exactly this moment; None if there is none."""
        return self._of(key).body_state(key, entries, tick)

    def together(self) -> AbstractContextManager[None]:
        """Make the calls inside the block atomic; only timelines in memory can change."""
        return self._own.together()

    def close(self) -> None:
        """Do nothing: the other journal belongs to the caller."""

    def _of(self, key: TimelineKey) -> Journal:
        return self._own if self._own.has(key) else self._other
