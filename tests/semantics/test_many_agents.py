"""Laws of beliefs with many agents, in a box with chunks and in one without."""

import random

import pytest
from tests.nest.comparing import everything, values
from tests.semantics.reference import Reference

import beliefnest as bn
from beliefnest.world import terrain

AGENTS = [f"a{number:02d}" for number in range(32)]
BOX = ((-4, -2, -4), (19, 5, 19))
PATHS = [
    *(f"/{one}" for one in AGENTS),
    *(f"/{one}/{other}" for one in AGENTS[:6] for other in AGENTS if one != other),
]


def crowd() -> bn.ScriptedWorld:
    """Return a world of many agents between walls, some of them fences."""
    chance = random.Random(7)
    kinds = ["stone", "stone", "oak_fence", "oak_slab"]
    walls = {
        (x, y, z): chance.choice(kinds)
        for x, z in [(chance.randrange(16), chance.randrange(16)) for _ in range(40)]
        for y in range(3)
    }
    floor = {(x, -1, z): "stone" for x in range(-4, 20) for z in range(-4, 20)}
    agents = {name: (n % 6 * 3 + 0.5, 0.0, n // 6 * 3 + 0.5) for n, name in enumerate(AGENTS)}
    return bn.ScriptedWorld(BOX, floor | walls, agents)


def walk(world: bn.ScriptedWorld, tick: int) -> None:
    """Let some agents move, one speak, and a block change, in one tick."""
    chance = random.Random(tick)
    with world.tick():
        for name in chance.sample(AGENTS, 20):
            at = (chance.randrange(18) + 0.5, 0.0, chance.randrange(18) + 0.5)
            world.place_agent(name, at, yaw=chance.uniform(-3, 3))
        world.say(chance.choice(AGENTS), "hi")
        place = (chance.randrange(16), 1, chance.randrange(16))
        world.set_block(place, chance.choice(["stone", "air"]))


def told(monkeypatch: pytest.MonkeyPatch, dense: int, *, each_tick: bool) -> list[object]:
    """Return what all nodes believe at the end, asked then alone or after each tick, too."""
    with monkeypatch.context() as patch:
        patch.setattr(terrain, "DENSE", dense)
        world = crowd()
        with bn.Nest(world, bn.Perception(max_visible_distance=7)) as nest:
            for tick in range(6):
                if each_tick:
                    nest.states(PATHS[tick::5])
                walk(world, tick)
            return [values(state) for state in nest.states(PATHS).values()]


@pytest.mark.long
def test_chunks_and_the_time_of_asking_change_no_belief_of_many_agents(
    monkeypatch: pytest.MonkeyPatch,
):
    expected = told(monkeypatch, 10**9, each_tick=False)
    assert told(monkeypatch, 0, each_tick=False) == expected
    assert told(monkeypatch, 0, each_tick=True) == expected


def test_deeper_beliefs_know_no_block_that_shallower_ones_do_not(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(terrain, "DENSE", 0)
    world = crowd()
    with bn.Nest(world, bn.Perception(max_visible_distance=7)) as nest:
        for tick in range(4):
            walk(world, tick)
        states = nest.states(PATHS)
    for path in PATHS[32:]:
        owner = path[: path.rindex("/")]
        unknown = states[owner].blocks.grid < 0
        assert (states[path].blocks.grid[unknown] < 0).all()


def test_the_reference_agrees_about_32_agents():
    chance = random.Random(3)
    places = [(x + 0.5, 0.0, z + 0.5) for x in range(8) for z in range(4)]
    walls = {(x, y, 4): "stone" for x in (1, 2, 5) for y in (0, 1)}
    agents = dict(zip(AGENTS, places, strict=True))
    world = bn.ScriptedWorld(((0, 0, 0), (7, 1, 5)), walls, agents)
    options = bn.Perception(max_visible_distance=4)
    reference = Reference(world.snapshot(), options, frozenset(["air"]), depth=2)
    with bn.Nest(world, options, static_blocks=["air"]) as nest:
        world.listen(lambda frame: reference.frame((), frame))
        for _ in range(2):
            with world.tick():
                for name in chance.sample(AGENTS, 16):
                    at = (chance.randrange(8) + 0.5, 0.0, chance.choice([0.5, 3.5, 5.5]))
                    world.place_agent(name, at, yaw=chance.uniform(-3, 3))
                world.say(chance.choice(AGENTS), "hi")
                world.set_block((chance.randrange(8), 1, 4), chance.choice(["stone", "air"]))
        for one, other in zip(AGENTS, AGENTS[5:] + AGENTS[:5], strict=True):
            for path in ((one,), (one, other)):
                expected, found = (
                    reference.everything(path),
                    everything(nest["/" + "/".join(path)].state),
                )
                for part, value in expected.items():
                    assert found[part] == value, f"{part} of {path}"
