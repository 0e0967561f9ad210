"""Scenario files: their content reaches the setting, and errors name the line."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

import beliefnest as bn
from beliefnest.errors import ScenarioError, UnknownNameError
from beliefnest.facts.kinds import AgentAt, ItemsIn
from beliefnest.scenarios.expected_acts import Arrives, Opens
from beliefnest.scenarios.json_schema import schema
from beliefnest.scenarios.scenario import Scenario
from beliefnest.scenarios.sources import builtin_names
from beliefnest.scenarios.yaml_reading import parse_yaml
from beliefnest.world.registry import Registry

ROOT = Path(__file__).parents[2]

BASE = """\
name: small
box: [[0, 0, 0], [8, 4, 8]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [8, 0, 8]]}
  - {block: bricks, walls: [[0, 1, 0], [8, 2, 8]]}
  - {block: air, at: [4, 1, 0]}
containers:
  - {label: box, at: [4, 1, 4], block: "barrel[facing=up]", items: {diamond: 2}}
agents:
  ann:
    position: [2.5, 1, 2.5]
    facing: west
    inventory: {apple: 3}
    equipment: {main_hand: iron_pickaxe}
  bob: {position: [6.5, 1, 6.5], yaw: 1.5, pitch: -0.25}
script:
  - label: ann looks
    agent: ann
    program: |
      await think(bot, "hm");
  - {label: both, programs: {ann: "await doNothing(bot)", bob: "await doNothing(bot)"}}
probes:
  - {label: p, path: /bob/ann, acts_in: /bob, agent: ann, task: Go, expect: {opens: [4, 1, 4]}}
expectations:
  - {label: e, path: /ann, container: [4, 1, 4], items: {diamond: 2}}
conditions:
  1: {description: as it is}
  2:
    description: bob is elsewhere
    agents: {bob: {position: [5.5, 1, 6.5]}}
    script: {ann looks: {program: "await doNothing(bot)"}}
    probes: {p: {expect: {opens: null, arrives: [1, 1, 1], within: 3}}}
    expectations:
      - {path: /, agent: ann, at: [2.5, 1, 2.5], within: 0.5}
