"""Warnings about scenarios: said with file and line, once, and without any effect on results."""

import warnings
from pathlib import Path

import pytest

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.llm.offline import OfflineModel
from beliefnest.scenarios.content import ScenarioWarning
from beliefnest.scenarios.prose_check import ProseWarning
from beliefnest.scenarios.running import run_scenario

ROOM = """\
name: room
map:
  legend:
    "#": {block: stone, height: 3}
    r: {container: barrel, label: red box, items: {apple: 1}}
    b: {container: barrel, label: blue box}
    a: {agent: ann}
    o: {agent: bob, inventory: {bread: 1}}
  floors: |
    ###########
    #..r....b.#
    #.a.......#
    #........o#
    ###########
static_blocks: [stone]
script:
  - {label: look, agent: ann, program: "await waitTicks(bot, 1);"}
probes:
  - label: ask
    path: /
    template: story
    expect:
      answers:
        question: Where does Bob think the apple is?
        options: [red box, blue box, nobody can know]
        right: {path: /bob, item: apple, unknown: nobody can know}
perception: {containers: transparent}
"""
LOW = """\
name: low
map:
  legend: {"#": stone, a: {agent: ann}, b: {agent: bob}}
  floors:
    - rows: ["#######", "#a.#.b#", "#..#..#", "#######"]
"""


def loaded(tmp_path: Path, text: str, condition: int | None = None) -> bn.Scenario:
    file = tmp_path / "room.yaml"
    file.write_text(text)
    return bn.Scenario.load(str(file), condition)


def said(scenario: bn.Scenario) -> list[str]:
    """Return the warnings of a scenario that is played."""
    with bn.Nest.open(scenario, "scripted") as nest, warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always", ScenarioWarning)
        run_scenario(nest, scenario, OfflineModel(), 0, 0.0, lambda *_: None)
    return texts(found)


def texts(found: list[warnings.WarningMessage]) -> list[str]:
    """Return the warnings, apart from those about prose."""
    ours = [each.message for each in found if isinstance(each.message, ScenarioWarning)]
    return [str(each) for each in ours if not isinstance(each, ProseWarning)]


def changed(old: str, new: str) -> str:
    assert old in ROOM
    return ROOM.replace(old, new)


def test_a_sound_scenario_has_no_warnings(tmp_path: Path) -> None:
    assert said(loaded(tmp_path, ROOM)) == []


@pytest.mark.parametrize(
    ("text", "place", "what"),
    [
        (LOW, "room.yaml:", "agents see each other over them"),
        (changed("{agent: bob,", "{agent: Ann,"), "room.yaml:", "differs from 'ann' only in case"),
        (changed("blue box}", "Red Box}"), "room.yaml:", "differs from 'red box' only in case"),
        (ROOM + "places: {ANN: [2, 1, 2]}\n", "room.yaml:", "'ANN' differs from 'ann'"),
        (changed("{bread: 1}", "{apple: 1}"), "room.yaml:", "there are several"),
        (changed("[red box, blue", "[box, red box, blue"), "room.yaml:", "'box' is contained"),
    ],
)
def test_what_the_file_says_is_named_with_its_line(
    tmp_path: Path, text: str, place: str, what: str
) -> None:
    text = text.replace("/bob", "/ann") if "{agent: Ann," in text else text
    first, *_ = [str(each) for each in loaded(tmp_path, text).warnings]
    assert place in first
    assert what in first


@pytest.mark.parametrize(
    "rows",
    [
        '[{rows: ["#######", "#a.#.b#", "#..#..#", "#######"], height: 2}]',
        '["#####", "#a.b#", "#.#.#", "#...#", "#####"]',
    ],
)
def test_high_walls_and_single_blocks_are_no_low_walls(tmp_path: Path, rows: str) -> None:
    low = '    - rows: ["#######", "#a.#.b#", "#..#..#", "#######"]\n'
    rows = rows if "rows" in rows else f"[{{rows: {rows}}}]"
    text = LOW.replace("floors:\n" + low, f"floors: {rows}\n")
    assert loaded(tmp_path, text).warnings == ()


