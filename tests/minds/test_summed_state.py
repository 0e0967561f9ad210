"""States of histories summed up from their entries: equal to the folded ones."""

import random

import numpy as np
import pytest
from tests.profiles import few_by_day

import beliefnest as bn
from beliefnest.errors import WorldError

DOOR, LEVER, SIGN, BOX = (5, 1, 1), (1, 1, 3), (1, 1, 1), (3, 1, 2)
RIGHT, LEFT, HIDDEN = (4, 1, 3), (3, 1, 3), (7, 1, 0)
PLAIN = {(x, 0, z): "stone" for x in range(8) for z in range(4)}
SHUT = "oak_door[facing=east,half={},open=false]"
HALVES = {
    place: f"chest[facing=north,type={side}]" for place, side in ((RIGHT, "right"), (LEFT, "left"))
}
DEEDS = (
    lambda world, chance: world.use_door("blue", DOOR, open=chance.random() < 0.5),
    lambda world, chance: world.use_lever("blue", LEVER, powered=chance.random() < 0.5),
    lambda world, chance: world.mine("blue", chance.choice([BOX, (2, 1, 2)])),
    lambda world, chance: world.put("blue", "red_wool", (2, 1, 2)),
    lambda world, chance: world.withdraw("blue", RIGHT, {"apple": 1}),
    lambda world, chance: world.deposit("blue", LEFT, {"red_wool": 1}),
    lambda world, chance: world.give("blue", "red", {"red_wool": 1}),
    lambda world, chance: world.write_sign("blue", SIGN, chance.choice(["soup", "stew"])),
    lambda world, chance: world.say("blue", "soup", [bn.Claim.located("apple", RIGHT)]),
    lambda world, chance: world.set_block((6, 1, 3), chance.choice(["chest", "barrel", "air"])),
    lambda world, chance: world.place_agent("blue", (2.5, 1, chance.choice([0.5, 1.5]))),
)
WALK = """
await openDoor(bot, new Vec3(5, 1, 1))
await goToPosition(bot, new Vec3(4, 1, 2), 0)
await say(bot, "an apple")
try { await getItemFromChest(bot, new Vec3(3, 1, 3), { apple: 1 }) } catch {}
"""


def hall():
    """Red and Blue stand in a hall; Gold, behind a wall, is known to nobody."""
    things = {
        BOX: "oak_planks",
        DOOR: SHUT.format("lower"),
        (5, 2, 1): SHUT.format("upper"),
        LEVER: "lever[face=floor]",
        SIGN: "oak_sign",
        (6, 1, 0): "bricks",
        (6, 2, 0): "bricks",
        **HALVES,
    }
    return bn.ScriptedWorld(
        box=((0, 0, 0), (7, 3, 3)),
        blocks={**PLAIN, **things},
        agents={"red": (0.5, 1, 0.5), "blue": (2.5, 1, 1.5), "gold": (7.5, 1, 0.5)},
        containers={RIGHT: {"apple": 3}},
        inventories={"blue": {"red_wool": 5}},
    )


def assert_sums_are_folded(history):
    """Compare a history's state at every tick with the one that is folded from its timeline."""
    kinds = set()
    for tick in range(history.tick + 1):
        shown = history.at(tick)
        recording, path = shown._recording, shown._path
        moment = recording.moment(path, tick)
        summed, folded = (
            shown.state,
            recording.history.state(moment.timeline, path, moment.entries, tick),
        )
        kinds |= {type(summed), type(folded)}
        assert summed == folded and folded == summed
        assert summed.snapshot() == folded.snapshot()
        assert summed.count_of_events == folded.count_of_events
        for count in range(folded.count_of_events + 1):
            assert summed.events_since(count) == folded.events_since(count)
            assert np.array_equal(summed.perceived_since(count), folded.perceived_since(count))
        assert summed.containers.get(LEFT) == folded.containers.get(LEFT)
    assert len(kinds) == 2
    for name in summed.agents:
        assert np.array_equal(summed.visible_from(name), folded.visible_from(name))
    for place in (DOOR, SIGN, RIGHT, LEFT, BOX, HIDDEN):
        assert summed.blocks.basis(place) == folded.blocks.basis(place)
        assert summed.blocks.current(place) == folded.blocks.current(place)


@pytest.mark.filterwarnings("ignore::beliefnest.minds.imagining.imagining.ImaginationWarning")
@pytest.mark.parametrize("path", ["/", "/red"])
@pytest.mark.parametrize("seed", few_by_day(range(12)))
def test_summed_states_are_the_folded_ones(seed, path):
    chance = random.Random(seed)
    world = hall()
    doubt = {"apple": {"containers": {HIDDEN: {"apple": 1}}}, "none": {"containers": {HIDDEN: {}}}}
    model = bn.MindModel(
        "red",
        {"here": {"at": (4, 1, 2)}, "apple": {"item": "apple"}},
        {"here": [0, 20], "apple": [0, 20]},
        doubt=doubt,
        actual="unknown",
        rationality=0.2,
    )
    statics = ["stone", "bricks"]
    with bn.Nest(
        world, static_blocks=statics, perception=bn.Perception(testimony="accept")
    ) as nest:
        world.step(2)
        for _ in range(12):
            try:
                chance.choice(DEEDS)(world, chance)
            except WorldError:
                world.step(1)
        if chance.random() < 0.5:
            nest[path].switch("edited", at=3)
            nest[path].step(2)
            nest[path].edit(blocks={(2, 1, 0): "chest", BOX: "air"}, containers={RIGHT: {}})
            nest[path].step(4)
        end = [{"agent": "red", "at": (4, 1, 2), "mistaken": 0.5}]
        actors = {"red": {"walk": WALK, "model": model}}
        imagined = nest[path].imagine(1, actors=actors, n=6, seed=seed, evidence=end)
        assert len(imagined)
        for history in imagined:
            assert_sums_are_folded(history)