"""


def write(folder: Path, text: str) -> str:
    file = folder / "small.yaml"
    file.write_text(text, encoding="utf-8")
    return str(file)


def test_the_world_is_as_written(tmp_path: Path) -> None:
    snapshot = Scenario.load(write(tmp_path, BASE)).setting.snapshot
    registry = Registry.load()
    names = {
        position: registry.name(int(snapshot.blocks[snapshot.box.index(position)]))
        for position in snapshot.box.positions()
    }
    assert {p for p, name in names.items() if name == "stone"} == {
        (x, 0, z) for x in range(9) for z in range(9)
    }
    rim = {(x, y, z) for x in range(9) for y in (1, 2) for z in range(9) if {x, z} & {0, 8}}
    assert {p for p, name in names.items() if name == "bricks"} == rim - {(4, 1, 0)}
    assert names[4, 1, 4] == "barrel"
    assert snapshot.containers == {(4, 1, 4): {"diamond": 2}}
    ann, bob = snapshot.agents["ann"], snapshot.agents["bob"]
    assert ann.position == (2.5, 1.0, 2.5)
    assert ann.yaw == pytest.approx(np.pi / 2)
    assert ann.inventory == {"apple": 3, "iron_pickaxe": 1}
    assert ann.equipment == {"main_hand": "iron_pickaxe"}
    assert (bob.yaw, bob.pitch) == (1.5, -0.25)


def test_an_agent_can_face_a_point(tmp_path: Path) -> None:
    text = BASE.replace("facing: west", "facing: [2.5, 1, 8.5]")
    ann = Scenario.load(write(tmp_path, text)).setting.snapshot.agents["ann"]
    assert abs(ann.yaw) == pytest.approx(np.pi)
    assert ann.pitch == pytest.approx(np.arctan2(-1.62, 6))


def test_a_step_knows_where_it_is_written(tmp_path: Path) -> None:
    file = write(tmp_path, BASE)
    first, second = Scenario.load(file).setting.script
    assert first.where == f"{file}:17"
    assert first.programs == {"ann": 'await think(bot, "hm");\n'}
    assert set(second.programs) == {"ann", "bob"}


def test_a_condition_changes_only_what_it_names(tmp_path: Path) -> None:
    file = write(tmp_path, BASE)
    one, two = Scenario.load_all(file)
    assert (one.condition, two.condition) == (1, 2)
    assert two.condition_description == "bob is elsewhere"
    assert one.setting.snapshot.blocks == two.setting.snapshot.blocks
    assert two.setting.snapshot.agents["bob"].position == (5.5, 1.0, 6.5)
    assert two.setting.snapshot.agents["bob"].pitch == -0.25
    assert two.setting.snapshot.agents["ann"] == one.setting.snapshot.agents["ann"]
    assert one.setting.script[0].programs["ann"].startswith("await think")
    assert two.setting.script[0].programs == {"ann": "await doNothing(bot)"}
    assert two.setting.script[1] == one.setting.script[1]
    assert one.probes[0].expect == (Opens((4, 1, 4)),)
    assert two.probes[0].expect == (Arrives((1.0, 1.0, 1.0), 3.0),)
    assert two.probes[0].task == "Go"
    assert one.expectations[0].fact == ItemsIn((4, 1, 4), (("diamond", 2),))
    assert [e.fact for e in two.expectations] == [AgentAt("ann", (2.5, 1.0, 2.5), 0.5)]


def test_initial_beliefs_reach_the_setting() -> None:
    content = {
        "name": "priors",
        "box": [[0, 0, 0], [4, 4, 4]],
        "agents": {"ann": {"position": [0.5, 1, 0.5]}, "bob": {"position": [2.5, 1, 2.5]}},
        "containers": [{"at": [4, 1, 4]}],
        "initial_beliefs": [
            {
                "path": "/ann/bob",
                "containers": [{"at": [4, 1, 4], "items": {"apple": 1}, "complete": False}],
                "blocks": [{"at": [0, 0, 0], "block": "stone"}, {"at": [1, 0, 0], "block": None}],
                "agents": {"ann": [1.5, 1, 1.5]},
            }
        ],
    }
    (belief,) = Scenario.from_mapping(content).setting.initial_beliefs
    assert belief.path == ("ann", "bob")
    assert belief.containers == {(4, 1, 4): ({"apple": 1}, False)}
    assert belief.blocks == {(0, 0, 0): Registry.load().state_id("stone"), (1, 0, 0): -1}
    assert belief.agents == {"ann": (1.5, 1.0, 1.5)}
    # Agents that are only named are believed to be where they stand.
    content["initial_beliefs"] = [{"path": "/**", "agents": ["bob", "ann"]}]
    (belief,) = Scenario.from_mapping(content).setting.initial_beliefs
    assert belief.agents == {"bob": (2.5, 1.0, 2.5), "ann": (0.5, 1.0, 0.5)}


@pytest.mark.parametrize("name", builtin_names())
def test_built_in_scenarios_load_under_every_condition(name: str) -> None:
    scenarios = Scenario.load_all(name)
    assert [s.condition for s in scenarios] == sorted(scenarios[0].conditions) or [None]
    for scenario in scenarios:
        assert scenario.setting.script
        assert scenario.expectations


FAULTS = [
    ("block: bricks", "block: brikcs", 5, "blocks[1].block", "bricks"),
    ("{diamond: 2}", "{diamnod: 2}", 8, "containers[0].items.diamnod", "diamond"),
    ("{diamond: 2}", "{diamond: 0}", 8, "containers[0].items.diamond", "at least 1"),
    ("{diamond: 2}", "{diamond: 9999}", 8, "containers[0].items", "27"),
    ("{diamond: 2}", "{diamond: two}", 8, "containers[0].items.diamond", "int"),
    ('[4, 1, 4], block: "barrel', '[4, 1, 9], block: "barrel', 8, "containers[0].at", "outside"),
    ("barrel[facing=up]", "barrel[facing=sideways]", 8, "containers[0].block", "facing"),
    ("barrel[facing=up]", "stone", 8, "containers[0].block", "no container"),
    ("[6.5, 1, 6.5]", "[2.8, 1, 2.5]", 15, "agents.bob.position", "ann"),
    ("[6.5, 1, 6.5]", "[4.5, 1, 5.1]", 15, "agents.bob.position", "barrel"),
    ("[6.5, 1, 6.5]", "[6.5, 0.5, 6.5]", 15, "agents.bob.position", "stone"),
    ("[6.5, 1, 6.5]", "[66.5, 1, 6.5]", 15, "agents.bob.position", "outside"),
    ("[6.5, 1, 6.5]", "[.nan, 1, 6.5]", 15, "agents.bob.position", "finite"),
    ("  bob: {pos", "  bob the builder: {pos", 15, "agents.bob the builder", "letters"),
    ("main_hand: iron_pickaxe", "main_hand: iron_pikaxe", 14, "main_hand", "iron_pickaxe"),
    ("main_hand:", "left_hand:", 14, "agents.ann.equipment.left_hand", "_hand"),
    ("    facing: west\n", "    facing: up\n", 12, "agents.ann.facing", "north"),
    ("    facing: west\n", "    facign: west\n", 12, "agents.ann.facign", "facing"),
    ("    position: [2.5, 1, 2.5]\n", "", 10, "agents.ann", "position"),
    ("agent: ann\n    program", "agent: anna\n    program", 18, "script[0].agent", "ann, bob"),
    ("    agent: ann\n", "", 17, "script[0]", "agent"),
    (', bob: "await', ', bo: "await', 21, "script[1].programs.bo", "ann, bob"),
    ("path: /bob/ann", "path: /bob/carl", 23, "probes[0].path", "carl"),
    ("path: /bob/ann", "path: bob", 23, "probes[0].path", "belief path"),
    ("{opens: [4, 1, 4]}", "{opens: [4, 2, 4]}", 23, "probes[0].expect.opens", "no container"),
    ("{opens: [4, 1, 4]}", "{}", 23, "probes[0].expect", "at least one"),
    ("items: {diamond: 2}}\ncond", "items: {dimond: 2}}\ncond", 25, "expectations[0]", "diamond"),
    ("at: [4, 1, 0]", "at: [4, 1, 0], fill: [[0, 0, 0], [1, 1, 1]]", 6, "blocks[2]", "exactly one"),
    ("name: small", "nmae: small", 1, "nmae", "name"),
    ("name: small", "name: ../small", 1, "name", "letters"),
    ("box: [[0", "box: [[0.5", 2, "box[0][0]", "int"),
    ("[8, 4, 8]]\nblocks", "[80000, 4, 80000]]\nblocks", 2, "box", "smaller"),
]


TALK = """
signs: [{at: [3, 1, 3], text: mine}]
perception:
  testimony: informed
  grace: 5
