"""Beliefs of one owner under several holders, which share lines of sight (`arrays.Nodes.twin`).

A node copies its twin's look only if the holder believes in the same shapes and poses as the
holder above it. In each of these scenes one of the two differs, so that a copied look would be
wrong.
"""

import random

import pytest
from tests.nest.comparing import values

import beliefnest as bn
from beliefnest.world import terrain

BOX = ((0, 0, 0), (12, 3, 12))
FLOOR = {(x, 0, z): "stone" for x in range(13) for z in range(13)}
KNOWN = ["air", "stone", "dirt"]
BOB, CARL = (2.5, 1.0, 6.5), (10.5, 1.0, 6.5)
SCREEN = {(6, y, z): "dirt" for y in (1, 2) for z in (5, 7)}
"""Pillars beside the line from Bob to Carl; Ann, south of it, does not see the cell between."""
WALL = [(6, 1, 6), (6, 2, 6)]


@pytest.fixture(params=[10**9, 0], ids=["dense", "chunks"], autouse=True)
def space(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(terrain, "DENSE", request.param)


def scene(
    ann: tuple[float, float, float], testimony: str = "none", **more: object
) -> tuple[bn.ScriptedWorld, bn.Nest]:
    agents = {"ann": ann, "bob": BOB, "carl": CARL}
    world = bn.ScriptedWorld(BOX, FLOOR | SCREEN, agents, **more)
    nest = bn.Nest(
        world, bn.Perception(max_visible_distance=9, testimony=testimony), static_blocks=KNOWN
    )
    nest.states(["/bob", "/ann", "/ann/bob"])
    return world, nest


def sees(nest: bn.Nest, path: str, agent: str) -> bool:
    """Return True if a node's owner saw an agent at its last move."""
    agents = nest[path].state.agents
    return agents[agent].current and agents[agent].position is not None


def build(world: bn.ScriptedWorld) -> None:
    with world.tick():
        for place in WALL:
            world.set_block(place, "bricks")


def test_a_wall_that_the_holder_has_not_seen_hides_nothing_from_whom_it_thinks_of():
    world, nest = scene((6.5, 1.0, 11.5))
    with nest:
        build(world)
        world.place_agent("carl", (10.5, 1.0, 6.6))
        assert sees(nest, "/ann", "bob") and sees(nest, "/ann", "carl")
        assert not sees(nest, "/bob", "carl")
        assert sees(nest, "/ann/bob", "carl")


def test_it_hides_them_once_the_holder_has_seen_it():
    world, nest = scene((6.5, 1.0, 11.5))
    with nest:
        build(world)
        world.place_agent("ann", (2.5, 1.0, 5.5))
        world.place_agent("ann", (6.5, 1.0, 11.5))
        world.place_agent("carl", (10.5, 1.0, 6.6))
        assert not sees(nest, "/ann/bob", "carl")


def test_a_wall_that_the_holder_was_told_of_hides_them_from_whom_it_thinks_of():
    world, nest = scene((6.5, 1.0, 11.5), testimony="accept")
    with nest:
        claims = [bn.Claim.block(place, "bricks") for place in WALL]
        world.whisper("carl", "ann", "They have built a wall.", claims=claims)
        assert nest["/ann"].state.blocks[WALL[0]] == "bricks"
        world.place_agent("carl", (10.5, 1.0, 6.6))
        assert sees(nest, "/bob", "carl") and sees(nest, "/ann", "carl")
        assert not sees(nest, "/ann/bob", "carl")


def test_an_agent_is_seen_where_the_holder_remembers_it():
    agents = {"ann": (5.5, 1.0, 2.5), "bob": (1.5, 1.0, 9.5), "carl": (9.5, 1.0, 2.5)}
    world = bn.ScriptedWorld(BOX, FLOOR, agents)
    with bn.Nest(world, bn.Perception(max_visible_distance=6), static_blocks=KNOWN) as nest:
        nest.states(["/bob", "/ann", "/ann/bob"])
        world.place_agent("carl", (9.5, 1.0, 12.5))
        world.place_agent("bob", (5.5, 1.0, 3.5))
        assert nest["/bob"].state.agents["carl"].position is None
        assert nest["/ann/bob"].state.agents["carl"].position == (9.5, 1.0, 2.5)


NAMES = [f"a{number}" for number in range(5)]
PATHS = [f"/{a}/{b}" for a in NAMES for b in NAMES if a != b]


BOXES = [(6, 1, 6), (2, 1, 9), (10, 1, 3)]


def walked(asked: list[str], testimony: str) -> dict[str, object]:
    """Return beliefs after a walk between changing walls, edits and claims; only these nodes."""
    chance = random.Random(5)
    walls = {(x, y, z): "bricks" for x, z in ((4, 4), (4, 5), (8, 7), (7, 8)) for y in (1, 2)}
    agents = {name: (2.5 * n + 1.5, 1.0, 3.5) for n, name in enumerate(NAMES)}
    options = bn.Perception(
        max_visible_distance=9, testimony=testimony, grace=1, negative_evidence=True
    )
    world = bn.ScriptedWorld(
        BOX, FLOOR | walls, agents, containers={at: {"apple": 1} for at in BOXES}
    )
    free = [(x, z) for x in range(13) for z in range(13) if (x, 1, z) not in walls]
    with bn.Nest(world, options, static_blocks=KNOWN) as nest:
        for _ in range(14):
            nest.states(asked)
            with world.tick():
                for name in chance.sample(NAMES, 3):
                    x, z = chance.choice(free)
                    world.place_agent(name, (x + 0.5, 1.0, z + 0.5))
                place = (chance.randrange(3, 9), chance.choice((1, 2)), chance.choice((4, 5, 8)))
                world.set_block(place, chance.choice(["bricks", "dirt", "air"]))
            spot = (chance.randrange(3, 9), 1, chance.randrange(4, 9))
            claims = [
                bn.Claim.block(spot, "bricks"),
                bn.Claim.located("apple", chance.choice(BOXES)),
            ]
            world.say(chance.choice(NAMES), "Look.", claims=claims)
        return {path: values(state) for path, state in nest.states(asked).items()}


@pytest.mark.parametrize("testimony", ["accept", "informed"])
def test_beliefs_are_the_same_with_and_without_twins(testimony: str):
    together = walked(["/" + name for name in NAMES] + PATHS, testimony)
    for path in PATHS[::3]:
        assert walked([path], testimony) == {path: together[path]}
