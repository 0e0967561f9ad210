"""Things that are numbered are found in boxes of every size."""

from itertools import product

import numpy as np
import pytest

from beliefnest.env.order import PLACED, placed_in
from beliefnest.world import terrain
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box

STATES = ("oak_door[half=lower]", "oak_door[half=upper]", "chest", "lever", "stone_button")


def test_things_of_a_box_in_chunks_are_those_of_a_small_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    states = [Registry.load().state_id(text) for text in STATES]
    grid = np.zeros((40, 20, 40), dtype=np.int32)
    for number, place in enumerate(product((0, 15, 16, 39), (0, 1, 19), (0, 17, 39))):
        grid[place] = states[number % len(states)]
    box = Box((-5, 3, 7), (34, 22, 46))
    small = placed_in(box, Terrain.of(grid))
    assert [len(small[kind]) for kind in PLACED] == [7, 8, 7, 7, 0]
    monkeypatch.setattr(terrain, "DENSE", 0)
    assert not Terrain.of(grid).is_dense
    assert placed_in(box, Terrain.of(grid)) == small
