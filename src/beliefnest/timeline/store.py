"""The journal: timelines with their entries, in one SQLite file per run or in a temporary one.

Entries are stored in chunks (`timeline/chunks.py`): reading a past entry unpacks one chunk. In a
file every call is durable when it returns. Without a file, the newest entries of each timeline stay
in memory, and only older ones go to a temporary database. So memory does not grow with the length
of a run. The metadata of all timelines are in memory in both cases.
"""

from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from functools import cache
from itertools import chain
from operator import attrgetter
from pathlib import Path
from typing import NamedTuple, Self
from weakref import finalize

import msgspec
from msgspec.structs import replace

from beliefnest.errors import BranchError
from beliefnest.timeline import codec
from beliefnest.timeline.bounds import RunBounds
from beliefnest.timeline.chunks import CHUNK_ENTRIES, Chunks
from beliefnest.timeline.database import Database, checksum, damage
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
from beliefnest.timeline.own_key import Marks, own_marks
from beliefnest.timeline.run_records import Records, path_from, path_to
from beliefnest.timeline.store_schema import PAST, RECORDS
from beliefnest.timeline.stored_states import StoredStates
from beliefnest.world.frames import Frame
from beliefnest.world.limits import LATEST_TICK
from beliefnest.world.paths import path_text
from beliefnest.world.texts import quoted, shortened
from beliefnest.world.values import AgentState

_RECENT = 512
"""Least number of entries that a timeline without a file keeps in memory once it packs older ones.
"""


class _TimelineRow(NamedTuple):
    """A row of the table of timelines."""

    id: int
    path: str
    branch: str
    base: int | None
    base_entries: int | None
    base_tick: int | None
    start: int
    head: int
    entries: int
    packed: int
    description: str

    @property
    def key(self) -> TimelineKey:
        return TimelineKey(path_from(self.path), self.branch)

    @property
    def words(self) -> str:
        """Words for messages."""
        return f"branch {quoted(self.branch)} of {shortened(path_text(self.key.path))}"

    def has_sound_numbers(self, base: "_TimelineRow | None") -> bool:
        """Return True if ticks and numbers of entries fit each other and the base."""
        is_own = 0 <= self.start <= self.head <= LATEST_TICK and 0 <= self.packed <= self.entries
        if base is None or self.base_entries is None or self.base_tick is None:
            return is_own and (self.base_entries, self.base_tick) == (None, None)
        # A timeline is created after its base, so that none leads to itself.
        return (
            is_own
            and base.id < self.id
            and 0 <= self.base_entries <= base.entries
            and base.start <= self.base_tick <= min(base.head, self.start)
        )


_COLUMNS = ", ".join(_TimelineRow._fields)


class _Timeline(msgspec.Struct, frozen=True):
    """A timeline with the entries that are not in the database.

    Attributes:
        info: Key, base, head and other metadata.
        number: Row id of the timeline in the database; it is never used again.
        packed: Number of entries in compressed chunks; these are the first ones.
        recent: The newest entries, which only memory has; none if there is a file.
    """

    info: TimelineInfo
    number: int
    packed: int = 0
    recent: Sequence[Entry] = ()

    @property
    def stored(self) -> int:
        """Number of entries in the database; these are the first ones."""
        return self.info.entries - len(self.recent)

    def part(self, start: int, stop: int) -> Sequence[Entry]:
        """Return the entries with indexes start to stop - 1 that only memory has."""
        return self.recent[max(0, start - self.stored) : max(0, stop - self.stored)]


