"""Tasks as environments: their rules are those of episodes; copies; turns."""

import copy
import json
import os
import warnings
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.shared_worlds import WORLDS

import beliefnest as bn
from beliefnest.belief.initial import initial_forest
from beliefnest.env import aec_env, parallel_env, vector_env
from beliefnest.episodes.episode import Episode
from beliefnest.episodes.policies.simple import Scripted
from beliefnest.episodes.task import Task
from beliefnest.nest.past import history
from beliefnest.scenarios import instances

pytest.importorskip("pettingzoo", reason="the extra `pettingzoo` is not installed")
from gymnasium.vector import AutoresetMode
from pettingzoo.test import api_test, parallel_api_test

pytestmark = pytest.mark.usefixtures("kept_worlds")

CHEST = [4, 1, 2]
HALL = {
    "name": "hall",
    "box": [[0, 0, 0], [8, 3, 8]],
    "blocks": [{"block": "stone", "fill": [[0, 0, 0], [8, 0, 8]]}],
    "containers": [{"at": CHEST, "items": {"diamond": 1}}],
    "agents": {"ann": {"position": [1.5, 1, 1.5]}, "bob": {"position": [6.5, 1, 6.5]}},
    "episode": {
        "goal": {"reach": [{"agent": "ann", "items": {"diamond": 1}}]},
        "goals": {"bob": {"never": [{"agent": "ann", "items": {"diamond": 1}}]}},
        "talk": ["ann"],
        "rewards": {"reached": 5, "violated": -3, "each_round": -1, "message": -0.25},
        "rounds": 4,
        "round_ticks": 2,
    },
}


def known_to_bob(env: Any, infos: Any) -> list[tuple[int, int, int]]:
    levers = infos["anne"]["beliefs"]["/anne/bob"]["levers"]
    return [place for place, on in zip(env.layout.levers, levers, strict=True) if on >= 0]


def lift(env: Any, seed: int) -> tuple[tuple[int, int, int], list[float]]:
    """Let Anne go to a lever that she believes Bob to know; return it and the rewards."""
    _, infos = env.reset(seed=seed)
    lever = known_to_bob(env, infos)[0]
    earned = []
    while env.agents:
        _, rewards, ended, cut, infos = env.step({"anne": env.action("turnOnLever", lever=lever)})
        earned.append(rewards["anne"])
        assert ended["anne"] is infos["anne"]["success"]
        assert not (ended["anne"] and cut["anne"])
    return lever, earned


def test_a_task_gives_players_goal_rewards_and_limits() -> None:
    env = parallel_env("joint-lift", nested=["/anne/bob"])
    assert env.possible_agents == ["anne"]
    for seed in (0, 1):
        lever, earned = lift(env, seed)
        assert earned == [0.0] * (len(earned) - 1) + [1.0]
        # The same programs in an episode have the same result, in the same round.
        task = Task.load("joint-lift", seed)
        assert env.layout.box == task.scenario.setting.snapshot.box
        going = Scripted([f"await turnOnLever(bot, new Vec3{lever})"] * len(earned))
        with Episode(task, {"anne": going}, seed=seed) as episode:
            episode.play()
            assert (episode.success, episode.rounds) == (True, len(earned))
    env.reset(seed=0)
    for _ in range(Task.load("joint-lift").form.rounds):
        _, _, ended, cut, _ = env.step({})
    assert (ended, cut, env.agents) == ({"anne": False}, {"anne": True}, [])
    env.close()


def test_the_episode_of_a_scenario_gives_rewards_and_costs() -> None:
    env = parallel_env(bn.Scenario.from_mapping(HALL), phrases=["hello"])
    env.reset(seed=0)
    say = env.action("say", phrase="hello")
    _, rewards, *_, infos = env.step({"ann": say, "bob": say})
    # Bob may not speak: nobody hears him, and it costs him nothing.
    assert rewards == {"ann": -1.25, "bob": -1.0}
    assert "may not speak" in infos["bob"]["error"]
    take = env.action("getItemFromChest", container=tuple(CHEST), item="diamond")
    total = {"ann": 0.0, "bob": 0.0}
    while env.agents:
        _, rewards, ended, _, infos = env.step({"ann": take if not infos["ann"]["busy"] else say})
        total = {agent: total[agent] + each for agent, each in rewards.items()}
    assert ended == {"ann": True, "bob": True}
    assert total["ann"] > total["bob"]
    assert infos["ann"]["success"]
    env.close()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"senses": "world"}, "leave senses and timeout_ticks out"),
        ({"timeout_ticks": 9}, "leave senses and timeout_ticks out"),
        ({"condition": 1}, "has no conditions"),
        ({"parameters": {"far": 3}}, "far"),
        ({"parameters": {"near": 3}}, "near"),
        ({"max_steps": 0}, "max_steps is 0"),
    ],
)
def test_options_that_do_not_fit_are_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(bn.BeliefNestError, match=message):
        parallel_env("joint-lift", **options)
    with pytest.raises(bn.ScenarioError, match="no parameter 'far'"):
        parallel_env("sally-anne", parameters={"far": 3})
    with pytest.raises(bn.InputError, match="parameters are for names and files"):
        parallel_env(Task.load("joint-lift"), parameters={"far": 3})


