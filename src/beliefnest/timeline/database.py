"""Run file as an SQLite database: opening, validation, transactions and errors.

Every SQLite error becomes a StoreError that names the file. SQLite's write-ahead log keeps
committed transactions even if the process is killed, and lets other processes read at the same
time.
"""

import ctypes
import os
import sqlite3
import weakref
import zlib
from collections.abc import Iterable, Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import Any, TypeVar

import msgspec

from beliefnest.errors import NotBegunError, StoreError
from beliefnest.files import open_regular
from beliefnest.locking import ProcessLock
from beliefnest.owned import Owned
from beliefnest.timeline.lock import writer_lock
from beliefnest.timeline.store_schema import (
    APPLICATION_ID,
    SCHEMA_VERSION,
    SMALL_TABLES,
    STATEMENTS,
    expected_schema,
)
from beliefnest.world.texts import quoted, shortened

T = TypeVar("T")

DatabaseRow = tuple[Any, ...]

_MAGIC = b"SQLite format 3\0"
_HEADER_BYTES = 100
_KNOWN_STARTS = (
    (b"PK\x03\x04", "a zip archive"),
    (b"\x1f\x8b", "gzip-compressed data"),
    (b"\x28\xb5\x2f\xfd", "zstandard-compressed data"),
    (b"PAR1", "a Parquet file"),
    (b"{", "JSON text"),
)
_LONGEST_DETAIL = 200
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
_NO_LOCKS = (
    "is on a disk without file locks (fcntl), such as Lustre mounted without `-o flock`; keep runs "
    "on a local disk, with --out or store="
)
_LOCK_FAULTS = (
    sqlite3.SQLITE_IOERR_LOCK,
    sqlite3.SQLITE_IOERR_RDLOCK,
    sqlite3.SQLITE_IOERR_CHECKRESERVEDLOCK,
)
_REFUSALS = (sqlite3.Error, OverflowError, UnicodeDecodeError)
"""Exceptions that a statement can raise. SQLite does not look into texts, so that damaged ones
raise UnicodeDecodeError."""

_COMPANIONS = ("-wal", "-shm", "-journal", "-lock")
"""Suffixes of the files that may exist beside a run file and belong to it."""

_PRIMARY_CODE = 0xFF
"""Mask of the part of an SQLite error code that names the kind of error."""


def checksum(*values: object) -> int:
    """Return the checksum of a row's values; only the last value may be long bytes.

    Raises:
        StoreError: A number is too large.
    """
    *head, last = values
    try:
        body = last if isinstance(last, bytes) else msgspec.msgpack.encode(last)
        return zlib.crc32(body, zlib.crc32(msgspec.msgpack.encode(head)))
    except OverflowError as fault:
        raise StoreError(f"{head} cannot be stored: {fault}") from fault


def damage(path: Path, detail: str) -> StoreError:
    """Return the error for a damaged run file."""
    return StoreError(f"{path} {_DAMAGED} ({shortened(detail, _LONGEST_DETAIL)})")


def checked(row: DatabaseRow, path: Path, what: str, form: type[T]) -> T:
    """Check a row against its last value, the checksum, and return the other values as `form`.

    Raises:
        StoreError: The checksum is wrong, or a value has another type.
    """
    *values, stored = row
    try:
        sound = checksum(*values)
        if sound == stored:
            return msgspec.convert(values, form)
    except (msgspec.MsgspecError, ValueError, TypeError) as fault:
        raise damage(path, f"{what}: {shortened(str(fault))}") from fault
    raise damage(path, f"wrong checksum of {what}")


