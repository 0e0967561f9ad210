"""One run file as an SQLite database: opening, recognising, transactions, faults.

Whatever SQLite reports becomes a StoreError that names the file. The write-ahead log keeps
what a transaction did once it is committed, whatever becomes of the process, and lets
others read meanwhile.
"""

import ctypes
import os
import sqlite3
import zlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from beliefnest.errors import NotBegunError, StoreError
from beliefnest.files import open_regular
from beliefnest.owned import Owned
from beliefnest.timeline.lock import WriterLock
from beliefnest.timeline.schema import (
    APPLICATION_ID,
    SCHEMA_VERSION,
    SMALL_TABLES,
    STATEMENTS,
    expected_schema,
)

__all__ = ["Database", "OlderFormat", "Row", "checked", "checksum"]

Row = tuple[Any, ...]

_MAGIC = b"SQLite format 3\0"
_HEADER_BYTES = 100
_KNOWN_STARTS = (
    (b"PK\x03\x04", "a zip archive"),
    (b"\x1f\x8b", "gzip-compressed data"),
    (b"\x28\xb5\x2f\xfd", "zstandard-compressed data"),
    (b"PAR1", "a Parquet file"),
    (b"{", "JSON text"),
)
_DAMAGED = "is damaged; restore it from a copy"
_FAULTS = {
    sqlite3.SQLITE_FULL: "could not grow: the disk is full; nothing of this call was kept, "
    "free some space and repeat it",
    sqlite3.SQLITE_IOERR: "could not be read or written by the operating system; nothing of "
    "this call was kept, check the disk and its free space",
    sqlite3.SQLITE_READONLY: "is read-only; make the file and its folder writable, or open "
    "it for reading",
    sqlite3.SQLITE_CANTOPEN: "cannot be opened; check the permissions of the file and its folder",
    sqlite3.SQLITE_BUSY: "is held by another program; close that and repeat",
    sqlite3.SQLITE_LOCKED: "is held by another program; close that and repeat",
    sqlite3.SQLITE_CORRUPT: _DAMAGED,
    sqlite3.SQLITE_NOTADB: _DAMAGED,
    sqlite3.SQLITE_ERROR: _DAMAGED,
}
_REFUSALS = (sqlite3.Error, OverflowError, UnicodeDecodeError)
"""What a statement can raise: damage can lie in texts, which SQLite itself does not look into."""

_COMPANIONS = ("-wal", "-shm", "-journal", "-lock")
"""Ends of the names of files that may lie beside a run file and are read with it."""

_PRIMARY_CODE = 0xFF
"""The part of an SQLite error code that names the kind of fault."""


def checksum(*values: object) -> int:
    """Checksum of a row's values; StoreError if a number is too large. The last may be long."""
    *head, last = values
    try:
        body = last if isinstance(last, bytes) else msgspec.msgpack.encode(last)
        return zlib.crc32(body, zlib.crc32(msgspec.msgpack.encode(head)))
    except OverflowError as fault:
        raise StoreError(f"{head} cannot be stored: {fault}") from fault


def checked(row: Row, path: Path, what: str) -> Row:
    """The row without its checksum, which is its last value; StoreError if they do not agree."""
    *values, found = row
    if checksum(*values) != found:
        raise StoreError(f"{path} {_DAMAGED} (checksum of {what} does not agree)")
    return tuple(values)


@dataclass(frozen=True, slots=True)
class OlderFormat:
    """A format of run files that is converted when a file is opened.

    Attributes:
        version: Its number.
        statements: What a file of it consists of.
        convert: Makes it a file of this format.
    """

    version: int
    statements: tuple[str, ...]
    convert: Callable[["Database"], None]


