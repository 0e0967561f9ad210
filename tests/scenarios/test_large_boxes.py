"""Scenario files with boxes of one chunk, of several, and of a hundred million blocks."""

import tracemalloc
from collections.abc import Mapping
from random import Random
from typing import Any

import numpy as np
import pytest

from beliefnest.errors import InputError, ScenarioError, TemplateError, WorldError
from beliefnest.nest.face.nest import Nest
from beliefnest.nest.past import over_time
from beliefnest.scenarios import instances, space
from beliefnest.scenarios.scenario import Scenario
from beliefnest.scenarios.sources import read_document
from beliefnest.world import limits, terrain
from beliefnest.world.memory import MemoryLimit
from beliefnest.world.registry import Registry
from beliefnest.worlds.scripted.world import ScriptedWorld

LOW, SHAPE = (-5, 60, 3), (34, 20, 30)
STATES = ["stone", "glass", "air", "oak_fence", "lever"]

ROOMS = """\
name: rooms
parameters:
  spot: {default: [4, 1, 4]}
  other: {default: [5, 1, 5]}
instances:
  spot: {within: [[0, 1, 0], [39, 1, 29]], free: true, seen_by: [ann], reached_by: [bob]}
  other: {within: [[0, 1, 0], [39, 1, 29]], free: true, hidden_from: [ann], reached_by: [ann]}
box: [[0, 0, 0], [39, 19, 29]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [39, 0, 29]]}
  - {block: bricks, walls: [[0, 1, 0], [39, 3, 29]]}
  - {block: bricks, fill: [[15, 1, 0], [15, 3, 29]]}
  - {block: "oak_door[facing=east,half=lower]", at: [15, 1, 9]}
  - {block: "oak_door[facing=east,half=upper]", at: [15, 2, 9]}
  - {block: glass, fill: [[4, 1, 12], [15, 3, 12]]}
  - {block: oak_fence, fill: [[7, 1, 6], [9, 1, 8]]}
agents:
  ann: {position: [5.5, 1, 5.5]}
  bob: {position: [20.5, 1, 20.5]}
"""


def drawn(random: Random) -> tuple[dict[str, Any], np.ndarray]:
    """Return a scenario with random blocks, and its grid, painted cell by cell."""
    registry = Registry.load()
    grid = np.zeros(SHAPE, dtype=np.int32)
    entries: list[Mapping[str, Any]] = []

    def corner() -> list[int]:
        return [a + random.randrange(size) for a, size in zip(LOW, SHAPE, strict=True)]

    for _ in range(25):
        block, key = random.choice(STATES), random.choice(("at", "fill", "walls"))
        first, second = corner(), corner()
        entries.append({"block": block, key: first if key == "at" else [first, second]})
        if key == "at":
            second = first
        (x0, x1), (y0, y1), (z0, z1) = map(sorted, zip(first, second, strict=True))
        for x in range(x0, x1 + 1):
            for y in range(y0, y1 + 1):
                for z in range(z0, z1 + 1):
                    if key != "walls" or x in (x0, x1) or z in (z0, z1):
                        grid[x - LOW[0], y - LOW[1], z - LOW[2]] = registry.state_id(block)
    high = [a + size - 1 for a, size in zip(LOW, SHAPE, strict=True)]
    content = {
        "name": "painted",
        "box": [list(LOW), high],
        "blocks": entries,
        "initial_beliefs": [{"path": "/ann", "blocks": [e for e in entries if "fill" not in e]}],
        "agents": {"ann": {"position": [100, 100, 100]}},
    }
    # Ann stands where nothing is in her way.
    grid[0, :3, 0] = 0
    content["blocks"] = [
        *entries,
        {"block": "air", "fill": [list(LOW), [LOW[0], LOW[1] + 2, LOW[2]]]},
    ]
    content["agents"] = {"ann": {"position": [LOW[0] + 0.5, LOW[1] + 0.5, LOW[2] + 0.5]}}
    return content, grid


