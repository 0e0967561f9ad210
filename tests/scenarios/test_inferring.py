"""Scenario files infer what agents want and believe, and hold that against expectations."""

import json
import re
import time
from pathlib import Path

import pytest
from ruamel.yaml import YAML

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.errors import ScenarioError
from beliefnest.llm.offline import OfflineModel
from beliefnest.scenarios.inferring import Inferred
from beliefnest.scenarios.running import run_scenario
from beliefnest.suites.films.rating import compared, rating_prompt, ratings_in, read_ratings

FILE = """\
name: lane
box: [[0, 0, 0], [6, 2, 2]]
blocks:
  - {block: stone, fill: [[0, 0, 0], [6, 0, 2]]}
  - {block: gold_block, at: [0, 0, 1]}
  - {block: emerald_block, at: [6, 0, 1]}
agents:
  ann: {position: [3.5, 1, 1.5]}
  bob: {position: [3.5, 1, 0.5]}
script:
  - agent: ann
    program: |
      await goToPosition(bot, new Vec3(4, 1, 1), 0);
      await goToPosition(bot, new Vec3(5, 1, 1), 0);
probes:
  - label: wish
    path: /bob
    infer:
      agent: ann
      goals: {left: {block: gold_block}, right: {block: emerald_block}}
      utilities: {left: [0, 20, 40], right: {range: [0, 40], step: 20}}
      doubt:
        here: [{block: [6, 0, 1], state: emerald_block}]
        gone: [{block: [6, 0, 1], state: stone}]
      credences: {grid: 2}
    expect:
      inferred:
        utility.right: {above: utility.left, below: 40}
expectations:
  - {path: /bob, agent: ann, at: [5.5, 1, 1.5]}
"""


def content(**infer):
    found = YAML(typ="safe").load(FILE)
    found["probes"][0]["infer"].update(infer)
    return found


def played(scenario, world="scripted"):
    with bn.Nest.open(scenario, world) as nest:
        return played_in(nest, scenario)


def played_in(nest, scenario):
    return run_scenario(
        nest, scenario, OfflineModel(), 0, time.perf_counter(), lambda what, done, total: None
    )


def outcome_of(found):
    return played(bn.Scenario.from_mapping(found)).probes[0]


def test_a_probe_infers_what_the_simulator_of_its_path_infers():
    scenario = bn.Scenario.from_mapping(content())
    outcome = played(scenario).probes[0]
    assert (outcome.ok, outcome.outcome) == (True, "ok")
    model = bn.MindModel(
        agent="ann",
        goals={"left": {"block": "gold_block"}, "right": {"block": "emerald_block"}},
        utilities={"left": [0, 20, 40], "right": [0, 20, 40]},
        doubt={
            "here": {"blocks": {(6, 0, 1): "emerald_block"}},
            "gone": {"blocks": {(6, 0, 1): "stone"}},
        },
        credences=bn.simplex_grid(2, 2),
    )
    with bn.Nest.open(scenario, "scripted") as nest:
        nest.play()
        inference = nest["/bob"].infer(model)
    assert outcome.inferred.means == {name: inference.mean(name) for name in model.factors}
    assert outcome.inferred.log_evidence == inference.log_evidence


@pytest.mark.parametrize(
    ("bounds", "told"),
    [
        ({"utility.left": {"above": "utility.right"}}, "not above utility.right ("),
        ({"utility.left": {"above": 39}}, "not above 39"),
        ({"utility.right": {"above": 0, "below": 1}}, "not below 1"),
    ],
)
def test_what_is_not_inferred_is_wrong_and_told(bounds, told):
    found = content()
    found["probes"][0]["expect"] = {"inferred": bounds}
    outcome = outcome_of(found)
    assert (outcome.ok, outcome.outcome) == (False, "wrong")
    assert told in outcome.why_not


def test_a_course_that_nothing_explains_is_wrong_and_tells_the_step():
    # Whoever has acted walks on no more, and no goal is where the course ends.
    outcome = outcome_of(content(ended=True))
    assert outcome.ok is False
    assert "which no hypothesis explains" in outcome.why_not
    assert outcome.inferred.log_evidence == float("-inf")


def test_without_expectations_means_are_recorded_alone():
    found = content(until=1)
    del found["probes"][0]["expect"]
    outcome = outcome_of(found)
    assert outcome.ok is None
    assert outcome.outcome == "ok"


