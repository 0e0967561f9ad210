"""Scenarios as environments: PettingZoo's own tests, and that observations are beliefs."""

import re
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from pettingzoo.test import parallel_api_test, parallel_seed_test

import beliefnest as bn
from beliefnest.belief import context
from beliefnest.env import parallel_env
from beliefnest.scenarios.scenario import Scenario
from beliefnest.world.memory import MemoryLimit

LEFT, RIGHT = (-2, -51, -4), (2, -51, -4)

FORMS = {
    "whole skills": {},
    "one tick a step": {"step_ticks": 1, "nested": 2, "phrases": ["yes", "no"]},
    "percepts": {"step_ticks": 3, "senses": "percepts"},
    "plain beliefs": {"observations": "dict", "nested": ["/anne/sally"]},
    "programs": {"actions": "programs"},
}


def make(**options):
    return parallel_env("sally-anne", max_steps=12, **options)


@pytest.mark.parametrize("form", FORMS)
def test_the_conformance_tests_of_the_library_pass(form):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = make(**FORMS[form])
        parallel_api_test(env, num_cycles=10)
        env.close()
    parallel_seed_test(lambda: make(**FORMS[form]), num_cycles=3)


def test_observations_lie_in_their_space_and_actions_make_sense_or_tell_why():
    env = make(step_ticks=2, phrases=["yes"])
    observations, _ = env.reset(seed=3)
    for number, agent in enumerate(env.agents):
        env.action_space(agent).seed(number)
    while env.agents:
        for agent in env.agents:
            assert env.observation_space(agent).contains(observations[agent])
        actions = {agent: env.action_space(agent).sample() for agent in env.agents}
        observations, *_, infos = env.step(actions)
        assert all(set(info) == {"error", "busy"} for info in infos.values())
    env.close()


def act(env, agent, skill, **parts):
    return env.step({agent: env.action(skill, **parts)})


def test_each_agent_observes_what_it_believes_and_no_more():
    env = make(nested=["/observer/sally"])
    env.reset(seed=0)
    act(env, "sally", "depositItemIntoChest", container=LEFT, item="diamond")
    # Behind the east wall.
    act(env, "sally", "goToPosition", position=(9, -51, 3))
    act(env, "anne", "getItemFromChest", container=LEFT, item="diamond")
    seen, *_, infos = act(env, "anne", "depositItemIntoChest", container=RIGHT, item="diamond")
    numbers = {agent: env.known(agent) for agent in env.agents}

    def diamonds(agent, belief, chest):
        things = numbers[agent]
        return belief["containers"][things.containers.index(chest), things.items.index("diamond")]

    assert (
        diamonds("anne", seen["anne"], RIGHT) == diamonds("observer", seen["observer"], RIGHT) == 1
    )
    assert diamonds("sally", seen["sally"], LEFT) == 1
    assert diamonds("sally", seen["sally"], RIGHT) == 0
    assert diamonds("observer", infos["observer"]["beliefs"]["/observer/sally"], LEFT) == 1
    me = numbers["sally"].agents.index("sally")
    assert seen["sally"]["me"] == me
    place = seen["sally"]["agents"][me, :3]
    assert np.allclose(place, env.nest["/"].state.agents["sally"].position)
    env.close()


def test_what_is_said_is_heard_once_by_those_who_can_and_its_claims_are_taken_up():
    lie = {"It is in the right chest.": [bn.Claim.located("diamond", RIGHT)]}
    env = parallel_env("help-sally", phrases=lie, max_steps=9)
    env.reset(seed=0)
    seen, *_ = act(env, "anne", "say", phrase=next(iter(lie)))
    anne = env.known("sally").agents.index("anne")
    assert seen["sally"]["heard"][anne].tolist() == [1, 0]
    (claim,) = env.nest.claims()
    assert claim.speaker == "anne"
    seen, *_ = env.step({})
    assert not seen["sally"]["heard"].any()
    env.close()


def test_signs_are_written_and_read_where_there_are_some():
    scenario = bn.Scenario.from_mapping(
        {
            "name": "note",
            "box": [[0, 0, 0], [8, 3, 8]],
            "blocks": [{"block": "stone", "fill": [[0, 0, 0], [8, 0, 8]]}],
            "signs": [{"at": [4, 1, 4], "text": "gone"}],
            "agents": {"ann": {"position": [1.5, 1, 1.5]}, "bob": {"position": [6.5, 1, 1.5]}},
        }
    )
    told = {"here": [bn.Claim.located("diamond", (4, 1, 2))], "gone": []}
    env = parallel_env(scenario, phrases=told, max_steps=3)
    observations, _ = env.reset()
    assert observations["bob"]["signs"].tolist() == [2]
    observations, *_, infos = act(env, "ann", "writeSign", sign=(4, 1, 4), phrase="here")
    assert (infos["ann"]["error"], observations["bob"]["signs"].tolist()) == ("", [1])
    assert [claim.speaker for claim in env.nest.claims()] == ["ann"]
    assert env.observation_space("bob").contains(observations["bob"])
    env.close()
    without = make()
    assert "writeSign" not in without.skills
    assert "signs" not in without.observation_space("anne").spaces
    without.close()


