"""The place where visitors of a belief arrive: the nearest free one, also in vast boxes."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from beliefnest.visits.embodying import Embodying
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box, Position
from beliefnest.worlds.scripted.footpaths import Ground

REGISTRY = Registry.load()


def stand(box: Box, terrain: Terrain, agents: list[tuple[float, float, float]]) -> Position:
    recording = SimpleNamespace(box=box, context=SimpleNamespace(registry=REGISTRY))
    present = {str(n): SimpleNamespace(position=at) for n, at in enumerate(agents)}
    reading = SimpleNamespace(terrain=terrain, agents=present)
    return Embodying(cast(Any, recording), cast(Any, None))._stand(cast(Any, reading))


@pytest.mark.parametrize("seed", range(8))
def test_it_is_the_nearest_free_place_of_all(seed):
    generator = np.random.default_rng(seed)
    box = Box((-7, 3, 40), (22, 17, 61))
    grid = (generator.random((30, 15, 22)) < 0.97).astype(np.int32)
    terrain = Terrain.of(grid)
    agents = [tuple(generator.uniform(box.low, box.high)) for _ in range(seed % 3)]
    middle = np.mean(agents or [box.low, box.high], axis=0)
    ground = Ground(REGISTRY, box, terrain)
    taken = {tuple(np.floor(at).astype(int).tolist()) for at in agents}
    free = [at for at in box.positions() if at not in taken and ground.stands(at)]
    nearest = min(free, key=lambda at: float(np.linalg.norm(np.array(at) + 0.5 - middle)))
    assert stand(box, terrain, agents) == nearest


def test_it_is_found_in_a_vast_box():
    draft = Terrain.full((1000, 100, 1000), 0).draft()
    draft.fill((0, 0, 0), (1000, 60, 1000), 1)
    box = Box((0, 0, 0), (999, 99, 999))
    # The middle lies 10 blocks deep in the ground.
    assert stand(box, draft.terrain(), []) == (499, 60, 499)
    assert stand(box, Terrain.full((1000, 100, 1000), 1), []) == (499, 49, 499)
