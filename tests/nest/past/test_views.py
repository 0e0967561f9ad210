"""Looks in a box of chunks are those in a dense box, also for states that were kept."""

import gc
import random
from weakref import ref

import numpy as np
import pytest

import beliefnest as bn
from beliefnest.belief.node_view import NodeView
from beliefnest.nest.explain.sightings import sighting_of_agent, sighting_of_block
from beliefnest.nest.past.views import visible_from, visible_part
from beliefnest.perception.sight import ChunkGeometry, Geometry
from beliefnest.viewer.page.reasons import sight_of
from beliefnest.world import terrain
from beliefnest.world.paths import paths_below

BOX = ((0, 0, 0), (19, 5, 17))
NAMES = ("ann", "bob", "cat")


def story(far: float | None) -> bn.Nest:
    """Return a nest of agents that walk among walls, fences and slabs."""
    chance = random.Random(5)
    kinds = ["stone", "oak_fence", "smooth_stone_slab", "glass"]
    blocks = {(x, 0, z): "stone" for x in range(20) for z in range(18)}
    for _ in range(90):
        place = chance.randrange(20), chance.randrange(1, 4), chance.randrange(18)
        blocks[place] = chance.choice(kinds)
    agents = {name: (2.5 + 6 * n, 4.0, 3.5 + 5 * n) for n, name in enumerate(NAMES)}
    world = bn.ScriptedWorld(box=BOX, blocks=blocks, agents=agents)
    nest = bn.Nest(world, bn.Perception(max_visible_distance=far))
    for _ in range(6):
        with world.tick():
            for name in NAMES:
                feet = (chance.uniform(1, 18), 4.0, chance.uniform(1, 16))
                world.place_agent(name, feet, chance.uniform(-3, 3))
            place = chance.randrange(20), 1, chance.randrange(18)
            world.set_block(place, chance.choice(kinds))
    return nest


def looks(nest: bn.Nest, reading: NodeView) -> list[object]:
    """Return all looks of agents at agents and at some blocks, in one node."""
    box = nest.setting.snapshot.box
    known = [name for name in NAMES if reading.agents[name].position is not None]
    places = [(x, y, z) for x in range(0, 20, 3) for y in (0, 1, 3) for z in range(0, 18, 4)]
    found: list[object] = []
    for viewer in known:
        found += [sighting_of_agent(reading, box, viewer, o) for o in NAMES if o != viewer]
        found += [sighting_of_block(reading, box, viewer, place) for place in places]
    return found


def told(nest: bn.Nest, kind: type) -> dict[object, object]:
    """Return all looks and views in some nodes of a nest, at some ticks."""
    found: dict[object, object] = {}
    sight = nest.reader.history.context.sight
    for tick in (0, 3, 6):
        for path in ["/" + "/".join(path) for path in paths_below((), 1, NAMES)]:
            state = nest.at(tick)[path].state
            assert isinstance(state.geometry, kind)
            found[tick, path] = looks(nest, state)
            for name in NAMES:
                found[tick, path, name] = visible_from(state, sight, name).tolist()
    return found


@pytest.mark.parametrize("far", [None, 7.0])
def test_looks_are_the_same_in_chunks(far, monkeypatch):
    dense = told(story(far), Geometry)
    monkeypatch.setattr(terrain, "DENSE", 0)
    chunks = told(story(far), ChunkGeometry)
    for at, looked in dense.items():
        assert looked == chunks[at], at


def test_looks_in_a_state_stay_the_same_after_later_ticks(monkeypatch):
    monkeypatch.setattr(terrain, "DENSE", 0)
    nest = story(7.0)
    key = nest.reader.timelines()[0].key
    forest = nest.reader.walk(key, paths_below((), 1, NAMES))
    nest.reader.advance(key, forest, 3)
    early, kept = NodeView(forest, ("ann",)), NodeView(forest, ("ann",))
    before = looks(nest, early)
    nest.reader.advance(key, forest, forest.position + 3)
    assert before == looks(nest, kept)
    assert before != looks(nest, NodeView(forest, ("ann",)))


@pytest.mark.parametrize("path", ["/", "/ann", "/ann/bob"])
def test_a_state_that_nobody_holds_is_gone_at_once_so_that_no_fold_reads_it(path):
    with story(16.0) as nest:
        state = nest[path].state
        read = [getattr(state, part) for part in ("agents", "containers", "items", "blocks")]
        reference = ref(state)
        gc.disable()  # only a cycle of references would wait for the collector
        try:
            del state, read
            assert reference() is None
        finally:
            gc.enable()


def test_a_view_covers_the_part_within_the_visible_distance_and_is_told_in_runs():
    nest = story(3.0)
    sight, state = nest.reader.history.context.sight, nest["/"].state
    key = nest.reader.timelines()[0].key
    box = nest.setting.snapshot.box
    for name in NAMES:
        part, seen = visible_part(state, sight, name), visible_from(state, sight, name)
        assert part is not None
        assert max(part.seen.shape) <= 11
        assert seen.sum() == part.seen.sum() > 0
        runs = sight_of(nest.reader, key, (), nest.tick, name)
        flags = np.repeat(np.arange(len(runs)) % 2 == 1, runs).reshape(box.shape)
        assert np.array_equal(flags, seen)
