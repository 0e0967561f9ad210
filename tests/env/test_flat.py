"""Actions by number: the mask tells what can begin as far as the agent knows, and no more."""

import copy
import warnings
from contextlib import closing
from typing import Any

import numpy as np
import pytest
from tests.env.test_doors import SPOTS, scene

import beliefnest as bn
from beliefnest.env import parallel_env, vector_env
from beliefnest.skills.calls import Call

pytest.importorskip("pettingzoo", reason="the extra `pettingzoo` is not installed")
from gymnasium import spaces
from pettingzoo.test import parallel_api_test, parallel_seed_test

CHEST, EMPTY, FAR = (2, 1, 2), (2, 1, 6), (8, 1, 2)
ROOM = {
    "name": "room",
    "box": [[0, 0, 0], [9, 3, 8]],
    "blocks": [
        {"block": "stone", "fill": [[0, 0, 0], [9, 0, 8]]},
        {"block": "bricks", "fill": [[5, 1, 0], [5, 3, 8]]},
    ],
    "containers": [
        {"at": list(CHEST), "items": {"diamond": 1}},
        {"at": list(EMPTY)},
        {"at": list(FAR), "items": {"apple": 1}},
    ],
    "places": {"corner": [4, 1, 8], "yard": [8, 1, 8]},
    "agents": {
        "ann": {"position": [1.5, 1, 1.5], "inventory": {"bread": 1}},
        "bob": {"position": [3.5, 1, 3.5]},
        "carl": {"position": [8.5, 1, 6.5]},
    },
    "perception": {"max_visible_distance": 64},
}


def room(episode: dict[str, Any] | None = None, **options: Any) -> Any:
    scenario = bn.Scenario.from_mapping({**ROOM, **({"episode": episode} if episode else {})})
    return parallel_env(scenario, actions="flat", **{"senses": "percepts", **options})


def number_of(env: Any, agent: str, call: Call) -> int:
    return env.calls(agent).index(call)


def claim(item: str, place: tuple[int, int, int]) -> tuple[Any, ...]:
    told = bn.Claim.located(item, place)
    return (f"located {item} {' '.join(map(str, place))}", [told.plain()])


def test_a_mask_is_true_where_the_act_can_begin_as_far_as_the_agent_knows() -> None:
    with closing(room(agents=["ann", "bob"])) as env:
        observations, infos = env.reset(seed=0)
        space, seen = env.action_space("ann"), observations["ann"]
        assert isinstance(space, spaces.Discrete)
        assert env.observation_space("ann").contains(seen)
        assert seen["action_mask"].tolist() == infos["ann"]["action_mask"].tolist()
        assert env.action_masks().shape == (2, space.n)
        assert env.action_masks("ann").tolist() == seen["action_mask"].tolist()
        assert env.calls("ann")[0] == Call("doNothing")
        for call, can_begin in (
            (Call("doNothing"), True),
            (Call("openContainer", (CHEST,)), True),
            # It is not known yet what the chest holds.
            (Call("getItemFromChest", (CHEST, {"bread": 1})), True),
            (Call("depositItemIntoChest", (CHEST, {"bread": 1})), True),
            (Call("giveItemToOther", ("bob", "bread", 1)), True),
            (Call("giveItemToOther", ("ann", "bread", 1)), False),
            (Call("goToPosition", (CHEST, 2)), True),
            (Call("goToPosition", ((3, 1, 3), 2)), True),
            (Call("goToPosition", ((4, 1, 8), 0)), True),
            (Call("goToPosition", ((8, 1, 8), 0)), False),
            (Call("say", claim("bread", EMPTY)), True),
            (Call("whisper", ("bob", *claim("bread", CHEST))), True),
            (Call("whisper", ("ann", *claim("bread", CHEST))), False),
        ):
            assert bool(seen["action_mask"][number_of(env, "ann", call)]) is can_begin, call
        # What she does not know has numbers that stand for nothing.
        assert not any(call and "carl" in call.args for call in env.calls("ann"))
        assert not any(call and FAR in call.args for call in env.calls("ann"))
        unknown = env.calls("ann").index(None)
        assert not seen["action_mask"][unknown]
        *_, infos = env.step({"ann": unknown})
        assert infos["ann"]["error"].startswith("it knows no ")
        # Now she looks in.
        look = number_of(env, "ann", Call("openContainer", (CHEST,)))
        observations, *_, infos = env.step({"ann": look})
        assert infos["ann"]["error"] == ""
        after = observations["ann"]["action_mask"]
        assert number_of(env, "ann", Call("openContainer", (CHEST,))) == look
        for item, can_begin in (("bread", False), ("diamond", True)):
            take = Call("getItemFromChest", (CHEST, {item: 1}))
            assert bool(after[number_of(env, "ann", take)]) is can_begin
        env.nest.scripted_world.set_block(CHEST, "air")
        observations, *_ = env.step({})
        assert not observations["ann"]["action_mask"][look]


