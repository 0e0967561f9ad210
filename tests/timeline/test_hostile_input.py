"""Run files that somebody else has made: what they define is compared before anything is read."""

import os
import shutil
import sqlite3
from contextlib import closing

import pytest
from hypothesis import given
from hypothesis import strategies as st

from beliefnest.errors import StoreError
from beliefnest.timeline.journal import TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.timeline.store_schema import STATEMENTS

OPENERS = (Journal.read, Journal.open)
TABLES = sorted(text.split()[2] for text in STATEMENTS if text.startswith("CREATE TABLE"))
ENDLESS = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n)"


def change(path, script):
    with closing(sqlite3.connect(path)) as connection:
        connection.executescript(script)


def columns(path, table):
    with closing(sqlite3.connect(path)) as connection:
        return [row[1] for row in connection.execute(f"PRAGMA table_info({table})")]


def endless_view(path, table):
    """Return the table's columns, and a row for every number there is."""
    names = ", ".join(f"i AS {name}" for name in columns(path, table))
    return (
        f"ALTER TABLE {table} RENAME TO kept;CREATE VIEW {table} AS {ENDLESS} SELECT {names} FROM n"
    )


def refused(path, told="has other tables than this program writes"):
    before = path.read_bytes()
    for opened in OPENERS:
        with pytest.raises(StoreError, match=told) as fault:
            opened(path)
        assert str(path) in str(fault.value)
        assert "\n" not in str(fault.value)
    assert path.read_bytes() == before


@pytest.mark.parametrize("table", TABLES)
def test_a_table_that_is_an_endless_view_is_refused(run_file, table):
    change(run_file, endless_view(run_file, table))
    refused(run_file)


def test_a_planted_trigger_does_not_run(run_file):
    change(
        run_file,
        "CREATE TRIGGER planted AFTER UPDATE ON timeline BEGIN DELETE FROM meta; END",
    )
    refused(run_file, "trigger 'planted'")


def test_what_a_file_defines_is_not_trusted(run_file):
    with Journal.read(run_file) as journal:
        assert journal._database.row("PRAGMA trusted_schema") == (0,)


@pytest.mark.parametrize("ending", ["", "-wal", "-shm", "-journal"])
def test_a_fifo_is_not_waited_for(run_file, ending):
    fifo = run_file.with_name(run_file.name + ending)
    fifo.unlink(missing_ok=True)
    os.mkfifo(fifo)
    for opened in (*OPENERS, Journal.create_file):
        with pytest.raises(StoreError, match="not a regular file"):
            opened(run_file)


def test_a_device_is_no_run():
    for opened in (*OPENERS, Journal.create_file):
        with pytest.raises(StoreError, match="not a regular file"):
            opened("/dev/zero")


NAMES = st.sampled_from(TABLES)
HARMS = st.one_of(
    st.tuples(st.just("view"), NAMES),
    NAMES.map(lambda t: f"CREATE TRIGGER x BEFORE INSERT ON {t} BEGIN SELECT 1; END"),
    NAMES.map(lambda t: f"CREATE INDEX x ON {t} (abs(id))" if t != "meta" else "CREATE TABLE x(y)"),
    NAMES.map(lambda t: f"ALTER TABLE {t} ADD COLUMN x GENERATED ALWAYS AS (1) VIRTUAL"),
    NAMES.map(lambda t: f"ALTER TABLE {t} ADD COLUMN x DEFAULT 1 CHECK (x > 0)"),
    NAMES.map(lambda t: f"ALTER TABLE {t} RENAME TO x"),
    st.sampled_from(["timeline_by_base", "piece_by_tick"]).map(lambda i: f"DROP INDEX {i}"),
    st.just("CREATE VIRTUAL TABLE x USING fts5(y)"),
    st.just("CREATE VIEW x AS SELECT load_extension('x')"),
)


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    path = tmp_path_factory.mktemp("sound") / "run.bn"
    with Journal.create_file(path) as journal:
        journal.create(TimelineKey((), "main"), None, 0)
    return path


@given(harm=HARMS)
def test_whatever_else_is_defined_is_refused(sound, tmp_path_factory, harm):
    path = tmp_path_factory.mktemp("harmed") / "run.bn"
    shutil.copy(sound, path)
    try:
        change(path, endless_view(path, harm[1]) if isinstance(harm, tuple) else harm)
    except sqlite3.OperationalError:
        # Not every harm can be done to every table by SQL.
        return
    refused(path)


def test_what_would_unpack_to_any_size_is_refused_unpacked(run_file):
    with Journal.read(run_file) as journal:
        bomb = journal._chunks.compressed(bytes(2**26 + 1))
        assert len(bomb) < 2**16
        with pytest.raises(StoreError, match="would unpack to more than 67,108,864 bytes"):
            journal._chunks.decompressed(bomb)
