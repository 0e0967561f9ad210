"""Journal for nests without a run file; only the newest entries stay in memory."""

from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from itertools import chain, count
from operator import attrgetter
from weakref import finalize

from beliefnest.errors import BranchError
from beliefnest.timeline import codec
from beliefnest.timeline.chunks import CHUNK_ENTRIES, Chunks
from beliefnest.timeline.database import Database
from beliefnest.timeline.journal import (
    Entry,
    EntryFilter,
    ForkPoint,
    TimelineInfo,
    TimelineKey,
    branch_carries,
    branch_missing,
    branch_taken,
    check_append,
    check_base,
    check_place,
    count_of_events,
    is_found,
)
from beliefnest.timeline.own_key import Marks
from beliefnest.timeline.run_records import Records
from beliefnest.timeline.store_schema import PAST, RECORDS
from beliefnest.timeline.stored_states import StoredStates
from beliefnest.world.frames import Frame
from beliefnest.world.values import AgentState

_RECENT = 512
"""Least number of entries that a timeline keeps in memory before it packs older ones."""


@dataclass
class _Timeline:
    """A timeline with its newest entries.

    It is copied before a change (`MemoryJournal._changing`), so that the old one can come back.

    Attributes:
        info: Key, base, head and other metadata.
        number: Number of the timeline in the temporary file; it is never used again.
        packed: Number of entries in the temporary file; these are the first ones.
        recent: The entries after these. Packing replaces the list, so that copies keep theirs.
    """

    info: TimelineInfo
    number: int
    packed: int = 0
    recent: list[Entry] = field(default_factory=list)

    def part(self, start: int, stop: int) -> list[Entry]:
        """Return the entries with indexes start to stop - 1 that are in memory."""
        return self.recent[max(0, start - self.packed) : max(0, stop - self.packed)]

    def copy(self) -> "_Timeline":
        """Return a copy that shares the entries."""
        return replace(self)

    def cut(self) -> None:
        """Drop the entries that copies have added since."""
        del self.recent[self.info.entries - self.packed :]


