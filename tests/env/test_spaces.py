"""Spaces that learners take, with nested beliefs in them; states, pictures, ends of episodes."""

import json
import warnings
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import beliefnest as bn
from beliefnest.env import aec_env, parallel_env, sb3_env, vector_env

pytest.importorskip("pettingzoo", reason="the extra `pettingzoo` is not installed")
from gymnasium import spaces
from gymnasium.wrappers.vector import RecordEpisodeStatistics
from pettingzoo.test import parallel_seed_test
from pettingzoo.test.state_test import state_test

ROOM = {
    "name": "room",
    "box": [[0, 0, 0], [9, 3, 8]],
    "blocks": [
        {"block": "stone", "fill": [[0, 0, 0], [9, 0, 8]]},
        {"block": "bricks", "fill": [[5, 1, 0], [5, 3, 8]]},
        {"block": "lever[face=floor,powered=true]", "at": [2, 1, 5]},
        {"block": "oak_fence_gate[open=true]", "at": [3, 1, 7]},
        {"block": "oak_fence_gate", "at": [1, 1, 7]},
    ],
    "containers": [{"at": [2, 1, 2], "items": {"diamond": 1}}, {"at": [8, 1, 2]}],
    "agents": {
        "ann": {"position": [1.5, 1, 1.5]},
        "bob": {"position": [3.5, 1, 3.5]},
        # Behind the wall: Ann does not know that he is there.
        "aaron": {"position": [8.5, 1, 6.5]},
    },
    "perception": {"max_visible_distance": 64},
}


def room(**options: Any) -> Any:
    return parallel_env(bn.Scenario.from_mapping(ROOM), **{"max_steps": 3, **options})


def numbers(space: spaces.Space[Any]) -> list[Any]:
    """Return the boxes of a space."""
    assert isinstance(space, spaces.Dict)
    assert all(type(each) is spaces.Box for each in space.values())
    return list(space.values())


@pytest.mark.parametrize("nested", [(), 2, 3])
@pytest.mark.parametrize("name", ["joint-lift", "help-find"])
def test_observations_are_boxes_with_elements_that_networks_take(name: str, nested: Any) -> None:
    with closing(parallel_env(name, nested=nested)) as env:
        observations, _ = env.reset(seed=0)
        (agent,) = env.agents
        space = env.observation_space(agent)
        for box in numbers(space):
            assert box.shape
            assert 0 not in box.shape
            assert np.isfinite(box.low).all()
            assert (box.low < box.high).all()
        flat = spaces.flatten(space, observations[agent])
        assert spaces.flatten_space(space).contains(flat)
        back = spaces.unflatten(space, flat)
        assert all(np.array_equal(back[key], each) for key, each in observations[agent].items())


def test_blocks_are_of_few_classes_and_doors_are_seen_to_stand_open() -> None:
    with closing(room(agents=["ann"])) as env:
        seen = env.reset(seed=0)[0]["ann"]
        assert env.observation_space("ann")["blocks"].high.max() == 6
        cells = {"free": (4, 1, 2), "solid": (4, 0, 2), "containers": (2, 1, 2)}
        cells |= {"levers": (2, 1, 5), "doors": (3, 1, 7)}
        found = {name: int(seen["blocks"][cell]) for name, cell in cells.items()}
        assert found == {"free": 0, "solid": 1, "containers": 2, "doors": 3, "levers": 4}
        assert seen["blocks"][8, 1, 2] == -1
        assert dict(zip(env.known("ann").doors, seen["doors"].tolist(), strict=False)) == {
            (3, 1, 7): 1,
            (1, 1, 7): 0,
        }
        assert seen["levers"].tolist() == [1]


def test_nested_beliefs_are_in_the_space_in_the_order_in_which_agents_are_known() -> None:
    without, env = room(agents=["ann"]), room(agents=["ann"], nested=3)
    assert env.observation_space("ann") != without.observation_space("ann")
    with closing(env):
        observations, infos = env.reset(seed=0)
        seen, told = observations["ann"], infos["ann"]["beliefs"]
        known = env.known("ann")
        assert env.observation_space("ann").contains(seen)
        assert known.agents == ("ann", "bob")
        # Ann knows nothing of Aaron, who would come first by his name.
        assert seen["beliefs"].tolist() == [[1, -1], [1, 0], *[[-1, -1]] * 4]
        for row, path in enumerate(("/ann/bob", "/ann/bob/ann")):
            for name, array in told[path].items():
                if name not in ("tick", "me"):
                    assert np.array_equal(seen[f"beliefs_{name}"][row], array), name
        assert (seen["beliefs_blocks"][2:] == -1).all()
        assert not seen["beliefs_agents_known"][2:].any()
        gone = env.action("goToPosition", position=(1, 1, 4))
        for place in ((5, 1, 6), (5, 2, 6)):
            env.nest.scripted_world.set_block(place, "air")
        observations, *_ = env.step({"ann": gone | {"position": np.array([4, 1, 6])}})
        assert env.known("ann").agents == ("ann", "bob", "aaron")
        numbers = observations["ann"]["beliefs"]
        assert numbers.tolist() == [[1, -1], [1, 0], [1, 2], [2, -1], [2, 0], [2, 1]]


