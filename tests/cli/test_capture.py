"""A place of a server or of a file becomes a scenario that says the same and runs embedded."""

import bisect
import gzip
import struct
import tracemalloc
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.servers import serving

from beliefnest import Nest, Scenario
from beliefnest.cli.app import run_command_line
from beliefnest.errors import ScenarioError
from beliefnest.scenarios import writing, yaml_reading
from beliefnest.scenarios.writing import scenario_text
from beliefnest.world import terrain
from beliefnest.world.cuboids import cuboids, distinct_cells
from beliefnest.world.frames import Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box
from beliefnest.worlds.servers.capturing import capture_file

ROOM = """
name: room
box: [[0, 0, 0], [7, 4, 7]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [7, 0, 7]]}
  - {block: "oak_stairs[facing=east]", at: [1, 1, 1]}
  - {block: "water[level=0]", at: [7, 1, 7]}
  - {block: stone, at: [5, 2, 5]}
containers:
  - {at: [3, 1, 5], block: "chest[facing=north,type=right]", items: {apple: 70}}
  - {at: [2, 1, 5], block: "chest[facing=north,type=left]", items: {bread: 2}}
  - {at: [5, 1, 5], block: barrel, items: {diamond: 1}}
  - {at: [6, 1, 2], block: furnace, items: {coal: 3}}
signs:
  - {at: [0, 1, 5], block: "oak_sign[rotation=8]", text: "it's left\\n\\"here\\""}
agents:
  sally: {position: [3.5, 1, 3.5], facing: south, inventory: {emerald: 3, iron_helmet: 1},
    equipment: {head: iron_helmet, main_hand: emerald}}
  anne: {position: [2.5, 1, 2.5], yaw: 1.0, pitch: -0.5}
"""
TAKE = "await getItemFromChest(bot, new Vec3(2, 1, 5), {bread: 1, apple: 3})"


def said(scenario: Scenario) -> tuple[Any, ...]:
    place = scenario.setting.snapshot
    agents = {
        name: (
            tuple(round(value, 3) for value in (*state.position, state.yaw, state.pitch)),
            state.inventory,
            state.equipment,
            (state.health, state.food),
        )
        for name, state in place.agents.items()
    }
    return place.box, place.blocks.dense().tolist(), place.containers, place.signs, agents


def believed(scenario: Scenario) -> list[Any]:
    with Nest.open(scenario) as nest:
        assert nest["/"].run("sally", TAKE).ok
        states = [nest[path].state for path in ("/", "/anne", "/anne/sally")]
        return [
            (
                state.containers,
                state.blocks.grid.tolist(),
                {name: agent.current for name, agent in state.agents.items()},
                [(event.kind, event.actor, event.detail) for event in state.events],
            )
            for state in states
        ]


@pytest.mark.long
def test_a_place_on_a_server_is_captured_as_it_is(tmp_path):
    file, out = tmp_path / "room.yaml", tmp_path / "captured.yaml"
    file.write_text(ROOM)
    room = Scenario.load(str(file))
    with (
        serving(ops=["BeliefNest", "Second"], latency=5) as server,
        Nest.open(room, server.address(at="16,-32")),
    ):
        place = server.address(operator="Second", at="16,-32")
        box = [str(value) for value in (7, 4, 7, 0, 0, 0)]
        assert run_command_line(["capture", place, "--box", *box, "-o", str(out)]) == 0
    captured = Scenario.load(str(out))
    assert captured.name == "captured"
    assert said(captured) == said(room)
    assert believed(captured) == believed(room)


HALL = """
name: hall
box: [[0, 0, 0], [43, 6, 53]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [43, 0, 53]]}
  - {block: glass, fill: [[20, 1, 9], [20, 4, 9]]}
containers:
  - {at: [40, 1, 50], block: barrel, items: {bread: 2}}
signs:
  - {at: [1, 1, 2], text: here}
agents:
  sally: {position: [3.5, 1, 3.5]}
"""


