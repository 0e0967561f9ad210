"""Stories in which somebody tells something: who believes it, and who does not, and why."""

import json
import re

import pytest

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.suites.stories.answer_check import data_fault
from beliefnest.suites.stories.data import read_items
from beliefnest.suites.stories.played_story import PlayedStory
from beliefnest.suites.stories.questions import parse_question
from beliefnest.suites.stories.story import read_story
from beliefnest.suites.stories.suite import answer_story

LEAVING = """\
1 Ann, Bob, Cid and Dot entered the den.
2 The pear is in the red_box.
3 Ann moved the pear to the tin.
4 Ann exited the den.
5 Bob exited the den.
6 Cid moved the pear to the jar.
7 Cid exited the den.
8 Dot exited the den.
9 Ann, Bob, Cid and Dot entered the waiting_room.
"""
CLAIMS = {
    # Of those who hear it, Ann left before Bob; Cid and Dot after him.
    "10 Bob publicly claimed that pear is in the red_box.": {
        "Ann": "red_box",
        "Bob": "tin",
        "Cid": "jar",
        "Dot": "jar",
        "Ann thinks Bob": "red_box",
        "Cid thinks Bob": "tin",
    },
    "10 Dot privately told Bob that the pear is in the crate.": {
        "Ann": "tin",
        "Bob": "crate",
        "Dot": "jar",
        "Bob thinks Dot": "crate",
        "Dot thinks Bob": "crate",
        "Ann thinks Bob": "tin",
    },
    "10 Ann privately told Dot that the pear is in the crate.": {
        "Dot": "jar",
        "Ann": "tin",
        "Dot thinks Ann": "tin",
    },
}
PROMPT = "Read the following story and answer the multiple-choice question. Think.\n"


def asked(who: str) -> str:
    first, *rest = who.split(" thinks ")
    return f"Where does {first} think {''.join(f'{name} thinks ' for name in rest)}the pear is?"


@pytest.mark.parametrize("claim", CLAIMS)
def test_who_left_earlier_believes_who_left_later(claim: str) -> None:
    expected = {asked(who): box for who, box in CLAIMS[claim].items()}
    with PlayedStory.play(read_story(LEAVING + claim)) as played:
        answers = played.answer_all(parse_question(text) for text in expected)
    found = {text: answer.text for text, answer in zip(expected, answers, strict=True)}
    assert found == expected


def test_bots_tell_it_as_the_scripted_world_does() -> None:
    claim = next(iter(CLAIMS))
    expected = {asked(who): box for who, box in CLAIMS[claim].items()}
    with PlayedStory.play(read_story(LEAVING + claim), "embedded") as played:
        answers = played.answer_all(parse_question(text) for text in expected)
    found = {text: answer.text for text, answer in zip(expected, answers, strict=True)}
    assert found == expected


def published(tmp_path, *rows):
    path = tmp_path / "published.json"
    names = ("story", "question", "answer", "question_order", "prompting_type", "deception")
    path.write_text(json.dumps({"data": [dict(zip(names, row, strict=True)) for row in rows]}))
    return path


def test_the_published_form_is_taken_as_it_is(tmp_path, capsys) -> None:
    claim = "10 Bob publicly claimed that pear is in the red_box."
    path = published(
        tmp_path,
        (LEAVING + "\n***", "Where is the pear really?", "jar", 0, "CoTP", False),
        (PROMPT + LEAVING, "Where does Ann really think the pear is?", "tin", 1, "VP", False),
        (LEAVING + claim, "Where does Ann really think the pear is?", "red_box", 1, "VP", True),
        (LEAVING + claim, "Where does Dot really think the pear is?", "tin", 1, "CoTP", True),
    )
    assert [[item.row for item in story.items] for story in read_items(path).whole()] == [
        [1, 2],
        [3, 4],
    ]
    status = run_command_line(["suite", "hi-tom", "--data", str(path), "--json"])
    report = json.loads(capsys.readouterr().out)
    assert status == 1
    assert report["without_claims"]["1"] == {"questions": 1, "right": 1, "accuracy": 1.0}
    assert report["with_claims"] == {"1": {"questions": 2, "right": 1, "accuracy": 0.5}}
    assert [(miss["row"], miss["claims"]) for miss in report["misses"]] == [(4, True)]
    arguments = ["suite", "hi-tom", "--data", str(path), "--rows", "1-2,3", "--json"]
    assert run_command_line(arguments) == 0
    assert json.loads(capsys.readouterr().out)["all"]["questions"] == 3


@pytest.mark.parametrize(
    ("rows", "what"), [("0", "has no row 0"), ("5-9", "has no row 5"), ("two", "--rows has 'two'")]
)
def test_rows_that_are_not_there_are_refused(tmp_path, capsys, rows: str, what: str) -> None:
    path = published(tmp_path, (LEAVING, "Where is the pear really?", "jar", 0, "CoTP", False))
    assert run_command_line(["suite", "hi-tom", "--data", str(path), "--rows", rows]) == 2
    assert what in capsys.readouterr().err


@pytest.mark.parametrize(
    ("answer", "what"),
    [
        ("tin", None),
        ("red_box", "from line 3 .* in the tin of the den while Ann and Bob are there"),
        ("jar", "never in the jar while Ann and Bob are there"),
    ],
)
def test_an_answer_that_contradicts_its_story_is_found(answer: str, what: str | None) -> None:
    found = data_fault(
        read_story(LEAVING), parse_question("Where does Ann think Bob thinks the pear is?"), answer
    )
    assert found is None if what is None else re.search(what, found or "")


def test_rows_wrong_in_the_data_are_told_apart(tmp_path) -> None:
    text = "Where does Ann think Bob thinks the pear is?"
    path = published(tmp_path, (LEAVING, text, "jar", 2, "CoTP", False))
    ((judged,),) = (answer_story(each) for each in read_items(path).whole())
    assert not judged.ok
    assert judged.wrong_in_data is not None


@pytest.mark.parametrize(
    ("line", "what"),
    [
        ("10 Zoe publicly claimed that pear is in the jar.", "Zoe was in no room so far"),
        ("10 Ann privately told Zoe that the pear is in the jar.", "Zoe was in no room so far"),
        ("10 Ann privately told Ann that the pear is in the jar.", "cannot whisper to itself"),
        ("10 Ann said that the fig is in the jar.", "nothing says where the fig was"),
    ],
)
def test_what_cannot_be_told_is_reported_with_its_line(line: str, what: str) -> None:
    with pytest.raises(bn.InputError, match=rf"^line 10: .*{what}"):
        read_story(LEAVING + line)
