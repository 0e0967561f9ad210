"""What a run file is besides a journal: whose, how sound, with what in it."""

import math
import os
import shutil
import sqlite3
import subprocess
import sys
import tempfile
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from beliefnest.errors import BranchError, InputError, StoreError
from beliefnest.timeline.chunks import CHUNK_ENTRIES
from beliefnest.timeline.codec import encode_snapshot
from beliefnest.timeline.journal import ForkPoint, TimelineKey
from beliefnest.timeline.records import ProgramRecord, PromptRecord, RunRecord
from beliefnest.timeline.schema import APPLICATION_ID, SCHEMA_VERSION
from beliefnest.timeline.store import SqliteJournal
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.values import AgentState, Box

MAIN = TimelineKey((), "main")
PLAN = TimelineKey(("sally",), "plan")
RUN = RunRecord("sally-anne", "box: …\n", "3", 7, {"minecraft": "1.20.4"}, b"\0setting")
PROGRAM = ProgramRecord(("sally",), "plan", "sally", "await x()", 12, False, "line 1: no x", 3)
LONG = replace(
    PROGRAM, ok=True, error=None, lines=(1, 3), log=("a", "é"), unfinished=("waitTicks of line 3",)
)
PROMPT = PromptRecord(
    ("sally", "anne"),
    PLAN,
    12,
    "offline",
    1,
    (("system", "You are …"), ("user", "Get a diamond.")),
    {"temperature": 0.5, "seed": None},
    "await x()",
    None,
)


def kept(journal):
    return [
        (info, list(journal.entries(info.key, 0, info.entries))) for info in journal.timelines()
    ]


def snapshot(tick):
    grid = np.arange(24, dtype=np.int32).reshape(2, 3, 4) + tick
    sally = AgentState((0.1, 1.0, 2.0))
    return Snapshot(
        tick, Box((0, 0, 0), (1, 2, 3)), grid, {(0, 0, 0): {"egg": 1}}, {"sally": sally}
    )


