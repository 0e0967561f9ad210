"""Maps in scenario files: what is drawn stands there, and wrong maps name row and column."""

import json
from pathlib import Path

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from ruamel.yaml import YAML

import beliefnest as bn
from beliefnest.errors import ScenarioError
from beliefnest.scenarios import drawn_map
from beliefnest.scenarios.json_schema import schema
from beliefnest.scenarios.scenario import Scenario
from beliefnest.scenarios.sources import read_document
from beliefnest.studies.variation import Variation
from beliefnest.world.registry import Registry

DRAWN = """\
name: rooms
parameters:
  content: {default: diamond}
  tool: {default: apple, values: [apple, stick]}
  spot: {default: [8, 1, 3]}
instances:
  tool:
  spot: {within: [[1, 1, 1], [10, 1, 3]], seen_by: [bob]}
map:
  origin: [0, 1, 0]
  legend:
    "#": bricks
    C: {container: "chest[facing=south]", label: red box, items: {"${content}": 1}}
    D: {door: oak, above: bricks}
    s: {sign: no apples}
    a: {agent: ann, facing: east, inventory: {"${tool}": 1}}
    b: {agent: bob, facing: west}
    x: {place: seat, floor: gold_block}
  floors: |
    ############
    #C....#..sx#
    #.a...D..b.#
    #.....#....#
    ############
containers:
  - {label: blue box, at: [3, 1, 3], block: barrel}
blocks:
  - {block: glass, at: [6, 2, 3]}
agents:
  bob: {equipment: {main_hand: stick}}
conditions:
  1: {description: as drawn}
  2: {description: the door is open, map: {legend: {D: {open: true}}}}
  3: {description: bob is beside it, agents: {bob: {position: [7.5, 1, 3.5]}}}
"""

WRITTEN = """\
name: rooms
box: [[0, 0, 0], [11, 3, 4]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [11, 0, 4]]}
  - {block: bricks, walls: [[0, 1, 0], [11, 3, 4]]}
  - {block: bricks, fill: [[6, 1, 1], [6, 3, 3]]}
  - {block: "oak_door[facing=east,half=lower]", at: [6, 1, 2]}
  - {block: "oak_door[facing=east,half=upper]", at: [6, 2, 2]}
  - {block: gold_block, at: [10, 0, 1]}
  - {block: glass, at: [6, 2, 3]}
containers:
  - {label: red box, at: [1, 1, 1], block: "chest[facing=south]", items: {diamond: 1}}
  - {label: blue box, at: [3, 1, 3], block: barrel}
signs:
  - {at: [9, 1, 1], text: no apples}
places: {seat: [10, 1, 1]}
agents:
  ann: {position: [2.5, 1, 2.5], facing: east, inventory: {apple: 1}}
  bob: {position: [9.5, 1, 2.5], facing: west, equipment: {main_hand: stick}}
"""


def file_of(folder: Path, text: str) -> str:
    file = folder / "rooms.yaml"
    file.write_text(text)
    return str(file)


def same(one, other) -> bool:
    first, second = one.setting.snapshot, other.setting.snapshot
    return (
        first.box == second.box
        and first.blocks == second.blocks
        and (first.containers, first.signs) == (second.containers, second.signs)
        and dict(first.agents) == dict(second.agents)
        and (one.labels, one.setting.places) == (other.labels, other.setting.places)
    )


def test_a_map_is_the_scene_that_it_shows(tmp_path):
    drawn, written = (
        Scenario.load(file_of(tmp_path, DRAWN)),
        Scenario.from_mapping(YAML(typ="safe", pure=True).load(WRITTEN)),
    )
    assert same(drawn, written)
    kept = Scenario.kept(drawn.text, {}, None, "kept")
    assert same(kept, written)
    opened = Scenario.load(drawn.source, 2).setting.snapshot
    changed = opened.blocks.differing(drawn.setting.snapshot.blocks).tolist()
    assert changed == [[6, 1, 2], [6, 2, 2]]
    moved = Scenario.load(drawn.source, 3).setting.snapshot.agents["bob"]
    assert (moved.position, moved.equipment) == ((7.5, 1, 3.5), {"main_hand": "stick"})
    validator = Draft202012Validator(schema())
    plain = json.loads(json.dumps(YAML(typ="safe", pure=True).load(DRAWN)))
    assert not list(validator.iter_errors(plain))
    del plain["map"]
    assert list(validator.iter_errors(plain))


def test_blocks_that_agents_walk_through_are_one_high_and_no_walls(tmp_path):
    text = """\
name: circuit
map:
  legend:
    "#": bricks
    L: "lever[face=floor]"
    w: redstone_wire
    P: stone_pressure_plate
    "%": glass
    D: {door: iron}
    a: {agent: ann}
  floors: |
    L#%
    wD.
    aPP
"""
    snapshot = Scenario.load(file_of(tmp_path, text)).setting.snapshot
    registry = Registry.load()

    def text_at(*place: int) -> str:
        return registry.text(int(snapshot.blocks[snapshot.box.index(place)]))

    heights = {
        (x, z): sum(text_at(x, y, z) != "air" for y in (1, 2, 3))
        for x in range(3)
        for z in range(3)
    }
    assert heights == {
        (0, 0): 1, (1, 0): 3, (2, 0): 3,
        (0, 1): 1, (1, 1): 2, (2, 1): 0,
        (0, 2): 0, (1, 2): 1, (2, 2): 1,
    }  # fmt: skip
    # A plate south of the door is no wall, so that the door does not face east.
    assert "facing=north" in text_at(1, 1, 1)


