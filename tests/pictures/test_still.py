"""Stills: pictures for people who know nothing of simulators, ticks and positions."""

import itertools
import re

import pytest
from tests.pictures.measuring import faults, texts

import beliefnest as bn
from beliefnest.pictures.still import draw_still

CHEST, BOX = (4, 1, 6), (7, 1, 6)


@pytest.fixture
def nest():
    """Yield a nest in which ann puts an apple away and leaves; bob takes it unseen."""
    blocks = {(x, 0, z): "stone" for x in range(12) for z in range(12)}
    blocks |= {(x, y, 4): "bricks" for x in range(12) for y in (1, 2, 3)}
    world = bn.ScriptedWorld(
        ((0, 0, 0), (11, 8, 11)),
        blocks,
        {"ann": (2.5, 1, 6.5), "bob": (7.5, 1, 7.5)},
        inventories={"ann": {"apple": 1}},
        containers={CHEST: {}, BOX: {}},
    )
    with bn.Nest(world, static_blocks=["bricks", "stone"]) as nest:
        world.deposit("ann", CHEST, {"apple": 1})
        world.place_agent("ann", (1.5, 1, 1.5))
        world.withdraw("bob", CHEST, {"apple": 1})
        yield nest


def still(nest, path, tick=None):
    (scene,) = nest.scenes(path, tick, path)
    return draw_still(scene, {CHEST: "red box"})


def test_a_still_names_things_and_tells_neither_ticks_nor_positions_nor_what_is_false(nest):
    for path in ("/", "/ann", "/bob/ann"):
        drawing = still(nest, path)
        told = " ".join(texts(drawing))
        assert {"Ann", "Bob"} <= set(re.findall(r"\w+", told))
        assert "red box" in told
        assert not re.search(r"tick|ago|false|believes|reality|\(|/", told)
        assert faults(drawing) == []


def test_a_still_shows_the_belief_alone(nest):
    (mind, real) = (" ".join(texts(still(nest, p))) for p in ("/ann", "/"))
    assert "red box: apple" in mind
    assert "red box: empty" in real
    assert "seen there before, not in sight now" in mind
    # In reality everything is known, so that the legend has nothing to explain.
    assert "not known" not in real


def test_stills_of_a_course_differ(nest):
    drawn = [still(nest, "/", tick) for tick in range(nest.tick + 1)]
    assert any(one != other for one, other in itertools.pairwise(drawn))
