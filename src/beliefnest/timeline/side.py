"""A journal beside another one: it reads what that one holds, and keeps what is added itself."""

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
from beliefnest.timeline.memory import MemoryJournal
from beliefnest.world.values import AgentState

__all__ = ["SideJournal"]


class SideJournal:
    """Timelines in memory whose bases may lie in another journal, which is only read.

    Args:
        other: The other journal; it has to stay open.

    Attributes:
        records: What ran on the timelines in memory.
    """

    def __init__(self, other: Journal) -> None:
        self._other, self._own = other, MemoryJournal()
        self.records = self._own.records

    @property
    def writable(self) -> bool:
        """It is; the other journal is not written to."""
        return True

    def timelines(self) -> Sequence[TimelineInfo]:
        """Return all timelines, those of the other journal first."""
        return (*self._other.timelines(), *self._own.timelines())

    def info(self, key: TimelineKey) -> TimelineInfo:
        """Return one timeline of either; BranchError if there is none of that key."""
        return self._of(key).info(key)

    def create(self, key: TimelineKey, base: ForkPoint | None, start: int) -> None:
        """Begin an empty timeline; BranchError if there is one, or the base is not there."""
        if any(info.key == key for info in self._other.timelines()):
            raise branch_taken(key)
        length = 0 if base is None else self.info(base.timeline).entries
        self._own.create_on(key, base, start, length)

    def append(self, key: TimelineKey, entries: Sequence[Entry], head: int) -> None:
        """Add entries to a timeline in memory and move its head."""
        self._own.append(key, entries, head)

    def entries(self, key: TimelineKey, start: int, stop: int) -> Iterator[Entry]:
        """Yield entries number start to stop - 1, oldest first."""
        return self._of(key).entries(key, start, stop)

    def entries_until(self, key: TimelineKey, tick: int) -> int:
        """How many entries lie at `tick` or before."""
        return self._of(key).entries_until(key, tick)

    def filtered(
        self, key: TimelineKey, start: int, stop: int, what: EntryFilter
    ) -> Iterator[tuple[int, Entry]]:
        """Yield those of entries start to stop - 1 that are looked for, with their numbers."""
        return self._of(key).filtered(key, start, stop, what)

    def events_until(self, key: TimelineKey, entries: int) -> int:
        """How many events the first `entries` entries have."""
        return self._of(key).events_until(key, entries)

    def agents_after(self, key: TimelineKey, entries: int) -> Mapping[str, AgentState | None]:
        """Return the last state of each agent that the first `entries` entries name."""
        return self._of(key).agents_after(key, entries)

    def rename(self, key: TimelineKey, name: str) -> None:
        """Give a timeline in memory another name."""
        self._own.rename(key, name)

    def delete(self, key: TimelineKey) -> None:
        """Remove a timeline in memory; BranchError if another is based on it."""
        self._own.delete(key)

    def describe(self, key: TimelineKey, description: str) -> None:
        """Set the description of a timeline in memory."""
        self._own.describe(key, description)

    def put_checkpoint(self, key: TimelineKey, name: str, entries: int, body: bytes) -> None:
        """Keep bytes that stand for the first entries of a timeline in memory; else nothing."""
        if self._own.has(key):
            self._own.put_checkpoint(key, name, entries, body)

    def nearest_checkpoint(
        self, key: TimelineKey, name: str, entries: int
    ) -> tuple[int, bytes] | None:
        """Return the last checkpoint of that name at or before entry `entries`, with its place."""
        return self._of(key).nearest_checkpoint(key, name, entries)

    def put_body_state(self, key: TimelineKey, entries: int, tick: int, state: bytes) -> None:
        """Keep the internal state of the body of a timeline in memory at a moment."""
        self._own.put_body_state(key, entries, tick, state)

    def body_state(self, key: TimelineKey, entries: int, tick: int) -> bytes | None:
        """Return the internal state that was kept for a moment; None if none was."""
        return self._of(key).body_state(key, entries, tick)

    def together(self) -> AbstractContextManager[None]:
        """Do all that is done inside or, if it raises, none of it."""
        return self._own.together()

    def close(self) -> None:
        """Leave the other journal to whoever opened it."""

    def _of(self, key: TimelineKey) -> Journal:
        return self._own if self._own.has(key) else self._other
