"""Run files of the format before: read as they are, converted by who goes on with them."""

import shutil
import sqlite3
from contextlib import closing
from dataclasses import replace

import pytest
from tests.timeline.conftest import MAIN
from tests.timeline.format_2 import make_format_2
from tests.timeline.stored import verify

from beliefnest.errors import StoreError
from beliefnest.timeline.run_records import ProgramRecord
from beliefnest.timeline.store import SqliteJournal
from beliefnest.timeline.store_schema import SCHEMA_VERSION

RAN = ProgramRecord((), "main", "sally", "await x()", 12, False, "line 1: no x", 3, 1)
PROGRAMS = (
    replace(RAN, entries=7, timeout_ticks=1200, step=0),
    replace(RAN, entries=9, timeout_ticks=20, kept=False, group=2),
)


def version_of(path):
    with closing(sqlite3.connect(path)) as file:
        return file.execute("PRAGMA user_version").fetchone()[0]


@pytest.fixture
def old_file(run_file):
    with SqliteJournal.open(run_file) as journal:
        for program in PROGRAMS:
            journal.records.add_program(program)
        journal.put_body_state(MAIN, 7, 12, b"falls")
        journal.put_body_state(MAIN, 7, 13, b"falls faster")
        journal.put_checkpoint(MAIN, "world x", 7, b"cache")
    make_format_2(run_file)
    return run_file


def check(journal):
    assert tuple(journal.records.programs()) == PROGRAMS
    assert journal.body_state(MAIN, 7, 12) == b"falls"
    assert journal.body_state(MAIN, 7, 13) == b"falls faster"
    assert journal.body_state(MAIN, 7, 14) is None
    assert journal.nearest_checkpoint(MAIN, "world x", 8) == (7, b"cache")
    assert journal.nearest_checkpoint(MAIN, "hidden 12", 8) is None
    verify(journal)


def test_it_is_read_and_left_as_it_is(old_file):
    before = old_file.read_bytes()
    with SqliteJournal.read(old_file) as journal:
        check(journal)
        with pytest.raises(StoreError, match="open for reading"):
            journal.describe(MAIN, "no")
    assert old_file.read_bytes() == before


def test_who_goes_on_with_it_converts_it(old_file):
    with SqliteJournal.open(old_file) as journal:
        check(journal)
    assert version_of(old_file) == SCHEMA_VERSION
    with SqliteJournal.read(old_file) as journal:
        check(journal)


@pytest.mark.parametrize(
    "damage",
    [
        "UPDATE keyframe SET entries = 3 WHERE name = 'hidden 12'",
        "UPDATE program SET branch = 'other' WHERE id = 2",
        "CREATE VIEW more AS SELECT * FROM program",
    ],
)
def test_a_damaged_one_is_refused_and_left_alone(old_file, damage):
    with closing(sqlite3.connect(old_file)) as file, file:
        file.execute(damage)
    kept = shutil.copy(old_file, old_file.with_suffix(".kept"))
    for opened in (SqliteJournal.open, SqliteJournal.read):
        with pytest.raises(StoreError, match="restore it from a copy"):
            opened(old_file)
    assert version_of(old_file) == version_of(kept) == 2