class Database(Owned):
    """An open run file; made by `create`, `in_memory`, `open` or `read`.

    Any use in a forked child raises ForkedError, but `close`, which does nothing there.

    Attributes:
        path: The file.
        writable: Whether it was opened to be written.
    """

    def __init__(self, connection: sqlite3.Connection, path: Path, lock: WriterLock | None) -> None:
        super().__init__()
        self._connection = connection
        self._lock = lock
        self._open = True
        self.path = path
        self.writable = lock is not None

    @classmethod
    def create(cls, path: Path) -> "Database":
        """Make a new run file; StoreError as of `SqliteJournal.create_file`."""
        _check_regular(path)
        database = cls._locked(path, "rwc")
        with database.closed_on_fault():
            if path.stat().st_size > 0:
                raise StoreError(f"{path} exists; resume it, remove it, or choose another name")
            if database.row("PRAGMA journal_mode = WAL") != ("wal",):
                raise StoreError(f"{path} lies where files cannot be shared; use a local disk")
            database.execute("PRAGMA synchronous = NORMAL")
            with database.transaction():
                for statement in STATEMENTS:
                    database.execute(statement)
                database.execute(f"PRAGMA application_id = {APPLICATION_ID}")
                database.execute(f"PRAGMA user_version = {SCHEMA_VERSION}")
        return database

    @classmethod
    def in_memory(cls, statements: Iterable[str]) -> "Database":
        """A new database that ends with the process, and consists of what statements define."""
        memory = ":memory:"
        connection = sqlite3.connect(memory, isolation_level=None, check_same_thread=False)
        database = cls(connection, Path(memory), None)
        database.writable = True
        for statement in statements:
            database.execute(statement)
        return database

    @classmethod
    def open(cls, path: Path, older: Sequence[OlderFormat] = ()) -> "Database":
        """Open a run file to go on with it; one of an older format is converted for good.

        StoreError as of `SqliteJournal.open`.
        """
        _recognise_start(path)
        if not os.access(path, os.W_OK):
            raise StoreError(f"{path} {_FAULTS[sqlite3.SQLITE_READONLY]}")
        database = cls._locked(path, "rw")
        with database.closed_on_fault():
            found = database._recognise(older)
            database.execute("PRAGMA synchronous = NORMAL")
            with database.transaction():
                database._convert(found)
                database._check_small_tables()
        return database

    @classmethod
    def read(cls, path: Path, older: Sequence[OlderFormat] = ()) -> "Database":
        """Open a run file to look at it; StoreError as of `SqliteJournal.read`.

        Of one of an older format a copy in memory is converted, as it is now.
        """
        _recognise_start(path)
        database = cls(_connected(path, "ro"), path, None)
        try:
            database._look(older)
        except StoreError as fault:
            if not _is_unshareable(fault) or _wal(path).exists():
                raise
            # Where SQLite cannot share the file with a writer, there can be none either.
            database = cls(_connected(path, "ro&immutable=1"), path, None)
            database._look(older)
        return database

    @classmethod
    def _locked(cls, path: Path, mode: str) -> "Database":
        lock = WriterLock.acquire(path)
        try:
            return cls(_connected(path, mode), path, lock)
        except BaseException:
            lock.release()
            raise

    def execute(self, sql: str, values: Iterable[object] = ()) -> sqlite3.Cursor:
        """Run a statement that returns nothing."""
        self.check_own(str(self.path))
        try:
            return self._connection.execute(sql, tuple(values))
        except _REFUSALS as fault:
            raise self._fault(fault) from fault

    def rows(self, sql: str, values: Iterable[object] = ()) -> list[Row]:
        """Return all rows a query returns."""
        self.check_own(str(self.path))
        try:
            return self._connection.execute(sql, tuple(values)).fetchall()
        except _REFUSALS as fault:
            raise self._fault(fault) from fault

    def row(self, sql: str, values: Iterable[object] = ()) -> Row | None:
        """Return the first row a query returns, or None."""
        rows = self.rows(sql, values)
        return rows[0] if rows else None

    def sound_rows(
        self, columns: str, rest: str, values: Iterable[object], what: str
    ) -> Iterator[Row]:
        """Yield columns of the rows that the rest of a query chooses; StoreError if one is damaged.

        `what` names them in its message.
        """
        for row in self.rows(f"SELECT {columns}, seal FROM {rest}", values):
            yield checked(row, self.path, what)

    def write(self, into: str, **row: object) -> None:
        """Write a row with its checksum; `into` is an `INSERT INTO` with a table, or the like.

        The last value may be long bytes.
        """
        marks = ", ".join("?" * (len(row) + 1))
        values = tuple(row.values())
        self.execute(
            f"{into} ({', '.join(row)}, seal) VALUES ({marks})", (*values, checksum(*values))
        )

    @contextmanager
    def transaction(self) -> Iterator[None]:
        """Do all that follows or, if anything raises, none of it. May be nested."""
        if not self.writable:
            raise StoreError(f"{self.path} is open for reading; open it for writing to change it")
        nested = self._connection.in_transaction
        self.execute("SAVEPOINT inner" if nested else "BEGIN IMMEDIATE")
        try:
            yield
            self.execute("RELEASE inner" if nested else "COMMIT")
        except BaseException:
            self._roll_back(nested)
            raise

    @contextmanager
    def unchanging(self) -> Iterator[None]:
        """See the file in one state throughout, whatever a writer does meanwhile."""
        nested = self._connection.in_transaction
        if not nested:
            self.execute("BEGIN")
        try:
            yield
        finally:
            if not nested:
                self._roll_back(nested=False)

    def _roll_back(self, nested: bool) -> None:
        # A full disk makes SQLite roll back of its own accord.
        if not self._open or not self.is_own or not self._connection.in_transaction:
            return
        if nested:
            self.execute("ROLLBACK TO inner")
            self.execute("RELEASE inner")
        else:
            self.execute("ROLLBACK")

    def close(self) -> None:
        """Close the file and give up the lock; closing twice is allowed.

        What SQLite keeps beside an open file is gone when nobody has it open any more.
        """
        if not self._open or not self.is_own:
            return
        self._open = False
        try:
            self._connection.close()
        except sqlite3.Error as fault:
            raise self._fault(fault) from fault
        finally:
            if self._lock is not None:
                self._lock.release()
        if not self.writable:
            _remove_empty_log(self.path)

    def disown(self) -> None:
        """Keep the connection open for good in a forked child: SQLite may not even close it there.

        Closing it would let SQLite write its parent's log into the file, and give up its locks.
        """
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(self._connection))

    @contextmanager
    def closed_on_fault(self) -> Iterator[None]:
        """Close the file if what follows raises."""
        try:
            yield
        except BaseException:
            self.close()
            raise

    def _check_small_tables(self) -> None:
        for table in SMALL_TABLES:
            found = self.row(f"PRAGMA integrity_check({table})")
            if found != ("ok",):
                raise StoreError(
                    f"{self.path} {_DAMAGED} ({found[0] if found else 'check failed'})"
                )

    def _look(self, older: Sequence[OlderFormat]) -> None:
        """Check a file that is only read, and go over to a converted copy if it is an older one."""
        with self.closed_on_fault():
            found = self._recognise(older)
            if found is not None:
                copy = sqlite3.connect(":memory:", isolation_level=None, check_same_thread=False)
                self._connection.backup(copy)
                self._connection.close()
                self._connection = copy
                self._convert(found)
            self._check_small_tables()

    def _convert(self, found: OlderFormat | None) -> None:
        if found is not None:
            found.convert(self)
            self.execute(f"PRAGMA user_version = {SCHEMA_VERSION}")

    def _recognise(self, older: Sequence[OlderFormat]) -> OlderFormat | None:
        """Check that a file is a run; returns the older format that it has."""
        application = self.row("PRAGMA application_id")
        version = self.row("PRAGMA user_version")
        if application != (APPLICATION_ID,):
            tables = [str(name) for (name,) in self.rows("SELECT name FROM sqlite_master LIMIT 5")]
            what = f"an SQLite file of another program (with {', '.join(tables)})"
            if not tables:
                raise NotBegunError(
                    f"{self.path} is no run: it is an SQLite file without content, perhaps of a "
                    "run stopped while it began; give the file of a run"
                )
            raise StoreError(f"{self.path} is no run: it is {what}; give the file of a run")
        number = version[0] if version else None
        found = next((each for each in older if each.version == number), None)
        if number != SCHEMA_VERSION and found is None:
            is_older = isinstance(number, int) and number < SCHEMA_VERSION
            raise StoreError(
                f"{self.path} has the format {number} and this program reads {SCHEMA_VERSION}; "
                f"use {'an older' if is_older else 'a newer'} version of beliefnest"
            )
        self._check_schema(STATEMENTS if found is None else found.statements)
        return found

    def _check_schema(self, statements: Iterable[str]) -> None:
        """Refuse a file that defines anything else: a view has no end, a trigger acts."""
        expected = expected_schema(statements)
        found = self.rows(
            "SELECT type, name, tbl_name, sql FROM sqlite_master LIMIT ?", [len(expected) + 1]
        )
        if set(found) != expected:
            other = sorted({(str(kind), str(name)) for kind, name, *_ in expected ^ set(found)})
            names = ", ".join(f"{kind} {name!r}" for kind, name in other[:5])
            raise StoreError(
                f"{self.path} is not as this program writes runs ({names} differ); "
                "restore it from a copy"
            )

    def _fault(self, fault: Exception) -> StoreError:
        if not self._open:
            return StoreError(f"{self.path} was closed; open it again")
        code = getattr(fault, "sqlite_errorcode", None)
        kind = "failed"
        if isinstance(code, int):
            kind = _FAULTS.get(code & _PRIMARY_CODE, kind)
        elif isinstance(fault, sqlite3.OperationalError | UnicodeDecodeError):
            kind = _DAMAGED
        return StoreError(f"{self.path} {kind} ({fault})")