@pytest.mark.parametrize("symmetry", ["mirrored", "turned-90", "mirrored-270"])
def test_a_map_is_mirrored_as_the_scene_that_it_shows(tmp_path, symmetry):
    variation = Variation({"symmetry": symmetry})
    scenes = []
    for text in (DRAWN, WRITTEN):
        document = read_document(file_of(tmp_path, text))
        scenes.append(Scenario.varied(document, None, {}, variation.scene))
        assert "Vec3(3, 1, 1)" not in variation.template("new Vec3(3, 1, 1)", document)
    assert same(*scenes)
    assert same(scenes[0], Scenario.kept(scenes[0].text, {}, None, "kept"))


def test_instances_draw_within_a_map(tmp_path):
    text = DRAWN + "episode: {goal: {reach: [{agent: ann, at: [1, 1, 2]}]}}\n"
    drawn = {
        tuple(
            bn.Task.load(file_of(tmp_path, text), seed)
            .scenario.setting.snapshot.agents["ann"]
            .inventory
        )
        for seed in range(8)
    }
    assert drawn == {("apple",), ("stick",)}
    wrong = text.replace("seen_by: [bob]", "seen_by: [eve]")
    with pytest.raises(ScenarioError, match="there is no agent 'eve'; agents are ann, bob"):
        bn.Task.load(file_of(tmp_path, wrong), 1)


def test_floors_lie_on_each_other():
    scenario = Scenario.from_mapping(
        {
            "name": "tower",
            "map": {
                "origin": [5, 60, 5],
                "height": 2,
                "floor": None,
                "legend": {"#": "stone", "l": {"block": "ladder[facing=east]", "height": 3},
                           "a": {"agent": "ann"}},
                "floors": [["###", "#a#"], {"rows": "#l#\n###"}, "...\n..."],
            },
        }
    )  # fmt: skip
    place = scenario.setting.snapshot
    assert (place.box.low, place.box.high) == ((5, 60, 5), (7, 64, 6))
    solid = {tuple(at) for at in np.argwhere(place.blocks.dense() != 0).tolist()}
    assert {(1, 0, 0), (1, 1, 0), (1, 2, 0), (1, 3, 0), (1, 4, 0), (1, 2, 1)} <= solid
    assert not {(1, 0, 1), (1, 1, 1), (0, 3, 0)} & solid


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("#C....", "#C...", "21: map.floors, row 2: has 11 columns, but the first row has 12"),
        ("#C....", "#C..?.", "21: map.floors, row 2, column 5: '?' is not in the legend, which"),
        (
            "#C....",
            "#C..a.",
            "22: map.floors, row 3, column 3: agent 'ann' is drawn twice; first at map.floors, "
            "row 2, column 5",
        ),
        (
            "map:",
            "box: [[0, 0, 0], [10, 3, 4]]\nmap:",
            "21: map.floors, row 1, column 12: [11, 1, 0] lies outside the box",
        ),
        ("inventory:", "inventry:", "16: map.legend.a.inventry: unknown key; did you mean"),
        ('"#": bricks', '"#": brikcs', "12: map.legend.#: no block 'brikcs'"),
        ("door: oak", "door: oka", "14: map.legend.D.door: no block 'oka_door'"),
        ("default: diamond}", "default: dimond}", "13: map.legend.C.items.dimond: no item"),
        ("    x: {", "    xx: {", "18: map.legend.xx: is not one character"),
        ("    x: {", "    5: {", "11: map.legend: a key in it: expected 'str', got 'int'; put"),
        ("{place: seat, floor: gold_block}", "{open: true}", "18: map.legend.x: shows nothing"),
        ("{place: seat,", "{items: {apple: 1},", "18: map.legend.x.items: needs container beside"),
        ("{sign: no apples}", "{sign: a, door: oak}", "15: map.legend.s: is both door and sign"),
    ],
)  # fmt: skip
def test_a_wrong_map_names_line_row_and_column(tmp_path, old, new, told):
    assert old in DRAWN
    with pytest.raises(ScenarioError) as caught:
        Scenario.load(file_of(tmp_path, DRAWN.replace(old, new, 1)))
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_drawn_map_may_be_as_high_as_a_world(tmp_path):
    rows = "\n".join("    #" + "." * 299 for _ in range(299))
    file = tmp_path / "high.yaml"
    file.write_text(
        "name: high\nbox: [[-400, 0, -400], [700, 290, 700]]\nmap:\n  origin: [0, 1, 0]\n"
        "  legend: {'#': bricks, a: {agent: ann}}\n  height: 100\n"
        f"  floors: |\n    a{'.' * 299}\n{rows}\n"
    )
    blocks = Scenario.load(str(file)).setting.snapshot.blocks
    air, stone, bricks = map(Registry.load().state_id, ("air", "stone", "bricks"))
    assert blocks.count([bricks]) == 100 * 299
    assert [blocks[400, y, 699] for y in (0, 1, 100, 101)] == [stone, bricks, bricks, air]


def test_more_characters_than_can_be_resolved_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(drawn_map, "_MOST_DRAWN", 5)
    file = tmp_path / "wide.yaml"
    file.write_text("name: wide\nmap:\n  legend: {a: {agent: ann}}\n  floors: |\n    a.....\n")
    with pytest.raises(
        ScenarioError, match=r"map.floors: has \d characters; at most 5 are .* draw"
    ):
        Scenario.load(str(file))
