"""Pairs of worlds that differ only behind a full wall: an agent's environment is the same."""

import random
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pytest
from tests.profiles import at_night

import beliefnest as bn
from beliefnest.env import parallel_env
from beliefnest.scenarios.scenario import Scenario

PAIRS = at_night(400, 3)
SIZES = {
    "agents": 5,
    "items": 8,
    "containers": 12,
    "doors": 12,
    "levers": 12,
    "buttons": 12,
    "signs": 12,
}
KINDS = ("chest", "lever", "stone_button", "oak_fence_gate", "oak_sign", "oak_planks")
ITEMS = ("diamond", "apple", "emerald", "bread")
PHRASES = ("yes", "no")
FORMS: Mapping[str, dict[str, Any]] = {
    "arrays": {"step_ticks": 2, "senses": "percepts", "nested": 2},
    "plain data": {"step_ticks": 1, "senses": "percepts", "observations": "dict"},
    "flat": {"step_ticks": 2, "senses": "percepts", "actions": "flat"},
    "task": {"step_ticks": 4, "has_goal": True, "nested": ["/ann/bob"]},
}


def side(chance: random.Random, columns: range) -> list[tuple[str, tuple[int, int, int], dict]]:
    """Return things in some columns of the hall: block, position, contents."""
    cells = [(x, 1, z) for x in columns for z in range(0, 9, 2)]
    return [
        (chance.choice(KINDS), cell, dict.fromkeys(chance.sample(ITEMS, 2), 1))
        for cell in chance.sample(cells, 5)
    ]


def scene(west: list, east: list, hidden: Mapping[str, Any], *, has_goal: bool) -> Scenario:
    """Return a hall with a full wall at x = 8; Ann and Bob are in the west, others in the east."""
    things = [*west, *east]
    goal = {"reach": [{"agent": "ann", "at": [0, 1, 8]}, {"agent": "ann", "items": {"apple": 9}}]}
    return Scenario.from_mapping(
        {
            "name": "pair",
            "box": [[0, 0, 0], [16, 4, 8]],
            "blocks": [
                {"block": "stone", "fill": [[0, 0, 0], [16, 0, 8]]},
                {"block": "bricks", "fill": [[8, 1, 0], [8, 4, 8]]},
                *(
                    {
                        "block": f"{kind}[face=floor]"
                        if kind in ("lever", "stone_button")
                        else kind,
                        "at": list(at),
                    }
                    for kind, at, _ in things
                    if kind not in ("chest", "oak_sign")
                ),
            ],
            "containers": [
                {"at": list(at), "items": held} for kind, at, held in things if kind == "chest"
            ],
            "signs": [
                {"at": list(at), "text": "yes"} for kind, at, _ in things if kind == "oak_sign"
            ],
            "agents": {
                "ann": {"position": [2.5, 1, 3.5], "inventory": {"emerald": 1}},
                "bob": {"position": [4.5, 1, 5.5]},
                **hidden,
            },
            "perception": {"hearing": "sight", "max_visible_distance": 64},
            **(
                {"episode": {"goal": goal, "rounds": 8, "talk": ["ann", "bob"]}} if has_goal else {}
            ),
        }
    )


