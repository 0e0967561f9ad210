"""Settings of nests as bytes."""

import msgspec
import numpy as np
import pytest

import beliefnest as bn
from beliefnest.errors import StoreError
from beliefnest.nest.past.setting import Setting, Step
from beliefnest.nest.past.setting_codec import decode_start, encode_start
from beliefnest.scenarios.scenario import Scenario
from beliefnest.world import terrain
from beliefnest.worlds.scripted.world import ScriptedWorld


def parts(setting):
    """All of a setting as values that compare."""
    snapshot = setting.snapshot
    return (
        setting.name,
        (snapshot.tick, snapshot.box, snapshot.containers, snapshot.agents, snapshot.items),
        setting.perception,
        setting.static_blocks,
        setting.initial_beliefs,
        setting.script,
    )


def check_kept(setting, world="scripted"):
    kept, name = decode_start(encode_start(setting, world))
    assert name == world
    assert parts(kept) == parts(setting)
    assert np.array_equal(kept.snapshot.blocks, setting.snapshot.blocks)


def setting(**changes):
    world = ScriptedWorld(
        ((-1, -5, 0), (3, 2, 4)),
        {(0, -5, 0): "oak_stairs[facing=east]"},
        {"ann": (0.1 + 0.2, -4.0, 1.5), "bob": (3.5, -4.0, 1.5)},
        {"ann": {"diamond": 3}},
        {(2, -4, 2): {"bread": 1}},
        tick=7,
    )
    return Setting("small", world.snapshot(), **changes)


@pytest.mark.parametrize("name", ["sally-anne", "ice-cream-van"])
def test_built_in_scenarios_are_kept(name):
    for scenario in Scenario.load_all(name):
        check_kept(scenario.setting, "embedded")


@pytest.mark.parametrize("hearing", ["global", "sight", {"radius": 3.5}])
def test_options_of_perception_are_kept(hearing):
    check_kept(
        setting(
            perception=bn.Perception(
                None, 90, hearing, "transparent", ["oak_leaves", "glass"], negative_evidence=True
            )
        )
    )


def test_priors_and_scripts_are_kept():
    prior = bn.InitialBelief(
        ("ann", "bob"),
        {(2, -4, 2): ({"bread": 2}, False)},
        {(0, -5, 0): -1},
        {"ann": (0.5, 1.5, 2.5)},
    )
    step = Step({"ann": "bot.chat('ü')"}, "says", "file.yaml:3", 50)
    check_kept(
        setting(static_blocks=frozenset({"stone"}), initial_beliefs=(prior,), script=(step,))
    )


def test_another_form_is_refused():
    fields = msgspec.msgpack.decode(encode_start(setting(), "scripted"), strict=False)
    with pytest.raises(StoreError, match="form 3"):
        decode_start(msgspec.msgpack.encode({**fields, "form": 3}))
    with pytest.raises(StoreError):
        decode_start(b"no setting")


def test_only_boxes_in_chunks_have_a_form_that_older_versions_refuse(monkeypatch):
    def form(one):
        return msgspec.msgpack.decode(encode_start(one, "scripted"), strict=False)["form"]

    assert form(setting()) == 1
    monkeypatch.setattr(terrain, "DENSE", 0)
    one = setting()
    assert form(one) == 2
    check_kept(one)