initial_beliefs:
  - {path: /bob, blocks: [{at: [1, 1, 1], block: stone}]}
  - {path: /ann, blocks: [{at: [1, 1, 1], block: stone}]}
"""
FAULTS_OF_TALK = [
    ("at: [3, 1, 3]", "at: [4, 1, 4]", 1, "signs[0].at", "has a container already"),
    ("text: mine", "text: 17", 1, "signs[0].text", "put it into quotes"),
    ("grace: 5", "grace: -1", 4, "perception.grace", "got -1"),
    ("grace: 5", "hearing: maybe", 4, "perception.hearing", "global, sight, {radius: ...}"),
    ("perception:", "testimony: accept\nperception:", 2, "testimony", "stands under 'perception'"),
    ("path: /ann", "path: /bob/", 7, "initial_beliefs[1].path", "put them into one"),
    ("path: /ann,", "path: /ann, agents: [eve],", 7, "initial_beliefs[1].agents[0]", "no agent"),
    (
        "path: /ann",
        "path: /ann/**/bob",
        7,
        "initial_beliefs[1].path",
        "may only stand at its end, once",
    ),
    ("path: /ann", "path: ann/**", 7, "initial_beliefs[1].path", "'ann/**' is not a belief path"),
    (
        "path: /ann",
        "path: /eve/**",
        7,
        "initial_beliefs[1].path",
        "'/eve/**' names an unknown agent 'eve'",
    ),
]


@pytest.mark.parametrize(("old", "new", "line", "key", "hint"), FAULTS_OF_TALK)
def test_a_fault_in_what_is_said_and_believed_is_named(
    tmp_path: Path, old: str, new: str, line: int, key: str, hint: str
) -> None:
    head = BASE.partition("conditions:")[0].rstrip("\n")
    file = write(tmp_path, head + TALK.replace(old, new, 1))
    with pytest.raises(ScenarioError) as caught:
        Scenario.load(file)
    message = str(caught.value)
    assert message.startswith(f"{file}:{head.count(chr(10)) + 1 + line}: {key}: "), message
    assert hint in message


@pytest.mark.parametrize(("old", "new", "line", "key", "hint"), FAULTS)
def test_a_fault_is_named_with_file_line_and_key(
    tmp_path: Path, old: str, new: str, line: int, key: str, hint: str
) -> None:
    assert BASE.count(old) >= 1
    file = write(tmp_path, BASE.replace(old, new, 1))
    with pytest.raises(ScenarioError) as caught:
        Scenario.load(file)
    message = str(caught.value)
    assert message.startswith(f"{file}:{line}: "), message
    assert key in message
    assert hint in message
    assert "\n" not in message


ASKED = "{question: Q, options: [a box, a pot], right: %s}"


@pytest.mark.parametrize(
    ("expect", "line", "told"),
    [
        ("{answers: " + ASKED % "a bax" + "}", 1, "'a bax' is none of the options"),
        (
            "\n      answers:\n        question: Q\n        options: [no, yes]\n        right: on",
            5,
            "'on' is none of the options",
        ),
        ("{answers: " + ASKED % "3" + "}", 1, "a text, or a list such as [text], or a mapping"),
        ("{answers: " + ASKED % "{path: /bob, container: box}" + "}", 1, "such as [1, 2, 3], got"),
        ("{answers: " + ASKED % "{path: /bob, item: apple, items: {}}" + "}", 1, "leaves open how"),
        ("{opens: box}", 1, "got 'box'; 'box' is at [4, 1, 4]"),
        ("{opens: {path: /bob, agent: ann}}", 1, "write one, or {path: /bob, item: ...}"),
    ],
)
def test_a_fault_of_a_probe_is_told_in_the_words_of_files(
    tmp_path: Path, expect: str, line: int, told: str
) -> None:
    before = BASE.partition("probes:")[0] + "probes:\n"
    probe = f"  - {{path: /bob, acts_in: /, agent: ann, task: Go,\n    expect: {expect}}}\n"
    if "\n" in expect:
        probe = f"  - path: /bob\n    expect: {expect}\n"
    file = write(tmp_path, before + probe)
    with pytest.raises(ScenarioError, match=re.escape(told)) as caught:
        Scenario.load(file)
    place = f"{file}:{before.count(chr(10)) + 1 + line}: probes[0].expect"
    assert str(caught.value).startswith(place), caught.value


@pytest.mark.parametrize("containers", ["box", "[box, 3, {label: [1]}]", "{label: box}", "null"])
def test_a_file_with_several_faults_is_told_of_one(tmp_path: Path, containers: str) -> None:
    goal = "episode: {goal: {reach: [{container: box, items: {diamond: 1}}]}}\n"
    text = f"{goal}name: small\ncontainers: {containers}\nplaces: box\n"
    with pytest.raises(ScenarioError, match="expected a "):
        Scenario.load(write(tmp_path, text))


def test_a_fault_in_a_condition_is_named_where_the_condition_is_written(tmp_path: Path) -> None:
    file = write(tmp_path, BASE.replace("[5.5, 1, 6.5]", "[2.5, 1, 2.5]"))
    Scenario.load(file, 1)
    with pytest.raises(ScenarioError, match=r"small.yaml:30: agents.bob.position: .*ann"):
        Scenario.load(file, 2)
    with pytest.raises(ScenarioError, match=r"small.yaml:30: "):
        Scenario.load_all(file)


def test_an_empty_mapping_of_a_condition_replaces_a_mapping(tmp_path: Path) -> None:
    emptied = """\
  2:
    agents: {ann: {inventory: {}}}
    expectations: {e: {items: {}}}
    script: {}
