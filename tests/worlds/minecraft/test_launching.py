"""Node launched ahead of a command serves its world, or is killed."""

from contextlib import suppress
from pathlib import Path

import pytest
from tests.children import children

from beliefnest.errors import BodyError, InputError
from beliefnest.worlds.by_name import Worlds
from beliefnest.worlds.minecraft.embedded import EmbeddedWorld
from beliefnest.worlds.minecraft.launching import Launch, ahead
from beliefnest.worlds.process_limits import ProcessLimits


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="needs /proc")
def test_a_launch_serves_one_world_or_is_killed():
    before = children()
    with ahead("embedded", 3) as launch:
        (pid,) = children() - before
        with Worlds(3, begun=launch.worlds(3)) as worlds:
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
    with pytest.raises(InputError, match="seed is"), ahead("embedded", 2**63):
        pass


def test_a_launch_that_fails_says_so_when_it_is_taken():
    launch = Launch.begin(0, ProcessLimits(), unknown="argument")
    launch._channel.kill()
    world = EmbeddedWorld(0, launch=launch)
    with pytest.raises(BodyError, match="Node cannot be started; run `beliefnest doctor`"):
        _ = world.pid
    world.close()