@pytest.mark.parametrize("dense", [terrain.DENSE, 100], ids=["dense", "chunks"])
@pytest.mark.parametrize("seed", range(8))
def test_blocks_are_painted_in_order(
    monkeypatch: pytest.MonkeyPatch, seed: int, dense: int
) -> None:
    content, grid = drawn(Random(seed))
    monkeypatch.setattr(terrain, "DENSE", dense)
    setting = Scenario.from_mapping(content).setting
    assert setting.snapshot.blocks.is_dense is (dense > 100)
    assert np.array_equal(setting.snapshot.blocks.dense(), grid)
    believed = setting.initial_beliefs[0].blocks
    # Each entry's positions come in order, and keep the place of the first entry that has them.
    expected: dict[tuple[int, int, int], int] = {}
    box = setting.snapshot.box
    for entry in content["initial_beliefs"][0]["blocks"]:
        state = Registry.load().state_id(entry["block"])
        for at in box.positions():
            if "at" in entry:
                is_in = list(at) == entry["at"]
            else:
                (x0, x1), (y0, y1), (z0, z1) = map(sorted, zip(*entry["walls"], strict=True))
                is_in = x0 <= at[0] <= x1 and y0 <= at[1] <= y1 and z0 <= at[2] <= z1
                is_in = is_in and (at[0] in (x0, x1) or at[2] in (z0, z1))
            if is_in:
                expected[at] = state
    assert list(believed.items()) == list(expected.items())


