"""In dense grids the flood of light leaves out only cells that are not seen."""

import random

import numpy as np
from tests.profiles import at_night

from beliefnest.perception.sight import Sight
from beliefnest.world.registry import Registry

REGISTRY = Registry.load()


def dense_grid(number):
    rng, chance = random.Random(number), np.random.default_rng(number)
    shape = tuple(rng.randint(3, 11) for _ in range(3))
    blocks = np.full(shape, REGISTRY.air, dtype=np.int32)
    blocks[chance.random(shape) < rng.choice((0.35, 0.5, 0.7))] = REGISTRY.state_id("stone")
    blocks[chance.random(shape) < 0.1] = REGISTRY.state_id("oak_fence")
    # Eyes level with sides, edges and middles of cells meet the rays that need care.
    eye = tuple(
        rng.choice((rng.uniform(0, size), rng.randrange(size) + 0.5, float(rng.randint(0, size))))
        for size in shape
    )
    return Sight(REGISTRY, None).geometry(blocks, (0, 0, 0)), eye


def test_looks_by_light_agree_with_looks_at_each_block():
    dense = 0
    for number in range(at_night(20_000, 400)):
        geometry, eye = dense_grid(number)
        dense += geometry._lit(geometry._eye(eye, 0.0, 0.0)[0]) is not None
        seen = geometry.visible_blocks(eye, 0.0, 0.0)
        places = np.argwhere(np.ones_like(seen))
        alone = geometry.sees_blocks(eye, 0.0, 0.0, places).reshape(seen.shape)
        assert (seen == alone).all(), number
    assert dense > number / 2