@pytest.mark.long
def test_a_box_of_several_cubes_is_captured_from_a_server(tmp_path, monkeypatch):
    file, out = tmp_path / "hall.yaml", tmp_path / "captured.yaml"
    file.write_text(HALL)
    hall = Scenario.load(str(file))
    with (
        serving(ops=["BeliefNest", "Second"]) as server,
        Nest.open(hall, server.address()),
    ):
        place = server.address(operator="Second")
        # Three corners of the box lie within cubes and within the columns of the game.
        box = [str(value) for value in (1, 0, 2, 43, 6, 53)]
        monkeypatch.setattr(terrain, "DENSE", 0)
        assert run_command_line(["capture", place, "--box", *box, "-o", str(out)]) == 0
        found = Scenario.load(str(out)).setting.snapshot
    assert not found.blocks.is_dense
    assert np.array_equal(found.blocks.dense(), hall.setting.snapshot.blocks.dense()[1:, :, 2:])
    assert found.containers == {(40, 1, 50): {"bread": 2}}
    assert found.signs == {(1, 1, 2): "here"}


def _named(kind: int, name: str, payload: bytes) -> bytes:
    return struct.pack(">bH", kind, len(name)) + name.encode() + payload


def _compound(**parts: tuple[int, bytes]) -> bytes:
    return b"".join(_named(kind, name, value) for name, (kind, value) in parts.items()) + b"\0"


def _texts(text: str) -> tuple[int, bytes]:
    return 8, struct.pack(">H", len(text)) + text.encode()


def _list(kind: int, *values: bytes) -> tuple[int, bytes]:
    return 9, struct.pack(">bi", kind, len(values)) + b"".join(values)


def _whole(*values: int) -> tuple[int, bytes]:
    return _list(3, *(struct.pack(">i", value) for value in values))


def structure() -> bytes:
    """Return a structure file: 2 x 4 x 1 blocks, a chest and an unknown block on stone."""
    bread = _compound(Slot=(1, b"\0"), id=_texts("minecraft:bread"), Count=(1, b"\2"))
    ray = _compound(Slot=(1, b"\1"), id=_texts("minecraft:ray_gun"), Count=(1, b"\1"))
    names = ("stone", "chest", "unobtainium")
    places = (((0, 0, 0), 0), ((1, 0, 0), 0), ((0, 1, 0), 1), ((0, 2, 0), 2))
    blocks = []
    for place, state in places:
        parts = {"state": (3, struct.pack(">i", state)), "pos": _whole(*place)}
        if state == 1:
            parts["nbt"] = (10, _compound(Items=_list(10, bread, ray)))
        blocks.append(_compound(**parts))
    root = _compound(
        size=_whole(2, 4, 1),
        palette=_list(10, *(_compound(Name=_texts(f"minecraft:{name}")) for name in names)),
        blocks=_list(10, *blocks),
    )
    return gzip.compress(_named(10, "", root))


def test_a_structure_file_becomes_a_scenario_that_runs(tmp_path, capsys):
    file, out = tmp_path / "house.nbt", tmp_path / "house 2.1.yaml"
    file.write_bytes(structure())
    command = ["capture", str(file), "--at", "8", "-4", "8", "-o", str(out)]
    assert run_command_line(command) == 2
    told = capsys.readouterr().err
    assert "minecraft:unobtainium" in told
    assert "ray_gun" in told
    assert "--unknown air" in told
    assert not out.exists()
    assert run_command_line([*command, "--unknown", "air"]) == 0
    told = capsys.readouterr()
    assert "blocks that Minecraft 1.20.4 has not, now air: minecraft:unobtainium" in told.err
    assert "items that Minecraft 1.20.4 has not: ray_gun" in told.err
    assert "beliefnest run" in told.out
    # As the file is called, with what a name can have in it.
    house = Scenario.load(str(out))
    assert house.name == "house-2-1"
    with Nest.open(house, "scripted") as nest:
        state = nest["/"].state
        assert state.containers[(8, -3, 8)].items == {"bread": 2}
        # The place was empty, so an agent was put where it can stand.
        assert state.agents["visitor"].position == (9.5, -3.0, 8.5)


