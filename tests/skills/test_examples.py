"""The example of every skill, which docs/skills.md shows, runs in Minecraft."""

from collections.abc import Iterator
from typing import Any

import pytest

import beliefnest as bn
from beliefnest.skills import skills

pytestmark = pytest.mark.usefixtures("kept_worlds")

EXAMPLES = {skill.name: skill.example for skill in skills()}
AT, DOOR, LEVER = (4, -51, 2), (4, -51, -3), (3, -50, 0)
ROOM: dict[str, Any] = {
    "name": "examples",
    "box": [[-10, -52, -10], [10, -47, 10]],
    "blocks": [
        {"block": "stone", "fill": [[-10, -52, -10], [10, -52, 10]]},
        {"block": "stone", "at": [3, -51, 0]},
    ],
    "containers": [
        {"at": [2, -51, -4], "block": "chest[facing=south]", "items": {"diamond": 1}},
        {"at": [-2, -51, -4], "block": "chest[facing=south]"},
    ],
    "agents": {
        "sally": {
            "position": [1.5, -51, 1.5],
            "food": 10,
            "inventory": {
                "diamond": 2,
                "oak_log": 1,
                "crafting_table": 1,
                "raw_iron": 3,
                "coal": 1,
                "bread": 1,
                "iron_chestplate": 1,
            },
        },
        "anne": {"position": [-1.5, -51, 2.5]},
    },
}
THERE = {
    "mineBlock": {AT: "oak_log"},
    "smeltItem": {AT: "furnace[facing=south]"},
    "sleep": {
        AT: "red_bed[part=foot,facing=north]",
        (4, -51, 1): "red_bed[part=head,facing=north]",
    },
    "turnOnLever": {LEVER: "lever[face=floor,powered=false]"},
    "turnOffLever": {LEVER: "lever[face=floor,powered=true]"},
    "pressButton": {LEVER: "stone_button[face=floor]"},
    "openDoor": {DOOR: "oak_door[half=lower,open=false]", (4, -50, -3): "oak_door[half=upper]"},
    "closeDoor": {
        DOOR: "oak_door[half=lower,open=true]",
        (4, -50, -3): "oak_door[half=upper,open=true]",
    },
    "writeSign": {DOOR: "oak_sign"},
    "readSign": {DOOR: "oak_sign"},
    "givePlacedItemBack": {AT: "crafting_table"},
}
"""Blocks in the world in which the example of a skill runs."""


MEANWHILE = {
    "receiveItemFromOther": {"sally": "await giveItemToOther(bot, 'anne', 'diamond', 1)"},
    "waitForChat": {"anne": "await say(bot, 'Here I am.')"},
    "waitUntil": {"anne": "await goToPosition(bot, new Vec3(0, -51, -4), 0)"},
}
"""Programs of another agent meanwhile."""
REFUSED = {"waitForMobRemoved": "is still there after 10 seconds"}
"""There are no mobs, and players stay."""


@pytest.fixture(scope="module")
def nest() -> Iterator[bn.Nest]:
    with bn.Nest.open(bn.Scenario.from_mapping(ROOM)) as nest:
        yield nest


@pytest.mark.parametrize("skill", EXAMPLES)
def test_the_example_runs(nest: bn.Nest, skill: str) -> None:
    world = nest["/"]
    world.switch("main")
    world.switch(f"{skill} is tried")
    world.edit(blocks=THERE.get(skill, {}))
    meanwhile = MEANWHILE.get(skill, {})
    agent = "anne" if "sally" in meanwhile else "sally"
    result = world.run_all({agent: EXAMPLES[skill], **meanwhile})[agent]
    if skill in REFUSED:
        assert result.error is not None
        assert REFUSED[skill] in result.error.message
    else:
        assert result.ok, result.error