def test_levers_and_buttons_are_used_and_move_iron_doors():
    door = [
        {"block": f"iron_door[facing=east,half={half}]", "at": [6, y, 4]}
        for half, y in (("lower", 1), ("upper", 2))
    ]
    scenario = bn.Scenario.from_mapping(
        {
            "name": "gate",
            "box": [[0, 0, 0], [8, 3, 8]],
            "blocks": [
                {"block": "stone", "fill": [[0, 0, 0], [8, 0, 8]]},
                *door,
                {"block": "lever[face=floor]", "at": [6, 1, 3]},
                {"block": "oak_button[face=floor]", "at": [6, 1, 5]},
            ],
            "agents": {"ann": {"position": [4.5, 1, 4.5]}},
        }
    )
    env = parallel_env(scenario, max_steps=90, step_ticks=1)
    seen, _ = env.reset()
    assert (seen["ann"]["levers"].tolist(), seen["ann"]["buttons"].tolist()) == ([0], [0])

    def is_open():
        return "open=true" in env.nest["/ann"].state.blocks[(6, 2, 4)]

    for skill, place, ticks in (
        ("pressButton", {"button": (6, 1, 5)}, 29),
        ("turnOnLever", {"lever": (6, 1, 3)}, 50),
    ):
        seen, *_ = act(env, "ann", skill, **place)
        held = 0
        while is_open() and held < 50:
            assert env.observation_space("ann").contains(seen["ann"])
            assert seen["ann"]["buttons" if "button" in place else "levers"].tolist() == [1]
            seen, *_ = env.step({})
            held += 1
        assert held == ticks
    act(env, "ann", "turnOffLever", lever=(6, 1, 3))
    assert not is_open()
    env.close()
    without = make()
    assert not {"turnOnLever", "pressButton"} & set(without.skills)
    without.close()


def test_with_ticks_for_steps_a_skill_goes_on_until_another_takes_its_place():
    env = make(step_ticks=1)
    env.reset(seed=0)
    *_, infos = act(env, "sally", "goToPosition", position=(9, -51, 3))
    assert infos["sally"]["busy"]
    *_, infos = env.step({})
    assert infos["sally"]["busy"]
    *_, infos = act(env, "sally", "goToPosition", position=(3, -51, 0))
    assert env.nest.tick == 3
    for _ in range(4):
        *_, infos = env.step({})
    assert not infos["sally"]["busy"]
    assert env.nest["/"].state.agents["sally"].position == (3.5, -51.0, 0.5)
    env.close()


def test_what_cannot_be_done_is_told_to_its_agent():
    env = make()
    env.reset(seed=0)
    *_, infos = act(env, "anne", "getItemFromChest", container=LEFT, item="diamond")
    assert "it holds 0" in infos["anne"]["error"]
    assert infos["sally"]["error"] == ""
    with pytest.raises(bn.InputError, match="takes container, item, count"):
        env.action("getItemFromChest", item="diamond")
    with pytest.raises(bn.UnknownNameError, match="not among the containers"):
        env.action("openContainer", container=(0, 0, 0))
    with pytest.raises(bn.UnknownNameError, match="there is no skill 'opnContainer' here; skills"):
        env.action("opnContainer", container=LEFT)
    with pytest.raises(bn.UnknownNameError, match="say needs a phrase, and there is none"):
        env.action("say", phrase="hello")
    with pytest.raises(bn.UnknownNameError, match=r"needs a button, and there is none$"):
        env.action("pressButton", button=(0, 0, 0))
    with pytest.raises(bn.InputError, match="'bob' does not act"):
        env.step({"bob": env.action("doNothing")})
    env.close()


@pytest.mark.parametrize("world", ["scripted", "embedded"])
def test_programs_and_calls_do_the_same_in_both_worlds(world):
    env = parallel_env("sally-anne", world=world, agents=["sally"], max_steps=3)
    env.reset(seed=0)
    seen, *_, infos = act(env, "sally", "depositItemIntoChest", container=LEFT, item="diamond")
    assert infos["sally"]["error"] == ""
    assert seen["sally"]["containers"].sum() == 1
    seen, *_ = act(env, "sally", "openContainer", container=RIGHT)
    assert seen["sally"]["containers_known"][
        env.known("sally").containers.index(RIGHT)
    ].tolist() == [
        1,
        1,
        1,
    ]
    env.close()


def test_options_that_make_no_sense_are_refused():
    with pytest.raises(bn.InputError, match="step_ticks is for tasks, and for calls of skills"):
        make(step_ticks=1, actions="programs")
    with pytest.raises(bn.PathError, match="not a belief of an acting agent"):
        make(nested=["/anne"])
    with pytest.raises(bn.PathError, match="no agent 'bob' at the start"):
        make(agents=["bob"])


