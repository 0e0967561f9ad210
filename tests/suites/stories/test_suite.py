"""Files of questions: read, answered, scored; the sample of Hi-ToM is answered all right."""

import json
from pathlib import Path

import pytest
from msgspec import convert
from tests.suites.stories.texts import COMING_BACK, SHARED_SECRET

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.cli.playing import status_of
from beliefnest.studies.suite_playing import play_suite
from beliefnest.suites.films.cells import FILM_KIND
from beliefnest.suites.stories.cells import STORY_KIND, story_cells
from beliefnest.suites.stories.data import read_items
from beliefnest.suites.stories.suite import (
    JudgedAnswer,
    Score,
    answer_story,
    score,
    scores_by_order,
)

SAMPLE = Path(__file__).parents[4] / "shared" / "samples" / "hi-tom" / "sample.json"

ROWS = [
    {"story": SHARED_SECRET, "question": question, "answer": answer, "question_order": order}
    for question, answer, order in (
        ("Where is the lantern really?", "grey_trunk", 0),
        ("Where does Tom really think the lantern is?", "oak_cabinet", 1),
        ("Where does Ida think Tom thinks the lantern is?", "oak_cabinet", 2),
        ("Where does Tom think Ida thinks Nora thinks the lantern is?", "tin_box", 3),
    )
] + [{"story": COMING_BACK, "question": "Where will Bo look for the apple?", "answer": "drawer"}]


@pytest.fixture
def file(tmp_path):
    def write(rows):
        path = tmp_path / "rows.json"
        path.write_text(rows if isinstance(rows, str) else json.dumps(rows))
        return path

    return write


def changed(number, **values):
    return [{**row, **values} if n == number else row for n, row in enumerate(ROWS)]


def test_rows_of_one_story_are_put_together(file):
    stories = read_items(file(ROWS)).whole()
    assert [[item.row for item in each.items] for each in stories] == [[1, 2, 3, 4], [5]]


@pytest.mark.parametrize(
    ("rows", "what"),
    [
        ("[", "rows.json, line 1: "),
        ('{"story": "x"}', "array"),
        ('[\n{"story": "x",}]', "rows.json, line 2: "),
        ([{"story": SHARED_SECRET, "question": "Where is the lantern really?"}], "answer"),
        (changed(4, story=COMING_BACK.replace("entered", "stormed")), "row 5: line 1: "),
        (changed(3, question="Who has the lantern?"), "row 4: 'Who has the lantern"),
        (changed(3, question="Where is the rope really?"), "row 4: .*rope"),
        (changed(1, question_order=2), "row 2: .*question_order says 2"),
    ],
)
def test_a_wrong_file_is_refused_with_the_row_and_the_line(file, rows, what):
    with pytest.raises(bn.InputError, match=what):
        read_items(file(rows)).whole()


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(bn.InputError, match=r"none\.json cannot be read"):
        read_items(tmp_path / "none.json").whole()


def test_scores_count_right_answers_by_order(file):
    rows = changed(2, answer="tin_box")
    judged = [each for asked in read_items(file(rows)).whole() for each in answer_story(asked)]
    assert [each.ok for each in judged] == [True, True, False, True, True]
    assert score(judged) == Score(5, 4)
    assert scores_by_order(judged) == {
        0: Score(1, 1),
        1: Score(2, 2),
        2: Score(1, 0),
        3: Score(1, 1),
    }
    assert score([]).accuracy is None


def test_what_the_first_believer_changes_is_told_apart(file):
    judged = [each for asked in read_items(file(ROWS)).whole() for each in answer_story(asked)]
    # Really the lantern is in the grey_trunk, and the apple in the basket; Tom alone, and
    # Ida of Nora, believe what is asked for with one believer more.
    assert [each.needs_first for each in judged] == [False, True, False, False, True]


def test_a_miss_is_explained_by_what_each_simulator_holds_and_since_when(file):
    (asked, _) = read_items(file(changed(2, answer="tin_box"))).whole()
    (miss,) = (each for each in answer_story(asked) if not each.ok)
    text = miss.why_not
    assert "expected the tin_box" in text
    assert "/Ida/Tom holds the lantern in the oak_cabinet of the attic" in text
    assert "at tick 6, during line 6" in text
    assert "the oak_cabinet, a barrel at" in text
    assert "the tin_box, a barrel at" in text
    assert "So Tom missed this: Ida took 1 lantern out." in text


def run(capsys, *arguments):
    status = run_command_line(["suite", "hi-tom", *map(str, arguments)])
    return status, *capsys.readouterr()


def test_the_command_prints_accuracy_and_ends_with_0_if_all_is_right(file, capsys):
    status, out, err = run(capsys, "--data", file(ROWS), "--json")
    report = json.loads(out)
    assert status == 0
    assert report["ok"] is True
    assert report["all"] == {"questions": 5, "right": 5, "accuracy": 1.0}
    assert report["orders"]["3"] == {"questions": 1, "right": 1, "accuracy": 1.0}
    assert report["first_believer_matters"]["1"] == {"questions": 2, "right": 2, "accuracy": 1.0}
    assert report["misses"] == []
    assert "hi-tom (scripted): playing (2/2)" in err


