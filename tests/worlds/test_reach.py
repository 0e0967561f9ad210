"""Reach of hands in both worlds: nothing through a wall, or out of reach."""

from collections.abc import Iterator, Mapping

import numpy as np
import pytest
from tests.profiles import few_by_day
from tests.shared_worlds import WORLDS

from beliefnest.skills.calls import Call
from beliefnest.world.frames import Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, Box, Position
from beliefnest.worlds.by_name import open_world
from beliefnest.worlds.protocol import World

BOX = Box((0, 0, 0), (12, 11, 14))
SPOTS: Mapping[str, tuple[int, int]] = {"near": (2, 1), "behind a wall": (7, 1), "high up": (3, 8)}
"""By kind, x and y of the things; each skill has a row of its own."""
PEOPLE = {"near": "cat", "behind a wall": "bob", "high up": "dan", "wrong": "zoe"}
THINGS = {
    1: "chest[facing=north,type=single,waterlogged=false]",
    3: "lever[face=floor,facing=north,powered=false]",
    5: "lever[face=floor,facing=north,powered=true]",
    7: "stone_button[face=floor,facing=north,powered=false]",
    9: "white_wool",
    11: "oak_fence_gate[facing=east,in_wall=false,open=false,powered=false]",
    13: "oak_sign[rotation=0,waterlogged=false]",
}
ITEMS = {"diamond": 1, "dirt": 1}


def calls(kind: str) -> Mapping[str, Call]:
    """Return a call of each skill that uses something of a kind."""
    x, y = SPOTS.get(kind, (4, 1))
    chest, off, on, button, wool, gate, sign = (
        (x, y, z) for z in ((1, 3, 5, 7, 9, 11, 13) if kind in SPOTS else (2,) * 7)
    )
    return {
        "take": Call("getItemFromChest", (chest, {"apple": 1})),
        "put": Call("depositItemIntoChest", (chest, {"diamond": 1})),
        "look in": Call("openContainer", (chest,)),
        "switch on": Call("turnOnLever", (off,)),
        "switch off": Call("turnOffLever", (on,)),
        "press": Call("pressButton", (button,)),
        "break": Call("mineBlock", (wool, "white_wool")),
        "open": Call("openDoor", (gate,)),
        "write": Call("writeSign", (sign, "hello")),
        "place": Call("placeItem", ("dirt" if kind in SPOTS else "stone", (x, y, 8))),
        "give": Call("giveItemToOther", (PEOPLE[kind], "diamond", 1)),
    }


def start() -> Snapshot:
    registry = Registry.load()
    blocks = np.zeros(BOX.shape, dtype=np.int32)
    stone = registry.state_id("stone")
    blocks[:, 0, :] = stone
    blocks[6, :, :] = stone
    blocks[3, 7, :] = stone
    containers: dict[Position, dict[str, int]] = {}
    for x, y in SPOTS.values():
        for z, text in THINGS.items():
            blocks[BOX.index((x, y, z))] = registry.state_id(text)
        containers[(x, y, 1)] = {"apple": 1}
    agents = {"ann": AgentState((4.5, 1.0, 4.5), inventory=dict(ITEMS))}
    agents |= {PEOPLE[kind]: AgentState((x + 0.5, float(y), 2.5)) for kind, (x, y) in SPOTS.items()}
    return Snapshot(0, BOX, Terrain.of(blocks), containers, agents)


@pytest.fixture(scope="module")
def worlds() -> Iterator[Mapping[str, World]]:
    opened = {name: open_world(name, 0) for name in WORLDS}
    yield opened
    for world in opened.values():
        world.close()


def played(world: World, call: Call) -> tuple[bool, dict[str, object]]:
    """Return whether a call succeeded, and what is different afterwards."""
    body = world.open_body("/", "seed", start(), lambda frame: None)
    before = body.snapshot()
    result = body.run({"ann": call.program}, 600)["ann"]
    after = body.snapshot()
    body.close()
    registry = Registry.load()
    blocks = {
        place: registry.text(int(after.blocks[BOX.index(place)]))
        for place in ((x, y, z) for x, y in SPOTS.values() for z in range(15))
        if after.blocks[BOX.index(place)] != before.blocks[BOX.index(place)]
    }
    # What is thrown against a wall falls down in Minecraft only.
    held = {name: dict(each.inventory) for name, each in after.agents.items() if name != "ann"}
    told = dict(after.containers) != dict(before.containers) and dict(after.containers)
    return result.ok, {"blocks": blocks, "held": held, "containers": told, "signs": after.signs}


@pytest.mark.parametrize("skill", few_by_day(calls("near"), 4))
def test_a_skill_reaches_as_far_in_both_worlds(worlds: Mapping[str, World], skill: str) -> None:
    for kind in (*SPOTS, "wrong"):
        call = calls(kind)[skill]
        scripted, embedded = (played(worlds[name], call) for name in ("scripted", "embedded"))
        assert scripted == embedded, kind
        assert scripted[0] is (kind == "near"), kind
        _, nothing = played(worlds["scripted"], Call("waitTicks", (1,)))
        if kind != "near":
            assert scripted[1] == nothing, kind