def test_a_gift_beside_somebody_else_is_named(tmp_path: Path) -> None:
    third = changed("#.a.......#", "#.ac......#").replace(
        "    a: {agent: ann}\n", "    a: {agent: ann}\n    c: {agent: cid}\n"
    )
    give = "await giveItemToOther(bot, 'ann', 'bread', 1);"
    gift = third.replace(
        '{label: look, agent: ann, program: "await waitTicks(bot, 1);"}',
        f'{{label: give, agent: bob, program: "{give}"}}',
    )
    (only,) = (str(each) for each in loaded(tmp_path, gift).warnings)
    assert ": script[0]: bob throws a gift to ann, and cid stands so near" in only
    far = gift.replace("#.ac......#", "#.a......c#")
    assert loaded(tmp_path, far).warnings == ()


def test_several_right_answers_are_named(tmp_path: Path) -> None:
    twice = changed("blue box}", "blue box, items: {apple: 1}}")
    told = said(loaded(tmp_path, twice))
    assert any(
        ": probes[0].expect.answers[0].right: probe 'ask' has 2 right answers, "
        "'red box' and 'blue box'" in each
        for each in told
    )
    assert said(loaded(tmp_path, changed("blue box}", "blue box, items: {bone: 1}}"))) == []


@pytest.mark.parametrize(
    ("intended", "what"),
    [
        ("true belief", None),
        ("red box", None),
        ("false belief", "is meant as 'false belief', but the computed right answer 'red box'"),
        ("blue box", "is meant as 'blue box', but the computed right answer is 'red box'"),
    ],
)
def test_what_is_intended_is_held_against_what_is_computed(
    tmp_path: Path, intended: str, what: str | None
) -> None:
    told = said(loaded(tmp_path, changed("label: ask", f"label: ask\n    intended: {intended}")))
    if what is None:
        assert told == []
    else:
        (only,) = told
        assert ": probes[0]: " in only
        assert what in only


def test_what_is_intended_of_an_answer_by_hand_is_named_as_not_checked(tmp_path: Path) -> None:
    by_hand = changed("{path: /bob, item: apple, unknown: nobody can know}", "red box")
    assert said(loaded(tmp_path, by_hand)) == []
    text = by_hand.replace("label: ask", "label: ask\n    intended: true belief")
    (only,) = said(loaded(tmp_path, text))
    assert "is meant as 'true belief', which is not checked" in only


def test_a_condition_is_held_against_its_description(tmp_path: Path) -> None:
    text = (
        ROOM + "conditions:\n  1: {description: A false belief.}\n  2: {description: True belief}\n"
    )
    (only,) = said(loaded(tmp_path, text, 1))
    assert "condition 1 is described as 'A false belief.'" in only
    assert "is that of a true belief" in only
    assert said(loaded(tmp_path, text, 2)) == []


STUDY = "scenarios: [room.yaml]\nmodels: [offline]\nrepeats: 3\nworld: scripted\n"


@pytest.mark.parametrize("command", ["run", "study", "participants"])
def test_commands_say_a_warning_once(tmp_path: Path, command: str, capfd) -> None:
    text = ROOM + "conditions:\n  1: {description: A false belief.}\n"
    text = text.replace("blue box}", "Red Box}").replace("[red box, blue box,", "[red box,")
    (tmp_path / "room.yaml").write_text(text)
    (tmp_path / "study.yaml").write_text(STUDY)
    file = tmp_path / ("room.yaml" if command == "run" else "study.yaml")
    options = ["--world", "scripted"] if command == "run" else []
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always", ScenarioWarning)
        run_command_line([command, str(file), "--out", str(tmp_path / "out"), *options])
    told = texts(found)
    assert sum("only in case" in each for each in dict.fromkeys(told)) == 1
    assert sum("is described as" in each for each in dict.fromkeys(told)) == 1
    if command == "study":
        assert len(told) == 2
    assert "Warning" not in capfd.readouterr().err
