"""One process at a time uses a folder of results; the others are told by whom and since when."""

import errno
import os
import re
import subprocess
import sys

import pytest
from tests.processes import started

from beliefnest import locking
from beliefnest.errors import InputError
from beliefnest.locking import LockHeldError, ProcessLock, holding, is_lock

OTHER = """
import sys
from pathlib import Path
from beliefnest.locking import holding
with holding(Path(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.read()
"""


@pytest.fixture(params=["flock", "no flock"])
def kind(request, monkeypatch):
    if request.param == "no flock":

        def missing(*args, **kwargs):
            raise OSError(errno.ENOSYS, os.strerror(errno.ENOSYS))

        monkeypatch.setattr(locking, "lock_descriptor", missing)
    return request.param


@pytest.fixture
def other(tmp_path):
    command = [sys.executable, "-c", OTHER, str(tmp_path)]
    with started(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdout.readline() == "held\n"
        yield process


def test_a_folder_in_use_is_refused_with_its_holder(tmp_path, other):
    expected = rf"{re.escape(str(tmp_path))} is in use by process {other.pid} of \S+ since \d{{4}}-"
    with pytest.raises(InputError, match=expected), holding(tmp_path):
        pass


def test_a_killed_holder_holds_nothing(tmp_path, other):
    other.kill()
    other.wait()
    with holding(tmp_path):
        assert any(map(is_lock, tmp_path.iterdir()))


def test_a_lock_is_for_one_and_leaves_nothing(tmp_path, kind):
    path = tmp_path / "lock"
    lock = ProcessLock.acquire(path)
    with pytest.raises(LockHeldError, match=rf"process {os.getpid()} of "):
        ProcessLock.acquire(path)
    lock.release()
    lock.release()
    assert list(tmp_path.iterdir()) == []
    ProcessLock.acquire(path).release()


def test_a_folder_without_locks_of_files_is_held_all_the_same(tmp_path, kind):
    with holding(tmp_path):
        assert all(map(is_lock, tmp_path.iterdir()))
        with pytest.raises(InputError, match="in use"), holding(tmp_path):
            pass
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "taken" / ".in-use").mkdir(parents=True)
    with pytest.raises(InputError, match="taken cannot be written"), holding(tmp_path / "taken"):
        pass