def schematic(states: list[str], numbers: np.ndarray) -> bytes:
    """Return a schematic of version 2 of numbers of states, z fastest."""
    width, height, length = numbers.shape
    palette = {state: (3, struct.pack(">i", number)) for number, state in enumerate(states)}
    data = numbers.transpose(1, 2, 0).astype(np.uint8).tobytes()
    root = _compound(
        Width=(2, struct.pack(">h", width)),
        Height=(2, struct.pack(">h", height)),
        Length=(2, struct.pack(">h", length)),
        Palette=(10, _compound(**palette)),
        BlockData=(7, struct.pack(">i", len(data)) + data),
    )
    return gzip.compress(_named(10, "Schematic", root), 1)


@pytest.mark.long
def test_a_schematic_of_millions_of_blocks_takes_what_is_in_it(tmp_path):
    file, out = tmp_path / "hills.schem", tmp_path / "hills.yaml"
    states = ["air", "stone", "grass_block", "oak_log[axis=x]"]
    numbers = np.zeros((260, 80, 410), dtype=np.uint8)
    numbers[:, :40], numbers[:, 40] = 1, 2
    generator = np.random.default_rng(3)
    for x, z in generator.integers(0, 260, size=(8000, 2)).tolist():
        numbers[x, 41, z] = 3
    file.write_bytes(schematic(states, numbers))
    assert run_command_line(["capture", str(file), "--at", "5", "0", "-9", "-o", str(out)]) == 0
    tracemalloc.start()
    try:
        capture_file(file.read_bytes(), (5, 0, -9))
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    # One array of all cells would take 34 MB.
    assert peak < 30e6
    # So many blocks are not listed one by one.
    assert "\nterrain:\n" in out.read_text()
    assert "\nblocks:\n" not in out.read_text()
    found = Scenario.load(str(out)).setting.snapshot
    assert found.box == Box((5, 0, -9), (264, 79, 400))
    ids = np.array([Registry.load().state_id(state) for state in states])
    assert np.array_equal(found.blocks.dense(), ids[numbers])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["minecraft://localhost:1"], "give --box"),
        (["minecraft://localhost:1", "--box", *"000999", "--at", *"000"], "no --at"),
        (["house.nbt", "--box", *"000999"], "no --box"),
        (["missing.schem"], "missing.schem cannot be read: No such file"),
        (["broken.schem"], "broken.schem: it is not a file of the game's data format"),
        (["minecraft://localhost:1", "--box", *"00", "9999999", *"009"], "make it smaller"),
    ],
)
def test_what_cannot_be_captured_is_said_in_a_line(
    arguments, message, tmp_path, capsys, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    Path("broken.schem").write_text("not a schematic")
    assert run_command_line(["capture", *arguments, "-o", "out.yaml"]) == 2
    assert message in capsys.readouterr().err
    assert not Path("out.yaml").exists()


def test_a_file_that_unpacks_to_more_than_the_limit_is_refused(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    # A gzip file may have several members: here 5 of 161 MB of zeros, together 805 MB.
    Path("bomb.nbt").write_bytes(gzip.compress(bytes(161_000_000), 1) * 5)
    assert run_command_line(["capture", "bomb.nbt", "-o", "out.yaml"]) == 2
    assert capsys.readouterr().err == (
        "beliefnest: bomb.nbt: it unpacks to more than 256 MiB, the limit for a place; give a file "
        "of a smaller place\n"
    )
    assert not Path("out.yaml").exists()


def test_nothing_is_written_over(tmp_path, capsys):
    out = tmp_path / "mine.yaml"
    out.write_text("mine")
    assert run_command_line(["capture", "any.nbt", "-o", str(out)]) == 2
    assert "exists already" in capsys.readouterr().err
    assert out.read_text() == "mine"


def greedy(grid: np.ndarray) -> list[tuple[int, Box]]:
    """Return the cuboids of a grid as earlier versions wrote them, without a look at layers."""
    found, open_cells = [], grid != 0
    for at in map(tuple, np.argwhere(open_cells).tolist()):
        if not open_cells[at]:
            continue
        low, high = list(at), list(at)
        for axis in (2, 0, 1):
            while high[axis] + 1 < grid.shape[axis]:
                part = [slice(a, b + 1) for a, b in zip(low, high, strict=True)]
                part[axis] = slice(high[axis] + 1, high[axis] + 2)
                there = tuple(part)
                if not (open_cells[there].all() and (grid[there] == grid[at]).all()):
                    break
                high[axis] += 1
        open_cells[tuple(slice(a, b + 1) for a, b in zip(low, high, strict=True))] = False
        found.append((int(grid[at]), Box(tuple(low), tuple(high))))
    return found


@pytest.mark.parametrize("dense", [terrain.DENSE, 0], ids=["dense", "chunks"])
@pytest.mark.parametrize("seed", range(6))
def test_cuboids_are_those_of_all_layers(seed, dense, monkeypatch):
    monkeypatch.setattr(terrain, "DENSE", dense)
    generator = np.random.default_rng(seed)
    grid = generator.integers(0, 3, size=(5, 4, 6)).astype(np.int32)
    for axis in range(3):
        grid = grid.repeat(generator.integers(1, 8, size=grid.shape[axis]), axis=axis)
    blocks = Terrain.of(grid)
    assert list(cuboids(blocks, 0)) == greedy(grid)
    assert distinct_cells(blocks) <= 5 * 4 * 6


def test_a_place_without_a_floor_is_refused():
    nowhere = Snapshot(0, Box((0, 0, 0), (2, 3, 2)), Terrain.full((3, 4, 3), 0), {}, {})
    with pytest.raises(Exception, match="there is no agent in the box, and no place for one"):
        scenario_text("nowhere", "", nowhere)


def snapshot_of(grid: np.ndarray) -> Snapshot:
    x, y, z = grid.shape
    return Snapshot(0, Box((0, 0, 0), (x - 1, y - 1, z - 1)), Terrain.of(grid), {}, {})


def test_blocks_are_listed_as_long_as_a_file_may_list_them(monkeypatch):
    grid = np.zeros((5, 3, 4), dtype=np.int32)
    grid[:, 0] = 1
    grid[::2, 0, ::2] = grid[1::2, 0, 1::2] = 10

    def text(most):
        for module in (writing, yaml_reading):
            monkeypatch.setattr(module, "MAX_VALUES", most)
        return scenario_text("floor", "", snapshot_of(grid))

    listed, packed = text(240), text(150)
    assert listed.count("{block: ") == 5 * 4
    assert packed.count("chunks: 0") == 1
    # The last limit at which the blocks are packed is the last at which they cannot be read.
    limit = bisect.bisect_left(range(240), True, 150, key=lambda most: text(most) == listed) - 1
    for most, is_read in ((limit + 1, True), (limit, False)):
        monkeypatch.setattr(yaml_reading, "MAX_VALUES", most)
        with nullcontext() if is_read else pytest.raises(ScenarioError, match="holds more than"):
            yaml_reading.parse_yaml(listed, "floor")


def test_a_wall_in_a_vast_box_is_listed(monkeypatch):
    draft = Terrain.full((1000, 100, 1000), 0).draft()
    draft.fill((0, 0, 0), (1000, 40, 1000), 1)
    draft.fill((500, 40, 500), (510, 44, 501), 10)
    box = Box((0, 0, 0), (999, 99, 999))
    monkeypatch.delattr(Terrain, "dense")
    text = scenario_text("vast", "", Snapshot(0, box, draft.terrain(), {}, {}))
    assert "fill: [[0, 0, 0], [999, 39, 999]]" in text
    assert "fill: [[500, 40, 500], [509, 43, 500]]" in text


def test_the_visitor_stands_on_the_lowest_floor_next_to_the_middle():
    grid = np.zeros((40, 8, 60), dtype=np.int32)
    grid[:, 4], grid[3:9, 1, 50:], grid[20, 1, 30] = 1, 1, 1
    # Too low to stand.
    grid[20, 2, 30] = 1
    grid[20, 3, 30] = 1
    text = scenario_text("halls", "", snapshot_of(grid))
    assert "visitor: {position: [8.5, 2.0, 50.5]" in text