def test_instances_are_the_same_in_chunks(monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    file = tmp_path / "rooms.yaml"
    file.write_text(ROOMS)
    document = read_document(str(file))
    found = [instances.drawn_instance(document, seed, {}) for seed in range(4)]
    monkeypatch.setattr(terrain, "DENSE", 100)
    assert found == [instances.drawn_instance(document, seed, {}) for seed in range(4)]
    scene = instances._Scene(Scenario.load(str(file)))
    assert not scene._place.blocks.is_dense
    cells = [(x, y, z) for x in range(-1, 41, 3) for y in (1, 12) for z in range(-1, 31, 3)]
    in_chunks = [(scene.sees("ann", at), scene.reaches("bob", at)) for at in cells]
    monkeypatch.undo()
    scene = instances._Scene(Scenario.load(str(file)))
    assert in_chunks == [(scene.sees("ann", at), scene.reaches("bob", at)) for at in cells]
    assert {True, False} == {seen for seen, _ in in_chunks} == {near for _, near in in_chunks}


BIG = """\
name: big
box: [[0, 0, 0], [999, 99, 999]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [999, 0, 999]]}
  - {block: oak_planks, walls: [[10, 1, 10], [18, 4, 18]]}
  - {block: air, fill: [[14, 1, 10], [14, 2, 10]]}
map:
  origin: [990, 1, 990]
  legend: {"#": bricks, c: {container: chest, label: red box}}
  floors: |
    ####
    #c.#
containers:
  - {at: [12, 1, 12], block: barrel}
agents:
  ann: {position: [14.5, 1, 14.5]}
"""


def test_a_large_box_takes_what_is_in_it(tmp_path: Any) -> None:
    file = tmp_path / "big.yaml"
    file.write_text(BIG)
    tracemalloc.start()
    try:
        snapshot = Scenario.load(str(file)).setting.snapshot
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 60e6
    assert snapshot.blocks.shape == (1000, 100, 1000)
    assert list(snapshot.containers) == [(12, 1, 12), (991, 1, 991)]
    assert len(snapshot.blocks.find([Registry.load().state_id("oak_planks")])) == 4 * 32 - 2


def test_a_run_in_a_large_box_is_recorded_and_read(tmp_path: Any) -> None:
    file, store = tmp_path / "big.yaml", tmp_path / "run.bn"
    file.write_text(BIG + "static_blocks: [stone, air]\n")
    chest = (991, 1, 991)
    with Nest.open(Scenario.load(str(file)), "scripted", store=store) as nest:
        (result,) = (
            nest["/"].run_all({"ann": "await goToPosition(bot, new Vec3(60, 1, 40))"}).values()
        )
        assert result.ok
        assert nest["/ann"].state.agents["ann"].position == (58.5, 1.0, 40.5)
    assert store.stat().st_size < 2_000_000
    with Nest.read(store) as nest:
        for path in ("/", "/ann"):
            blocks = nest[path].state.blocks
            assert (blocks[999, 0, 999], blocks[999, 99, 999]) == ("stone", "air")
        assert nest["/"].state.blocks[chest].startswith("chest")
        assert nest["/ann"].state.blocks[chest] is None


def refused(text: str, tmp_path: Any) -> str:
    """Return the message with which a file is refused."""
    file = tmp_path / "big.yaml"
    file.write_text(text)
    with pytest.raises(ScenarioError) as fault:
        Scenario.load(str(file))
    return str(fault.value).removeprefix(str(file))


def test_boxes_without_room_are_refused_with_file_and_line(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Any
) -> None:
    assert refused(BIG.replace("999, 99, 999", "4000, 99, 4000"), tmp_path) == (
        ":2: box: the box holds 1,600,800,100 blocks; at most 1,073,741,824 are possible: "
        "make it smaller"
    )
    assert refused(BIG.replace("999, 99, 999", "9999, 99, 999"), tmp_path).startswith(
        ":2: box: the box is 10,000 blocks long; at most 4,096 are possible"
    )
    limit = MemoryLimit(5_000_000, "a test's limit")
    monkeypatch.setattr(limits, "memory_limit", lambda: limit)
    assert refused(BIG, tmp_path) == (
        ":2: box: the box holds 100,000,000 blocks, which need at least 10 MB; this process may "
        "use 5 MB, a test's limit: make the box smaller"
    )
    monkeypatch.undo()
    monkeypatch.setattr(space, "memory_limit", lambda: limit)
    believed = """\
initial_beliefs:
  - path: /ann
    blocks:
      - {block: stone, at: [0, 0, 0]}
      - {block: stone, fill: [[0, 0, 0], [99, 0, 199]]}
"""
    assert refused(BIG + believed, tmp_path) == (
        ":21: initial_beliefs[0].blocks[1]: gives 20,001 blocks with the entries before it, which "
        "need 7 MB; this process may use 5 MB, a test's limit: name blocks that everybody knows "
        "in 'static_blocks', or give a smaller part"
    )


def test_agents_beyond_the_limit_are_refused_with_file_and_line(tmp_path: Any) -> None:
    crowd = "".join(f"  a{n}: {{position: [{n + 0.5}, 1, 30.5]}}\n" for n in range(200))
    assert refused(BIG + crowd, tmp_path) == (
        ":15: agents: there are 201 agents; at most 200 are possible, because time and memory grow "
        "with the square of their number: each has a belief about each other. Take some out"
    )
    agents = {f"a{n}": (n % 15 + 0.5, 1.0, n // 15 + 0.5) for n in range(201)}
    with pytest.raises(WorldError, match="there are 201 agents; at most 200 are possible"):
        ScriptedWorld(((0, 0, 0), (15, 3, 15)), agents=agents)
    del agents["a7"]
    assert len(ScriptedWorld(((0, 0, 0), (15, 3, 15)), agents=agents).agents) == 200


def test_prompts_and_exports_refuse_millions_of_blocks_with_what_to_do(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Any
) -> None:
    monkeypatch.setattr(over_time, "_MOST_BLOCKS", 999_999)
    file = tmp_path / "big.yaml"
    file.write_text(BIG + "static_blocks: [stone]\n")
    store = tmp_path / "run.bn"
    with Nest.open(Scenario.load(str(file)), "scripted", store=store) as nest:
        assert "barrel: (12, 1, 12)" in nest["/ann"].render('{{ branch | blocks(["barrel"]) }}')
        for template in (
            "{{ branch | blocks }}",
            '{{ branch | blocks(["stone", "barrel"]) }}',
            '{{ branch | block_property("stone") }}',
            "{{ branch | blocks_and_visibilities }}",
        ):
            with pytest.raises(TemplateError) as fault:
                nest["/ann"].render(template)
            assert "known blocks to list, most of them stone; at most" in str(fault.value)
    with Nest.read(store) as nest:
        with pytest.raises(
            InputError, match=r"/ann knows 1,00\d,\d\d\d blocks at tick 0"
        ) as refused:
            list(nest.over_time("/ann"))
        assert "at most 999,999: leave the path out" in str(refused.value)
