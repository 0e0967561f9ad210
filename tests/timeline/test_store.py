"""Run files beyond the protocol of journals: owner, integrity, records."""

import os
import shutil
import sqlite3
import subprocess
import sys
import tempfile
from contextlib import closing
from pathlib import Path

import pytest
from msgspec.structs import replace
from tests.timeline.stored import LONG, MAIN, PLAN, PROGRAM, PROMPT, RUN, kept, verify

from beliefnest.errors import BranchError, InputError, StoreError
from beliefnest.timeline.chunks import CHUNK_ENTRIES
from beliefnest.timeline.journal import ForkPoint, TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.world.frames import Frame


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
    with Journal.open(run_file), pytest.raises(StoreError) as refusal:
        Journal.open(run_file)
    assert str(run_file) in str(refusal.value)
    assert f"process {os.getpid()}" in str(refusal.value)


def test_a_second_writer_in_another_process_is_refused(run_file):
    code = (
        "import sys; from beliefnest.errors import StoreError\n"
        "from beliefnest.timeline.chunks import CHUNK_ENTRIES\n"
        "from beliefnest.timeline.store import Journal\n"
        "try: Journal.open(sys.argv[1])\n"
        "except StoreError as refusal: print(refusal)"
    )
    with Journal.open(run_file):
        assert f"process {os.getpid()}" in run_python(code, run_file)
    assert run_python(code, run_file) == ""


def test_a_link_to_a_file_that_is_written_is_refused(run_file):
    link = run_file.with_name("link.bn")
    link.symlink_to(run_file)
    with Journal.open(run_file), pytest.raises(StoreError, match="one writer"):
        Journal.open(link)


def test_a_lock_file_left_behind_does_not_refuse(run_file):
    run_file.with_name("run.bn-lock").write_text("1")
    with Journal.open(run_file) as journal:
        journal.describe(MAIN, "mine")


def test_nothing_is_left_beside_a_closed_file(run_file):
    assert [path.name for path in run_file.parent.iterdir()] == ["run.bn"]


def test_readers_see_what_was_done_while_it_is_written(run_file):
    with (
        Journal.open(run_file) as journal,
        Journal.read(run_file) as one,
        Journal.read(run_file) as other,
    ):
        for tick in range(301, 700):
            journal.append(MAIN, [Frame(tick)], tick)
            assert one.info(MAIN).head == tick
        assert kept(one) == kept(other) == kept(journal)


def test_a_reader_changes_nothing(run_file):
    with Journal.read(run_file) as reader:
        for call in (
            lambda: reader.create(PLAN, None, 0),
            lambda: reader.append(MAIN, [], 400),
            lambda: reader.describe(MAIN, "x"),
            lambda: reader.records.set_run(RUN),
        ):
            with pytest.raises(StoreError, match="open for reading"):
                call()


def test_a_reader_of_a_timeline_deleted_meanwhile_is_told(run_file):
    with Journal.open(run_file) as journal, Journal.read(run_file) as reader:
        reading = reader.entries(MAIN, 0, 300)
        next(reading)
        journal.delete(MAIN)
        with pytest.raises(BranchError, match="no branch 'main'"):
            list(reading)


def test_a_closed_file_says_so(run_file):
    journal = Journal.open(run_file)
    journal.close()
    journal.close()
    with pytest.raises(StoreError, match="was closed"):
        journal.timelines()


# --- all or nothing


def test_calls_made_together_are_kept_together(run_file):
    with Journal.open(run_file) as journal:
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
    with Journal.open(run_file) as journal, journal.together():
        journal.append(MAIN, [Frame(301)], 301)
        with pytest.raises(BranchError), journal.together():
            journal.append(MAIN, [Frame(302)], 302)
            journal.info(PLAN)
        journal.append(MAIN, [], 305)
    with Journal.read(run_file) as reader:
        assert reader.info(MAIN).head == 305
        assert next(reader.entries(MAIN, reader.info(MAIN).entries - 1, 10**6)) == Frame(301)


@pytest.mark.parametrize("step", [1, 5, CHUNK_ENTRIES + 1])
def test_entries_are_packed_however_they_come(tmp_path, step):
    path = tmp_path / "run.bn"
    frames = [Frame(tick) for tick in range(1, 10 * CHUNK_ENTRIES + 4)]
    with Journal.create_file(path) as journal:
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
    with Journal.open(run_file) as journal:
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
from beliefnest.timeline.store import Journal
from beliefnest.world.frames import Frame
key = TimelineKey((), "main")
journal = Journal.open(sys.argv[1])
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
    with Journal.open(run_file) as journal:
        verify(journal)
        assert journal.info(MAIN).head == int(head) + 1


def test_a_full_database_is_told_and_nothing_is_kept(run_file):
    with closing(sqlite3.connect(run_file)) as other:
        pages = other.execute("PRAGMA page_count").fetchone()[0]
    other.close()
    with Journal.open(run_file) as journal:
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
from beliefnest.timeline.store import Journal
if os.getuid() == 0:
    os.setuid(65534)
with Journal.read(sys.argv[1]) as reader:
    print(len(reader.timelines()))
try:
    Journal.open(sys.argv[1])
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


def test_the_nearest_checkpoint_lies_at_or_before(run_file):
    with Journal.open(run_file) as journal:
        assert journal.nearest_checkpoint(MAIN, "facts", 300) is None
        for place in (0, 100, 200):
            journal.put_checkpoint(MAIN, "facts", place, b"%d" % place)
        for asked, place in ((0, 0), (99, 0), (100, 100), (199, 100), (10**6, 200)):
            assert journal.nearest_checkpoint(MAIN, "facts", asked) == (place, b"%d" % place)
        with pytest.raises(InputError, match="nothing can be stored after"):
            journal.put_checkpoint(MAIN, "facts", 10**6, b"")
        with pytest.raises(BranchError):
            journal.nearest_checkpoint(PLAN, "facts", 0)
        journal.delete(MAIN)
        journal.create(MAIN, None, 0)
        assert journal.nearest_checkpoint(MAIN, "facts", 0) is None


def test_records_are_there_after_opening_again(run_file):
    with Journal.open(run_file) as journal:
        with pytest.raises(StoreError, match="has no record of what was run"):
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
    with Journal.read(run_file) as reader:
        records = reader.records
        assert records.run() == RUN
        assert records.programs() == (PROGRAM, LONG)
        assert records.prompts() == (PROMPT,)
        assert records.selected() == {(): "main", ("sally",): "plan"}
        assert records.state("random") == b"\0\1"
        assert records.state("other") is None


def test_records_follow_their_branch(run_file):
    with Journal.open(run_file) as journal:
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
        verify(journal)
        journal.delete(TimelineKey(("sally",), "try"))
        assert [p.path for p in records.programs()] == [("anne",)]
        journal.delete(MAIN)
        assert records.next_group() == 3
        assert records.prompts() == ()
        assert records.selected() == {}


def files_beside(path):
    return {each.name for each in path.parent.iterdir()} - {path.name, f"{path.name}-lock"}


def test_a_reader_that_closes_takes_nothing_from_a_writer(run_file):
    with Journal.open(run_file) as writer:
        Journal.read(run_file).close()
        writer.create(PLAN, None, 0)
        Journal.read(run_file).close()
        with Journal.read(run_file) as reader:
            assert PLAN in [info.key for info in reader.timelines()]
    assert files_beside(run_file) == set()
