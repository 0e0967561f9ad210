"""The key `terrain`: blocks that a capture compressed, read, changed, mirrored and damaged."""

import json

import numpy as np
import pytest

from beliefnest.errors import ScenarioError
from beliefnest.scenarios import terrain_entry
from beliefnest.scenarios.format import TerrainEntry
from beliefnest.scenarios.instances import _Scene
from beliefnest.scenarios.scenario import Scenario
from beliefnest.scenarios.sources import read_document
from beliefnest.scenarios.terrain_entry import entry_of, numbers_in
from beliefnest.studies.symmetry import SYMMETRIES, Placing, symmetry_named
from beliefnest.studies.variation import Variation
from beliefnest.world import terrain
from beliefnest.world.memory import MemoryLimit
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain

REGISTRY = Registry.load()
TEXTS = ["air", "stone", "glass", "oak_log[axis=x]", "lever[face=floor,facing=east,powered=true]"]
IDS = np.array([REGISTRY.state_id(text) for text in TEXTS], dtype=np.int32)


def content(blocks: Terrain) -> dict[str, object]:
    x, y, z = blocks.shape
    return {
        "name": "captured",
        "box": [[5, 0, -3], [4 + x, y - 1, z - 4]],
        "terrain": entry_of(blocks, REGISTRY),
        "agents": {"ann": {"position": [6.5, 3, 0.5]}},
    }


def random_blocks(seed: int) -> Terrain:
    generator = np.random.default_rng(seed)
    grid = IDS[generator.integers(0, len(IDS), size=(19, 9, 22))]
    grid[:, 2:] = 0
    return Terrain.of(grid)


@pytest.fixture(params=[terrain.DENSE, 0], ids=["dense", "chunks"])
def dense(request, monkeypatch):
    monkeypatch.setattr(terrain, "DENSE", request.param)


@pytest.mark.usefixtures("dense")
def test_it_is_what_was_packed_and_blocks_come_later():
    blocks = random_blocks(1)
    told = content(blocks)
    assert Scenario.from_mapping(told).setting.snapshot.blocks == blocks
    told["blocks"] = [{"block": "bricks", "at": [7, 1, 0]}]
    found = Scenario.from_mapping(told).setting.snapshot.blocks
    assert found.differing(blocks).tolist() == [[2, 1, 3]]


def test_a_cut_is_read_by_versions_that_would_not_cut(monkeypatch):
    blocks = random_blocks(2)
    with monkeypatch.context() as patch:
        patch.setattr(terrain, "DENSE", 0)
        told = content(Terrain.of(blocks.dense()))
    assert told["terrain"]["chunks"] > 1
    assert Scenario.from_mapping(told).setting.snapshot.blocks == blocks


@pytest.mark.parametrize("symmetry", SYMMETRIES, ids=lambda each: each.name)
@pytest.mark.usefixtures("dense")
def test_it_is_mirrored_and_turned(symmetry, tmp_path):
    told = content(random_blocks(3))
    written = Scenario.from_mapping(told)
    file = tmp_path / "captured.yaml"
    file.write_text(json.dumps(told))
    variation = Variation({"symmetry": symmetry.name})
    varied = Scenario.varied(read_document(str(file)), None, variation.parameters, variation.scene)
    moved = varied.setting.snapshot
    old = written.setting.snapshot
    placing = Placing(symmetry, old.box)
    for place in old.box.positions():
        text = REGISTRY.text(old.blocks[old.box.index(place)])
        expected = REGISTRY.state_id(symmetry.block_state(text, REGISTRY))
        assert moved.blocks[moved.box.index(placing.block(place))] == expected


def test_places_are_free_above_its_blocks():
    scene = _Scene(Scenario.from_mapping(content(random_blocks(4))))
    blocks = scene._place.blocks.dense()
    for at in scene._place.box.positions():
        i, j, k = scene._place.box.index(at)
        is_free = j > 0 and blocks[i, j, k] == 0 and blocks[i, j - 1, k] != 0
        assert scene.is_free(at) == is_free


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"cells": "KLUv"}, "is damaged, or was captured with another box"),
        ({"cells": "no Base64"}, "is damaged, or was captured with another box"),
        ({"chunks": 3}, "unpack to more than 6,216 bytes"),
        ({"chunks": 10**9}, "chunks need 4,096,000 MB; this process may use 5,000 MB, a test"),
        ({"states": ["air"]}, "names the states 0 to 4, but there are 1"),
        ({"states": [*TEXTS[:-1], "levr"]}, "no block 'levr' in"),
        ({"chunks": -1}, "terrain.chunks: expected an integer, at least 0, got -1"),
    ],
)
def test_damage_is_told_with_the_key(change, told, monkeypatch):
    limit = MemoryLimit(5_000_000_000, "a test's limit")
    monkeypatch.setattr(terrain_entry, "memory_limit", lambda: limit)
    good = content(random_blocks(5))
    good["terrain"] |= change
    with pytest.raises(ScenarioError, match="terrain") as fault:
        Scenario.from_mapping(good)
    assert told in str(fault.value)


def test_a_box_of_another_size_is_refused():
    told = content(random_blocks(6))
    told["box"] = [[5, 0, -3], [30, 8, 18]]
    with pytest.raises(ScenarioError, match=r"was captured with another box .* capture the place"):
        Scenario.from_mapping(told)


def test_a_large_one_is_turned_without_a_dense_array(monkeypatch):
    blocks = Terrain.full((1000, 100, 900), 0).draft()
    blocks.fill((0, 0, 0), (1000, 40, 900), 1)
    blocks[3, 7, 800] = 10
    monkeypatch.delattr(Terrain, "dense")
    told = {**content(blocks.terrain()), "agents": {"ann": {"position": [6.5, 40, 0.5]}}}
    box = Scenario.from_mapping(told).setting.snapshot.box
    entry = TerrainEntry(**told["terrain"])
    turned = Placing(symmetry_named("turned-90"), box).terrain(numbers_in(entry, box.shape))
    assert turned.shape == (900, 100, 1000)
    assert turned.find([2]).tolist() == [[99, 7, 3]]
