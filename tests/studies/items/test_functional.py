"""Functional items: what order their episodes need, and how families are refused."""

import json
from itertools import product
from pathlib import Path

import pytest
from tests.profiles import at_night, few_by_day

from beliefnest.cli.app import run_command_line
from beliefnest.episodes.task import Task
from beliefnest.errors import InputError
from beliefnest.studies.items.functional.certifying import Certificate, GroupFolder, certified
from beliefnest.studies.items.functional.pairing import LiteralFunctionalPair, by_order, read_gaps
from beliefnest.studies.items.functional.siblings import TaskFamily

EXAMPLES = Path(__file__).parents[3] / "examples" / "functional"
FAMILIES = ("bring", "take", "tell", "warn", "mislead")


def tell(tmp_path: Path, start: str) -> TaskFamily:
    """Return the family `tell` with one thing drawn, and a place where Eva goes in the end."""
    text = (EXAMPLES / "tell.yaml").read_text(encoding="utf-8")
    text = text.replace("instances: {missed: {}, boxes: {}, things: {}}", "instances: {missed: {}}")
    walk = f'  - {{agent: eva, program: "await goToPosition(bot, new Vec3({start}), 0);"}}\n'
    text = text.replace("episode:\n", f"{walk}episode:\n")
    (tmp_path / "tell.yaml").write_text(text, encoding="utf-8")
    document = Task.scenario_document(str(tmp_path / "tell.yaml"))
    assert document is not None
    return TaskFamily("tell", document, 1)


def test_what_she_missed_looks_the_same_without_beliefs_about_her(tmp_path):
    assert tell(tmp_path, "3, 1, 3").hidden(0, 1) == "missed"


def test_a_family_that_shows_its_answer_is_refused(tmp_path):
    assert tell(tmp_path, "${3 + 2 * missed}, 1, 3").hidden(0, 1) == ""
    (fault,) = Certificate("planted", 1, 1, (3, 3)).faults
    assert fault == "every parameter that is drawn shows in beliefs of order 0"


@pytest.mark.parametrize(
    ("values", "fault"),
    [
        ({"solved": (19, 20)}, "search:2 wins 19 of 20"),
        ({"bound": 0.6}, "one course wins 60% of the instances that look the same"),
        ({"lower": (13, 20)}, "search:1 wins 13 of 20, above 33%"),
        ({"rules": {"first": (14, 21)}}, "rule:first wins 14 of 21, above 33%"),
    ],
)
def test_each_fault_of_a_family_is_named(values, fault):
    sound = {"solved": (20, 20), "lower": (0, 20), "bound": 1 / 3, "rules": {"any": (9, 21)}}
    assert Certificate("tell", 2, 2, **sound, hidden="missed").faults == []
    assert Certificate("tell", 2, 2, **{**sound, **values}, hidden="missed").faults == [fault]


def test_a_question_is_compared_with_the_episode_of_the_same_instance():
    literal = {1: [True, True], 2: [True, True], 3: [True, False]}
    acted = {1: [True, False], 2: [False, False], 3: [True, False]}
    row = LiteralFunctionalPair("tell", 1, literal, acted).plain()
    assert (row["instances"], row["repeats"]) == (3, 2)
    rates = ("rate", "pass_at_k", "pass_hat_k")
    assert [row["literal"][name] for name in rates] == [5 / 6, 1.0, 2 / 3]
    assert [row["functional"][name] for name in rates] == [2 / 6, 2 / 3, 0.0]
    # Of the 4 permutations of 2 instances that differ, 2 lie as far from zero.
    assert (row["difference"], row["p"]) == (0.5, 0.5)


def test_families_are_put_together_by_order():
    one = LiteralFunctionalPair("tell", 1, {1: [True]}, {1: [False]})
    other = LiteralFunctionalPair("warn", 1, {1: [False]}, {1: [False]})
    last = LiteralFunctionalPair("warn", 2, {1: [True]}, {1: [True]})
    first, second = by_order([last, one, other])
    assert (first.family, first.order, second.order) == ("", 1, 2)
    assert list(first.literal.values()) == [[True], [False]]


ROWS = list(product(FAMILIES, range(1, 4)))


@pytest.mark.parametrize(("name", "order"), few_by_day(ROWS[:: at_night(1, 5)]))
def test_each_family_needs_its_order(name, order, tmp_path):
    document = Task.scenario_document(str(EXAMPLES / f"{name}.yaml"))
    assert document is not None
    family = TaskFamily(str(EXAMPLES / f"{name}.yaml"), document, order)
    seeds = range(1000, 1000 + at_night(20, 1))
    certificate = certified(family, seeds, tmp_path, 1, lambda progress: None)
    assert certificate.faults == []
    assert (certificate.order, certificate.bound) == (order, 1 / 3)
    # Outcomes are kept: nothing is played again.
    kept = {file: file.stat().st_mtime_ns for file in tmp_path.glob("*.json")}
    assert certified(family, seeds, tmp_path, 1, lambda progress: None) == certificate
    assert {file: file.stat().st_mtime_ns for file in tmp_path.glob("*.json")} == kept


