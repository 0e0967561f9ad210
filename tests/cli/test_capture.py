"""A place of a server or of a file becomes a scenario that says the same and runs embedded."""

import gzip
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.servers import serving

from beliefnest import Nest, Scenario
from beliefnest.cli.app import run_command_line
from beliefnest.scenarios.cuboids import cuboids
from beliefnest.scenarios.writing import scenario_text
from beliefnest.world.frames import Snapshot
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box

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
    assert run_command_line(["capture", str(file), "--at", "8", "-4", "8", "-o", str(out)]) == 0
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


def test_cuboids_are_all_cells_once():
    generator = np.random.default_rng(5)
    grid = generator.integers(0, 3, size=(5, 4, 6)).astype(np.int32)
    skipped = grid == 0
    filled = np.zeros_like(grid)
    times = np.zeros_like(grid)
    for state, box in cuboids(grid, skipped):
        part = tuple(slice(a, b + 1) for a, b in zip(box.low, box.high, strict=True))
        filled[part] = state
        times[part] += 1
    assert (filled == grid).all()
    assert (times == ~skipped).all()


def test_a_place_without_a_floor_is_refused():
    nowhere = Snapshot(0, Box((0, 0, 0), (2, 3, 2)), Terrain.full((3, 4, 3), 0), {}, {})
    with pytest.raises(Exception, match="there is no agent in the box, and no place for one"):
        scenario_text("nowhere", "", nowhere)
