"""Values of parameters that name other parameters."""

import pytest

import beliefnest as bn
from beliefnest.errors import ScenarioError

SCENE = """
name: room
box: [[0, 0, 0], [4, 3, 4]]
blocks: [{block: stone, fill: [[0, 0, 0], [4, 0, 4]]}]
agents: {ann: {position: [1.5, 1, 1.5]}}
description: "QUESTION"
parameters:
"""


def description(tmp_path, parameters, shown="${asked}", **values):
    file = tmp_path / "room.yaml"
    file.write_text(SCENE.replace("QUESTION", shown) + parameters)
    return bn.Scenario.load(str(file), parameters=values or None).description


def test_a_value_may_name_other_parameters_of_any_form(tmp_path):
    parameters = """
  asked: {default: "Where is ${thing}?"}
  thing: {default: "the ${set[0]} at ${set[1]}"}
  set: {default: ["${item}", [1, 2]]}
  item: {default: key}
"""
    assert description(tmp_path, parameters) == "Where is the key at 1, 2?"
    assert description(tmp_path, parameters, item="egg") == "Where is the egg at 1, 2?"


def test_a_value_that_contains_itself_is_refused(tmp_path):
    parameters = """
  asked: {default: "${other}"}
  other: {default: "again ${asked}"}
"""
    with pytest.raises(ScenarioError, match=r"room\.yaml:\d+: .*contains itself: 'asked' in 'oth"):
        description(tmp_path, parameters)


@pytest.mark.parametrize("shown", ["${asked}", "Now: ${asked}"])
def test_what_names_no_parameter_is_never_shown(tmp_path, shown):
    with pytest.raises(ScenarioError, match=r"description.* '\$\{nobody\[0\]\}'"):
        description(tmp_path, '\n  asked: {default: "Where is ${nobody[0]}?"}\n', shown)


def test_nor_is_it_where_no_parameter_is_declared(tmp_path):
    with pytest.raises(ScenarioError, match=r"room\.yaml:6: description"):
        description(tmp_path, " {}\n", "Where is ${set[0]}?")


@pytest.mark.parametrize("shown", ["Where is ${asked?", "It is ${asked[{0}]}.", "A ${"])
def test_an_expression_without_an_end_is_not_shown_either(tmp_path, shown):
    told = r"description: has a '\$\{' without an expression; write \$\{NAME\}"
    for parameters in ("\n  asked: {default: x}\n", " {}\n"):
        with pytest.raises(ScenarioError, match=told):
            description(tmp_path, parameters, shown)
    with pytest.raises(ScenarioError, match=told):
        description(tmp_path, f"\n  asked: {{default: {shown!r}}}\n")