def run_python(code, *arguments):
    """Run a piece of Python in a process of its own; what it printed."""
    done = subprocess.run(
        [sys.executable, "-c", code, *map(str, arguments)],
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout


# --- one writer, many readers


def test_a_second_writer_is_refused_by_file_and_process(run_file):
    with SqliteJournal.open(run_file), pytest.raises(StoreError) as refusal:
        SqliteJournal.open(run_file)
    assert str(run_file) in str(refusal.value)
    assert f"process {os.getpid()}" in str(refusal.value)


def test_a_second_writer_in_another_process_is_refused(run_file):
    code = (
        "import sys; from beliefnest.errors import StoreError\n"
        "from beliefnest.timeline.chunks import CHUNK_ENTRIES\n"
        "from beliefnest.timeline.store import SqliteJournal\n"
        "try: SqliteJournal.open(sys.argv[1])\n"
        "except StoreError as refusal: print(refusal)"
    )
    with SqliteJournal.open(run_file):
        assert f"process {os.getpid()}" in run_python(code, run_file)
    assert run_python(code, run_file) == ""


def test_a_link_to_a_file_that_is_written_is_refused(run_file):
    link = run_file.with_name("link.bn")
    link.symlink_to(run_file)
    with SqliteJournal.open(run_file), pytest.raises(StoreError, match="one writer"):
        SqliteJournal.open(link)


def test_a_lock_file_left_behind_does_not_refuse(run_file):
    run_file.with_name("run.bn-lock").write_text("1")
    with SqliteJournal.open(run_file) as journal:
        journal.describe(MAIN, "mine")


def test_nothing_is_left_beside_a_closed_file(run_file):
    assert [path.name for path in run_file.parent.iterdir()] == ["run.bn"]


def test_readers_see_what_was_done_while_it_is_written(run_file):
    with (
        SqliteJournal.open(run_file) as journal,
        SqliteJournal.read(run_file) as one,
        SqliteJournal.read(run_file) as other,
    ):
        for tick in range(301, 700):
            journal.append(MAIN, [Frame(tick)], tick)
            assert one.info(MAIN).head == tick
        assert kept(one) == kept(other) == kept(journal)


def test_a_reader_changes_nothing(run_file):
    with SqliteJournal.read(run_file) as reader:
        for call in (
            lambda: reader.create(PLAN, None, 0),
            lambda: reader.append(MAIN, [], 400),
            lambda: reader.describe(MAIN, "x"),
            lambda: reader.records.set_run(RUN),
        ):
            with pytest.raises(StoreError, match="open for reading"):
                call()


def test_a_reader_of_a_timeline_deleted_meanwhile_is_told(run_file):
    with SqliteJournal.open(run_file) as journal, SqliteJournal.read(run_file) as reader:
        reading = reader.entries(MAIN, 0, 300)
        next(reading)
        journal.delete(MAIN)
        with pytest.raises(BranchError, match="no branch 'main'"):
            list(reading)


def test_a_closed_file_says_so(run_file):
    journal = SqliteJournal.open(run_file)
    journal.close()
    journal.close()
    with pytest.raises(StoreError, match="was closed"):
        journal.timelines()


# --- all or nothing


def test_calls_made_together_are_kept_together(run_file):
    with SqliteJournal.open(run_file) as journal:
        before = kept(journal)
        with pytest.raises(BranchError), journal.together():
            journal.append(MAIN, [Frame(301)], 301)
            journal.records.put_state("random", b"1")
            journal.create(PLAN, ForkPoint(MAIN, 5, 5), 5)
            journal.create(PLAN, None, 5)
        assert kept(journal) == before
        assert journal.records.state("random") is None
        with journal.together():
            journal.append(MAIN, [Frame(301)], 301)
            with pytest.raises(BranchError):
                journal.create(MAIN, None, 0)
            journal.records.put_state("random", b"2")
        assert journal.info(MAIN).head == 301
        assert journal.records.state("random") == b"2"


def test_an_inner_part_that_fails_leaves_the_rest(run_file):
    with SqliteJournal.open(run_file) as journal, journal.together():
        journal.append(MAIN, [Frame(301)], 301)
        with pytest.raises(BranchError), journal.together():
            journal.append(MAIN, [Frame(302)], 302)
            journal.info(PLAN)
        journal.append(MAIN, [], 305)
    with SqliteJournal.read(run_file) as reader:
        assert reader.info(MAIN).head == 305
        assert next(reader.entries(MAIN, reader.info(MAIN).entries - 1, 10**6)) == Frame(301)


@pytest.mark.parametrize("step", [1, 5, CHUNK_ENTRIES + 1])
def test_entries_are_packed_however_they_come(tmp_path, step):
    path = tmp_path / "run.bn"
    frames = [Frame(tick) for tick in range(1, 10 * CHUNK_ENTRIES + 4)]
    with SqliteJournal.create_file(path) as journal:
        journal.create(MAIN, None, 0)
        for at in range(0, len(frames), step):
            part = frames[at : at + step]
            journal.append(MAIN, part, part[-1].tick)
    with closing(sqlite3.connect(path)) as other:
        packed = other.execute("SELECT count FROM piece WHERE compressed").fetchall()
        loose = other.execute("SELECT sum(count) FROM piece WHERE NOT compressed").fetchone()
    other.close()
    assert packed == [(CHUNK_ENTRIES,)] * 10
    assert loose == (3,)


def test_what_cannot_be_stored_is_refused_whole(run_file):
    with SqliteJournal.open(run_file) as journal:
        before = kept(journal)
        with pytest.raises(StoreError, match="object"):
            journal.append(MAIN, [Frame(301), Frame(302, blocks={(0, 0, 0): object()})], 302)
        with pytest.raises(StoreError):
            journal.append(MAIN, [], 2**70)
        assert kept(journal) == before


FILL = """
import resource, sys
from beliefnest.errors import StoreError
from beliefnest.timeline.journal import TimelineKey
from beliefnest.timeline.chunks import CHUNK_ENTRIES
from beliefnest.timeline.store import SqliteJournal
from beliefnest.world.frames import Frame
key = TimelineKey((), "main")
journal = SqliteJournal.open(sys.argv[1])
head = journal.info(key).head
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]), resource.RLIM_INFINITY))
import random
chance = random.Random(0)
def frame(tick):
    return Frame(tick, blocks={(chance.randrange(10**6), 0, 0): 1 for _ in range(500)})
try:
    for _ in range(500):
        ticks = range(head + 1, head + 21)
        journal.append(key, [frame(tick) for tick in ticks], ticks[-1])
        head = ticks[-1]
except StoreError as fault:
    assert journal.info(key).head == head
    resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY,) * 2)
    journal.append(key, [], head + 1)
    print(head, fault)
"""


def test_a_file_that_cannot_grow_keeps_what_was_acknowledged(run_file):
    told = run_python(FILL, run_file, 2_000_000)
    head, fault = told.split(" ", 1)
    assert int(head) > 300
    assert str(run_file) in fault
    assert "nothing of this call was kept" in fault
    with SqliteJournal.open(run_file) as journal:
        journal.verify()
        assert journal.info(MAIN).head == int(head) + 1


def test_a_full_database_is_told_and_nothing_is_kept(run_file):
    with closing(sqlite3.connect(run_file)) as other:
        pages = other.execute("PRAGMA page_count").fetchone()[0]
    other.close()
    with SqliteJournal.open(run_file) as journal:
        journal._database.execute(f"PRAGMA max_page_count = {pages + 5}")
        before = kept(journal)
        big = Frame(301, blocks={(x, 0, 0): x for x in range(10_000)})
        with pytest.raises(StoreError, match="the disk is full"):
            journal.append(MAIN, [big], 301)
        assert kept(journal) == before
        journal.append(MAIN, [], 302)
        assert journal.info(MAIN).head == 302


UNPRIVILEGED = """
import os, sys, urllib.parse  # loaded while it can be read
from beliefnest.errors import StoreError
from beliefnest.timeline.chunks import CHUNK_ENTRIES
from beliefnest.timeline.store import SqliteJournal
if os.getuid() == 0:
    os.setuid(65534)
with SqliteJournal.read(sys.argv[1]) as reader:
    print(len(reader.timelines()))
try:
    SqliteJournal.open(sys.argv[1])
except StoreError as fault:
    print(fault)
"""


@pytest.mark.parametrize("folder_mode", [0o555, 0o777])
def test_a_read_only_file_is_read_and_not_written(run_file, folder_mode):
    with tempfile.TemporaryDirectory(dir="/tmp") as folder:
        path = Path(shutil.copy(run_file, folder))
        path.chmod(0o444)
        path.parent.chmod(folder_mode)
        told = run_python(UNPRIVILEGED, path).splitlines()
        path.parent.chmod(0o777)
    assert told[0] == "1"
    assert str(path) in told[1]
    assert "writable" in told[1]


# --- recognising files


def test_there_is_no_file(tmp_path):
    for opened in (SqliteJournal.open, SqliteJournal.read):
        with pytest.raises(StoreError, match=r"no run file .*none\.bn"):
            opened(tmp_path / "none.bn")
    assert list(tmp_path.iterdir()) == []


def test_a_file_is_not_begun_over_another(run_file):
    before = run_file.read_bytes()
    with pytest.raises(StoreError, match="exists"):
        SqliteJournal.create_file(run_file)
    assert run_file.read_bytes() == before


def test_a_file_in_no_folder_is_refused(tmp_path):
    with pytest.raises(StoreError, match="folder"):
        SqliteJournal.create_file(tmp_path / "no" / "run.bn")


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"", "an empty file"),
        (b'{"scenario": 1}', "JSON"),
        (b"PK\x03\x04....", "zip"),
        (b"\x1f\x8b....", "gzip"),
        (b"PAR1....", "Parquet"),
        (b"hello, world", "hello"),
        (b"SQLite format 3\0" + b"\xff" * 200, "damaged"),
    ],
)
def test_foreign_files_are_named(tmp_path, content, told):
    path = tmp_path / "run.bn"
    path.write_bytes(content)
    for opened in (SqliteJournal.open, SqliteJournal.read):
        with pytest.raises(StoreError, match=told) as fault:
            opened(path)
        assert str(path) in str(fault.value)
    assert path.read_bytes() == content
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_is_no_run(tmp_path):
    with pytest.raises(StoreError, match="cannot be read"):
        SqliteJournal.read(tmp_path)


