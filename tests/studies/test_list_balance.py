"""Lists of a Latin square hold each right answer equally often, or the study says so."""

import json
import warnings
from collections import Counter

import pytest

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.scenarios.probing import resolved
from beliefnest.studies.list_balance import ListsWarning

SCENE = """
name: boxes
description: Ann puts something into one of two boxes, before Bob's eyes or behind his back.
box: [[0, 0, 0], [8, 3, 4]]
blocks: [{block: stone, fill: [[0, 0, 0], [8, 0, 4]]}]
static_blocks: [stone]
containers:
  - {label: red box, at: [2, 1, 1], block: barrel}
  - {label: blue box, at: [6, 1, 1], block: barrel}
agents:
  ann: {position: [4.5, 1, 2.5], inventory: {apple: 1, bone: 1, clock: 1, egg: 1}}
  bob: {position: [4.5, 1, 3.5]}
parameters:
  set: {default: [apple, 2, 6]}
script:
  - label: put
    agent: ann
    program: "await depositItemIntoChest(bot, new Vec3(${set[1]}, 1, 1), {${set[0]}: 1});"
  - {label: move, agent: ann, program: "await doNothing(bot);"}
probes:
  - label: where
    path: /
    expect:
      answers:
        question: Where is it?
        options: [red box, blue box]
        right: {path: /, item: "${set[0]}"}
conditions:
  1: {description: It stays.}
  2:
    description: It is moved.
    script:
      move:
        program: >-
          await getItemFromChest(bot, new Vec3(${set[1]}, 1, 1), {${set[0]}: 1});
          await depositItemIntoChest(bot, new Vec3(${set[2]}, 1, 1), {${set[0]}: 1});
"""


def square(tmp_path, values):
    (tmp_path / "boxes.yaml").write_text(SCENE)
    return bn.Study(
        [str(tmp_path / "boxes.yaml")],
        models=["chance"],
        variations={"set": values},
        design="latin-square",
        world="scripted",
    )


def rights(study):
    """Return how often each answer is right in each list, by playing all of it."""
    found = {}
    for cell in study.plan().cells:
        with bn.Nest.open(cell.scenario, world="scripted", seed=0) as nest:
            nest.play()
            (question,) = resolved(nest, cell.scenario.probes[0]).questions
        found.setdefault(cell.list_number, Counter()).update(question.right)
    return found


def test_values_that_alternate_as_conditions_do_are_balanced(tmp_path):
    alternating = [["apple", 2, 6], ["bone", 6, 2], ["clock", 2, 6], ["egg", 6, 2]]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        study = square(tmp_path, alternating)
        assert rights(study) == {
            1: {"red box": 2, "blue box": 2},
            2: {"red box": 2, "blue box": 2},
        }
    for number in (1, 2):
        cells = [cell for cell in study.plan().cells if cell.list_number == number]
        assert Counter(cell.key.condition for cell in cells) == {1: 2, 2: 2}
        assert len({repr(cell.key.variation) for cell in cells}) == len(alternating)


def test_lists_that_cannot_be_balanced_are_told_with_a_table(tmp_path):
    # Two values that alternate leave one answer for each list, however they are exchanged.
    with pytest.warns(ListsWarning, match=r"boxes cannot be balanced .* where, blue box: 0 2; whe"):
        square(tmp_path, [["apple", 2, 6], ["bone", 6, 2]]).plan()


def test_power_needs_no_lists_that_are_alike(tmp_path, monkeypatch):
    alternating = [["apple", 2, 6], ["bone", 6, 2], ["clock", 2, 6], ["egg", 6, 2]]
    planned, new = square(tmp_path, alternating), square(tmp_path, alternating)
    planned.plan()
    # To balance lists, every scene is played.
    monkeypatch.setattr(bn.Nest, "play", None)
    with pytest.raises(TypeError):
        square(tmp_path, alternating).plan()
    assert new.power_sources() == planned.power_sources()


def test_what_was_warned_of_stands_below_the_table(tmp_path, capsys):
    values = [["apple", 2, 6], ["bone", 6, 2]]
    square(tmp_path, values)
    names = {"scenarios": [str(tmp_path / "boxes.yaml")], "models": ["chance", "first-option"]}
    chosen = {"variations": {"set": values}, "design": "latin-square"}
    file = tmp_path / "s.yaml"
    file.write_text(json.dumps({**names, **chosen, "world": "scripted"}), encoding="utf-8")
    with warnings.catch_warnings(record=True):
        warnings.simplefilter("always", ListsWarning)
        run_command_line(["study", str(file), "--out", str(tmp_path / "out"), "--jobs", "1"])
    printed = capsys.readouterr().out
    table, _, below = printed.partition("warning: the lists of boxes cannot be balanced")
    assert "first-option" in table
    assert below
    methods = bn.StudyResult.read(tmp_path / "out").methods()
    assert "`chance` and `first-option` are no language models of a provider" in methods
    assert "Models were asked" not in methods
