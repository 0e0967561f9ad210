"""The rules of percepts, for those that call them with the blocks of one state."""

import math

import numpy as np
import pytest

from beliefnest.perception.options import Perception
from beliefnest.perception.percept import Perceptibles, gaze_from, perceives, percept
from beliefnest.perception.sight import Sight
from beliefnest.world.event_kinds import Sense
from beliefnest.world.registry import Registry
from beliefnest.world.values import DroppedItem

REGISTRY = Registry.load()
FEET = (0.5, 0.0, 0.5)
BEYOND = (10.5, 0.0, 0.5)


def lines(blocks=()):
    """Lines of sight through a row of air with some blocks, by position."""
    grid = np.full((12, 3, 1), REGISTRY.air, dtype=np.int32)
    for place, block in dict(blocks).items():
        grid[place] = REGISTRY.state_id(block)
    return Sight(REGISTRY).geometry(grid, (0, 0, 0))


@pytest.mark.parametrize(
    ("hearing", "heard"),
    [
        ("global", [True, True, True]),
        ("sight", [True, False, False]),
        ({"radius": 5}, [True, True, False]),
    ],
)
def test_speech_is_heard_as_the_option_says(hearing, heard):
    limits = Perception(hearing=hearing).limits
    cases = [(True, 2.0), (False, 5.0), (False, math.inf)]
    assert [perceives(limits, Sense.HEARING, *(sees, False, away)) for sees, away in cases] == heard


@pytest.mark.parametrize(
    ("sense", "sees_actor", "sees_place", "is_perceived"),
    [
        (Sense.ACTOR, True, False, True),
        (Sense.ACTOR, False, True, False),
        (Sense.PLACE, False, True, True),
        (Sense.PLACE, True, False, False),
        (Sense.NONE, True, True, False),
    ],
)
def test_what_is_seen_is_seen_at_its_actor_or_its_place(
    sense, sees_actor, sees_place, is_perceived
):
    limits = Perception(hearing="global").limits
    assert perceives(limits, sense, sees_actor, sees_place, 1.0) is is_perceived


def test_a_percept_has_what_no_wall_hides():
    things = Perceptibles(
        {(10, 0, 0): {"diamond": 1}, (2, 0, 0): None},
        {"anne": BEYOND, "carl": (3.5, 0.0, 0.5)},
        {7: DroppedItem("bread", 1, BEYOND), 8: DroppedItem("egg", 1, (2.5, 0.0, 0.5))},
    )
    gaze = gaze_from(FEET, 0.0, 0.0)
    assert percept(lines(), gaze, things) == things
    wall = {(5, y, 0): "stone" for y in range(3)}
    seen = percept(lines(wall), gaze, things)
    assert (seen.contents, [*seen.agents], [*seen.items]) == ({(2, 0, 0): None}, ["carl"], [8])
    assert percept(lines(), gaze, Perceptibles()) == Perceptibles()


def test_an_item_is_seen_by_its_middle():
    """A carpet before it hides the ground on which it lies, and not the item."""
    carpet = lines({(9, 0, 0): "white_carpet"})
    gaze = gaze_from(FEET, 0.0, 0.0)
    ground = (10.2, 0.0, 0.5)
    assert not carpet.sees_points(*gaze, [ground])[0]
    assert percept(carpet, gaze, Perceptibles(items={1: DroppedItem("egg", 1, ground)})).items