FAULTS = [
    ("agent: ann\n      goals", "agent: eve\n      goals", 19, "probes[0].infer.agent", "ann, bob"),
    ("{block: gold_block}, right", "{block: gold_blok}, right", 18, "probes[0].infer", "gold_blok"),
    ("{block: gold_block}, right", "{at: [9, 1, 1]}, right", 20, ".goals.left.at", "outside"),
    ("range: [0, 40]", "range: [40, 0]", 21, ".utilities.right.range", "lower one first"),
    ("step: 20", "step: 0", 21, ".utilities.right", "above 0"),
    ("step: 20", "step: 1.0e-9", 21, ".utilities.right", "larger step"),
    ("step: 20", "step: 1.0e-4", 18, "probes[0].infer", "hypotheses"),
    ("[0, 20, 40], right", "x, right", 21, ".utilities.left", "expected"),
    ("right: {range: [0, 40], step: 20}", "middle: 3", 18, "probes[0].infer", "middle"),
    ("gone: [{block: [6, 0, 1]", "gone: [{block: [5, 0, 1]", 18, ".infer", "same elem"),
    ("gone: [{block: [6, 0, 1]", "gone: [{block: [7, 0, 1]", 24, "[0].block", "outside"),
    ("credences: {grid: 2}", "credences: [[0.5, 0.6]]", 18, "probes[0].infer", "sums to 1.1"),
    ("credences: {grid: 2}", "actual: away", 18, "probes[0].infer", "here, gone"),
    ("credences: {grid: 2}", "since: 4\n      until: 3", 26, ".infer.until", "before since"),
    ("credences: {grid: 2}", "rationalty: 3", 25, "rationalty", "rationality"),
    ("        utility.right:", "        utility.up:", 28, ".inferred.utility.up", "utility.left"),
    ("above: utility.left", "above: utility.up", 28, ".inferred.utility.right", "utility.left"),
    ("{above: utility.left, below: 40}", "{}", 28, ".inferred.utility.right", "above, below"),
    ("    expect:", "    task: Walk.\n    expect:", 26, "probes[0].task", "'infer'"),
    ("      inferred:", "      says: hi\n      inferred:", 27, "[0].expect.says", "'inferred'"),
]


@pytest.mark.parametrize(("old", "new", "line", "key", "hint"), FAULTS)
def test_every_fault_names_file_line_and_key(tmp_path, old, new, line, key, hint):
    assert FILE.count(old) == 1
    file = tmp_path / "lane.yaml"
    file.write_text(FILE.replace(old, new))
    with pytest.raises(ScenarioError) as caught:
        bn.Scenario.load(str(file))
    told = str(caught.value)
    assert told.startswith(f"{file}:{line}: "), told
    assert key in told
    assert hint in told
    assert "\n" not in told


def test_inferred_is_for_probes_that_infer(tmp_path):
    found = content()
    probe = found["probes"][0]
    del probe["infer"]
    with pytest.raises(ScenarioError, match="give 'infer', too"):
        bn.Scenario.from_mapping(found)


def test_what_does_not_fit_what_happened_names_file_and_line(tmp_path, capsys):
    file = tmp_path / "lane.yaml"
    file.write_text(FILE.replace("credences: {grid: 2}", "since: 99"))
    out = str(tmp_path / "out")
    status = run_command_line(["run", str(file), "--world", "scripted", "--out", out])
    told = capsys.readouterr().err
    assert status == 2
    assert f"{file}:18: " in told


def test_runs_tell_what_is_inferred(tmp_path, capsys):
    file = tmp_path / "lane.yaml"
    file.write_text(FILE)
    command = ["run", str(file), "--world", "scripted", "--out", str(tmp_path / "out")]
    assert run_command_line([*command, "--json"]) == 0
    (probe,) = json.loads(capsys.readouterr().out)["runs"][0]["probes"]
    assert probe["inferred"]["utility.right"] > probe["inferred"]["utility.left"]
    assert probe["expected"] == {
        "inferred": {"utility.right": {"above": "utility.left", "below": 40}}
    }
    page = (tmp_path / "out/report.html").read_text()
    assert "Inferred from <code>/bob</code>" in page
    assert "<td>utility.right</td>" in page
    assert "posterior mean of utility.right" in page
    command[-1] = str(tmp_path / "again")
    assert run_command_line(command) == 0
    assert "inferred of ann from /bob" in " ".join(capsys.readouterr().out.split())