"""
    file = write(tmp_path, BASE.partition("  2:\n")[0] + emptied)
    one, two = Scenario.load_all(file)
    assert one.setting.snapshot.agents["ann"].inventory["apple"] == 3
    assert "apple" not in two.setting.snapshot.agents["ann"].inventory
    assert two.expectations[0].fact == ItemsIn((4, 1, 4), ())
    assert two.setting.script == one.setting.script


def test_a_condition_can_only_change_labels_that_are_there(tmp_path: Path) -> None:
    file = write(tmp_path, BASE.replace("script: {ann looks:", "script: {ann loks:"))
    with pytest.raises(ScenarioError, match=r"small.yaml:31: .*'ann looks', 'both'"):
        Scenario.load(file, 2)


def test_an_unknown_condition_names_the_known_ones(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="no condition 7; conditions are 1, 2"):
        Scenario.load(write(tmp_path, BASE), 7)


@pytest.mark.parametrize(
    ("text", "line"),
    [("name: [1, 2\nbox: 3\n", 2), ("name: a\nname: b\n", 2), ("\tname: a\n", 1)],
)
def test_broken_yaml_names_the_line(tmp_path: Path, text: str, line: int) -> None:
    file = write(tmp_path, text)
    with pytest.raises(ScenarioError, match="broken YAML") as caught:
        Scenario.load(file)
    assert str(caught.value).startswith(f"{file}:{line}: ")


@pytest.mark.parametrize(
    "text",
    [
        "",
        "- a\n",
        "a: &a {b: *a}\n",
        "a: &a [1, 1]\nb: &b [*a, *a]\n" + "c: [" + "*b, " * 60000 + "]",
    ],
)
def test_what_is_no_scenario_is_refused(tmp_path: Path, text: str) -> None:
    with pytest.raises(ScenarioError, match=r"small\.yaml"):
        Scenario.load(write(tmp_path, text))


def test_unreadable_files_are_named(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"missing\.yaml: cannot be read: No such file"):
        Scenario.load(str(tmp_path / "missing.yaml"))
    with pytest.raises(ScenarioError, match="is a folder; give a"):
        Scenario.load(str(tmp_path))
    binary = tmp_path / "binary.yaml"
    binary.write_bytes(b"name: \xff\xfe")
    with pytest.raises(ScenarioError, match="UTF-8"):
        Scenario.load(str(binary))
    with pytest.raises(UnknownNameError, match="sally-anne"):
        Scenario.load("sally-ann")


def test_the_published_schema_is_that_of_the_types() -> None:
    published = json.loads((ROOT / "docs" / "scenario.schema.json").read_text(encoding="utf-8"))
    assert published == json.loads(json.dumps(schema())), "write it anew with `make schema`"


def test_a_condition_may_be_given_as_text() -> None:
    assert Scenario.load("sally-anne", "3").condition == 3
    with pytest.raises(bn.ScenarioError, match="give its number"):
        Scenario.load("sally-anne", condition="three")


def test_a_nest_of_a_scenario_is_opened_otherwise() -> None:
    with pytest.raises(bn.InputError, match=r"bn\.Nest\.open\(scenario\)"):
        bn.Nest(Scenario.load("sally-anne"))  # type: ignore[arg-type]


def test_a_program_that_breaks_flow_yaml_is_told_how_to_be_written() -> None:
    text = "script:\n  - {agent: a, program: await go(bot, new Vec3(1, 2, 3), {a: 1});}\n"
    with pytest.raises(bn.ScenarioError, match=r"x\.yaml:2: .*'program: \|'"):
        parse_yaml(text, "x.yaml")
