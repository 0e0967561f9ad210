"""Node that ends while it starts is told about by the world that takes it."""

import pytest

from beliefnest.errors import BodyError
from beliefnest.worlds.minecraft.embedded import EmbeddedWorld
from beliefnest.worlds.minecraft.launching import Launch
from beliefnest.worlds.process_limits import ProcessLimits


def test_a_launch_that_fails_says_so_when_it_is_taken():
    launch = Launch.begin(0, ProcessLimits(), unknown="argument")
    launch._channel.kill()
    world = EmbeddedWorld(0, launch=launch)
    with pytest.raises(BodyError, match="Node cannot be started; run `beliefnest doctor`"):
        _ = world.pid
    world.close()