def test_rows_of_studies_have_inferred_means_in_mirrored_scenes_too(tmp_path):
    file = tmp_path / "lane.yaml"
    file.write_text(FILE)
    symmetries = ["as-written", "mirrored", "turned-90"]
    study = bn.Study(str(file), world="scripted", variations={"symmetry": symmetries})
    frame = study.run(tmp_path / "study", jobs=1).frame()
    assert list(frame["ok"]) == [True] * 3
    first, *others = map(json.loads, frame["inferred"])
    for other in others:
        assert other == pytest.approx(first, abs=1e-9)


@pytest.mark.parametrize("condition", [1, 2, 3])
def test_the_food_trucks_come_out_as_expected_in_the_scripted_world(condition):
    outcome = played(bn.Scenario.load("food-trucks", condition))
    assert outcome.ok, outcome.failures


def test_the_probe_of_the_guide_comes_out_as_it_expects():
    guide = (Path(__file__).parents[2] / "docs/scenarios.md").read_text()
    *_, text = re.findall(r"```yaml\n(.*?)```", guide, re.DOTALL)
    written = dict(bn.Scenario.load("food-trucks", 3).written)
    outcome = outcome_of({**written, **YAML(typ="safe").load(text)})
    assert outcome.ok, outcome.why_not


def prompt_of(condition):
    scenario = bn.Scenario.load("food-trucks", condition)
    probe = scenario.probes[0]
    with bn.Nest.open(scenario, "scripted") as nest:
        nest.play()
        return probe.infer.model, rating_prompt(nest, probe.path, probe.infer)


def test_a_course_is_told_in_words_of_what_the_observer_holds():
    _, prompt = prompt_of(1)
    assert "#.########" in prompt
    assert "- korean: to stand on gold_block, which is at (5, 6)" in prompt
    # The place in doubt is no goal's own place.
    assert "- lebanese: to stand on emerald_block\n" in prompt
    assert "As far as you know, it is lebanese." in prompt
    assert "tick 0: (4, 4)\ntick 1: (3, 4)" in prompt
    assert "out of your sight" not in prompt
    assert prompt.splitlines()[-6:] == [
        *("desire korean:", "desire lebanese:", "desire mexican:"),
        *("belief lebanese:", "belief mexican:", "belief nothing:"),
    ]
    assert "As far as you know, it is nothing." in prompt_of(3)[1]


def test_a_course_out_of_sight_is_told_as_such():
    found = content()
    found["agents"]["bob"]["position"] = [6.5, 1, 0.5]
    found["blocks"].append({"block": "bricks", "walls": [[4, 1, 0], [4, 2, 2]]})
    found["script"][0]["program"] = "await goToPosition(bot, new Vec3(2, 1, 1), 0);"
    found["box"][1] = [6, 3, 3]
    scenario = bn.Scenario.from_mapping(found)
    probe = scenario.probes[0]
    with bn.Nest.open(scenario, "scripted") as nest:
        nest.play()
        told = rating_prompt(nest, probe.path, probe.infer)
    assert "ticks 0 to 1: out of your sight" in told
    assert "?" in told


def test_ratings_are_read_and_compared_on_one_scale():
    model, _ = prompt_of(1)
    text = "Desire Korean: 4\n- **desire lebanese**: 1\ndesire mexican = 7\ndesire mexican: 6.5\n"
    text += "belief lebanese: 3\nbelief mexican: 5\nbelief nothing: 1\nbelief pizza: 3"
    ratings = ratings_in(read_ratings(text, model), model)
    assert ratings[("desires", "mexican")] == 6.5
    means = {
        **{"utility.korean": 40, "utility.lebanese": -20, "utility.mexican": 100},
        **{"credence.lebanese": 1 / 3, "credence.mexican": 2 / 3, "credence.nothing": 0},
    }
    found = compared(ratings, model, Inferred(means, -1.0))
    assert found.pairs["desires"] == [(4, 4), (1, 1), (7, 6.5)]
    assert found.pairs["beliefs"] == [(1 / 3, 1 / 3), (2 / 3, 2 / 3), (0, 0)]
    assert found.error == pytest.approx(0.5 / 6 / 6)
    few = read_ratings("desire korean: 9\nbelief lebanese: 2", model)
    assert few.outcome == "unread"
    some = compared(ratings_in(few, model), model, Inferred({}, 0))
    assert "desire korean" in some.missing
    assert some.error == 1
