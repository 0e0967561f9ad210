"""Edits of scenario files: they do what is asked, and leave everything else as it was."""

import pytest
import yaml

from beliefnest.cli.scenario_editing import drawn_starter, edited
from beliefnest.errors import InputError
from beliefnest.scenarios.scenario import Scenario
from beliefnest.scenarios.sources import builtin_file

DRAWN = """\
name: small   # a comment
parameters: {what: {default: diamond}}
map:
  legend:
    "#": bricks
    C: {container: chest, label: red box, items: {"${what}": 1}}  # another
    a: {agent: ann, facing: east}
  floors: |
    ######
    #C.a.#
    #....#
    ######
agents:
  ann: {inventory: {apple: 1}}
script:
  - {agent: ann, program: "await doNothing(bot);"}
"""


def scene(text):
    return Scenario.from_mapping(yaml.safe_load(text)).setting.snapshot


def put(text, at, thing):
    return edited(text, {"do": "put", "at": at, "thing": thing})


def test_things_are_put_on_a_map_and_the_rest_stays():
    text = put(DRAWN, [2, 1, 2], {"container": "barrel", "label": "blue box"})
    text = put(text, [3, 1, 2], "bricks")
    text = put(text, [4, 1, 2], {"agent": "ann", "facing": "north"})
    text = put(text, [2, 1, 1], {"agent": "bob"})
    text = put(text, [4, 1, 1], {"place": "seat"})
    text = edited(edited(text, {"do": "clear", "at": [1, 1, 1]}), {"do": "grow", "side": "east"})
    assert "    #.bx##\n" not in text
    assert "######\n" in text
    for kept in ("# a comment", "# another", '"${what}": 1', 'program: "await doNothing(bot);"'):
        assert kept in text
    found = scene(text)
    assert found.containers == {(2, 1, 2): {}}
    assert found.agents["ann"].position == (4.5, 1, 2.5)
    assert found.agents["ann"].yaw == 0
    assert found.agents["ann"].inventory == {"apple": 1}
    assert found.agents["bob"].position == (2.5, 1, 1.5)
    assert found.box.high == (6, 3, 3)
    # A thing that the legend knows gets its character.
    assert text.count("bricks") == 1
    assert yaml.safe_load(text)["map"]["floors"].splitlines()[2] == "#.B#a##"


def test_an_ordinary_file_keeps_its_form():
    before = builtin_file("sally-anne").read_text(encoding="utf-8")
    text = put(before, [0, -51, 2], {"agent": "sally", "facing": "east"})
    text = put(text, [4, -51, 4], "bricks")
    text = put(text, [5, -51, 4], {"container": "barrel", "label": "third", "items": {"apple": 2}})
    text = put(text, [6, -51, 4], {"door": "oak", "facing": "east"})
    text = put(text, [7, -51, 7], {"place": "seat"})
    text = edited(text, {"do": "clear", "at": [2, -51, -4]})
    old, new = yaml.safe_load(before), yaml.safe_load(text)
    assert new["agents"]["sally"] == {
        "position": [0.5, -51, 2.5],
        "facing": "east",
        "inventory": {"diamond": 1},
    }
    assert new["blocks"][: len(old["blocks"])] == old["blocks"]
    assert [each["label"] for each in new["containers"]] == ["left chest", "third"]
    assert new["places"] == {"seat": [7, -51, 7]}
    rest = set(old) - {"agents", "blocks", "containers"}
    assert {key: new[key] for key in rest} == {key: old[key] for key in rest}
    assert "# Behind the east wall Sally does not see the chests" in text
    # The last wall is taken back; other blocks become air.
    walled = put(before, [4, -51, 4], "bricks")
    assert yaml.safe_load(edited(walled, {"do": "clear", "at": [4, -51, 4]})) == old


@pytest.mark.parametrize(
    ("edit", "told"),
    [
        ({"do": "put", "at": [9, 1, 9], "thing": "stone"}, "is not on the map"),
        ({"do": "put", "at": [1, 1], "thing": "stone"}, "is no position"),
        ({"do": "put", "at": [1, 1, 1], "thing": 3}, "is no thing"),
        ({"do": "grow", "side": "up"}, "is no side to grow"),
        ({"do": "paint"}, "is no edit"),
        ({"do": "put", "at": [1, 1, 1], "thing": {"agent": ["x"]}}, "is no thing"),
    ],
)
def test_wrong_edits_are_refused(edit, told):
    with pytest.raises(InputError, match=told):
        edited(DRAWN, edit)


def test_what_a_parameter_decides_is_not_edited():
    text = builtin_file("sally-anne").read_text(encoding="utf-8")
    text = text.replace("[-0.5, -51, 3.5]", '"${spot}"')
    text += "parameters: {spot: {default: [1.5, -51, 3.5]}}\n"
    with pytest.raises(InputError, match=r"position of sally is .*, a parameter"):
        put(text, [0, -51, 2], {"agent": "sally"})


def test_a_new_file_is_a_scenario():
    assert list(scene(drawn_starter("mine")).agents) == ["ann"]
