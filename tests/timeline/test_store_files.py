"""Recognition of run files, and of damage in them."""

import math
import os
import shutil
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest
from tests.profiles import at_night
from tests.timeline.stored import MAIN, PLAN, PROGRAM, PROMPT, RUN, kept, snapshot, verify

from beliefnest.errors import StoreError
from beliefnest.timeline.codec import encode_snapshot
from beliefnest.timeline.journal import ForkPoint
from beliefnest.timeline.store import Journal
from beliefnest.timeline.store_schema import APPLICATION_ID, SCHEMA_VERSION
from beliefnest.world.frames import Frame
from beliefnest.world.values import AgentState

# --- recognising files


def test_there_is_no_file(tmp_path):
    for opened in (Journal.open, Journal.read):
        with pytest.raises(StoreError, match=r"no run file .*none\.bn"):
            opened(tmp_path / "none.bn")
    assert list(tmp_path.iterdir()) == []


def test_a_file_is_not_begun_over_another(run_file):
    before = run_file.read_bytes()
    with pytest.raises(StoreError, match="exists"):
        Journal.create_file(run_file)
    assert run_file.read_bytes() == before


def test_a_file_in_no_folder_is_refused(tmp_path):
    with pytest.raises(StoreError, match="folder"):
        Journal.create_file(tmp_path / "no" / "run.bn")


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
    for opened in (Journal.open, Journal.read):
        with pytest.raises(StoreError, match=told) as fault:
            opened(path)
        assert str(path) in str(fault.value)
    assert path.read_bytes() == content
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_is_no_run(tmp_path):
    with pytest.raises(StoreError, match="cannot be read"):
        Journal.read(tmp_path)


def test_another_programs_database_is_named_and_left_alone(tmp_path):
    path = tmp_path / "places.sqlite"
    with closing(sqlite3.connect(path)) as other, other:
        other.execute("CREATE TABLE bookmarks (id)")
    other.close()
    before = path.read_bytes()
    for opened in (Journal.open, Journal.read):
        with pytest.raises(StoreError, match=r"another program.*bookmarks"):
            opened(path)
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    ("version", "advice"),
    [(SCHEMA_VERSION + 1, "use a newer version"), (SCHEMA_VERSION - 1, "play the run again")],
)
def test_another_format_is_refused_and_left_alone(run_file, version, advice):
    with closing(sqlite3.connect(run_file)) as other, other:
        other.execute(f"PRAGMA user_version = {version}")
    other.close()
    before = run_file.read_bytes()
    for opened in (Journal.open, Journal.read):
        with pytest.raises(StoreError, match=f"format {version}, .*{advice}"):
            opened(run_file)
    assert run_file.read_bytes() == before


def test_a_run_is_marked_as_one(run_file):
    assert int.from_bytes(run_file.read_bytes()[68:72], "big") == APPLICATION_ID


# --- damage


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """Write a full run file; return it and all its contents."""
    path = tmp_path_factory.mktemp("sound") / "run.bn"
    with Journal.create_file(path) as journal:
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
    with Journal.read(path) as reader:
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
    refused, tried = 0, at_night(400, 50)
    for position in range(0, len(data), len(data) // tried or 1):
        damaged = bytearray(data)
        damaged[position] ^= 1 << position % 8
        path.write_bytes(damaged)
        try:
            assert everything(path) == whole, f"byte {position}"
        except StoreError:
            refused += 1
    assert refused > tried // 4


@pytest.mark.parametrize("part", [0.1, 0.3, 0.5, 0.7, 0.9, 0.99])
def test_a_truncated_file_is_refused(sound, tmp_path, part):
    data = sound.read_bytes()
    path = tmp_path / "run.bn"
    path.write_bytes(data[: int(len(data) * part)])
    with pytest.raises(StoreError, match=r"run\.bn"):
        everything(path)
    with pytest.raises(StoreError, match=r"run\.bn"), Journal.open(path) as journal:
        verify(journal)


def test_a_missing_end_is_noticed_where_nothing_lay(run_file):
    with Journal.open(run_file) as journal:
        journal.create(PLAN, None, 0)
        journal.append(PLAN, [Frame(1, blocks={(x, 0, 0): x for x in range(10_000)})], 1)
        journal.delete(PLAN)
    os.truncate(run_file, run_file.stat().st_size - 4096)
    for opened in (Journal.open, Journal.read):
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
    with pytest.raises(StoreError, match="damaged"), Journal.open(path) as journal:
        verify(journal)
    with Journal.open(sound) as journal:
        verify(journal)


# --- checkpoints and records


def files_beside(path):
    return {each.name for each in path.parent.iterdir()} - {path.name, f"{path.name}-lock"}


def test_whoever_looked_leaves_a_whole_file(sound):
    with Journal.read(sound) as one:
        with Journal.read(sound) as other:
            assert kept(other) == kept(one)
        before = kept(one)
        with Journal.open(sound):
            pass
        assert kept(one) == before
    assert files_beside(sound) == set()
