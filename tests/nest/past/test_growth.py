"""Memory of a nest that follows beliefs does not grow with the number of ticks."""

import gc
import tracemalloc

import pytest
from tests.profiles import few_by_day

import beliefnest as bn
from beliefnest.nest.past import history

AGENTS = [f"agent{number}" for number in range(4)]
PATHS = [f"/{one}/{other}" for one in AGENTS for other in AGENTS if one != other]
PERIOD = 1024
"""Ticks after which all buffers of fixed length are as full as before."""
LEAST = 40
"""Bytes of growth for each pose that are taken for growth; a pose in memory has about 300."""


def walk(world: bn.ScriptedWorld, nest: bn.Nest, ticks: int) -> int:
    """Let all agents walk, read beliefs now and then, and return the traced bytes."""
    for tick in range(ticks):
        with world.tick():
            for number, name in enumerate(AGENTS):
                world.place_agent(name, (tick % 97 / 12 + 0.5, 1, number + 0.5), yaw=tick / 7)
        if tick % 128 == 127:
            nest.states(PATHS)
    gc.collect()
    return tracemalloc.get_traced_memory()[0]


@pytest.mark.parametrize("store", few_by_day(["run.bn", None]))
def test_no_pose_of_the_past_stays_in_memory(store, tmp_path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(history, "_STRETCHES", 1)
    agents = {name: (0.5, 1.0, number + 0.5) for number, name in enumerate(AGENTS)}
    world = bn.ScriptedWorld(((0, 0, 0), (9, 4, 9)), agents=agents)
    path = None if store is None else tmp_path / store
    with bn.Nest(world, static_blocks=["air"], store=path) as nest:
        nest.states(PATHS)
        tracemalloc.start()
        try:
            before = walk(world, nest, PERIOD)
            grown = walk(world, nest, PERIOD) - before
        finally:
            tracemalloc.stop()
    assert grown < LEAST * PERIOD * len(AGENTS)
