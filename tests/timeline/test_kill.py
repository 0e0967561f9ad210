"""Run files of a writing process: while it writes, and when it is killed."""

import random
import runpy
import signal
import subprocess
import sys
from contextlib import contextmanager
from itertools import islice
from pathlib import Path

import pytest
from tests.profiles import at_night, few_by_day
from tests.timeline.stored import verify

from beliefnest.timeline.store import Journal

WRITER = Path(__file__).with_name("killed_writer.py")
KILLS = at_night(200, 10)
LONGEST = 1000
"""Calls after which a writer is killed at the latest, while it still writes."""


def kept(journal):
    """All a journal holds."""
    return [
        (info, list(journal.entries(info.key, 0, info.entries))) for info in journal.timelines()
    ]


def expected(seed, calls):
    """All a journal holds after a number of the writer's calls, and after one more."""
    model = Journal()
    going = runpy.run_path(str(WRITER))["calls"](model, seed)
    assert sum(1 for _ in islice(going, calls)) == calls
    before = kept(model)
    next(going, None)
    return before, kept(model)


@contextmanager
def writing(path, seed):
    """Yield a process that writes; kill it in the end."""
    with subprocess.Popen(
        [sys.executable, str(WRITER), str(path), str(seed)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    ) as writer:
        try:
            yield writer
        finally:
            writer.kill()


def kill_after(path, seed, calls):
    """Let a writer make at least that many calls, kill it; how many returned."""
    with writing(path, seed) as writer:
        told = writer.stdout.read(calls)
        writer.send_signal(signal.SIGKILL)
        told += writer.stdout.read()
    assert writer.returncode == -signal.SIGKILL
    return len(told)


@pytest.mark.parametrize("seed", few_by_day(range(KILLS), 4))
def test_a_killed_writer_leaves_what_it_was_told_was_kept(tmp_path, seed):
    path = tmp_path / "run.bn"
    calls = kill_after(path, seed, random.Random(seed).randrange(1, LONGEST))
    before, after = expected(seed, calls)
    with Journal.read(path) as reader:
        assert kept(reader) in (before, after)
    with Journal.open(path) as journal:
        assert kept(journal) in (before, after)
        verify(journal)


def check_ends(reader):
    """Check the last entries of every timeline against what is told of it."""
    for info in reader.timelines():
        first = max(0, info.entries - 20)
        ticks = [entry.tick for entry in reader.entries(info.key, first, info.entries)]
        assert len(ticks) == info.entries - first
        assert ticks == sorted(ticks)
        assert all(tick <= info.head for tick in ticks)
        assert reader.entries_until(info.key, info.head) == info.entries


def test_a_reader_sees_whole_calls_while_another_process_writes(tmp_path):
    path = tmp_path / "run.bn"
    with writing(path, seed=0) as writer:
        writer.stdout.read(1)
        with Journal.read(path) as reader:
            for _ in range(30):
                writer.stdout.read(10)
                with reader.unchanging():
                    check_ends(reader)


def test_opening_to_read_never_meets_a_half_written_file(tmp_path):
    path = tmp_path / "run.bn"
    with writing(path, seed=1) as writer:
        for _ in range(60):
            writer.stdout.read(10)
            with Journal.read(path) as reader:
                assert reader.timelines()