@pytest.mark.extra("matplotlib")
def test_a_model_answers_and_plays_and_a_figure_is_drawn(tmp_path, capsys):
    (tmp_path / "small.yaml").write_text(
        f"tasks: [{EXAMPLES / 'tell.yaml'}]\npolicies: [search]\norders: [0]\n"
        "conditions: [0]\nseeds: 1\n",
        encoding="utf-8",
    )
    command = ["items", str(tmp_path / "small.yaml"), "-o", str(tmp_path / "out"), "--jobs", "1"]
    assert run_command_line([*command, "--functional", "--model", "first-option", "--json"]) == 0
    captured = capsys.readouterr()
    for phase in ("certificate of tell-0 (1/1)", "first-option in tell-0 (1/1)"):
        assert f"small: {phase}\n" in captured.err
    told = json.loads(captured.out)
    (certificate,) = told["certificates"]
    assert certificate["certified"]
    assert (certificate["hidden"], certificate["bound"]) == ("missed", 1 / 3)
    assert [each["family"] for each in told["pairs"]] == ["tell", ""]
    assert (tmp_path / "out" / "functional.png").exists()
    assert json.loads((tmp_path / "out" / "functional.json").read_text("utf-8")) == told
    model, gaps = read_gaps(tmp_path / "out")
    assert (model, [*gaps]) == ("first-option", [0])
    assert gaps[0].difference == told["pairs"][-1]["difference"]


@pytest.mark.parametrize(
    ("content", "words"),
    [('{"error": nu', "group.json is damaged"), ('{"error": null}', "field 'search'")],
)
def test_a_damaged_result_of_a_group_is_refused(tmp_path, content, words):
    (tmp_path / "group.json").write_text(content, encoding="utf-8")
    with pytest.raises(InputError, match="delete it to certify it again") as refusal:
        GroupFolder(tmp_path).cell("group")
    assert words in str(refusal.value)


@pytest.mark.parametrize("options", [[], ["--model", "chance"]])
def test_figures_of_a_model_are_not_replaced(tmp_path, capsys, options):
    content = json.dumps({"certificates": [], "model": "first-option", "pairs": []})
    (tmp_path / "functional.json").write_text(content, encoding="utf-8")
    study = str(EXAMPLES / "study.yaml")
    assert run_command_line(["items", study, "-o", str(tmp_path), "--functional", *options]) == 2
    words = f"add `--model first-option`, or name another folder: `-o {tmp_path}-2`"
    assert words in " ".join(capsys.readouterr().err.split())
    assert (tmp_path / "functional.json").read_text("utf-8") == content


@pytest.mark.parametrize("option", ["--report", "--verify"])
def test_options_of_sets_are_refused(tmp_path, capsys, option):
    study = str(EXAMPLES / "study.yaml")
    assert run_command_line(["items", study, "-o", str(tmp_path), "--functional", option]) == 2
    assert f"{option} belongs to `beliefnest items STUDY -o SET" in capsys.readouterr().err


def test_a_model_is_refused_without_episodes(tmp_path, capsys):
    study = str(EXAMPLES / "study.yaml")
    assert run_command_line(["items", study, "-o", str(tmp_path), "--model", "offline"]) == 2
    err = capsys.readouterr().err
    assert "--model belongs to `beliefnest items STUDY -o DIR --functional`, and this is" in err


def test_a_study_of_scenarios_is_refused(tmp_path, capsys):
    study = str(EXAMPLES.parent / "benchmark" / "study.yaml")
    assert run_command_line(["items", study, "-o", str(tmp_path), "--functional"]) == 2
    assert "name the files under `tasks`" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("orders", "words"),
    [
        ("[2]", "tell.yaml is of order 1, and `orders` has 2; add"),
        ("[1, 2]", "`orders` has 2, and no condition that is played is of this order"),
    ],
)
def test_a_study_that_names_another_order_is_refused(tmp_path, capsys, orders, words):
    study, out = tmp_path / "study.yaml", tmp_path / "out"
    study.write_text(
        f"tasks: [{EXAMPLES / 'tell.yaml'}]\npolicies: [search]\norders: {orders}\n"
        "conditions: [1]\n",
        encoding="utf-8",
    )
    assert run_command_line(["items", str(study), "-o", str(out), "--functional"]) == 2
    assert words in " ".join(capsys.readouterr().err.split())
    assert not out.exists()