def test_another_programs_database_is_named_and_left_alone(tmp_path):
    path = tmp_path / "places.sqlite"
    with closing(sqlite3.connect(path)) as other, other:
        other.execute("CREATE TABLE bookmarks (id)")
    other.close()
    before = path.read_bytes()
    for opened in (SqliteJournal.open, SqliteJournal.read):
        with pytest.raises(StoreError, match=r"another program.*bookmarks"):
            opened(path)
    assert path.read_bytes() == before


def test_a_newer_format_is_refused_and_left_alone(run_file):
    with closing(sqlite3.connect(run_file)) as other, other:
        other.execute(f"PRAGMA user_version = {SCHEMA_VERSION + 1}")
    other.close()
    before = run_file.read_bytes()
    for opened in (SqliteJournal.open, SqliteJournal.read):
        with pytest.raises(StoreError, match=rf"format {SCHEMA_VERSION + 1} .*a newer version"):
            opened(run_file)
    assert run_file.read_bytes() == before


def test_a_run_is_marked_as_one(run_file):
    assert int.from_bytes(run_file.read_bytes()[68:72], "big") == APPLICATION_ID


# --- damage


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """A full run file, and all that is in it."""
    path = tmp_path_factory.mktemp("sound") / "run.bn"
    with SqliteJournal.create_file(path) as journal:
        journal.create(MAIN, None, 0)
        frames = [
            Frame(tick, {"sally": AgentState((math.sin(tick), math.cos(tick), 1 / tick))})
            for tick in range(1, 2000)
        ]
        journal.append(MAIN, frames[:-50], 1949)
        for frame in frames[-50:]:
            journal.append(MAIN, [frame], frame.tick)
        journal.create(PLAN, ForkPoint(MAIN, 5, 5), 5)
        journal.put_checkpoint(MAIN, "facts", 0, encode_snapshot(snapshot(0)))
        journal.records.set_run(RUN)
        journal.records.add_program(PROGRAM)
        journal.records.add_prompt(PROMPT)
        journal.records.select(("sally",), "plan")
    with closing(sqlite3.connect(path)) as other, other:
        other.execute("VACUUM")
    other.close()
    return path