class MemoryJournal:
    """A journal that is lost when the process ends.

    The last entries of each timeline are objects in memory. Older ones are in a temporary database,
    in the chunks of run files, with checkpoints and internal states of bodies. So memory does not
    grow with the length of a run.
    """

    writable = True

    def __init__(self) -> None:
        self._timelines: dict[TimelineKey, _Timeline] = {}
        self._database = Database.temporary(RECORDS)
        # Users need not close this journal, and can read it after `close`.
        finalize(self, self._database.close)
        self.records = Records(self._database)
        self._chunks = Chunks(self._database)
        marks = Marks()
        self._states = StoredStates(self._database, self._chunks, lambda: marks)
        self._numbers = count()

    def timelines(self) -> Sequence[TimelineInfo]:
        """Return all timelines, in order of creation."""
        return tuple(timeline.info for timeline in self._timelines.values())

    def has(self, key: TimelineKey) -> bool:
        """Return True if there is a timeline of that key."""
        return key in self._timelines

    def info(self, key: TimelineKey) -> TimelineInfo:
        """Return one timeline; BranchError if there is none of that key."""
        # Hot path: reading states calls this twice for each node.
        timeline = self._timelines.get(key)
        return self._timeline(key).info if timeline is None else timeline.info

    def create(self, key: TimelineKey, base: ForkPoint | None, start: int) -> None:
        """Begin an empty timeline; BranchError if it exists or its base does not."""
        if key in self._timelines:
            raise branch_taken(key)
        if base is not None:
            check_base(key, base, self.info(base.timeline).entries)
        info = TimelineInfo(key, base, start, start)
        self._timelines[key] = _Timeline(info, next(self._numbers))

    def append(self, key: TimelineKey, entries: Sequence[Entry], head: int) -> None:
        """Add entries and move the head; StoreError if the disk is full."""
        check_append(self._timeline(key).info, entries, head)
        timeline = self._changing(key)
        if len(timeline.recent) + len(entries) < _RECENT + CHUNK_ENTRIES:
            timeline.recent.extend(entries)
        else:
            self._pack(timeline, [*timeline.recent, *entries])
        known = timeline.packed + len(timeline.recent)
        timeline.info = replace(timeline.info, head=head, entries=known)

    def _pack(self, timeline: _Timeline, entries: list[Entry]) -> None:
        """Move the older of a timeline's entries to the temporary file, in whole chunks."""
        spare = len(entries) - _RECENT
        old = entries[: spare - spare % CHUNK_ENTRIES]
        encoded = [codec.encode_entry(entry) for entry in old]
        with self._database.transaction():
            self._make_tables()
            at = timeline.packed
            packed = self._chunks.add(timeline.number, at, at, encoded, old)
        timeline.packed, timeline.recent = packed, entries[len(old) :]

    def entries(self, key: TimelineKey, start: int, stop: int) -> Iterator[Entry]:
        """Yield the entries with indexes start to stop - 1, oldest first."""
        timeline = self._timeline(key)
        recent = timeline.part(start, stop)
        if start >= timeline.packed:
            return iter(recent)
        until = min(stop, timeline.packed)
        old = self._chunks.raw(
            timeline.number, start, until, lambda: self._gone(timeline.number, key)
        )
        return chain(map(codec.decode_entry, old), recent)

    def entries_until(self, key: TimelineKey, tick: int) -> int:
        """Return the number of entries at `tick` or earlier."""
        timeline = self._timeline(key)
        packed, recent = timeline.packed, timeline.recent
        if packed and tick < recent[0].tick:
            found = self._chunks.entries_until(timeline.number, tick)
            return packed if found is None else found
        return packed + bisect_right(recent, tick, key=attrgetter("tick"))

    def filtered(
        self, key: TimelineKey, start: int, stop: int, what: EntryFilter
    ) -> Iterator[tuple[int, Entry]]:
        """Yield the entries from start to stop - 1 that match a filter, with their indexes."""
        timeline = self._timeline(key)
        first = max(start, timeline.packed)
        numbered = enumerate(timeline.part(start, stop), start=first)
        recent = ((number, entry) for number, entry in numbered if is_found(entry, what))
        if start >= timeline.packed:
            return recent
        until = min(stop, timeline.packed)
        return chain(self._chunks.filtered(timeline.number, start, until, what), recent)

    def events_until(self, key: TimelineKey, entries: int) -> int:
        """Return the number of events in the first `entries` entries."""
        timeline = self._timeline(key)
        old = min(entries, timeline.packed)
        found = self._chunks.events_until(timeline.number, old) if old else 0
        return found + sum(map(count_of_events, timeline.part(0, entries)))

    def agents_after(self, key: TimelineKey, entries: int) -> Mapping[str, AgentState | None]:
        """Return the last state of each agent that the first `entries` entries name."""
        timeline = self._timeline(key)
        old = min(entries, timeline.packed)
        agents = dict(self._chunks.agents_after(timeline.number, old)) if old else {}
        for entry in timeline.part(0, entries):
            if isinstance(entry, Frame):
                agents.update(entry.agents)
        return agents

    def rename(self, key: TimelineKey, name: str) -> None:
        """Rename a timeline's branch; timelines based on it refer to the new name."""
        self._timeline(key)
        new_key = TimelineKey(key.path, name)
        if new_key in self._timelines:
            raise branch_taken(new_key)
        based = [timeline.info for timeline in self._based_on(key)]
        for info in based:
            base = info.base and replace(info.base, timeline=new_key)
            self._changing(info.key).info = replace(info, base=base)
        renamed = self._changing(key)
        renamed.info = replace(renamed.info, key=new_key)
        # The mapping is built again, so that timelines stay in order of creation.
        self._timelines = {each.info.key: each for each in self._timelines.values()}
        self.records.follow_rename(key.path, key.branch, name)

    def delete(self, key: TimelineKey) -> None:
        """Remove a timeline; BranchError if another is based on it."""
        number = self._timeline(key).number
        based = [timeline.info.key for timeline in self._based_on(key)]
        if based:
            raise branch_carries(key, based)
        with self._database.transaction():
            if self._has_tables:
                self._states.forget(number)
            self.records.forget_branch(key.path, key.branch)
        del self._timelines[key]

    def describe(self, key: TimelineKey, description: str) -> None:
        """Set a timeline's description."""
        timeline = self._changing(key)
        timeline.info = replace(timeline.info, description=description)

    def put_checkpoint(self, key: TimelineKey, name: str, entries: int, body: bytes) -> None:
        """Store a checkpoint for the first `entries` entries; InputError if there are fewer."""
        timeline = self._timeline(key)
        check_place(timeline.info, entries)
        packed = self._chunks.compressed(body)
        with self._database.transaction():
            self._make_tables()
            self._states.put_checkpoint(timeline.number, name, entries, packed)

    def nearest_checkpoint(
        self, key: TimelineKey, name: str, entries: int
    ) -> tuple[int, bytes] | None:
        """Return the last checkpoint of that name at or before entry `entries`, and its place."""
        number = self._timeline(key).number
        return self._states.nearest_checkpoint(number, name, entries) if self._has_tables else None

    def put_body_state(self, key: TimelineKey, entries: int, tick: int, state: bytes) -> None:
        """Store the internal state of a timeline's body; InputError if there are fewer entries."""
        timeline = self._timeline(key)
        check_place(timeline.info, entries)
        with self._database.transaction():
            self._make_tables()
            self._states.put_body_state(timeline.number, entries, tick, state)

    def body_state(self, key: TimelineKey, entries: int, tick: int) -> bytes | None:
        """Return the internal state stored for exactly this moment; None if there is none."""
        number = self._timeline(key).number
        return self._states.body_state(number, entries, tick) if self._has_tables else None

    @contextmanager
    def together(self) -> Iterator[None]:
        """Make the calls inside the block atomic: if the block raises, undo all of them."""
        before = dict(self._timelines)
        try:
            with self._database.transaction():
                yield
        except BaseException:
            for timeline in before.values():
                timeline.cut()
            self._timelines = before
            raise

    def close(self) -> None:
        """Do nothing: the temporary database is closed together with this object."""

    @property
    def _has_tables(self) -> bool:
        """True if the temporary database has the tables for the past."""
        # Asked each time, because undoing a call may remove the tables again.
        found = self._database.row("SELECT 1 FROM sqlite_master WHERE name = 'piece'")
        return found is not None

    def _make_tables(self) -> None:
        """Create the tables for the past, which short runs never need."""
        if not self._has_tables:
            for statement in PAST:
                self._database.execute(statement)

    def _timeline(self, key: TimelineKey) -> _Timeline:
        timeline = self._timelines.get(key)
        if timeline is None:
            raise self._missing(key)
        return timeline

    def _changing(self, key: TimelineKey) -> _Timeline:
        """Return a copy of a timeline that takes its place and may be changed."""
        timeline = self._timelines[key] = self._timeline(key).copy()
        return timeline

    def _gone(self, number: int, key: TimelineKey) -> BranchError | None:
        """Return the error for a timeline if it was deleted, None if it was not."""
        kept = (timeline.number for timeline in self._timelines.values())
        return None if number in kept else self._missing(key)

    def _missing(self, key: TimelineKey) -> BranchError:
        return branch_missing(key, (k.branch for k in self._timelines if k.path == key.path))

    def _based_on(self, key: TimelineKey) -> list[_Timeline]:
        return [
            timeline
            for timeline in self._timelines.values()
            if timeline.info.base is not None and timeline.info.base.timeline == key
        ]