def test_what_memory_has_no_room_for_is_refused_before_it_is_made(monkeypatch):
    most = MemoryLimit(300_000_000, "a test's limit")
    monkeypatch.setattr(context, "memory_limit", lambda: most)
    with pytest.raises(
        bn.InputError, match=r"simulators below /anne to depth .* use 300 MB, a test"
    ):
        make(nested=40)
    make(nested=3).close()
    agents = {name: {"position": [at + 0.5, 1, 0.5]} for at, name in enumerate(("ann", "bob"))}
    hall = {"name": "hall", "box": [[0, 0, 0], [499, 99, 999]], "agents": agents}
    with pytest.raises(bn.InputError) as fault:
        parallel_env(Scenario.from_mapping(hall))
    assert str(fault.value) == (
        "observations as arrays need at least 301 MB, 51 MB for each of 2 agents and 0 nested "
        "beliefs, in a box of 500 x 100 x 1000 blocks. This process may use 300 MB, a test's "
        "limit: choose observations='dict', or take fewer agents or a smaller box"
    )
    hall["box"] = [[0, 0, 0], [1999, 199, 999]]
    with pytest.raises(bn.InputError) as fault:
        parallel_env(Scenario.from_mapping(hall))
    assert str(fault.value) == (
        "an observation as arrays would have 401 MB in a box of 2000 x 200 x 1000 blocks, new for "
        "each agent and step; at most 256 MB are possible: choose observations='dict', or take a "
        "smaller box"
    )
    env = parallel_env(Scenario.from_mapping(hall), observations="dict", max_steps=2)
    env.reset(seed=1)
    _, *_, infos = env.step({"ann": env.action("goToPosition", position=(30, 1, 20))})
    assert infos["ann"]["error"].startswith("could not reach")
    env.close()


def test_nested_beliefs_are_those_down_to_a_depth():
    env = make(nested=3, agents=["sally"])
    others = [name for name in env.layout.agents if name != "sally"]
    paths = [("sally", other) for other in others]
    paths += [(*path, name) for path in paths for name in env.layout.agents if name != path[-1]]
    assert env._nested == tuple(sorted(paths, key=lambda path: (-len(path), path)))
    assert make(nested=1)._nested == make(nested=0)._nested == ()


def test_without_the_library_it_says_what_to_install():
    code = (
        "import sys; sys.modules['pettingzoo'] = None\n"
        "from beliefnest.env import parallel_env\n"
        "try: parallel_env('sally-anne')\n"
        "except Exception as error: print(error)\n"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert 'pip install "beliefnest[pettingzoo]"' in said.stdout


def test_the_guide_does_what_it_says(capsys):
    guide = Path(__file__).parents[2] / "docs" / "pettingzoo.md"
    code = "\n".join(re.findall(r"```python\n(.*?)```", guide.read_text("utf-8"), re.DOTALL))
    exec(compile(code, "guide", "exec"), {"__name__": "guide"})
    printed = capsys.readouterr().out.splitlines()
    assert printed == re.findall(r"print\(.*\)  # (.*)", code)


@pytest.mark.parametrize("seed", ["x", 1.5, 2**63, b"1", [1]])
def test_a_seed_that_is_none_is_refused_and_the_episode_goes_on(seed):
    env = make(actions="skills")
    env.reset(seed=np.int64(3))
    with pytest.raises(
        bn.InputError, match=r"seed is .*; environments take whole numbers from 0 to"
    ):
        env.reset(seed=seed)
    env.step({})
    with pytest.raises(bn.InputError, match="seed is"):
        make(seed=seed)
    with pytest.raises(bn.InputError, match="seed is"):
        bn.Nest.open(bn.Scenario.load("sally-anne", 3), world="scripted", seed=seed)
    env.close()


@pytest.mark.parametrize("actions", [None, 3, "sally", [{"skill": 0}], ("sally",)])
def test_actions_that_are_no_mapping_are_refused(actions):
    env = make(actions="skills")
    env.reset()
    with pytest.raises(bn.InputError, match="give a dict of agents' names and actions"):
        env.step(actions)
    env.close()


@pytest.mark.parametrize(
    "action",
    [
        None,
        3,
        {},
        {"skill": float("inf")},
        {"skill": -1},
        {"skill": "x" * 10_000},
        {"skill": True},
        [],
    ],
)
def test_what_is_no_action_is_refused_in_one_line(action):
    env = make(actions="skills")
    env.reset()
    with pytest.raises(bn.InputError) as fault:
        env.step({env.agents[0]: action})
    assert "\n" not in str(fault.value)
    assert len(str(fault.value)) < 600
    for parts in ({"position": None}, {"position": "abc"}, {"position": (float("inf"), 0, 0)}):
        with pytest.raises(bn.InputError):
            env.action("goToPosition", **parts)
    env.close()


@pytest.mark.parametrize("name", ["max_steps", "timeout_ticks", "step_ticks", "reward", "ends"])
def test_options_of_another_type_are_refused(name):
    with pytest.raises(bn.InputError, match=f"{name} is "):
        parallel_env("sally-anne", **{name: "x"})
