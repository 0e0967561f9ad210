"""Node launched ahead of a command serves its world, or is killed."""

import os
from contextlib import suppress
from pathlib import Path

import pytest

from beliefnest.cli.ahead import ahead
from beliefnest.errors import BodyError, InputError
from beliefnest.worlds.by_name import Worlds


def children():
    """Return the process ids of all children of this process that still run."""
    alive = set()
    for file in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            state, parent = file.read_text().rpartition(")")[2].split()[:2]
            if int(parent) == os.getpid() and state != "Z":
                alive.add(int(file.parent.name))
    return alive


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="needs /proc")
def test_a_launch_serves_one_world_or_is_killed():
    before = children()
    with ahead("embedded", 3) as launch:
        (pid,) = children() - before
        with Worlds(3, launch=launch) as worlds:
            world = worlds.lend("embedded")
            assert world.inner.pid == pid
            assert "node" in world.versions
            assert children() - before == {pid}
            with pytest.raises(BodyError, match="launch another one"):
                launch.take()
    assert children() == before
    with ahead("embedded", 3), suppress(KeyError):
        assert children() - before
        raise KeyError
    assert children() == before
    with ahead("scripted", 3) as none:
        assert none is None
        assert children() == before


def test_a_bad_seed_is_told_before_anything_starts():
    with pytest.raises(InputError, match="--seed is"), ahead("embedded", 2**63):
        pass
