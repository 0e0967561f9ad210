"""Worlds lent to one nest after another, and a channel that stays in step."""

import pytest

import beliefnest as bn
from beliefnest.world.frames import Frame
from beliefnest.worlds.by_name import Worlds
from beliefnest.worlds.minecraft.embedded import EmbeddedWorld


def frames(scenario: bn.Scenario, worlds: Worlds | None = None) -> list[Frame]:
    with bn.Nest.open(scenario, worlds=worlds) as nest:
        nest.play()
        info = nest["/"].branches()[0]
        return list(nest.reader.entries(info.key, 0, info.entries))


def test_a_lent_world_gives_the_frames_of_a_fresh_one():
    last = bn.Scenario.load("sally-anne", condition=3)
    with Worlds(0) as worlds:
        frames(bn.Scenario.load("sally-anne", condition=1), worlds)
        assert frames(last, worlds) == frames(last)


def test_a_frame_that_is_refused_does_not_put_the_channel_out_of_step():
    setting = bn.Scenario.load("sally-anne", condition=1).setting

    def refuse(frame: Frame) -> None:
        raise OSError(f"no room for tick {frame.tick}")

    world = EmbeddedWorld(0).start()
    try:
        body = world.open_body("/", "seed", setting.snapshot, refuse)
        with pytest.raises(OSError, match="no room for tick"):
            body.run(setting.script[0].programs, 1200)
        assert body.snapshot().tick > setting.snapshot.tick
        body.close()
        body.close()
    finally:
        world.close()