def test_masks_and_skills_agree_where_everything_is_known() -> None:
    kinds = {(*spot, row): kind for kind, spot in SPOTS.items() for row in range(15)}
    with closing(parallel_env(scene(), agents=["ann"], phrases=["hi"], actions="flat")) as env:
        observations, _ = env.reset(seed=0)
        mask, seen = observations["ann"]["action_mask"], set()
        for number, call in enumerate(env.calls("ann")):
            place = call.args[0] if call and call.args else None
            lacks = call and any(
                isinstance(arg, dict) and ("apple" in arg) is (call.skill != "getItemFromChest")
                for arg in call.args
            )
            if place in kinds and not lacks and call.skill != "goToPosition":
                assert bool(mask[number]) is (kinds[place] == "near"), call
                seen.add(call.skill)
        assert {"turnOnLever", "pressButton", "openDoor", "writeSign", "getItemFromChest"} <= seen


def test_only_agents_that_may_speak_have_claims() -> None:
    goal = {"goal": {"reach": [{"agent": "bob", "items": {"diamond": 1}}]}, "rounds": 3}
    with closing(room(goal)) as env:
        env.reset(seed=0)
        assert not any(call and call.skill in ("say", "whisper") for call in env.calls("ann"))
    with closing(room({**goal, "talk": ["bob"]}, agents=["ann", "bob"], phrases=["hi"])) as env:
        observations, _ = env.reset(seed=0)
        for agent, may_speak in (("ann", 0), ("bob", 1)):
            say = number_of(env, agent, Call("say", ("hi",)))
            assert observations[agent]["action_mask"][say] == may_speak
        assert env.action_space("ann") == env.action_space("bob")


def told_news(env: Any, agent: str, seen: Any, own: str = "") -> int:
    """Return the number of a claim about contents that an agent believes, and the other not.

    `own`: an item that the other one does not need.
    """
    things = env.known(agent)
    for number, call in enumerate(env.calls(agent)):
        told = call.args[1][0] if call is not None and call.skill == "say" else {}
        if told.get("item", own) != own and seen["action_mask"][number]:
            at = things.containers.index(tuple(told["place"])), things.items.index(told["item"])
            if seen["containers"][at] and not seen["beliefs_containers"][0][at]:
                return number
    return 0


def test_a_task_about_speech_is_won_with_claims_and_nested_beliefs_and_lost_without() -> None:
    with closing(parallel_env("help-find", actions="flat", nested=["/anne/sally"])) as env:
        for seed, speaks in ((0, True), (1, True), (1, False)):
            observations, _ = env.reset(seed=seed)
            is_told = not speaks
            while env.agents:
                number = 0 if is_told else told_news(env, "anne", observations["anne"])
                is_told = is_told or number > 0
                observations, *_, infos = env.step({"anne": number})
            assert infos["anne"]["success"] is speaks


def test_what_is_needed_is_told_and_the_own_errand_done() -> None:
    with closing(parallel_env("tell-what-is-needed", actions="flat", nested=["/nora/max"])) as env:
        observations, _ = env.reset(seed=0)
        books = [
            place
            for place, box in env.nest["/nora"].state.containers.items()
            if "book" in box.items
        ]
        fetch = Call("getItemFromChest", (*books, {"book": 1}))
        news = told_news(env, "nora", observations["nora"], "book")
        for number in (news, number_of(env, "nora", fetch)):
            env.step({"nora": number})
        while env.agents:
            *_, infos = env.step({"nora": 0})
        assert infos["nora"]["success"]


def builders_call(env: Any, agent: str, other: str, has_spoken: bool) -> Call:
    """Return what a builder of *blueprint* does: describe what the other lacks, then build."""
    mine, others = (env.nest[path].state for path in (f"/{agent}", f"/{agent}/{other}"))
    pairs = [condition.fact.blocks for condition in env.view(agent).goal.conditions]
    for place, model in pairs:
        wanted, there = mine.blocks[model], mine.blocks[place]
        if wanted is not None and others.blocks[model] is None and not has_spoken:
            told = bn.Claim.block(model, wanted)
            x, y, z = model
            return Call("say", (f"block {wanted} {x} {y} {z}", [told.plain()]))
    for place, model in pairs:
        wanted, there = mine.blocks[model], mine.blocks[place]
        if wanted in (None, there) or (place[0] < 13) is not (agent == "anne"):
            continue
        if there != "air":
            return Call("mineBlock", (place, there))
        if mine.agents[agent].inventory.get(wanted, 0):
            return Call("placeItem", (wanted, place))
        near = min(mine.containers, key=lambda at: abs(at[0] - place[0]))
        return Call("getItemFromChest", (near, {wanted: 1}))
    return Call("doNothing")