class Database(Owned):
    """An open run file, created by `create`, `temporary`, `open` or `read`.

    In a forked child every call raises ForkedError, except `close`, which does nothing there.

    Attributes:
        path: Path of the file.
        writable: True if it was opened for writing.
    """

    def __init__(
        self, connection: sqlite3.Connection, path: Path, lock: ProcessLock | None
    ) -> None:
        super().__init__()
        self._connection = connection
        self._lock = lock
        self._open = True
        self.path = path
        self.writable = lock is not None

    @classmethod
    def create(cls, path: Path) -> "Database":
        """Create a new run file; StoreError as of `Journal.create_file`."""
        _check_regular(path)
        database = cls._locked(path, "rwc")
        with database.closed_on_fault():
            if path.stat().st_size > 0:
                raise StoreError(
                    f"{path} exists already; resume it, remove it, or choose another name"
                )
            # There is nothing in it yet that a fall of the system could take.
            database.execute("PRAGMA synchronous = OFF")
            if database.row("PRAGMA journal_mode = WAL") != ("wal",):
                raise StoreError(
                    f"{path} is on a file system without shared access; use a local disk"
                )
            database.execute("PRAGMA synchronous = NORMAL")
            with database.transaction():
                for statement in STATEMENTS:
                    database.execute(statement)
                database.execute(f"PRAGMA application_id = {APPLICATION_ID}")
                database.execute(f"PRAGMA user_version = {SCHEMA_VERSION}")
        return database

    @classmethod
    def temporary(cls, statements: Iterable[str]) -> "Database":
        """Create a database that ends with this object, with the tables that `statements` define.

        It is in memory until it outgrows SQLite's cache of 2 MB, then in a file without a name,
        which the system removes even if the process is killed (https://sqlite.org/tempfiles.html).
        """
        connection = sqlite3.connect("", isolation_level=None, check_same_thread=False)
        database = cls(connection, Path("temporary run file"), None)
        # From Python 3.13 on, a connection that is collected while it is open warns.
        weakref.finalize(database, connection.close).atexit = False
        database.writable = True
        for statement in statements:
            database.execute(statement)
        return database

    @classmethod
    def open(cls, path: Path) -> "Database":
        """Open a run file for writing; StoreError as of `Journal.open`."""
        _recognise_start(path)
        if not os.access(path, os.W_OK):
            raise StoreError(f"{path} {_FAULTS[sqlite3.SQLITE_READONLY]}")
        database = cls._locked(path, "rw")
        with database.closed_on_fault():
            database._recognise()
            database.execute("PRAGMA synchronous = NORMAL")
            with database.transaction():
                database._check_small_tables()
        return database

    @classmethod
    def read(cls, path: Path) -> "Database":
        """Open a run file for reading; StoreError as of `Journal.read`."""
        _recognise_start(path)
        database = cls(_connected(path, "ro"), path, None)
        try:
            database._look()
        except StoreError as fault:
            if not _is_unshareable(fault) or _wal(path).exists():
                raise
            # SQLite could not share this file with a writer, so nobody can be writing it now.
            database = cls(_connected(path, "ro&immutable=1"), path, None)
            database._look()
        return database

    @classmethod
    def _locked(cls, path: Path, mode: str) -> "Database":
        lock = writer_lock(path)
        try:
            return cls(_connected(path, mode), path, lock)
        except BaseException:
            lock.release()
            raise

    def execute(self, sql: str, values: Iterable[object] = ()) -> sqlite3.Cursor:
        """Execute a statement that returns no rows."""
        self.check_own(str(self.path))
        try:
            return self._connection.execute(sql, tuple(values))
        except _REFUSALS as fault:
            raise self._fault(fault) from fault

    def rows(self, sql: str, values: Iterable[object] = ()) -> list[DatabaseRow]:
        """Return all rows of a query."""
        self.check_own(str(self.path))
        try:
            return self._connection.execute(sql, tuple(values)).fetchall()
        except _REFUSALS as fault:
            raise self._fault(fault) from fault

    def row(self, sql: str, values: Iterable[object] = ()) -> DatabaseRow | None:
        """Return the first row of a query, or None."""
        rows = self.rows(sql, values)
        return rows[0] if rows else None

    def sound_rows(
        self, columns: str, rest: str, values: Iterable[object], what: str, form: type[T]
    ) -> Iterator[T]:
        """Yield the rows of a query after a check of their checksums and types.

        Args:
            columns: Names of the columns.
            rest: Query after the word FROM.
            values: Values of its placeholders.
            what: Name of the rows for the error message.
            form: Type of a row without its checksum; SQLite does not hold columns to their types.

        Raises:
            StoreError: A row is damaged.
        """
        for row in self.rows(f"SELECT {columns}, seal FROM {rest}", values):
            yield checked(row, self.path, what, form)

    def write(self, into: str, **row: object) -> None:
        """Write a row with its checksum; only the last value may be long bytes.

        `into` is the beginning of the statement, such as `INSERT INTO meta`.
        """
        marks = ", ".join("?" * (len(row) + 1))
        values = tuple(row.values())
        self.execute(
            f"{into} ({', '.join(row)}, seal) VALUES ({marks})", (*values, checksum(*values))
        )

    @contextmanager
    def transaction(self) -> Iterator[None]:
        """Make the statements inside the block atomic; blocks may be nested."""
        if not self.writable:
            raise StoreError(
                f"{self.path} is open for reading only; open it for writing to change it"
            )
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
        """Read one state of the file throughout the block, whatever a writer does meanwhile."""
        nested = self._connection.in_transaction
        if not nested:
            self.execute("BEGIN")
        try:
            yield
        finally:
            if not nested:
                self._roll_back(nested=False)

    def _roll_back(self, nested: bool) -> None:
        # If the disk is full, SQLite has rolled back already.
        if not self._open or not self.is_own or not self._connection.in_transaction:
            return
        if nested:
            self.execute("ROLLBACK TO inner")
            self.execute("RELEASE inner")
        else:
            self.execute("ROLLBACK")

    def close(self) -> None:
        """Close the file and release the lock; closing twice is allowed.

        SQLite removes its companion files when the last connection is closed.
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
        """Leave the connection open in a forked child; it must not even be closed there.

        If the child closed it, SQLite would write the parent's log into the file and release the
        parent's locks.
        """
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(self._connection))

    @contextmanager
    def closed_on_fault(self) -> Iterator[None]:
        """Close the file if the block raises."""
        try:
            yield
        except BaseException:
            self.close()
            raise

    def _check_small_tables(self) -> None:
        for table in SMALL_TABLES:
            verdict = self.row(f"PRAGMA integrity_check({table})")
            if verdict != ("ok",):
                raise damage(self.path, verdict[0] if verdict else "check failed")

    def _look(self) -> None:
        """Validate a file opened for reading."""
        with self.closed_on_fault():
            self._recognise()
            self._check_small_tables()

    def _recognise(self) -> None:
        """Raise StoreError if the file is no run, or a run of another format."""
        application = self.row("PRAGMA application_id")
        version = self.row("PRAGMA user_version")
        if application != (APPLICATION_ID,):
            tables = [str(name) for (name,) in self.rows("SELECT name FROM sqlite_master LIMIT 5")]
            what = f"an SQLite file of another program (with {', '.join(tables)})"
            if not tables:
                raise NotBegunError(
                    f"{self.path} is not a run file: it is an empty SQLite database, perhaps of a "
                    "run that was stopped while it began; give a run file"
                )
            raise StoreError(f"{self.path} is not a run file: it is {what}; give a run file")
        number = version[0] if version else None
        if number != SCHEMA_VERSION:
            is_older = isinstance(number, int) and number < SCHEMA_VERSION
            raise StoreError(
                f"{self.path} has format {number}, but this program reads {SCHEMA_VERSION}; "
                f"{'play the run again' if is_older else 'use a newer version of beliefnest'}"
            )
        self._check_schema()

    def _check_schema(self) -> None:
        """Refuse a file with other definitions: a view can be endless, a trigger acts by itself."""
        expected = expected_schema(STATEMENTS)
        objects = self.rows(
            "SELECT type, name, tbl_name, sql FROM sqlite_master LIMIT ?", [len(expected) + 1]
        )
        if set(objects) != expected:
            other = sorted({(str(kind), str(name)) for kind, name, *_ in expected ^ set(objects)})
            names = ", ".join(f"{kind} {quoted(name)}" for kind, name in other[:5])
            raise StoreError(
                f"{self.path} has other tables than this program writes ({names}); "
                "restore it from a copy"
            )

    def _fault(self, fault: Exception) -> StoreError:
        if not self._open:
            return StoreError(f"{self.path} was closed; open it again")
        code = getattr(fault, "sqlite_errorcode", None)
        kind = "failed"
        if code in _LOCK_FAULTS:
            kind = _NO_LOCKS
        elif isinstance(code, int):
            kind = _FAULTS.get(code & _PRIMARY_CODE, kind)
        elif isinstance(fault, sqlite3.OperationalError | UnicodeDecodeError):
            kind = _DAMAGED
        return StoreError(f"{self.path} {kind} ({fault})")


def _wal(path: Path) -> Path:
    real = path.resolve()
    return real.with_name(real.name + "-wal")


def _remove_empty_log(path: Path) -> None:
    """Let SQLite remove an empty write-ahead log, unless another process uses it.

    A read-only connection creates a log if there is none, but cannot remove it.
    """
    log = _wal(path)
    # A log with content belongs to a writer or to a writer that was killed. It stays: reading
    # must not change a run.
    if not log.exists() or log.stat().st_size > 0 or not os.access(path, os.W_OK):
        return
    # If another process has the file open just now, that process will remove the log.
    with suppress(*_REFUSALS, StoreError), closing(_connected(path, "rw")) as connection:
        connection.execute("SELECT 1 FROM sqlite_master LIMIT 1").fetchall()


def _is_unshareable(fault: StoreError) -> bool:
    code = getattr(fault.__cause__, "sqlite_errorcode", 0) & _PRIMARY_CODE
    return code in (sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_READONLY)


def _connected(path: Path, mode: str) -> sqlite3.Connection:
    try:
        # Several threads use one connection in turn. SQLite is built in serialised mode, so the
        # check of Python's sqlite3 module is not needed.
        connection = sqlite3.connect(
            f"{path.resolve().as_uri()}?mode={mode}",
            uri=True,
            isolation_level=None,
            check_same_thread=False,
        )
        # Definitions in a foreign file may not call functions with side effects.
        connection.execute("PRAGMA trusted_schema = OFF")
    except sqlite3.Error as fault:
        raise StoreError(
            f"{path} cannot be opened ({fault}); check path and permissions"
        ) from fault
    return connection


def _recognise_start(path: Path) -> None:
    """Check the first bytes and the size of a file: it must be a complete SQLite file."""
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
        what = kinds[0] if kinds else f"a file that begins with {quoted(begin)}"
        if not header:
            raise NotBegunError(f"{path} is not a run file: it is an empty file; give a run file")
        raise StoreError(f"{path} is not a run file: it is {what}; give a run file")
    # If there is a write-ahead log, the rest of the file may still be in the log.
    if settled and size < _page_size(header) * int.from_bytes(header[28:32], "big"):
        raise damage(path, "its end is missing")


def _check_regular(path: Path) -> None:
    """Refuse irregular files, also beside the run file: SQLite would open them and wait."""
    real = path.resolve()
    for each in (real, *(real.with_name(real.name + end) for end in _COMPANIONS)):
        if each.exists() and not each.is_file():
            what = "give a run file" if each == real else "remove it"
            raise StoreError(f"{each} cannot be read: it is not a regular file; {what}")


def _page_size(header: bytes) -> int:
    stored = int.from_bytes(header[16:18], "big")
    return 65536 if stored == 1 else stored
