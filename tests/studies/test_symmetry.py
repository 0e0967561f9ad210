"""Mirrored and turned blocks, places and gazes: what the world's own shapes say of them."""

import math
import random

import numpy as np
import pytest
from tests.profiles import at_night

from beliefnest.studies.symmetry import SYMMETRIES, Placing, Symmetry, symmetry_named
from beliefnest.world.registry import Registry
from beliefnest.world.values import Box

REGISTRY = Registry.load()
BLOCKS = [name for name in REGISTRY.item_names if REGISTRY.has_block(name)]
LOPSIDED = ("candle", "sea_pickle", "_egg", "bamboo", "pointed_dripstone", "cake")
"""Stand a little aside in their block, whichever way anything faces."""
UNIT = Box((0, 0, 0), (0, 0, 0))
FACING = {"north": (0.0, -1.0), "east": (1.0, 0.0), "south": (0.0, 1.0), "west": (-1.0, 0.0)}


def states(count):
    chance = random.Random(0)
    for _ in range(count):
        yield REGISTRY.text(chance.choice(REGISTRY.state_ids(chance.choice(BLOCKS))))


def space(symmetry, boxes):
    """Return the filled 32nds of a block's columns, each box put where its corners go."""
    placing = Placing(symmetry, UNIT)
    filled = np.zeros((32, 64, 32), bool)
    for x0, y0, z0, x1, y1, z1 in boxes:
        (a, _, c), (b, _, d) = placing.point((x0, y0, z0)), placing.point((x1, y1, z1))
        edges = [round(32 * edge) for edge in (*sorted((a, b)), y0, y1, *sorted((c, d)))]
        x, y, z = (
            slice(max(0, low), high) for low, high in zip(edges[::2], edges[1::2], strict=True)
        )
        filled[x, y, z] = True
    return filled


@pytest.mark.parametrize("symmetry", SYMMETRIES, ids=lambda each: each.name)
def test_a_changed_block_fills_the_changed_space(symmetry):
    for text in states(at_night(20_000, 400)):
        changed = symmetry.block_state(text, REGISTRY)
        own, other = (REGISTRY.boxes(REGISTRY.state_id(each)) for each in (text, changed))
        same = np.array_equal(space(symmetry, own), space(Symmetry(), other))
        assert same or any(name in text for name in LOPSIDED), (text, changed)


@pytest.mark.parametrize("name", ["turned-90", "mirrored", "mirrored-90"])
def test_what_is_changed_often_enough_is_what_it_was(name):
    symmetry, times = symmetry_named(name), 4 if name == "turned-90" else 2
    for text in states(at_night(20_000, 400)):
        changed = text
        for _ in range(times):
            changed = symmetry.block_state(changed, REGISTRY)
        assert REGISTRY.state_id(changed) == REGISTRY.state_id(text)


@pytest.mark.parametrize("symmetry", SYMMETRIES, ids=lambda each: each.name)
def test_gazes_directions_and_vectors_go_the_same_way(symmetry):
    for name, (x, z) in FACING.items():
        turned = symmetry.vector(x, z)
        assert turned == pytest.approx(FACING[symmetry.direction(name)])
        yaw = symmetry.yaw(math.atan2(-x, -z))
        assert (-math.sin(yaw), -math.cos(yaw)) == pytest.approx(turned)


@pytest.mark.parametrize("symmetry", SYMMETRIES, ids=lambda each: each.name)
def test_places_stay_in_a_box_that_is_not_square(symmetry):
    box = Box((-2, 0, 5), (3, 1, 7))
    placing = Placing(symmetry, box)
    width, depth = (3, 6) if symmetry.turns % 2 else (6, 3)
    places = {placing.block(place) for place in box.positions()}
    assert places == {
        (x, y, z) for x in range(-2, -2 + width) for y in (0, 1) for z in range(5, 5 + depth)
    }
    x, _, z = placing.point((0.5, 0, 6.5))
    assert placing.block((0, 0, 6)) == (math.floor(x), 0, math.floor(z))
