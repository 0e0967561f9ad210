"""Every world keeps the same contract: the same acts are the same facts, told the same way."""

import math
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from tests.servers import serving
from tests.shared_worlds import WORLDS

from beliefnest.testing import check_world
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, Box, EventKind
from beliefnest.worlds.by_name import open_world
from beliefnest.worlds.protocol import Body, World
from beliefnest.worlds.scripted.nest_world import ScriptedBody

CHEST = (2, 1, 2)
BOX = Box((0, 0, 0), (6, 4, 6))
SALLY, ANNE = (1.5, 1.0, 3.5), (4.5, 1.0, 2.5)

ACTS: dict[str, tuple[str, Callable[[ScriptedBody], None], str]] = {
    "deposit": (
        "sally",
        lambda body: body.world.deposit("sally", CHEST, {"diamond": 1}),
        "await depositItemIntoChest(bot, new Vec3(2, 1, 2), {diamond: 1})",
    ),
    "withdraw": (
        "anne",
        lambda body: body.world.withdraw("anne", CHEST, {"emerald": 2}),
        "await getItemFromChest(bot, new Vec3(2, 1, 2), {emerald: 2})",
    ),
    "open": (
        "anne",
        lambda body: body.world.open("anne", CHEST),
        "const c = await bot.openContainer(bot.blockAt(new Vec3(2, 1, 2))); c.close()",
    ),
    "say": ("sally", lambda body: body.world.say("sally", "hello"), "bot.chat('hello')"),
    "whisper": (
        "sally",
        lambda body: body.world.whisper("sally", "anne", "psst"),
        "await whisper(bot, 'anne', 'psst')",
    ),
    "think": ("anne", lambda body: body.world.think("anne", "hm"), "await think(bot, 'hm')"),
}


@pytest.fixture(params=[*WORLDS, "server"], scope="module")
def world(request: pytest.FixtureRequest) -> Iterator[World]:
    if request.param != "server":
        opened = open_world(request.param, 0)
        yield opened
        opened.close()
        return
    with serving(latency=10) as server:
        opened = open_world(server.address(at="0,32"), 0)
        yield opened
        opened.close()


@pytest.fixture
def frames() -> list[Frame]:
    return []


@pytest.fixture
def body(world: World, frames: list[Frame]) -> Iterator[Body]:
    opened = world.open_body("/", "seed", start(), frames.append)
    yield opened
    opened.close()


def start() -> Snapshot:
    registry = Registry.load()
    blocks = np.zeros(BOX.shape, dtype=np.int32)
    blocks[:, 0, :] = registry.state_id("stone")
    blocks[BOX.index(CHEST)] = registry.state_id("chest")
    agents = {
        "sally": AgentState(SALLY, inventory={"diamond": 2}),
        "anne": AgentState(ANNE, 1.5, 0.25, inventory={"bread": 3}),
    }
    return Snapshot(7, BOX, Terrain.of(blocks), {CHEST: {"emerald": 2}}, agents)


def do(body: Body, act: str) -> None:
    actor, told, program = ACTS[act]
    if isinstance(body, ScriptedBody):
        told(body)
        return
    result = body.run({actor: program}, 200)[actor]
    assert result.ok, result.error


def deeds(frames: list[Frame]) -> list[tuple[EventKind, str | None, dict[str, object]]]:
    told = [event for frame in frames for event in frame.events]
    left_out = (EventKind.MOVE_TO, EventKind.OPEN_CONTAINER)
    return [(e.kind, e.actor, dict(e.detail)) for e in told if e.kind not in left_out]


def test_a_world_passes_the_checks_for_worlds_of_others(world):
    check_world(world)


def test_the_same_acts_are_the_same_facts(body, frames):
    for act in ("deposit", "withdraw", "say", "whisper", "think"):
        do(body, act)
    assert deeds(frames) == [
        (EventKind.DEPOSIT_ITEM_INTO_CHEST, "sally", {"position": CHEST, "items": {"diamond": 1}}),
        (EventKind.GET_ITEM_FROM_CHEST, "anne", {"position": CHEST, "items": {"emerald": 2}}),
        (EventKind.CHAT, "sally", {"text": "hello"}),
        (EventKind.CHAT, "sally", {"text": "psst", "to": "anne"}),
        (EventKind.THINK, "anne", {"text": "hm"}),
    ]
    there = body.snapshot()
    assert there.containers == {CHEST: {"diamond": 1}}
    assert there.agents["sally"].inventory == {"diamond": 1}
    assert there.agents["anne"].inventory == {"bread": 3, "emerald": 2}


def test_looking_in_is_told_without_what_is_inside(body, frames):
    do(body, "open")
    told = [event for frame in frames for event in frame.events]
    assert [(e.kind, e.actor, dict(e.detail)) for e in told] == [
        (EventKind.OPEN_CONTAINER, "anne", {"position": CHEST})
    ]


def test_one_walk_leads_through_two_doors_and_another_into_a_doorway(world, frames):
    registry, blocks = Registry.load(), start().blocks.draft()
    for x, leaf in ((3, "open=true"), (5, "open=false")):
        blocks[x, 1:, :] = registry.state_id("stone")
        for y, half in ((1, "lower"), (2, "upper")):
            state = f"oak_door[half={half},facing=east,{leaf}]"
            blocks[BOX.index((x, y, 3))] = registry.state_id(state)
    agents = {"sally": AgentState(SALLY)}
    body = world.open_body(
        "/doors", "seed", Snapshot(7, BOX, blocks.terrain(), {}, agents), frames.append
    )
    for x in (6, 3):
        program = f"await goToPosition(bot, new Vec3({x}, 1, 3), 0)"
        result = body.run({"sally": program}, 400)["sally"]
        assert result.ok, result.error
        assert math.floor(body.snapshot().agents["sally"].position[0]) == x
    body.close()
