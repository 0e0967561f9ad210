"""Grounds of the scripted world's programs: one for all bodies with the same blocks."""

import numpy as np

from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box
from beliefnest.worlds.scripted.ground_cache import Grounds

LOW = (-3, 60, 5)


def grid_of(seed: int) -> np.ndarray:
    """Return levers, stone, unknown blocks and air, mostly air."""
    registry = Registry.load()
    lever = registry.state_id("lever[powered=true]")
    kinds = [0, 0, 0, registry.state_id("stone"), registry.state_id("lever"), lever, -1]
    return np.random.default_rng(seed).choice(kinds, (20, 20, 20)).astype(np.int32)


def box_of(grid: np.ndarray) -> Box:
    """Return the box of a grid."""
    x, y, z = (a + size - 1 for a, size in zip(LOW, grid.shape, strict=True))
    return Box(LOW, (x, y, z))


def test_a_large_box_has_one_ground() -> None:
    box = Box((0, 0, 0), (999, 99, 999))
    draft = Terrain.full(box.shape, 0).draft()
    draft.fill((0, 0, 0), (1000, 1, 1000), 1)
    blocks = draft.terrain()
    grounds = Grounds()
    assert grounds.of(box, blocks) is grounds.of(box, blocks)


def test_small_boxes_with_equal_blocks_share_their_ground() -> None:
    grid = grid_of(0)
    box, grounds = box_of(grid), Grounds()
    first, second = Terrain.of(grid), Terrain.of(grid)
    assert grounds.of(box, first) is grounds.of(box, second)
    assert grounds.of(box, first) is grounds.of(box, Terrain.of_one(np.ascontiguousarray(grid)))