def test_nested_beliefs_are_in_vectors_and_in_plain_data() -> None:
    scene = bn.Scenario.from_mapping(ROOM)
    with closing(vector_env(scene, 2, nested=2, agents=["ann", "bob"], max_steps=2)) as env:
        observations, _ = env.reset(seed=0)
        assert env.observation_space.contains(observations)
        assert observations["beliefs_levers"].shape == (4, 2, 1)
        assert observations["beliefs"][:, 0, 0].tolist() == [1, 0, 1, 0]
    with closing(room(observations="dict", nested=["/ann/bob"])) as env:
        observations, infos = env.reset(seed=0)
        assert observations["ann"]["beliefs"] == infos["ann"]["beliefs"]
        assert env.observation_space("ann").contains(observations["ann"])
        assert "beliefs" not in observations["bob"]


def test_statistics_of_episodes_are_recorded_by_the_wrapper_of_gymnasium() -> None:
    env = RecordEpisodeStatistics(vector_env("joint-lift", 2))
    with closing(env):
        env.reset(seed=0)
        nothing = env.action_space.sample()
        nothing["skill"][:] = 0
        for _ in range(3):
            *_, cut, infos = env.step(nothing)
        assert cut.all()
        assert infos["episode"]["l"].tolist() == [3, 3]


@pytest.mark.parametrize("observations", ["arrays", "dict"])
def test_the_state_is_the_world_in_one_row(observations: str) -> None:
    with closing(room(observations=observations)) as env:
        env.reset(seed=0)
        assert env.state_space.contains(env.state())
        if observations == "arrays":
            own = {**env.observation_space("ann").spaces}
            parts = spaces.unflatten(spaces.Dict(own), env.state())
            # The world has no owner who would have to come to know things.
            assert parts["containers"][:, env.layout.items.index("diamond")].tolist() == [1, 0]
            assert (parts["blocks"] >= 0).all()


def test_the_state_test_and_the_seed_test_of_the_library_pass() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        state_test(aec_env("joint-lift"), parallel_env("joint-lift"))
    parallel_seed_test(lambda: parallel_env("joint-lift", nested=2), num_cycles=2)


def test_pictures_have_one_size_and_show_what_is_asked_for() -> None:
    shown = {}
    for path in ("/", "/ann"):
        with closing(room(render_mode="rgb_array", render_path=path)) as env:
            assert "rgb_array" in env.metadata["render_modes"]
            env.reset(seed=0)
            shown[path] = env.render()
            assert (shown[path].shape, shown[path].dtype) == ((512, 688, 3), np.uint8)
    assert not np.array_equal(shown["/"], shown["/ann"])
    scene = bn.Scenario.from_mapping(ROOM)
    with closing(vector_env(scene, 1, render_mode="rgb_array", render_path="/ann")) as copies:
        copies.reset(seed=0)
        assert copies.render_mode == "rgb_array"
        assert [np.array_equal(each, shown["/ann"]) for each in copies.render()] == [True] * 3
    with pytest.raises(bn.InputError, match="render_mode is 'ansi'; it is human or rgb_array"):
        room(render_mode="ansi")
    with pytest.raises(bn.PathError, match="carl"):
        room(render_path="/carl")


def test_lines_for_people_are_printed_at_each_step(capsys: pytest.CaptureFixture[str]) -> None:
    with closing(room(render_mode="human", render_path="/ann")) as env:
        env.reset(seed=0)
        env.step({})
    lines = capsys.readouterr().out.splitlines()
    assert [line.split(":")[0] for line in lines] == ["/ann, tick 0", "/ann, tick 1"]
    assert "aaron place not known; ann at (1.5, 1, 1.5); bob at (3.5, 1, 3.5)" in lines[0]