def test_a_blueprint_is_built_by_number() -> None:
    with closing(parallel_env("blueprint", actions="flat", nested=1)) as env:
        env.reset(seed=0)
        partner, first = {"anne": "bob", "bob": "anne"}, True
        while env.agents:
            chosen = {}
            for agent, other in partner.items():
                call = builders_call(env, agent, other, not first)
                chosen[agent] = number_of(env, agent, call)
                assert env.action_masks(agent)[chosen[agent]], call
            first = False
            *_, infos = env.step(chosen)
        assert infos["anne"]["success"]


def test_cells_are_gone_to_broken_filled_and_described_as_far_as_the_agent_knows() -> None:
    wall, free, hidden = (5, 1, 1), (4, 1, 4), (8, 1, 3)
    cells, held = [hidden, wall, free], {"bread": 1, "oak_planks": 1}
    scene = {
        **ROOM,
        "agents": {**ROOM["agents"], "ann": {"position": [1.5, 1, 1.5], "inventory": held}},
    }
    scenario = bn.Scenario.from_mapping(scene)
    with closing(
        parallel_env(scenario, actions="flat", cells=cells, agents=["ann"], senses="percepts")
    ) as env:
        observations, _ = env.reset(seed=0)
        calls, mask = env.calls("ann"), observations["ann"]["action_mask"]
        for call, can_begin in (
            (Call("mineBlock", (wall, "bricks")), True),
            (Call("mineBlock", (free, "air")), False),
            (Call("placeItem", ("oak_planks", free)), True),
            (Call("placeItem", ("oak_planks", wall)), False),
            (Call("placeItem", ("bread", free)), False),
            (Call("placeItem", ("oak_planks", hidden)), False),
            (Call("goToPosition", (free, 0)), True),
            (Call("goToPosition", (hidden, 0)), False),
        ):
            assert bool(mask[calls.index(call)]) is can_begin, call
        told = [call.args[1][0] for call in calls if call and call.skill == "say"]
        assert {tuple(each["place"]) for each in told if each["kind"] == "block"} == {wall, free}
        # The number of what is behind the wall stands for nothing: she does not know what is there.
        assert not any(call and call.skill == "mineBlock" and hidden in call.args for call in calls)
        observations, *_, infos = env.step(
            {"ann": calls.index(Call("placeItem", ("oak_planks", free)))}
        )
        assert infos["ann"]["error"] == ""
        assert env.nest["/"].state.blocks[free] == "oak_planks"


@pytest.mark.parametrize("cells", [[(1, 2)], [(1, 2, 0.5)], ["abc"], [3], [(99, 0, 0)]])
def test_cells_that_are_none_are_refused(cells: Any) -> None:
    with pytest.raises(bn.InputError, match="cells has"):
        room(cells=cells)


def test_the_conformance_tests_of_the_library_pass_with_masks() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        parallel_api_test(room(max_steps=6), num_cycles=5)
    parallel_seed_test(lambda: room(max_steps=4, observations="dict"), num_cycles=2)


def test_copies_have_masks_for_each_row_and_go_on_alike() -> None:
    scenario = bn.Scenario.from_mapping(ROOM)
    with closing(vector_env(scenario, 2, actions="flat", max_steps=4)) as env:
        observations, infos = env.reset(seed=0)
        assert observations["action_mask"].tolist() == env.action_masks().tolist()
        assert infos["action_mask"].shape == env.action_masks().shape
    with closing(room(step_ticks=2)) as env:
        env.reset(seed=0)
        go = number_of(env, "ann", Call("goToPosition", ((4, 1, 8), 0)))
        *_, infos = env.step({"ann": go})
        assert infos["ann"]["busy"]
        with closing(copy.deepcopy(env)) as other:
            assert repr(env.step({"bob": np.int64(0)})) == repr(other.step({"bob": np.int64(0)}))


def test_more_actions_than_fit_are_refused_and_parts_of_a_dict_are_not_counted() -> None:
    for many in (400, 10**9):
        with pytest.raises(bn.InputError, match="more than 100,000 actions; give smaller sizes"):
            room(sizes={"containers": many, "items": 300}, observations="dict")
    scenario = bn.Scenario.from_mapping(ROOM)
    parallel_env(scenario, actions="skills", sizes={"containers": 400, "items": 300}).close()


@pytest.mark.parametrize("action", [-1, 10**6, 1.5, "x", None, {}, float("inf"), 10**30, True])
def test_numbers_that_do_not_exist_are_refused_in_one_line(action: Any) -> None:
    with closing(room(agents=["ann"])) as env:
        env.reset(seed=0)
        with pytest.raises(bn.InputError, match="is not in the action space; give a number from"):
            env.step({"ann": action})
        # Names are understood as well.
        *_, infos = env.step({"ann": env.action("openContainer", container=CHEST)})
        assert infos["ann"]["error"] == ""