def everything(path):
    """All a run file holds, read as a user would."""
    with SqliteJournal.read(path) as reader:
        nearest = reader.nearest_checkpoint(MAIN, "facts", 99)
        if nearest is None:
            raise StoreError("there is no checkpoint")
        place, checkpoint = nearest
        records = reader.records
        return (
            kept(reader),
            place,
            checkpoint,
            records.run(),
            records.programs(),
            records.prompts(),
            records.selected(),
        )


def test_flipped_bits_are_never_read_as_facts(sound, tmp_path):
    whole = everything(sound)
    data = bytearray(sound.read_bytes())
    path = tmp_path / "run.bn"
    refused = 0
    for position in range(0, len(data), len(data) // 400 or 1):
        damaged = bytearray(data)
        damaged[position] ^= 1 << position % 8
        path.write_bytes(damaged)
        try:
            assert everything(path) == whole, f"byte {position}"
        except StoreError:
            refused += 1
    assert refused > 100


@pytest.mark.parametrize("part", [0.1, 0.3, 0.5, 0.7, 0.9, 0.99])
def test_a_truncated_file_is_refused(sound, tmp_path, part):
    data = sound.read_bytes()
    path = tmp_path / "run.bn"
    path.write_bytes(data[: int(len(data) * part)])
    with pytest.raises(StoreError, match=r"run\.bn"):
        everything(path)
    with pytest.raises(StoreError, match=r"run\.bn"), SqliteJournal.open(path) as journal:
        journal.verify()


def test_a_missing_end_is_noticed_where_nothing_lay(run_file):
    with SqliteJournal.open(run_file) as journal:
        journal.create(PLAN, None, 0)
        journal.append(PLAN, [Frame(1, blocks={(x, 0, 0): x for x in range(10_000)})], 1)
        journal.delete(PLAN)
    os.truncate(run_file, run_file.stat().st_size - 4096)
    for opened in (SqliteJournal.open, SqliteJournal.read):
        with pytest.raises(StoreError, match="its end is missing"):
            opened(run_file)


@pytest.mark.parametrize(
    "harm",
    [
        "UPDATE piece SET body = zeroblob(length(body)) WHERE first = 0",
        "UPDATE piece SET body = substr(body, 1, 50) WHERE first = 0",
        "UPDATE piece SET first = 1 WHERE first = 0",
        "UPDATE piece SET last_tick = last_tick + 1 WHERE first = 0",
        "UPDATE timeline SET entries = entries + 1",
        "UPDATE timeline SET description = 'x'",
        "DELETE FROM timeline WHERE branch = 'main'",
        "DELETE FROM piece",
        "UPDATE keyframe SET entries = 3",
        "UPDATE meta SET value = x'00'",
        "UPDATE program SET branch = 'main'",
        "UPDATE prompt SET body = x'00'",
        "UPDATE selected SET branch = 'main'",
    ],
)
def test_rows_that_were_tampered_with_are_found(sound, tmp_path, harm):
    path = Path(shutil.copy(sound, tmp_path))
    with closing(sqlite3.connect(path)) as other, other:
        other.execute(harm)
    other.close()
    with pytest.raises(StoreError, match="damaged"), SqliteJournal.open(path) as journal:
        journal.verify()
    with SqliteJournal.open(sound) as journal:
        journal.verify()


# --- checkpoints and records


def test_the_nearest_checkpoint_lies_at_or_before(run_file):
    with SqliteJournal.open(run_file) as journal:
        assert journal.nearest_checkpoint(MAIN, "facts", 300) is None
        for place in (0, 100, 200):
            journal.put_checkpoint(MAIN, "facts", place, b"%d" % place)
        for asked, place in ((0, 0), (99, 0), (100, 100), (199, 100), (10**6, 200)):
            assert journal.nearest_checkpoint(MAIN, "facts", asked) == (place, b"%d" % place)
        with pytest.raises(InputError, match="no checkpoint"):
            journal.put_checkpoint(MAIN, "facts", 10**6, b"")
        with pytest.raises(BranchError):
            journal.nearest_checkpoint(PLAN, "facts", 0)
        journal.delete(MAIN)
        journal.create(MAIN, None, 0)
        assert journal.nearest_checkpoint(MAIN, "facts", 0) is None


def test_records_are_there_after_opening_again(run_file):
    with SqliteJournal.open(run_file) as journal:
        with pytest.raises(StoreError, match="does not say what was run"):
            journal.records.run()
        records = journal.records
        records.set_run(RUN)
        records.add_program(PROGRAM)
        records.add_program(LONG)
        records.add_prompt(PROMPT)
        records.select(("sally",), "x")
        records.select(("sally",), "plan")
        records.select((), "main")
        records.put_state("random", b"\0\1")
    with SqliteJournal.read(run_file) as reader:
        records = reader.records
        assert records.run() == RUN
        assert records.programs() == (PROGRAM, LONG)
        assert records.prompts() == (PROMPT,)
        assert records.selected() == {(): "main", ("sally",): "plan"}
        assert records.state("random") == b"\0\1"
        assert records.state("other") is None


def test_records_follow_their_branch(run_file):
    with SqliteJournal.open(run_file) as journal:
        records = journal.records
        journal.create(PLAN, None, 0)
        assert records.next_group() == 1
        records.add_program(PROGRAM)
        records.add_prompt(PROMPT)
        records.add_program(replace(PROGRAM, path=("anne",)))
        assert records.next_group() == 3
        records.select(("sally",), "plan")
        journal.rename(PLAN, "try")
        assert [p.branch for p in records.programs()] == ["try", "plan"]
        assert [p.timeline.branch for p in records.prompts()] == ["try"]
        assert [p.branch for p in records.prompts()] == ["follow"]
        assert records.selected() == {("sally",): "try"}
        journal.verify()
        journal.delete(TimelineKey(("sally",), "try"))
        assert [p.path for p in records.programs()] == [("anne",)]
        journal.delete(MAIN)
        assert records.next_group() == 3
        assert records.prompts() == ()
        assert records.selected() == {}


def files_beside(path):
    return {each.name for each in path.parent.iterdir()} - {path.name, f"{path.name}-lock"}


def test_whoever_looked_leaves_a_whole_file(sound):
    with SqliteJournal.read(sound) as one:
        with SqliteJournal.read(sound) as other:
            assert kept(other) == kept(one)
        before = kept(one)
        with SqliteJournal.open(sound):
            pass
        assert kept(one) == before
    assert files_beside(sound) == set()


def test_a_reader_that_closes_takes_nothing_from_a_writer(run_file):
    with SqliteJournal.open(run_file) as writer:
        SqliteJournal.read(run_file).close()
        writer.create(PLAN, None, 0)
        SqliteJournal.read(run_file).close()
        with SqliteJournal.read(run_file) as reader:
            assert PLAN in [info.key for info in reader.timelines()]
    assert files_beside(run_file) == set()