@pytest.mark.parametrize(
    ("rounds", "deadline", "ends"),
    [
        (3, None, (False, True)),
        # The deadline passes in the last round, in one before it, and at the end of one.
        (3, 5, (True, False)),
        (9, 5, (True, False)),
        (9, 6, (True, False)),
        (3, 6, (True, False)),
        # It would have passed in the next round.
        (3, 7, (False, True)),
    ],
)
def test_a_deadline_of_the_task_terminates_and_a_limit_of_rounds_truncates(
    rounds: int, deadline: int | None, ends: tuple[bool, bool]
) -> None:
    goal = {"reach": [{"agent": "ann", "items": {"diamond": 1}}]}
    goals = {**goal, **({"ticks": deadline} if deadline else {})}
    episode = {"goal": goals, "rounds": rounds, "round_ticks": 2}
    scene = bn.Scenario.from_mapping({**ROOM, "episode": episode})
    with closing(parallel_env(scene, agents=["ann"])) as env:
        env.reset(seed=0)
        while env.agents:
            _, _, ended, cut, infos = env.step({})
        assert (ended["ann"], cut["ann"], infos["ann"]["success"]) == (*ends, False)
        assert env.nest.tick == 6


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"nested": -1}, "nested is -1; give paths, or a depth from 0 on"),
        ({"nested": True}, "nested is True; give paths"),
        ({"phrases": [3]}, r"phrases is \[3\]; give a list of texts"),
        ({"phrases": ["x" * 300]}, "phrases has a text of 300 characters; at most 256 can be"),
        ({"phrases": "yes"}, "phrases is 'yes'; give a list of texts"),
        ({"items": [3]}, r"items is \[3\]; give a list of texts"),
        ({"items": "egg"}, "items is 'egg'; give a list of texts"),
        ({"nested": None}, "nested is None; give a list of texts"),
        ({"agents": "anne"}, "agents is 'anne'; give a list of texts"),
        ({"agents": ["anne", "anne"]}, r"agents is \['anne', 'anne'\]; name each agent once"),
        ({"max_steps": True}, "max_steps is True; give a whole number from 1 on"),
        ({"seed": -1}, r"seed is -1; environments take whole numbers from 0 to 2\*\*63 - 1"),
        ({"seed": 2**63}, "seed is 9223372036854775808; environments take whole numbers from 0"),
        ({"seed": True}, "seed is True; environments take whole numbers"),
        ({"phrases": ["yes", "no", "yes"]}, r"phrases is \['yes', 'no', 'yes'\]; name each phrase"),
        (
            {"phrases": {"yes": 5}},
            r"phrases\['yes'\] is 5; give a list of claims, each as bn.Claim",
        ),
        ({"phrases": {"yes": [5]}}, r"phrases\['yes'\] is \[5\]; give a list of claims"),
        ({"phrases": {"yes": [{"heard": "no"}]}}, "cannot be claimed"),
        ({"cells": [(0, -51, 0)]}, "cells are numbers of actions='flat' alone"),
        ({"agents": []}, "agents is empty; name agents that act"),
        ({"parameters": 3}, "parameters is 3; give values by name"),
    ],
)
def test_options_of_wrong_kinds_are_refused_in_one_line(options: Any, message: str) -> None:
    with pytest.raises(bn.InputError, match=message):
        parallel_env("sally-anne", **options)
    with pytest.raises(bn.InputError, match="None is no scenario; give a name, a file, or an"):
        parallel_env(None)  # type: ignore[arg-type]  # the wrong input itself
    with pytest.raises(bn.InputError, match="actions is 'skills', which learners of stable-base"):
        sb3_env("sally-anne", actions="skills")


def test_what_is_said_can_be_given_as_facts_and_a_file_as_a_path(tmp_path: Path) -> None:
    file = tmp_path / "room.yaml"
    file.write_text(json.dumps(ROOM))
    fact = {"container": [2, 1, 2], "items": {"diamond": 1}}
    with closing(parallel_env(file, phrases={"It is there.": [fact]})) as env:
        env.reset(seed=0)
        env.step({"ann": env.action("say", phrase="It is there.")})
        (said,) = env.nest.claims()
        assert said.claim == bn.Claim.located("diamond", (2, 1, 2))
        with pytest.warns(UserWarning, match="render shows nothing: make the environment with"):
            assert env.render() is None


def test_functions_of_the_user_return_numbers_and_truths() -> None:
    for options, message in (
        (
            {"reward": lambda nest, agent: "much"},
            "reward returned 'much' for anne; return a finite number",
        ),
        ({"reward": lambda nest, agent: None}, "reward returned None for anne; return a finite"),
        ({"reward": lambda nest, agent: float("nan")}, "reward returned nan for anne; return a"),
        ({"reward": lambda nest, agent: 10**400}, "reward returned 10{99}.* for anne; return a"),
        ({"ends": lambda nest: None}, "ends returned None; return True or False"),
        ({"ends": lambda nest: "no"}, "ends returned 'no'; return True or False"),
    ):
        with closing(parallel_env("sally-anne", **options)) as env:
            env.reset(seed=0)
            with pytest.raises(bn.InputError, match=message):
                env.step({})
    with closing(parallel_env("sally-anne", reward=lambda *_: np.float32(2))) as env:
        with pytest.raises(bn.InputError, match="seed is -1"):
            env.reset(seed=-1)
        env.reset(seed=0)
        assert env.step({})[1]["anne"] == 2.0
