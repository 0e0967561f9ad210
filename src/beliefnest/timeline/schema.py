"""What a run file consists of.

Every row carries `seal`, a checksum of its other columns, because SQLite itself does not
notice a flipped bit inside a value.
"""

import sqlite3
from collections.abc import Iterable
from contextlib import closing

__all__ = [
    "APPLICATION_ID",
    "BODY_STATE",
    "RECORDS",
    "SCHEMA_VERSION",
    "SMALL_TABLES",
    "STATEMENTS",
    "expected_schema",
]

APPLICATION_ID = 0x42656C4E
"""Marks an SQLite file as a run ("BelN")."""

SCHEMA_VERSION = 3

SMALL_TABLES = ("timeline", "meta", "selected", "program", "prompt")
"""Tables whose structure is checked whenever a file is opened; the others can be large."""

# What goes on in a timeline's body after its first `entries` entries, at a tick, and cannot be
# perceived, compressed. No cache: nothing else holds it.
BODY_STATE = """CREATE TABLE body_state (
        timeline INTEGER NOT NULL,
        entries INTEGER NOT NULL,
        tick INTEGER NOT NULL,
        state BLOB NOT NULL,
        seal INTEGER NOT NULL,
        PRIMARY KEY (timeline, entries, tick)
    )"""

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
"""Tables of what is kept besides timelines."""

STATEMENTS = (
    # A path is a JSON array of agent names. `packed` of the entries lie in compressed chunks.
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
    # A chunk: entries `first` to `first + count - 1` of a timeline; see codec.join. How many events
    # they have, how many of them change more than agents, and, where they are compressed, what is
    # known of every agent after them. Files of every version have the names piece and seal.
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
    # What stands for the first `entries` entries of a timeline, compressed; a cache. Whose, says
    # `name`.
    """CREATE TABLE keyframe (
        id INTEGER PRIMARY KEY,
        timeline INTEGER NOT NULL,
        name TEXT NOT NULL,
        entries INTEGER NOT NULL,
        body BLOB NOT NULL,
        seal INTEGER NOT NULL,
        UNIQUE (timeline, name, entries)
    )""",
    BODY_STATE,
    *RECORDS,
)


def expected_schema(statements: Iterable[str]) -> frozenset[tuple[object, ...]]:
    """What statements define: kind, name, table and text, as `sqlite_master` lists them.

    Tables that SQLite makes of its own accord are in it.
    """
    with closing(sqlite3.connect(":memory:")) as connection:
        for statement in statements:
            connection.execute(statement)
        return frozenset(connection.execute("SELECT type, name, tbl_name, sql FROM sqlite_master"))
