"""Schema of a run file.

Every row has a column `seal`, a checksum of its other columns, because SQLite does not notice a
flipped bit inside a value.
"""

import sqlite3
from collections.abc import Iterable
from contextlib import closing

APPLICATION_ID = 0x42656C4E
"""SQLite application id that marks a file as a run ("BelN")."""

SCHEMA_VERSION = 4

SMALL_TABLES = ("timeline", "meta", "selected", "program", "prompt")
"""Tables whose structure is checked whenever a file is opened; the others can be large."""

RECORDS = (
    """CREATE TABLE meta (
        name TEXT PRIMARY KEY,
        value BLOB NOT NULL,
        seal INTEGER NOT NULL
    )""",
    """CREATE TABLE selected (
        path TEXT PRIMARY KEY,
        branch TEXT NOT NULL,
        seal INTEGER NOT NULL
    )""",
    """CREATE TABLE program (
        id INTEGER PRIMARY KEY AUTOINCREMENT,
        path TEXT NOT NULL,
        branch TEXT NOT NULL,
        body BLOB NOT NULL,
        seal INTEGER NOT NULL
    )""",
    """CREATE TABLE prompt (
        id INTEGER PRIMARY KEY AUTOINCREMENT,
        path TEXT NOT NULL,
        branch TEXT NOT NULL,
        body BLOB NOT NULL,
        seal INTEGER NOT NULL
    )""",
)
"""SQL statements of the tables for all records besides timelines."""

PAST = (
    # A chunk holds the entries `first` to `first + count - 1` of a timeline, joined by codec.join.
    # `events` is the number of their events. `changes` is the number of entries that change more
    # than agents. In compressed chunks `agents` holds the last state of every agent up to the end
    # of the chunk.
    """CREATE TABLE piece (
        id INTEGER PRIMARY KEY,
        timeline INTEGER NOT NULL,
        first INTEGER NOT NULL,
        count INTEGER NOT NULL,
        first_tick INTEGER NOT NULL,
        last_tick INTEGER NOT NULL,
        events INTEGER NOT NULL,
        changes INTEGER NOT NULL,
        agents BLOB NOT NULL,
        compressed INTEGER NOT NULL,
        body BLOB NOT NULL,
        seal INTEGER NOT NULL,
        UNIQUE (timeline, first)
    )""",
    "CREATE INDEX piece_by_tick ON piece (timeline, last_tick, first)",
    "CREATE INDEX piece_with_events ON piece (timeline, first, events) WHERE events > 0",
    "CREATE INDEX piece_with_changes ON piece (timeline, first) WHERE changes > 0",
    # Cached checkpoints, compressed: each replaces the first `entries` entries of a timeline for
    # the reader that `name` identifies.
    """CREATE TABLE keyframe (
        id INTEGER PRIMARY KEY,
        timeline INTEGER NOT NULL,
        name TEXT NOT NULL,
        entries INTEGER NOT NULL,
        body BLOB NOT NULL,
        seal INTEGER NOT NULL,
        UNIQUE (timeline, name, entries)
    )""",
    # Compressed internal state of a timeline's body, which cannot be perceived: after the first
    # `entries` entries, at tick `tick`. This is not a cache: the state cannot be computed again.
    """CREATE TABLE body_state (
        timeline INTEGER NOT NULL,
        entries INTEGER NOT NULL,
        tick INTEGER NOT NULL,
        state BLOB NOT NULL,
        seal INTEGER NOT NULL,
        PRIMARY KEY (timeline, entries, tick)
    )""",
)
"""SQL statements of the tables for entries, checkpoints and internal states of bodies."""

STATEMENTS = (
    # A path is a JSON array of agent names. The first `packed` entries are in compressed chunks.
    """CREATE TABLE timeline (
        id INTEGER PRIMARY KEY AUTOINCREMENT,
        path TEXT NOT NULL,
        branch TEXT NOT NULL,
        base INTEGER REFERENCES timeline (id),
        base_entries INTEGER,
        base_tick INTEGER,
        start INTEGER NOT NULL,
        head INTEGER NOT NULL,
        entries INTEGER NOT NULL,
        packed INTEGER NOT NULL,
        description TEXT NOT NULL,
        seal INTEGER NOT NULL,
        UNIQUE (path, branch)
    )""",
    "CREATE INDEX timeline_by_base ON timeline (base)",
    *PAST,
    *RECORDS,
)


def expected_schema(statements: Iterable[str]) -> frozenset[tuple[object, ...]]:
    """Return the kind, name, table and text of each object that statements define.

    The rows are those of `sqlite_master`, including the tables that SQLite adds itself.
    """
    with closing(sqlite3.connect(":memory:")) as connection:
        for statement in statements:
            connection.execute(statement)
        return frozenset(connection.execute("SELECT type, name, tbl_name, sql FROM sqlite_master"))
