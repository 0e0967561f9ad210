"""Journal in one SQLite file per run.

Entries are stored in chunks (`timeline/chunks.py`): every call is durable when it returns, and
reading a past entry unpacks one chunk.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import NamedTuple

from beliefnest.errors import BranchError
from beliefnest.timeline import codec
from beliefnest.timeline.bounds import RunBounds
from beliefnest.timeline.chunks import Chunks
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
)
from beliefnest.timeline.own_key import own_marks
from beliefnest.timeline.run_records import Records, path_from, path_to
from beliefnest.timeline.stored_states import StoredStates
from beliefnest.world.limits import LATEST_TICK
from beliefnest.world.paths import path_text
from beliefnest.world.texts import quoted, shortened
from beliefnest.world.values import AgentState


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


class SqliteJournal:
    """A `Journal` in a run file; what a call wrote is durable when it returns.

    Create one with `create_file`, `open` or `read`; close it, or use it as a context manager. Every
    call may raise StoreError: the disk is full, or the file is damaged, closed, or open for reading
    only.

    Attributes:
        path: Path of the file.
        writable: True if the file was opened for writing.
        records: Records of the run besides its timelines.
    """

    def __init__(self, database: Database) -> None:
        self._database = database
        self._chunks = Chunks(database)
        self._states = StoredStates(database, self._chunks, own_marks)
        self.path, self.writable = database.path, database.writable
        self.records = Records(database)

    @classmethod
    def create_file(cls, path: Path | str) -> "SqliteJournal":
        """Create a run file.

        Raises:
            StoreError: The file exists already, or it cannot be created or written.
        """
        return cls(Database.create(Path(path)))

    @classmethod
    def open(cls, path: Path | str) -> "SqliteJournal":
        """Open a run file for writing, to continue the run.

        Raises:
            StoreError: The file is missing, no run file, of another format, damaged or read-only,
                or another writer has it open.
        """
        return cls._sound(Database.open(Path(path)))

    @classmethod
    def read(cls, path: Path | str) -> "SqliteJournal":
        """Open a run file for reading; another process may write it at the same time.

        Raises:
            StoreError: The file is missing, no run file, of another format or damaged.
        """
        return cls._sound(Database.read(Path(path)))

    @classmethod
    def _sound(cls, database: Database) -> "SqliteJournal":
        with database.closed_on_fault(), database.unchanging():
            journal = cls(database)
            journal._check_timelines()
            return journal

    def __enter__(self) -> "SqliteJournal":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def keep_within(self, bounds: RunBounds) -> None:
        """Check all entries that are read from now on: StoreError if one is out of bounds.

        StoreError also if a timeline is that of a simulator that cannot be.
        """
        for row in self._timeline_rows("ORDER BY id"):
            bounds.check_path(row.key.path)
        self._chunks.bounds = bounds

    def together(self) -> AbstractContextManager[None]:
        """Make the calls inside the block atomic: if one raises, nothing of them is stored."""
        return self._database.transaction()

    def unchanging(self) -> AbstractContextManager[None]:
        """Read one state of the file throughout the block, whatever a writer does meanwhile."""
        return self._database.unchanging()

    def timelines(self) -> Sequence[TimelineInfo]:
        """Return all timelines, in order of creation."""
        rows = {row.id: row for row in self._timeline_rows("ORDER BY id")}
        return tuple(
            _info(row, None if row.base is None else rows[row.base]) for row in rows.values()
        )

    def has(self, key: TimelineKey) -> bool:
        """Return True if there is a timeline of that key."""
        return self._found(key) is not None

    def info(self, key: TimelineKey) -> TimelineInfo:
        """Return one timeline; BranchError if there is none of that key."""
        row = self._row(key)
        base = None
        if row.base is not None:
            base = next(self._timeline_rows("WHERE id = ?", row.base), None)
            if base is None:
                raise damage(self.path, f"the base of {row.words} is missing")
        return _info(row, base)

    def create(self, key: TimelineKey, base: ForkPoint | None, start: int) -> None:
        """Begin an empty timeline; BranchError if it exists or its base does not."""
        with self._database.transaction():
            if self._found(key) is not None:
                raise branch_taken(key)
            number = None
            if base is not None:
                below = self._row(base.timeline)
                check_base(key, base, below.entries)
                number = below.id
            self._write(
                _TimelineRow(
                    id=self._next_id(),
                    path=path_to(key.path),
                    branch=key.branch,
                    base=number,
                    base_entries=None if base is None else base.entries,
                    base_tick=None if base is None else base.tick,
                    start=start,
                    head=start,
                    entries=0,
                    packed=0,
                    description="",
                )
            )

    def append(self, key: TimelineKey, entries: Sequence[Entry], head: int) -> None:
        """Add entries, all or none, and move the head; TickError if ticks do not rise."""
        encoded = [codec.encode_entry(entry) for entry in entries]
        with self._database.transaction():
            row = self._row(key)
            check_append(_info(row, None), entries, head)
            packed = row.packed
            if encoded:
                packed = self._chunks.add(row.id, row.entries, row.packed, encoded, entries)
            self._write(row._replace(head=head, entries=row.entries + len(encoded), packed=packed))

    def entries(self, key: TimelineKey, start: int, stop: int) -> Iterator[Entry]:
        """Yield the entries with indexes start to stop - 1, oldest first."""
        row = self._row(key)
        stop = min(stop, row.entries)
        return self._chunks.entries(row.id, start, stop, lambda: self._gone(row.id, key))

    def entries_until(self, key: TimelineKey, tick: int) -> int:
        """Return the number of entries at `tick` or earlier."""
        row = self._row(key)
        found = self._chunks.entries_until(row.id, tick)
        return row.entries if found is None else found

    def filtered(
        self, key: TimelineKey, start: int, stop: int, what: EntryFilter
    ) -> Iterator[tuple[int, Entry]]:
        """Yield the entries from start to stop - 1 that match a filter, with their indexes."""
        row = self._row(key)
        return self._chunks.filtered(row.id, start, min(stop, row.entries), what)

    def events_until(self, key: TimelineKey, entries: int) -> int:
        """Return the number of events in the first `entries` entries."""
        with self._database.unchanging():
            return self._chunks.events_until(self._row(key).id, entries)

    def agents_after(self, key: TimelineKey, entries: int) -> Mapping[str, AgentState | None]:
        """Return the last state of each agent that the first `entries` entries name."""
        with self._database.unchanging():
            return self._chunks.agents_after(self._row(key).id, entries)

    def rename(self, key: TimelineKey, name: str) -> None:
        """Rename a timeline's branch in all tables that name it."""
        with self._database.transaction():
            row = self._row(key)
            if self._found(TimelineKey(key.path, name)) is not None:
                raise branch_taken(TimelineKey(key.path, name))
            self._write(row._replace(branch=name))
            self.records.follow_rename(key.path, key.branch, name)

    def delete(self, key: TimelineKey) -> None:
        """Remove a timeline with its records; BranchError if another is based on it."""
        with self._database.transaction():
            row = self._row(key)
            based = [other.key for other in self._timeline_rows("WHERE base = ?", row.id)]
            if based:
                raise branch_carries(key, based)
            self._states.forget(row.id)
            self._database.execute("DELETE FROM timeline WHERE id = ?", (row.id,))
            self.records.forget_branch(key.path, key.branch)

    def describe(self, key: TimelineKey, description: str) -> None:
        """Set a timeline's description."""
        with self._database.transaction():
            self._write(self._row(key)._replace(description=description))

    def put_checkpoint(self, key: TimelineKey, name: str, entries: int, body: bytes) -> None:
        """Store a checkpoint for the first `entries` entries; InputError if there are fewer."""
        packed = self._chunks.compressed(body)
        with self._database.transaction():
            row = self._row(key)
            check_place(_info(row, None), entries)
            self._states.put_checkpoint(row.id, name, entries, packed)

    def nearest_checkpoint(
        self, key: TimelineKey, name: str, entries: int
    ) -> tuple[int, bytes] | None:
        """Return the last checkpoint of that name at or before entry `entries`, and its place."""
        return self._states.nearest_checkpoint(self._row(key).id, name, entries)

    def put_body_state(self, key: TimelineKey, entries: int, tick: int, state: bytes) -> None:
        """Store the internal state of a timeline's body; InputError if there are fewer entries."""
        with self._database.transaction():
            row = self._row(key)
            check_place(_info(row, None), entries)
            self._states.put_body_state(row.id, entries, tick, state)

    def body_state(self, key: TimelineKey, entries: int, tick: int) -> bytes | None:
        """Return the internal state stored for exactly this moment; None if there is none."""
        return self._states.body_state(self._row(key).id, entries, tick)

    def close(self) -> None:
        """Close the file and release its lock; closing twice is allowed."""
        self._database.close()

    def _timeline_rows(self, where: str, *values: object) -> Iterator[_TimelineRow]:
        rest, what = f"timeline {where}", "a timeline"
        return self._database.sound_rows(_COLUMNS, rest, values, what, _TimelineRow)

    def _found(self, key: TimelineKey) -> _TimelineRow | None:
        rows = self._timeline_rows("WHERE path = ? AND branch = ?", path_to(key.path), key.branch)
        return next(rows, None)

    def _row(self, key: TimelineKey) -> _TimelineRow:
        row = self._found(key)
        if row is None:
            raise self._missing(key)
        return row

    def _gone(self, number: int, key: TimelineKey) -> BranchError | None:
        """Return the error for a timeline if it was deleted, None if it was not."""
        return None if any(self._timeline_rows("WHERE id = ?", number)) else self._missing(key)

    def _missing(self, key: TimelineKey) -> BranchError:
        beside = self._timeline_rows("WHERE path = ?", path_to(key.path))
        return branch_missing(key, (other.branch for other in beside))

    def _next_id(self) -> int:
        # SQLite's sequence also counts deleted rows. An id is never used twice, so that a reader
        # never takes one timeline for another.
        row = self._database.row("SELECT seq FROM sqlite_sequence WHERE name = 'timeline'")
        return 1 if row is None else row[0] + 1

    def _write(self, row: _TimelineRow) -> None:
        marks = ", ".join("?" * (len(row) + 1))
        self._database.execute(
            f"INSERT INTO timeline ({_COLUMNS}, seal) VALUES ({marks}) ON CONFLICT (id) DO UPDATE "
            "SET branch = excluded.branch, head = excluded.head, entries = excluded.entries, "
            "packed = excluded.packed, description = excluded.description, seal = excluded.seal",
            (*row, checksum(*row)),
        )

    def _check_timelines(self) -> None:
        """Check that every timeline has its base and its last entry."""
        rows = {row.id: row for row in self._timeline_rows("ORDER BY id")}
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


def _info(row: _TimelineRow, base: _TimelineRow | None) -> TimelineInfo:
    fork = None
    if base is not None and row.base_entries is not None and row.base_tick is not None:
        fork = ForkPoint(base.key, row.base_entries, row.base_tick)
    return TimelineInfo(row.key, fork, row.start, row.head, row.entries, row.description)