def test_seeds_of_a_file_are_its_instances_and_parameters_can_be_given(tmp_path: Path) -> None:
    spots = [[1, 1, 7], [4, 1, 7], [7, 1, 7]]
    declared = {"default": spots[0], "values": spots}
    drawn = {
        **HALL,
        "parameters": {"box": declared, "decoy": {**declared, "default": spots[1]}},
        "instances": {"box": {}, "decoy": {"differs_from": ["box"]}},
        "containers": [{"at": "${box}", "items": {"diamond": 1}}, {"at": "${decoy}"}],
    }
    file = tmp_path / "hall.yaml"
    file.write_text(json.dumps(drawn), encoding="utf-8")

    def full(env: Any, seed: int) -> list[tuple[int, ...]]:
        env.reset(seed=seed)
        containers = env.nest["/"].state.containers
        assert env.layout.containers == tuple(sorted(containers))
        return [place for place, content in containers.items() if content.items]

    with closing(parallel_env(str(file))) as env:
        found = [full(env, seed) for seed in range(8)]
    assert len({place for (place,) in found}) > 1
    for seed, places in enumerate(found):
        held = Task.load(str(file), seed).scenario.setting.snapshot.containers
        assert [place for place, items in held.items() if items] == places
    # A given value may be the default of a parameter that is drawn.
    with closing(parallel_env(str(file), parameters={"box": spots[1]})) as env:
        assert {place for seed in range(4) for place in full(env, seed)} == {tuple(spots[1])}


@pytest.mark.parametrize("world", WORLDS)
def test_a_container_is_opened_from_its_own_side_of_a_wall(world: str) -> None:
    """It is empty, within 2 blocks of a place on Ann's side, and everybody knows of it."""
    wall = {"block": "stone", "fill": [[3, 1, 0], [3, 3, 4]]}
    content = {
        **HALL,
        "blocks": [*HALL["blocks"], wall],
        "containers": [{"at": CHEST}],
        "static_blocks": ["stone", "chest"],
    }
    room, place = bn.Scenario.from_mapping(content), (4, 1, 2)
    with closing(
        parallel_env(room, world=world, step_ticks=200, items=["apple", "diamond"])
    ) as env:
        env.reset(seed=0)
        *_, infos = env.step({"ann": env.action("openContainer", container=place)})
        assert infos["ann"]["error"] == ""
        assert env.nest["/ann"].state.containers[place].complete
        take = env.action("getItemFromChest", container=place, item="apple")
        *_, infos = env.step({"ann": take})
        assert infos["ann"]["error"] == "getItemFromChest did not work"


@pytest.mark.parametrize(("agent", "ticks"), [("ann", 2), ("bob", 3)])
def test_a_skill_in_rounds_of_one_tick_takes_as_long_as_in_a_long_one(
    agent: str, ticks: int
) -> None:
    """Ann reaches the chest, Bob walks a cell; each opens it and takes, in a tick each."""
    env = parallel_env(bn.Scenario.from_mapping(HALL), step_ticks=1, max_steps=9, agents=[agent])
    env.reset(seed=0)
    take = env.action("getItemFromChest", container=tuple(CHEST), item="diamond")
    *_, infos = env.step({agent: take})
    while env.agents and infos[agent]["busy"]:
        *_, infos = env.step({})
    assert env.nest["/"].state.agents[agent].inventory == {"diamond": 1}
    assert env.nest.tick == ticks
    env.close()


