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


PROGRAM = """
  thing: {default: diamond, values: [diamond, bone]}
  count: {default: 1, range: [1, 3]}
script: [{agent: ann, program: "PROGRAM"}]
"""


def played(tmp_path, program, **values):
    parameters = PROGRAM.replace("PROGRAM", program)
    file = tmp_path / "room.yaml"
    file.write_text(SCENE.replace("QUESTION", "${thing} ${count}") + parameters)
    scenario = bn.Scenario.load(str(file), parameters=values or None)
    return scenario.setting.script[0].programs["ann"]


@pytest.mark.parametrize(
    "program", ["say(bot, 'a ${thign}')", "${thign}", "say(bot, 'it`s') // ${thign}"]
)
def test_a_misspelt_name_in_a_program_is_refused(tmp_path, program):
    with pytest.raises(ScenarioError, match="program: 'thign' names 'thign'; did you mean 'thing'"):
        played(tmp_path, program)


@pytest.mark.parametrize("hole", ["name", "bot.health", "thign"])
def test_template_literals_of_programs_keep_their_holes(tmp_path, hole):
    assert played(tmp_path, f"say(bot, `${{{hole}}} ${{thing}}`)") == (
        f"say(bot, `${{{hole}}} diamond`)"
    )


def test_a_value_does_not_bring_a_misspelt_name_into_a_program(tmp_path):
    parameters = """
  asked: {default: "where ${thign} is"}
  thing: {default: key}
script: [{agent: ann, program: "say(bot, '${asked} ${thing}')"}]
"""
    with pytest.raises(ScenarioError, match=r"program: would hold '\$\{thign\}'"):
        description(tmp_path, parameters, "${thing}")


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ({"thing": "bnoe"}, 'is given \'bnoe\', and lists "diamond", "bone"; correct one'),
        ({"count": 4}, "is given 4, and lists numbers from 1 to 3"),
        ({"count": "two"}, "is given 'two', and lists numbers from 1 to 3"),
    ],
)
def test_given_values_that_the_file_does_not_list_are_warned_of(tmp_path, values, told):
    file = tmp_path / "room.yaml"
    parameters = PROGRAM.replace("PROGRAM", "think(bot, 'hm')")
    file.write_text(SCENE.replace("QUESTION", "${thing} ${count}") + parameters)
    with pytest.warns(UserWarning) as given:
        (warned,) = bn.Scenario.load(str(file), parameters=values).warnings
    assert told in str(warned)
    assert [str(each.message) for each in given] == [str(warned)]
    assert not bn.Scenario.load(str(file), parameters={"thing": "bone", "count": 3}).warnings


def test_no_value_is_refused(tmp_path):
    with pytest.raises(ScenarioError, match=r"parameters\.thing: is None; give a value"):
        played(tmp_path, "think(bot, 'hm')", thing=None)


@pytest.mark.parametrize(
    ("more", "warned"),
    [
        ("  spare: {default: 1}\n", True),
        ("  spare: {default: 1}\nconstraints: [spare <= count]\n", False),
        ("  spare: {default: 1}\nconditions: {1: {description: 'a ${spare}'}}\n", False),
        ("  spare: {default: ann}\nplaces: {'${spare}': [1, 1, 1]}\n", False),
        ("  spare: {default: 1}\n  thing: {default: '${spare}'}\n", False),
    ],
)
def test_a_parameter_that_is_used_nowhere_is_warned_of(tmp_path, more, warned):
    file = tmp_path / "room.yaml"
    declared = "\n  count: {default: 1}\n" + more
    file.write_text(SCENE.replace("QUESTION", "a ${count}") + declared)
    told = [str(each) for each in bn.Scenario.load(str(file)).warnings]
    assert [each for each in told if "parameters.spare: is used nowhere" in each] == told * warned
    assert bool(told) is (warned or "thing" in more)


def test_values_are_given_by_name(tmp_path):
    for values, told in ((["thing"], "give values by name"), ({3: 3}, "no parameter 3; declared")):
        with pytest.raises(ScenarioError, match=told):
            bn.Scenario.load("lie", parameters=values)


@pytest.mark.parametrize(
    ("declared", "told"),
    [
        ("values: diamond", r"values: expected a list such as \[\.\.\.\], got 'diamond'"),
        ("range: [1, a]", r"range\[1\]: expected an integer, or a number, got 'a'"),
        ("valeus: [1]", "valeus: unknown key; did you mean 'values'"),
    ],
)
def test_a_declaration_of_a_wrong_form_says_what_to_write(tmp_path, declared, told):
    with pytest.raises(ScenarioError, match=rf"room\.yaml:9: parameters\.asked\.{told}"):
        description(tmp_path, f"\n  asked: {{default: 1, {declared}}}\n")
