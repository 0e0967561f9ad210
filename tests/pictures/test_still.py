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
        drawing = still(nest, path, 1)
        told = " ".join(texts(drawing))
        assert {"Ann", "Bob"} <= set(re.findall(r"\w+", told))
        assert "red box" in told
        assert not re.search(r"tick|ago|false|believes|reality|\(|/", told)
        assert faults(drawing) == []


def test_a_still_of_a_mind_shows_what_it_perceives_and_not_what_it_remembers(nest):
    told = {
        (path, tick): texts(still(nest, path, tick))
        for path in ("/", "/ann")
        for tick in range(nest.tick + 1)
    }
    assert "red box: apple" in told["/ann", 1]
    assert "Bob" in told["/ann", 1]
    assert nest["/ann"].state.containers[CHEST].items == {"apple": 1}
    assert not any("apple" in text or text == "Bob" for text in told["/ann", 3])
    assert "Ann" in told["/ann", 3]
    assert "closed, or out of sight" in told["/ann", 3]
    # A narrator perceives everything, so that the legend has nothing to explain.
    assert {"red box: empty", "Ann", "Bob"} <= set(told["/", 3])
    assert "closed, or out of sight" not in told["/", 3]


def test_stills_of_a_course_differ(nest):
    drawn = [still(nest, "/", tick) for tick in range(nest.tick + 1)]
    assert any(one != other for one, other in itertools.pairwise(drawn))
