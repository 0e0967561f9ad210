"""Functional items: what order their episodes need, and how families are refused."""

from pathlib import Path

import pytest

from beliefnest.cli.app import run_command_line
from beliefnest.episodes.task import Task
from beliefnest.studies.items.functional.certifying import Certificate, TaskFamily, best_course

EXAMPLES = Path(__file__).parents[3] / "examples" / "functional"


def family(name: str, condition: int | None = 1) -> TaskFamily:
    document = Task.scenario_document(str(EXAMPLES / f"{name}.yaml"))
    assert document is not None
    return TaskFamily(name, document, condition)


def test_what_is_missed_looks_the_same_without_beliefs_about_others():
    assert family("tell").hidden(0, 1) == "missed"


@pytest.mark.long
def test_what_looks_the_same_is_won_by_different_courses():
    siblings = family("tell").siblings(0, "missed")
    assert len(siblings) == 3
    assert best_course(siblings, 1) == 1


def test_a_family_that_shows_its_answer_is_refused(tmp_path):
    text = (EXAMPLES / "tell.yaml").read_text(encoding="utf-8")
    # What Ann missed decides about what lies in the tray.
    planted = text.replace("values: [0, 1, 2]}", "values: [0]}")
    assert planted != text
    (tmp_path / "planted.yaml").write_text(planted, encoding="utf-8")
    document = Task.scenario_document(str(tmp_path / "planted.yaml"))
    assert document is not None
    assert TaskFamily("planted", document, 1).hidden(0, 1) == ""
    (fault,) = Certificate("planted", 1, 1, (3, 3)).faults
    assert fault == "every parameter that is drawn shows in beliefs of order 0"


@pytest.mark.parametrize(
    ("values", "fault"),
    [
        ({"solved": (19, 20)}, "search:2 wins 19 of 20"),
        ({"bound": 0.6}, "one course wins 60% of the instances that look the same"),
        ({"lower": (13, 20)}, "search:1 wins 13 of 20, above 33%"),
        ({"rules": {"rule:first": (14, 21)}}, "rule:first wins 14 of 21, above 33%"),
    ],
)
def test_each_fault_of_a_family_is_named(values, fault):
    sound = {"solved": (20, 20), "lower": (0, 20), "bound": 1 / 3, "rules": {"rule:any": (9, 21)}}
    assert Certificate("tell", 2, 2, **sound, hidden="missed").faults == []
    assert Certificate("tell", 2, 2, **{**sound, **values}, hidden="missed").faults == [fault]


@pytest.mark.parametrize("option", ["--report", "--verify"])
def test_options_of_sets_are_refused(tmp_path, capsys, option):
    study = str(EXAMPLES / "study.yaml")
    assert run_command_line(["items", study, "-o", str(tmp_path), "--functional", option]) == 2
    assert f"{option} is for sets of items" in capsys.readouterr().err


def test_a_study_of_scenarios_is_refused(tmp_path, capsys):
    study = str(EXAMPLES.parent / "benchmark" / "study.yaml")
    assert run_command_line(["items", study, "-o", str(tmp_path), "--functional"]) == 2
    assert "name the files under `tasks`" in capsys.readouterr().err
