"""Branches in Minecraft: what is restored, and who is not disturbed (semantics, section 6)."""

import threading

import numpy as np
import pytest

import beliefnest as bn
from beliefnest.errors import BeliefNestError
from beliefnest.worlds.by_name import Worlds

BOX, LEVER = (1, 1, 5), (8, 1, 2)
ROOM = {
    "name": "room",
    "box": [[0, 0, 0], [11, 4, 11]],
    "blocks": [
        {"block": "stone", "fill": [[0, 0, 0], [11, 0, 11]]},
        {"block": "dirt", "at": [5, 1, 5]},
        {"block": "lever[face=floor,facing=north,powered=false]", "at": list(LEVER)},
    ],
    "containers": [{"at": list(BOX), "items": {"apple": 3}}],
    "agents": {
        "ann": {
            "position": [2.5, 1, 3.5],
            "inventory": {"bread": 2, "stone": 4, "iron_helmet": 1},
        },
        "bob": {"position": [9.5, 1, 9.5], "inventory": {"diamond": 1}},
    },
    "static_blocks": ["stone"],
}
EVERYTHING = """
await getItemFromChest(bot, new Vec3(1, 1, 5), {apple: 2})
await mineBlock(bot, new Vec3(5, 1, 5), 'dirt')
await placeItem(bot, 'stone', new Vec3(4, 1, 7))
await equip(bot, 'iron_helmet', 'head')
await turnOnLever(bot, new Vec3(8, 1, 2))
await bot.toss(bot.registry.itemsByName.bread.id, null, 1)
await waitTicks(bot, 30)
"""
DROP = """
await goToPosition(bot, new Vec3(9, 1, 3))
await bot.toss(bot.registry.itemsByName.diamond.id, null, 1)
await waitTicks(bot, 20)
"""
WALK = "await goToPosition(bot, new Vec3(3, 1, 9)); bot.chat('here')"


@pytest.fixture(scope="module")
def worlds():
    with Worlds(0) as lending:
        yield lending


@pytest.fixture
def nest(worlds):
    with bn.Nest.open(bn.Scenario.from_mapping(ROOM), worlds=worlds) as opened:
        yield opened


def standing(nest, *path):
    """All there is in a simulator's body; angles as finely as the protocol tells them."""
    there = nest._engine.body(path).snapshot()
    return {
        "tick": there.tick,
        "blocks": there.blocks.dense().tolist(),
        "containers": there.containers,
        "items": {
            n: (i.name, i.count, np.round(i.position, 3).tolist()) for n, i in there.items.items()
        },
        "agents": {
            n: (
                np.round(a.position, 4).tolist(),
                (round(a.yaw, 1), round(a.pitch, 1)),
                (dict(a.equipment), dict(a.inventory), a.health, a.food),
            )
            for n, a in there.agents.items()
        },
    }


def run(simulator, agent, program):
    result = simulator.run(agent, program)
    assert result.ok, result.error


def test_the_real_world_is_rolled_back_and_taken_up_again(nest):
    world = nest["/"]
    begun = standing(nest)
    world.switch("what if")
    assert standing(nest) == begun
    run(world, "ann", EVERYTHING)
    done = standing(nest)
    for part in begun:
        assert done[part] != begun[part], part
    world.switch("main")
    assert standing(nest) == begun
    run(world, "bob", DROP)
    other = standing(nest)
    for _ in range(2):
        world.switch("what if")
        assert standing(nest) == done
        world.switch("main")
        assert standing(nest) == other


def test_a_branch_from_the_past_is_as_it_was_then(nest):
    world = nest["/"]
    seen = {}
    for _ in range(4):
        run(world, "ann", "await goToPosition(bot, new Vec3(3, 1, 9)); await waitTicks(bot, 3)")
        run(world, "ann", "await goToPosition(bot, new Vec3(8, 1, 8)); await waitTicks(bot, 3)")
        seen[nest.tick] = standing(nest)
    run(world, "ann", EVERYTHING)
    for tick, then in reversed(seen.items()):
        world.switch(f"from {tick}", at=tick)
        assert standing(nest) == then


def test_simulators_on_branches_do_not_disturb_one_another_and_children_follow(nest):
    ann, bob = nest["/ann"], nest["/bob"]
    ann.switch("a")
    bob.switch("b")
    world_before, bob_before = standing(nest), standing(nest, "bob")
    run(ann, "ann", WALK)
    ann_after = standing(nest, "ann")
    assert (standing(nest), standing(nest, "bob")) == (world_before, bob_before)
    run(bob, "bob", WALK)
    assert (standing(nest), standing(nest, "ann")) == (world_before, ann_after)
    assert [text for _, _, text in nest["/ann/bob"].state.chat] == ["here"]
    assert (nest["/ann/bob"].mode, nest["/ann/bob"].tick) == ("follow", ann.tick)
    assert nest["/"].state.chat == []
    bob_before = standing(nest, "bob")
    ann.switch("a 2", at=0)
    assert nest["/ann/bob"].state.chat == []
    ann.switch("a")
    assert standing(nest, "ann") == ann_after
    ann.switch("follow")
    assert (ann.state.chat, ann.tick) == ([], nest.tick)
    assert standing(nest, "bob") == bob_before


def test_a_switch_waits_for_a_program_that_runs(nest):
    bob = nest["/bob"]
    bob.switch("b")
    begun = threading.Event()

    def program():
        with nest._recording.turn:
            begun.set()
            run(bob, "bob", "await waitTicks(bot, 100); bot.chat('late')")

    running = threading.Thread(target=program)
    running.start()
    begun.wait()
    bob.switch("after")
    running.join()
    assert [(info.key.branch, info.start, info.head) for info in bob.branches()] == [
        ("b", 0, bob.tick),
        ("after", bob.tick, bob.tick),
    ]
    assert [text for _, _, text in bob.state.chat] == ["late"]


def test_a_refused_call_leaves_the_body_as_it_was(nest):
    world = nest["/"]
    run(world, "bob", DROP)
    before = standing(nest)
    for call in (
        lambda: world.switch("past", at=nest.tick + 1),
        lambda: world.switch("main", at=0),
        lambda: world.switch("follow"),
        lambda: world.delete("main", recursive=True),
        lambda: world.rename("main", "follow"),
    ):
        with pytest.raises(BeliefNestError):
            call()
        assert standing(nest) == before
    assert [info.key.branch for info in world.branches()] == ["main"]