def episode(scenario: Scenario, seed: int, which: int, form: Mapping[str, Any]) -> Iterator[object]:
    """Yield everything that Ann is given; the agents behind the wall act as `which` says."""
    options = {key: value for key, value in form.items() if key != "has_goal"}
    env = parallel_env(scenario, phrases=PHRASES, sizes=SIZES, items=ITEMS, max_steps=8, **options)
    yield env.observation_space("ann"), env.action_space("ann"), env.skills
    observations, infos = env.reset(seed=seed)
    chance = {"here": random.Random(f"{seed}"), "there": random.Random(f"{seed} {which}")}
    number = 0
    while env.agents:
        yield observations["ann"], infos["ann"], env.known("ann")
        actions = {}
        for agent in env.agents:
            space = env.action_space(agent)
            draws = chance["here" if agent in ("ann", "bob") else "there"]
            space.seed(draws.randrange(2**31))
            action = space.sample()
            if form.get("actions") == "flat":
                call = env.calls(agent)[action]
                skill = "" if call is None else call.skill
            else:
                skill = env.skills[action["skill"]]
            # A whisper is heard through walls: it would be a difference that Ann perceives.
            is_whisper = skill == "whisper"
            if draws.random() < 0.7 and not (is_whisper and agent not in ("ann", "bob")):
                actions[agent] = action
        observations, rewards, ended, cut, infos = env.step(actions)
        yield rewards["ann"], ended["ann"], cut["ann"]
        number += 1
    yield observations["ann"], infos["ann"]
    env.close()


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("seed", range(PAIRS))
def test_an_agent_is_given_the_same_in_both_worlds(seed: int, form: str) -> None:
    chance = random.Random(f"pair {seed}")
    west = side(chance, range(0, 7))
    told = []
    for which in (0, 1):
        hidden = {
            name: {"position": [chance.randint(10, 15) + 0.5, 1, 2 * place + 1.5]}
            for place, name in enumerate(("aaron", "zoe"))
        }
        scenario = scene(west, side(chance, range(9, 17)), hidden, has_goal=form == "task")
        told.append(list(episode(scenario, seed, which, FORMS[form])))
    for one, other in zip(*told, strict=True):
        assert plain(one) == plain(other)


def plain(value: object) -> object:
    """Return a value in a form that can be compared."""
    match value:
        case np.ndarray():
            return value.tolist()
        case dict():
            return {key: plain(each) for key, each in value.items()}
        case list() | tuple():
            return [plain(each) for each in value]
    return value


def test_a_number_does_not_change_when_another_thing_is_found() -> None:
    scenario = Scenario.from_mapping(
        {
            "name": "corner",
            "box": [[0, 0, 0], [12, 3, 6]],
            "blocks": [
                {"block": "stone", "fill": [[0, 0, 0], [12, 0, 6]]},
                {"block": "stone", "fill": [[5, 1, 0], [5, 3, 4]]},
            ],
            "containers": [{"at": [1, 1, 1], "items": {"apple": 1}}, {"at": [11, 1, 1]}],
            "agents": {
                "ann": {"position": [9.5, 1, 1.5], "inventory": {"bread": 1}},
                "aaron": {"position": [1.5, 1, 3.5], "inventory": {"apple": 1}},
            },
        }
    )
    env = parallel_env(scenario, agents=["ann"], senses="percepts", max_steps=9)
    observations, _ = env.reset(seed=0)
    before = env.known("ann")
    assert before.containers == ((11, 1, 1),)
    assert before.agents == ("ann",)
    assert observations["ann"]["containers_known"][:, 0].tolist() == [1, 0]
    # There is no second container, as far as she knows.
    unknown = env.action_space("ann").sample() | {"skill": env.skills.index("openContainer")}
    *_, infos = env.step({"ann": unknown | {"container": 1}})
    assert infos["ann"]["error"] == "it knows no container 1 so far"
    observations, *_ = env.step({"ann": env.action("goToPosition", position=(4, 1, 5))})
    after = env.known("ann")
    assert after.containers == ((11, 1, 1), (1, 1, 1))
    assert after.agents == ("ann", "aaron")
    assert after.items[: len(before.items)] == before.items
    assert observations["ann"]["me"] == 0
    env.close()


def test_sizes_are_those_of_the_file_and_can_be_given() -> None:
    hall = scene([("chest", (1, 1, 2), {"apple": 1})], [], {}, has_goal=False)
    assert parallel_env(hall).observation_space("ann")["containers"].shape == (1, 2)
    env = parallel_env(hall, sizes={"containers": 3, "levers": 2})
    assert env.observation_space("ann")["containers"].shape == (3, 2)
    assert "turnOnLever" in env.skills
    for sizes, message in (
        ({"chairs": 1}, "sizes names 'chairs'; kinds are agents, items"),
        ({"levers": -1}, "sizes gives -1 levers; give a whole number from 0 on"),
    ):
        with pytest.raises(bn.InputError, match=message):
            parallel_env(hall, sizes=sizes)
    with pytest.raises(bn.InputError, match=r"containers in this .* is 1, .* room for 0; .*sizes="):
        parallel_env(hall, sizes={"containers": 0})