def test_the_command_lists_misses_and_ends_with_1(file, capsys):
    path = file(changed(2, answer="tin_box"))
    status, out, _ = run(capsys, "--data", path)
    assert status == 1
    assert "row 3: Where does Ida think Tom thinks the lantern is?" in out
    assert "expected the tin_box" in out
    status, out, _ = run(capsys, "--data", path, "--json")
    (miss,) = json.loads(out)["misses"]
    assert status == 1
    assert (miss["row"], miss["answer"], miss["path"]) == (3, "oak_cabinet", "/Ida/Tom")


def test_no_more_stories_are_played_than_asked_for(file, capsys):
    status, out, _ = run(capsys, "--data", file(ROWS), "--limit", 1, "--json")
    assert status == 0
    assert json.loads(out)["stories"] == 1


def test_a_suite_goes_on_in_its_folder_and_its_rows_are_those_of_a_study(file, tmp_path, capsys):
    out = tmp_path / "out"
    command = ["--data", file(changed(2, answer="tin_box")), "--out", out]
    assert run(capsys, *command, "--limit", 1)[0] == 1
    (cell,) = (out / "cells").iterdir()
    played = cell.stat().st_mtime_ns
    status, told, _ = run(capsys, *command, "--json")
    assert (status, json.loads(told)["all"]["right"]) == (1, 4)
    assert cell.stat().st_mtime_ns == played
    assert len(list((out / "cells").iterdir())) == 2
    rows = bn.StudyResult.read(out).rows
    assert [(row["row"], row["ok"], row["outcome"]) for row in rows][2] == (3, False, "wrong")
    assert len({row["variation"] for row in rows}) == 2
    assert run_command_line(["stats", str(out)]) == 0
    assert "hi-tom" in capsys.readouterr().out
    assert run_command_line(["methods", str(out)]) == 2
    assert "supplements are of scenarios and episodes" in capsys.readouterr().err


def test_a_story_that_cannot_be_played_counts_as_not_right_and_is_tried_again(file, tmp_path):
    stories = read_items(file(ROWS)).whole()
    setting = {"world": "nowhere", "seed": 0, "claims_from": None}
    cells = story_cells("hi-tom", stories, setting)
    result = play_suite(tmp_path / "out", STORY_KIND, cells, {}, (), lambda progress: None)
    judged = convert(result.rows, list[JudgedAnswer])
    assert {(each.ok, each.outcome, each.answer) for each in judged} == {(False, "error", None)}
    assert "nowhere" in judged[0].why_not
    assert score(judged) == Score(5, 0)
    with pytest.raises(bn.ModelError, match="2 of 2 cells have no answer, counted as not right"):
        status_of(result)
    with pytest.raises(bn.InputError, match="holds a study of stories, and this one is of films"):
        play_suite(tmp_path / "out", FILM_KIND, [], {}, (), lambda progress: None)


@pytest.mark.parametrize(
    ("arguments", "what"),
    [(["--world", "nowhere"], "no world 'nowhere'"), (["--limit", "0"], "--limit is 0")],
)
def test_wrong_input_ends_with_2(file, capsys, arguments, what):
    status, _, err = run(capsys, "--data", file(ROWS), *arguments)
    assert status == 2
    assert what in err


def test_an_unknown_suite_ends_with_2(file, capsys):
    status = run_command_line(["suite", "sally", "--data", str(file(ROWS))])
    assert status == 2
    assert "there are hi-tom, stories, tomi, food-trucks" in capsys.readouterr().err


def test_the_sample_of_hi_tom_is_answered_right_at_every_order():
    if not SAMPLE.is_file():
        pytest.skip(f"{SAMPLE} is not on this machine")
    judged = [each for asked in read_items(SAMPLE).whole() for each in answer_story(asked)]
    scores = scores_by_order(judged)
    assert set(scores) == {0, 1, 2, 3, 4}
    assert all(found.accuracy == 1 for found in scores.values()), [
        each.why_not for each in judged if not each.ok
    ]


def test_a_folder_of_other_data_is_refused(tmp_path, capsys):
    """Unread questions of the data are told with the statistics."""
    rows = [ROWS[0], {**ROWS[1], "question": "Why?"}]
    for name, some in (("one.json", rows), ("moved.json", rows), ("other.json", ROWS[4:])):
        (tmp_path / name).write_text(json.dumps(some))
    out = tmp_path / "out"

    def run(name):
        status = run_command_line(
            ["suite", "hi-tom", "--data", str(tmp_path / name), "--out", str(out)]
        )
        return status, capsys.readouterr()

    assert (run("one.json")[0], run("moved.json")[0]) == (1, 1)
    status, said = run("other.json")
    assert status == 2
    assert "moved.json, which has nothing in common with" in said.err
    assert run_command_line(["stats", str(out)]) == 0
    assert "1 question of the data could not be read" in capsys.readouterr().out


def test_stories_without_questions_are_refused(tmp_path, capsys):
    events = [{"event": "enter", "agents": ["ann"], "room": "den"}]
    story = {"events": [*events, {"event": "is", "thing": "pear", "place": "box"}], "questions": []}
    (tmp_path / "own.json").write_text(json.dumps(story))
    assert run_command_line(["suite", "stories", "--data", str(tmp_path / "own.json")]) == 2
    assert "asks no question" in capsys.readouterr().err
    assert run_command_line(["suite", "storys", "--data", str(tmp_path / "own.json")]) == 2
    assert "did you mean 'stories'?" in capsys.readouterr().err