def _wal(path: Path) -> Path:
    real = path.resolve()
    return real.with_name(real.name + "-wal")


def _remove_empty_log(path: Path) -> None:
    """Let SQLite remove a write-ahead log without content, unless somebody uses it.

    A connection that only reads makes a log where there is none, and cannot remove it.
    """
    log = _wal(path)
    # One with content is a writer's, or left by one that was killed: looking changes no run.
    if not log.exists() or log.stat().st_size > 0 or not os.access(path, os.W_OK):
        return
    # Somebody else may be at it at this very moment; then it is theirs to remove.
    with suppress(*_REFUSALS, StoreError), closing(_connected(path, "rw")) as connection:
        connection.execute("SELECT 1 FROM sqlite_master LIMIT 1").fetchall()


def _is_unshareable(fault: StoreError) -> bool:
    code = getattr(fault.__cause__, "sqlite_errorcode", 0) & _PRIMARY_CODE
    return code in (sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_READONLY)


def _connected(path: Path, mode: str) -> sqlite3.Connection:
    try:
        # Readers hand a connection from thread to thread; SQLite itself is built serialised.
        connection = sqlite3.connect(
            f"{path.resolve().as_uri()}?mode={mode}",
            uri=True,
            isolation_level=None,
            check_same_thread=False,
        )
        # What a file defines gets none of the functions that could act on something else.
        connection.execute("PRAGMA trusted_schema = OFF")
    except sqlite3.Error as fault:
        raise StoreError(
            f"{path} cannot be opened ({fault}); check path and permissions"
        ) from fault
    return connection