def test_given_values_are_warned_of_if_unlisted_and_refused_at_once_if_impossible(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = {
        "parameters": {"near": {"default": 4, "values": [4, 5]}},
        "instances": {"near": {}},
        "containers": [{"at": ["${near}", 1, 2], "items": {"diamond": 1}}],
    }
    file = tmp_path / "hall.yaml"
    file.write_text(json.dumps({**HALL, **lines}))
    for load in (parallel_env, bn.Task.load, bn.Scenario.load):
        given = {"near": 3} if load == bn.Task.load else {"parameters": {"near": 3}}
        with pytest.warns(UserWarning, match="near: is given 3, and lists 4, 5"):
            load(str(file), **given)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            load(str(file), **({"near": 5} if "near" in given else {"parameters": {"near": 5}}))
    tried: list[object] = []

    def fault(_: object, values: object) -> str:
        tried.append(values)
        return "full"

    monkeypatch.setattr(instances._Drawing, "fault", fault)
    with pytest.raises(bn.ScenarioError, match="nothing is drawn, and the given values fail: full"):
        parallel_env(str(file), parameters={"near": 4})
    assert tried == [{"near": 4}]


class Fetches:
    """Policy that takes the diamond in its second round; in the first it gives no program."""

    def act(self, view: bn.AgentView) -> str | None:
        take = f"await getItemFromChest(bot, new Vec3({CHEST[0]}, 1, 2), {{diamond: 1}})"
        idle = "" if view.round else None
        return take if view.round and view.agent == "ann" else idle


def test_a_policy_of_play_acts_in_the_environment_as_it_does_there() -> None:
    policy, scenario = Fetches(), bn.Scenario.from_mapping(HALL)
    with closing(parallel_env(scenario, actions="programs")) as env:
        with pytest.raises(bn.InputError, match=r"no view of 'ann': call reset\(\) first"):
            env.view("ann")
        env.reset(seed=3)
        with pytest.raises(bn.InputError, match="'eve' does not act now"):
            env.view("eve")
        steps = 0
        while env.agents:
            *_, infos = env.step({agent: policy.act(env.view(agent)) for agent in env.agents})
            steps += 1
        ended = infos["ann"]["success"], steps, env.nest.tick
    with Episode(Task.of(scenario), {"ann": policy, "bob": policy}, seed=3) as episode:
        episode.play()
        assert (episode.success, episode.rounds, episode.nest.tick) == ended
        assert episode.success
    with closing(parallel_env("sally-anne")) as env:
        env.reset(seed=0)
        with pytest.raises(bn.InputError, match="only tasks have rounds"):
            env.view("anne")


def test_the_conformance_tests_of_the_library_pass() -> None:
    hall = bn.Scenario.from_mapping(HALL)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = parallel_env(hall, phrases=["yes"])
        parallel_api_test(env, num_cycles=8)
        env.close()
    with warnings.catch_warnings():
        # The library recommends boxes as spaces, and names such as player_0.
        warnings.simplefilter("ignore")
        turns = aec_env(hall, phrases=["yes"])
        api_test(turns, num_cycles=8)
        turns.close()


def test_in_turns_a_wrong_action_is_refused_at_once_and_another_one_can_be_chosen() -> None:
    with closing(aec_env(bn.Scenario.from_mapping(HALL), actions="flat", max_steps=2)) as turns:
        turns.reset(seed=0)
        for agent in ("ann", "bob"):
            assert turns.agent_selection == agent
            for wrong in (None, -1, "x"):
                with pytest.raises(bn.InputError, match="is not in the action space"):
                    turns.step(wrong)
            assert turns.action_masks().tolist() == turns.last()[4]["action_mask"].tolist()
            turns.step(1)
        assert turns.unwrapped.nest.tick == 2
        turns.step(2)
        saved = turns.save()
        ends = []
        for _ in range(2):
            turns.step(0)
            ends.append([turns.agent_selection, *map(str, turns.last()), dict(turns.rewards)])
            with pytest.raises(bn.InputError, match="over for ann: step with None, or reset"):
                turns.step(0)
            turns.step(None)
            turns.step(None)
            with pytest.raises(
                bn.InputError, match=r"over, and no agent has a turn: call reset\(\)"
            ):
                turns.last()
            turns.restore(saved)
            assert turns.agent_selection == "bob"
        assert ends[0] == ends[1]
        with closing(copy.deepcopy(turns)) as other:
            other.step(0)
            assert [other.agent_selection, *map(str, other.last()), other.rewards] == ends[0]


def test_copies_are_stepped_together_and_begin_again() -> None:
    env = vector_env(bn.Scenario.from_mapping(HALL), 2, max_steps=3)
    assert env.rows == [(0, "ann"), (0, "bob"), (1, "ann"), (1, "bob")]
    assert env.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    observations, _ = env.reset(seed=7)
    assert env.observation_space.contains(observations)
    assert observations["me"].tolist() == [[0], [1], [0], [1]]
    env.action_space.seed(0)
    ticks = []
    for step in range(5):
        observations, rewards, ended, cut, infos = env.step(env.action_space.sample())
        assert env.observation_space.contains(observations)
        assert rewards.shape == ended.shape == (4,)
        assert cut.all() if step == 2 else not cut.any()
        assert infos["success"].tolist() == [False] * 4 if step != 3 else "success" not in infos
        ticks.append(int(observations["tick"][0, 0]))
    assert ticks[3] < ticks[2]
    assert ticks[3] < ticks[4]
    env.close()
    with pytest.raises(bn.InputError, match="arrays"):
        vector_env("sally-anne", 2, observations="dict")


def test_an_environment_is_refused_in_a_forked_child() -> None:
    env = parallel_env("sally-anne")
    env.reset(seed=0)
    child = os.fork()
    if not child:
        code = 1
        try:
            env.reset(seed=1)
        except bn.ForkedError:
            code = 0
        finally:
            os._exit(code)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    # The parent's episode goes on.
    observations, *_ = env.step({})
    assert np.all(observations["anne"]["tick"] > 0)
    env.close()


def test_the_beliefs_of_a_first_observation_are_begun_together(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    begun: list[set[tuple[str, ...]]] = []

    def noted(*arguments: Any) -> Any:
        begun.append({*arguments[4]})
        return initial_forest(*arguments)

    monkeypatch.setattr(history, "initial_forest", noted)
    nested, agents = ["/spy/watchman"], ["spy", "watchman"]
    with closing(parallel_env("watchman", nested=nested, agents=agents)) as env:
        env.reset(1)
        of_the_goal = ("watchman", "spy")
        assert begun == [{("spy",), ("watchman",), ("spy", "watchman"), of_the_goal}]