class Journal:
    """Store of timelines with one writer.

    Create one with `temporary`, `create_file`, `open` or `read`; close it, or use it as a context
    manager. Every call may raise StoreError: the disk is full, or the file is damaged, closed, or
    open for reading only. Every call with a key raises BranchError if there is no timeline of it.

    Attributes:
        path: Path of the file.
        writable: True if the journal accepts changes. Readers leave no checkpoints in a journal
            that does not.
        records: Records of the run besides its timelines. They change with timelines that are
            renamed or deleted.
    """

    def __init__(self, database: Database | None = None) -> None:
        self._has_file, self._made_past = database is not None, False
        if database is None:
            database = Database.temporary(RECORDS)
            # Users need not close this journal, and can read it after `close`.
            finalize(self, database.close)
        self._database = database
        self._chunks = Chunks(database)
        marks = own_marks if self._has_file else cache(Marks)
        self._states = StoredStates(database, self._chunks, marks)
        self._known: dict[TimelineKey, _Timeline] = {}
        self._last_number = 0
        self._version: object = None
        self.path, self.writable = database.path, database.writable
        self.records = Records(database)

    @classmethod
    def create_file(cls, path: Path | str) -> Self:
        """Create a run file.

        Raises:
            StoreError: The file exists already, or it cannot be created or written.
        """
        return cls(Database.create(Path(path)))

    @classmethod
    def open(cls, path: Path | str) -> Self:
        """Open a run file for writing, to continue the run.

        Raises:
            StoreError: The file is missing, no run file, of another format, damaged or read-only,
                or another writer has it open.
        """
        return cls._sound(Database.open(Path(path)))

    @classmethod
    def read(cls, path: Path | str) -> Self:
        """Open a run file for reading; another process may write it at the same time.

        Raises:
            StoreError: The file is missing, no run file, of another format or damaged.
        """
        return cls._sound(Database.read(Path(path)))

    @classmethod
    def _sound(cls, database: Database) -> Self:
        with database.closed_on_fault(), database.unchanging():
            journal = cls(database)
            journal._check_timelines()
            return journal

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file and release its lock; closing twice is allowed.

        A journal without a file can still be read.
        """
        if self._has_file:
            self._database.close()

    def keep_within(self, bounds: RunBounds) -> None:
        """Check all entries that are read from now on: StoreError if one is out of bounds.

        StoreError also if a timeline is that of a simulator that cannot be.
        """
        for key in self._timelines:
            bounds.check_path(key.path)
        self._chunks.bounds = bounds

    @contextmanager
    def together(self) -> Iterator[None]:
        """Make the calls inside the block atomic: if one raises, nothing of them is stored.

        Blocks may be nested.
        """
        before = dict(self._timelines), self._last_number
        try:
            with self._database.transaction():
                yield
        except BaseException:
            self._known, self._last_number = before
            raise

    def unchanging(self) -> AbstractContextManager[None]:
        """Read one state of the file throughout the block, whatever a writer does meanwhile."""
        return self._database.unchanging()

    def timelines(self) -> Sequence[TimelineInfo]:
        """Return the metadata of all timelines, in order of creation."""
        return tuple(timeline.info for timeline in self._timelines.values())

    def has(self, key: TimelineKey) -> bool:
        """Return True if there is a timeline of that key."""
        return key in self._timelines

    def info(self, key: TimelineKey) -> TimelineInfo:
        """Return the metadata of a timeline."""
        return self._timeline(key).info

    def lineage(self, key: TimelineKey) -> Iterator[tuple[TimelineKey, int]]:
        """Yield a timeline and its ancestors, each with its last tick in the timeline's past."""
        info = self.info(key)
        yield key, info.head
        while info.base is not None:
            yield info.base.timeline, info.base.tick
            info = self.info(info.base.timeline)

    def create(self, key: TimelineKey, base: ForkPoint | None, start: int) -> None:
        """Begin an empty timeline; the cost does not depend on the length of its base.

        Raises:
            BranchError: The key is in use, or the base does not exist.
        """
        if key in self._timelines:
            raise branch_taken(key)
        if base is not None:
            check_base(key, base, self.info(base.timeline).entries)
        number = self._last_number + 1
        self._put(_Timeline(TimelineInfo(key, base, start, start), number))
        self._last_number = number

    def append(self, key: TimelineKey, entries: Sequence[Entry], head: int) -> None:
        """Add entries, all or none, and move the head to tick `head`.

        Raises:
            TickError: The ticks do not rise from the old head to the new one.
        """
        timeline = self._timeline(key)
        check_append(timeline.info, entries, head)
        if not entries and head == timeline.info.head:
            return
        recent = (*timeline.recent, *entries)
        old = len(recent)
        if not self._has_file:
            old = max(old - _RECENT, 0) // CHUNK_ENTRIES * CHUNK_ENTRIES
        count = timeline.info.entries + len(entries)
        info = replace(timeline.info, head=head, entries=count)
        self._put(replace(timeline, info=info, recent=recent[old:]), recent[:old])

    def _put(self, timeline: _Timeline, old: Sequence[Entry] = ()) -> None:
        """Keep a timeline that is new or has changed.

        Args:
            timeline: The timeline.
            old: Entries before its recent ones that are not in the database yet.
        """
        if self._has_file or old:
            encoded = [codec.encode_entry(entry) for entry in old]
            with self._writing_past():
                if old:
                    first = timeline.stored - len(old)
                    number, packed = timeline.number, timeline.packed
                    packed = self._chunks.add(number, first, packed, encoded, old)
                    timeline = replace(timeline, packed=packed)
                self._write(timeline)
        self._known[timeline.info.key] = timeline

    def entries(self, key: TimelineKey, start: int, stop: int) -> Iterator[Entry]:
        """Yield the entries with indexes start to stop - 1, oldest first.

        Fewer come if the timeline ends earlier. Entries that are appended during the iteration are
        left out. `start` must not be negative.
        """
        timeline = self._timeline(key)
        recent = iter(timeline.part(start, stop))
        if start >= timeline.stored:
            return recent
        number, until = timeline.number, min(stop, timeline.stored)
        old = self._chunks.entries(number, start, until, lambda: self._gone(number, key))
        return chain(old, recent)

    def entries_until(self, key: TimelineKey, tick: int) -> int:
        """Return the number of entries at `tick` or earlier."""
        timeline = self._timeline(key)
        stored, recent = timeline.stored, timeline.recent
        if stored and not (recent and recent[0].tick <= tick):
            stored_until = self._chunks.entries_until(timeline.number, tick)
            return stored if stored_until is None else stored_until
        return stored + bisect_right(recent, tick, key=attrgetter("tick"))

    def filtered(
        self, key: TimelineKey, start: int, stop: int, what: EntryFilter
    ) -> Iterator[tuple[int, Entry]]:
        """Yield the entries from start to stop - 1 that match a filter, with their indexes.

        The time depends on the number of matches, hardly on the number of entries skipped.
        """
        timeline = self._timeline(key)
        numbered = enumerate(timeline.part(start, stop), start=max(start, timeline.stored))
        recent = ((number, entry) for number, entry in numbered if is_found(entry, what))
        if start >= timeline.stored:
            return recent
        until = min(stop, timeline.stored)
        return chain(self._chunks.filtered(timeline.number, start, until, what), recent)

    def events_until(self, key: TimelineKey, entries: int) -> int:
        """Return the number of events in the first `entries` entries."""
        timeline = self._timeline(key)
        count = sum(map(count_of_events, timeline.part(0, entries)))
        if not timeline.stored:
            return count
        with self._database.unchanging():
            old = min(entries, timeline.stored)
            return count + self._chunks.events_until(timeline.number, old)

    def agents_after(self, key: TimelineKey, entries: int) -> Mapping[str, AgentState | None]:
        """Return the last state of each agent that the first `entries` entries name.

        The time does not depend on the number of entries.
        """
        timeline = self._timeline(key)
        agents: dict[str, AgentState | None] = {}
        if timeline.stored:
            with self._database.unchanging():
                old = min(entries, timeline.stored)
                agents.update(self._chunks.agents_after(timeline.number, old))
        for entry in timeline.part(0, entries):
            if isinstance(entry, Frame):
                agents.update(entry.agents)
        return agents

    def rename(self, key: TimelineKey, name: str) -> None:
        """Rename a timeline's branch; timelines based on it refer to the new name.

        Raises:
            BranchError: The new name is in use.
        """
        new, timeline = TimelineKey(key.path, name), self._timeline(key)
        if new in self._timelines:
            raise branch_taken(new)
        with self._database.transaction():
            self._write(_renamed(timeline, key, new))
            self.records.follow_rename(key.path, key.branch, name)
        # The mapping is built again, so that timelines stay in order of creation.
        all_of_them = (_renamed(each, key, new) for each in self._known.values())
        self._known = {each.info.key: each for each in all_of_them}

    def delete(self, key: TimelineKey) -> None:
        """Remove a timeline with its records; BranchError if another one is based on it."""
        number = self._timeline(key).number
        infos = [each.info for each in self._known.values()]
        based = [info.key for info in infos if info.base and info.base.timeline == key]
        if based:
            raise branch_carries(key, based)
        with self._database.transaction():
            if self._has_past:
                self._states.forget(number)
            if self._has_file:
                self._database.execute("DELETE FROM timeline WHERE id = ?", (number,))
            self.records.forget_branch(key.path, key.branch)
        del self._known[key]

    def describe(self, key: TimelineKey, description: str) -> None:
        """Set a timeline's description."""
        timeline = self._timeline(key)
        self._put(replace(timeline, info=replace(timeline.info, description=description)))

    def put_checkpoint(self, key: TimelineKey, name: str, entries: int, body: bytes) -> None:
        """Store bytes from which a reader continues after the first `entries` entries.

        A checkpoint spares the reader these entries. It replaces an older one of the same place and
        name, and is deleted with its timeline.

        Raises:
            InputError: The timeline has fewer entries.
        """
        timeline = self._timeline(key)
        check_place(timeline.info, entries)
        packed = self._chunks.compressed(body)
        with self._writing_past():
            self._states.put_checkpoint(timeline.number, name, entries, packed)

    def nearest_checkpoint(
        self, key: TimelineKey, name: str, entries: int
    ) -> tuple[int, bytes] | None:
        """Return the last checkpoint of that name at or before entry `entries`, and its place.

        None if the timeline has none there; its base may have one.
        """
        number = self._timeline(key).number
        return self._states.nearest_checkpoint(number, name, entries) if self._has_past else None

    def put_body_state(self, key: TimelineKey, entries: int, tick: int, state: bytes) -> None:
        """Store the internal state of a timeline's body, which no entry contains.

        Args:
            key: Key of the timeline.
            entries: Number of entries before this moment.
            tick: Tick of the body; several calls may end after the same entry.
            state: Bytes that only the world can read.

        Raises:
            InputError: The timeline has fewer entries.
        """
        timeline = self._timeline(key)
        check_place(timeline.info, entries)
        with self._writing_past():
            self._states.put_body_state(timeline.number, entries, tick, state)

    def body_state(self, key: TimelineKey, entries: int, tick: int) -> bytes | None:
        """Return the internal state stored for exactly this moment; None if there is none."""
        number = self._timeline(key).number
        return self._states.body_state(number, entries, tick) if self._has_past else None

    @property
    def _has_past(self) -> bool:
        """True if there are tables for entries, checkpoints and states of bodies."""
        # Asked again, because undoing a call may remove the tables of a temporary database.
        made = "SELECT 1 FROM sqlite_master WHERE name = 'piece'"
        return self._has_file or (self._made_past and self._database.row(made) is not None)

    @contextmanager
    def _writing_past(self) -> Iterator[None]:
        """Make the statements inside the block atomic; make the tables that short runs lack."""
        with self._database.transaction():
            if not self._has_past:
                self._made_past = True
                for statement in PAST:
                    self._database.execute(statement)
            yield

    @property
    def _timelines(self) -> dict[TimelineKey, _Timeline]:
        """All timelines in order of creation, as the file has them now."""
        # Nobody else writes a file that is open for writing.
        if self._has_file and (self._version is None or not self._database.writable):
            # The number changes if another process has written the file.
            version = self._database.row("PRAGMA data_version")
            if version != self._version:
                self._known, self._version = self._read_timelines(), version
        return self._known

    def _timeline(self, key: TimelineKey) -> _Timeline:
        timeline = self._timelines.get(key)
        if timeline is None:
            raise self._missing(key)
        return timeline

    def _gone(self, number: int, key: TimelineKey) -> BranchError | None:
        """Return the error for a timeline if it was deleted, None if it was not."""
        kept = (timeline.number for timeline in self._timelines.values())
        return None if number in kept else self._missing(key)

    def _missing(self, key: TimelineKey) -> BranchError:
        return branch_missing(
            key, (other.branch for other in self._known if other.path == key.path)
        )

    def _rows(self) -> dict[int, _TimelineRow]:
        rest, what = "timeline ORDER BY id", "a timeline"
        rows = self._database.sound_rows(_COLUMNS, rest, (), what, _TimelineRow)
        return {row.id: row for row in rows}

    def _read_timelines(self) -> dict[TimelineKey, _Timeline]:
        rows = self._rows()
        # SQLite's sequence also counts deleted rows. An id is never used twice, so that a reader
        # never takes one timeline for another.
        last = self._database.row("SELECT seq FROM sqlite_sequence WHERE name = 'timeline'")
        self._last_number = 0 if last is None else last[0]
        timelines = (self._from_row(row, rows) for row in rows.values())
        return {timeline.info.key: timeline for timeline in timelines}

    def _from_row(self, row: _TimelineRow, rows: Mapping[int, _TimelineRow]) -> _Timeline:
        fork = None
        if row.base is not None:
            base = rows.get(row.base)
            if base is None or row.base_entries is None or row.base_tick is None:
                raise damage(self.path, f"the base of {row.words} is missing")
            fork = ForkPoint(base.key, row.base_entries, row.base_tick)
        info = TimelineInfo(row.key, fork, row.start, row.head, row.entries, row.description)
        return _Timeline(info, row.id, row.packed)

    def _write(self, timeline: _Timeline) -> None:
        """Write the row of a timeline if there is a file; the caller opens the transaction."""
        if not self._has_file:
            return
        info, base = timeline.info, timeline.info.base
        row = _TimelineRow(
            id=timeline.number,
            path=path_to(info.key.path),
            branch=info.key.branch,
            base=None if base is None else self._known[base.timeline].number,
            base_entries=None if base is None else base.entries,
            base_tick=None if base is None else base.tick,
            start=info.start,
            head=info.head,
            entries=info.entries,
            packed=timeline.packed,
            description=info.description,
        )
        marks = ", ".join("?" * (len(row) + 1))
        self._database.execute(
            f"INSERT INTO timeline ({_COLUMNS}, seal) VALUES ({marks}) ON CONFLICT (id) DO UPDATE "
            "SET branch = excluded.branch, head = excluded.head, entries = excluded.entries, "
            "packed = excluded.packed, description = excluded.description, seal = excluded.seal",
            (*row, checksum(*row)),
        )

    def _check_timelines(self) -> None:
        """Check that every timeline has its base and its last entry."""
        rows = self._rows()
        for row in rows.values():
            last = self._database.row(
                "SELECT first + count FROM piece WHERE timeline = ? ORDER BY first DESC LIMIT 1",
                (row.id,),
            )
            length = 0 if last is None else last[0]
            base = rows.get(row.base) if row.base is not None else None
            if length != row.entries or (row.base is not None and base is None):
                raise damage(self.path, f"{row.words} is incomplete")
            if not row.has_sound_numbers(base):
                raise damage(self.path, f"{row.words} has ticks or entries that cannot be")


def _renamed(timeline: _Timeline, key: TimelineKey, new: TimelineKey) -> _Timeline:
    """Return a timeline as it is when a key has become another."""
    info = timeline.info
    if info.base is not None and info.base.timeline == key:
        info = replace(info, base=replace(info.base, timeline=new))
    return replace(timeline, info=replace(info, key=new if info.key == key else info.key))