def _recognise_start(path: Path) -> None:
    """Check by its first bytes that a file is SQLite's and whole."""
    _check_regular(path)
    settled = not _wal(path).exists()
    try:
        with open_regular(path) as file:
            header = file.read(_HEADER_BYTES)
            size = path.stat().st_size
    except FileNotFoundError as fault:
        raise StoreError(f"there is no run file {path}; check the path") from fault
    except OSError as fault:
        raise StoreError(f"{path} cannot be read ({fault.strerror}); check the path") from fault
    if not header.startswith(_MAGIC):
        kinds = [kind for start, kind in _KNOWN_STARTS if header.startswith(start)]
        begin = header[: len(_MAGIC)]
        what = kinds[0] if kinds else f"a file that begins with {begin!r}"
        if not header:
            raise NotBegunError(f"{path} is no run: it is an empty file; give the file of a run")
        raise StoreError(f"{path} is no run: it is {what}; give the file of a run")
    # With a write-ahead log beside it, the rest of the file may still lie in that.
    if settled and size < _page_size(header) * int.from_bytes(header[28:32], "big"):
        raise StoreError(f"{path} {_DAMAGED} (its end is missing)")


def _check_regular(path: Path) -> None:
    """Refuse a file, or one beside it, that SQLite would open and wait for."""
    real = path.resolve()
    for each in (real, *(real.with_name(real.name + end) for end in _COMPANIONS)):
        if each.exists() and not each.is_file():
            what = "give the file of a run" if each == real else "remove it"
            raise StoreError(f"{each} cannot be read: it is not a regular file; {what}")


def _page_size(header: bytes) -> int:
    stored = int.from_bytes(header[16:18], "big")
    return 65536 if stored == 1 else stored
