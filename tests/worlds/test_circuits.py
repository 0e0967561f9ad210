"""Circuits of redstone do the same in the scripted world as in Minecraft, tick by tick."""

import random
from collections.abc import Iterator

import numpy as np
import pytest
from tests.profiles import at_night

from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, Box, EventKind, Position
from beliefnest.worlds.by_name import open_world
from beliefnest.worlds.protocol import World

SIZE = 8
BOX = Box((0, 0, 0), (SIZE, 6, SIZE))
LOW = ("air", "stone", "glass", "redstone_wire", "redstone_lamp", "iron_door", "iron_trapdoor")
SWITCHES = ("lever", "stone_button", "oak_button")
ACTS = (EventKind.USE_LEVER, EventKind.PRESS_BUTTON)
Told = list[tuple[int, EventKind, dict[str, object]]]


@pytest.fixture(scope="module")
def worlds() -> Iterator[dict[str, World]]:
    opened = {name: open_world(name, 0) for name in ("scripted", "embedded")}
    yield opened
    for each in opened.values():
        each.close()


def played(
    world: World, blocks: dict[Position, str], program: str, at: tuple[float, float, float]
) -> tuple[Told, Snapshot]:
    """Return the acts and changes of blocks that a program brings about, and what is there then."""
    registry = Registry.load()
    grid = np.zeros(BOX.shape, dtype=np.int32)
    grid[:, 0, :] = registry.state_id("stone")
    for place, text in blocks.items():
        grid[BOX.index(place)] = registry.state_id(text)
    frames: list[Frame] = []
    agents = {"sally": AgentState(at)}
    body = world.open_body(
        "/", "seed", Snapshot(0, BOX, Terrain.of(grid), {}, agents), frames.append
    )
    try:
        result = body.run({"sally": program}, 4000)["sally"]
        there = body.snapshot()
    finally:
        body.close()
    assert result.ok, (result.error, there.agents)
    kinds = (*ACTS, EventKind.BLOCK_UPDATE)
    told = [(f.tick, e.kind, dict(e.detail)) for f in frames for e in f.events if e.kind in kinds]
    return told, there


def since_acts(told: Told) -> Told:
    """Return what was told, with ticks since the latest act, which walking does not change."""
    acts = sorted({tick for tick, kind, _ in told if kind in ACTS})
    assert acts
    return [(t - max(a for a in acts if a <= t), kind, detail) for t, kind, detail in told]


def circuit(chance: random.Random) -> tuple[dict[Position, str], list[Position]]:
    """Return random blocks on a table with a free way around it, and the switches at its edge."""
    inner = [(x, z) for x in range(1, SIZE) for z in range(1, SIZE)]
    edge = [(x, z) for x, z in inner if {x, z} & {1, SIZE - 1}]
    switches = [(x, 3, z) for x, z in chance.sample(edge, 4)]
    blocks = {(x, y, z): "stone" for x, z in inner for y in (1, 2)}
    for x, z in inner:
        low, high = (x, 3, z), (x, 4, z)
        if low in switches:
            name = chance.choice(SWITCHES)
            blocks[low] = f"{name}[face=floor,facing={chance.choice(['north', 'east'])}]"
            continue
        name = chance.choices(LOW, (3, 3, 2, 12, 2, 2, 1))[0]
        if name == "iron_door":
            facing = chance.choice(["north", "west"])
            for place, half in ((low, "lower"), (high, "upper")):
                blocks[place] = f"iron_door[facing={facing},half={half}]"
            continue
        blocks[low] = name
        if name in ("stone", "glass") and chance.random() < 0.7:
            blocks[high] = "redstone_wire"
    return blocks, switches


@pytest.mark.parametrize("seed", range(at_night(200, 6)))
def test_random_circuits_are_alike(worlds: dict[str, World], seed: int) -> None:
    chance = random.Random(seed)
    blocks, switches = circuit(chance)
    calls = []
    for place in (*switches, *switches):
        lever = blocks[place].startswith("lever")
        skill = chance.choice(["turnOnLever", "turnOffLever"]) if lever else "pressButton"
        calls.append(f"await {skill}(bot, new Vec3{place}); await bot.waitForTicks(45)")
    program = "\n".join(calls)
    scripted, minecraft = (
        played(world, blocks, program, (0.5, 1.0, 0.5))[0] for world in worlds.values()
    )
    assert since_acts(scripted) == since_acts(minecraft)


def iron_door(x: int, z: int) -> dict[Position, str]:
    return {
        (x, 1, z): "iron_door[facing=east,half=lower]",
        (x, 2, z): "iron_door[facing=east,half=upper]",
    }


def test_an_agent_goes_through_an_iron_door_that_it_opened(worlds: dict[str, World]) -> None:
    wall = {(4, y, z): "stone" for y in (1, 2) for z in range(SIZE + 1)}
    blocks = {**wall, **iron_door(4, 4), (2, 1, 4): "redstone_wire", (3, 1, 4): "redstone_wire"}
    blocks |= {(2, 1, 5): "lever[face=floor]"}
    through = "await goToPosition(bot, new Vec3(7, 1, 4), 0)"
    for world in worlds.values():
        shut = f"try {{ {through} }} catch (error) {{ await turnOnLever(bot, new Vec3(2, 1, 5)) }}"
        told, there = played(world, blocks, f"{shut}\n{through}", (0.5, 1.0, 4.5))
        x, _, z = there.agents["sally"].position
        assert (int(x), int(z)) == (7, 4)
        opened = [detail["position"] for _, _, detail in told if "open=true" in str(detail)]
        assert opened == [(4, 1, 4), (4, 2, 4)]


@pytest.mark.parametrize("name", ["stone_pressure_plate", "oak_pressure_plate"])
def test_who_stands_on_a_plate_holds_the_door_open(worlds: dict[str, World], name: str) -> None:
    program = (
        "await goToPosition(bot, new Vec3(4, 1, 4), 0); await bot.waitForTicks(30)\n"
        "await goToPosition(bot, new Vec3(1, 1, 1), 0); await bot.waitForTicks(45)"
    )
    blocks = {(4, 1, 4): name, **iron_door(5, 4)}
    moved = []
    for world in worlds.values():
        told, _ = played(world, blocks, program, (0.5, 1.0, 4.5))
        pressed = told[0][0]
        left = told[-1][0]
        # A plate looks every 20 ticks whether somebody stands on it.
        assert (left - pressed) % 20 == 0
        assert left - pressed > 30
        moved.append([(tick == pressed, detail) for tick, _, detail in told])
    assert moved[0] == moved[1]
    assert len(moved[0]) == 6


def test_an_agent_gets_past_the_corner_of_an_iron_door(worlds: dict[str, World]) -> None:
    # From this edge of its block, the pathfinder of Minecraft's bots takes a way that it cannot go.
    door = {
        (4, 1, 4): "iron_door[facing=north,half=lower]",
        (4, 2, 4): "iron_door[facing=north,half=upper]",
    }
    for world in worlds.values():
        program = "await goToPosition(bot, new Vec3(4, 1, 5), 0)"
        _, there = played(world, door, program, (5.5, 1.0, 4.319474))
        x, _, z = there.agents["sally"].position
        assert (int(x), int(z)) == (4, 5)
