"""Models on a set of items: what they are asked, how answers count, and files of results."""

import json

import pytest

from beliefnest.cli.app import run_command_line
from beliefnest.llm.messages import Answer
from beliefnest.studies.items.asking import judged_answer, prompt_of
from beliefnest.studies.items.item_set import ItemSet
from beliefnest.studies.items.record import ItemRecord

MODEL = """
from beliefnest.llm.messages import Answer

class Careful:
    name = "careful"

    def answer(self, messages, sampling):
        text = messages[-1].text
        if "silent" in text:
            return Answer("I wonder.")
        return Answer("Answer: box", finish="length" if "long" in text else "stop")
"""


def item(number: int, text: str, right: str = "box", order: int = 1) -> ItemRecord:
    return ItemRecord(
        id=f"i{number}",
        text=text,
        question="Where is it?",
        options=("bag", "box"),
        right=right,
        kind="item",
        order=order,
        path="/x",
        told_by="/",
        chain=("x",),
        chance=0.5,
        family="f",
        scenario="s",
        condition=None,
        variation="v",
        factors={},
        probe="p",
        seed=number,
        tick=0,
        skeleton=str(number),
        checked="follows",
        shortcuts={},
    )


ITEMS = (
    item(0, "plain"),
    item(1, "plain", "bag"),
    item(2, "silent"),
    item(3, "long"),
    item(4, "plain", order=2),
)


@pytest.fixture
def answered(tmp_path, capsys):
    """Folder of the set, folder of the results of two models, and what the command printed."""
    ItemSet("own", ITEMS, ()).write(tmp_path / "set")
    model = tmp_path / "careful.py"
    model.write_text(MODEL)
    command = ["items", str(tmp_path / "set"), "-o", str(tmp_path / "out"), "--json"]
    models = f"{model}:Careful,first-option"
    assert run_command_line([*command, "--models", models, "--jobs", "1"]) == 0
    return tmp_path / "set", tmp_path / "out", json.loads(capsys.readouterr().out)


def test_answers_count_as_in_studies_and_models_are_compared(answered, capsys):
    _, folder, report = answered
    own = [each for each in report["models"] if each["model"].endswith(":Careful")]
    whole = next(each for each in own if "order" not in each)
    assert (whole["judged"], whole["right"], whole["wrong"]) == (5, 2, 1)
    assert (whole["unread"], whole["cut"], whole["chance"]) == (1, 1, 0.5)
    assert [each["order"] for each in own if "order" in each] == [1, 2]
    assert run_command_line(["stats", str(folder), "--between", "model", "--json"]) == 0
    (pair,) = json.loads(capsys.readouterr().out)["differences"]["model"]
    assert pair["pairs"] == len(ITEMS)
    assert len((folder / "results.jsonl").read_text().splitlines()) == 2 * len(ITEMS)


def test_a_model_reads_story_question_and_options():
    system, user = prompt_of(ITEMS[0])
    assert "Answer: the option" in system.text
    assert user.text == "plain\n\nQuestion: Where is it?\n\nOptions:\nA) bag\nB) box\n"


def test_an_answer_without_an_option_is_not_right():
    assert judged_answer(ITEMS[0], "any", Answer("Answer: B")).ok
    both = judged_answer(ITEMS[0], "any", Answer("Answer: bag or box"))
    assert (both.answered, both.ok, both.outcome) == (None, False, "ambiguous")


def test_results_are_checked_against_their_set(answered, capsys):
    made, folder, _ = answered
    results = folder / "results.jsonl"
    command = ["items", str(made), "--json", "--verify-results"]
    assert run_command_line([*command, str(results)]) == 0
    capsys.readouterr()
    lines = [json.loads(line) for line in results.read_text().splitlines()]
    changes = [
        {"ok": False},
        {"answered": "bag"},
        {"id": "none"},
        {"digest": "0"},
        {"version": "2"},
    ]
    bad = [{**line, **change} for line, change in zip(lines, changes, strict=False)]
    rest = [json.dumps(each) for each in [*bad, {**lines[5], "note": "mine"}, lines[5]]]
    results.write_text("\n".join([*rest, "{not json", "[1, 2]", rest[0][:40]]))
    assert run_command_line([*command, str(results)]) == 1
    report = json.loads(capsys.readouterr().out)
    words = [
        "ok is False",
        "answered is 'bag'",
        "no item 'none'",
        "digest is '0'",
        "version is '2'",
    ]
    words = [*["is no result"] * 3, *words, "has a result of i0 before"]
    numbers = [8, 9, 10, 1, 2, 3, 4, 5, 7]
    for fault, number, word in zip(report["faults"], numbers, words, strict=True):
        assert f":{number}: " in fault and word in fault
    assert report["missing"] == {lines[0]["model"]: 5, "first-option": 4}
    assert [each["right"] for each in report["models"] if "order" not in each] == [0, 0]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--models", "first-option"], "with -o"),
        (["--models", "first-option,first-option", "-o", "OUT"], "each model once"),
        (["--models", "nobody", "-o", "OUT"], "no model 'nobody'"),
        (["--models", "first-option,", "-o", "OUT"], "each model once"),
        (["--verify-results", "nowhere.jsonl"], "no file of results"),
        (["--verify-results", "nowhere.jsonl", "-o", "OUT"], "alone"),
        (["-o", "OUT"], "add --models"),
    ],
)
def test_wrong_input_is_refused(options, words, tmp_path, capsys):
    ItemSet("own", ITEMS, ()).write(tmp_path / "set")
    own = [each.replace("OUT", str(tmp_path / "out")) for each in options]
    assert run_command_line(["items", str(tmp_path / "set"), *own]) == 2
    assert words in capsys.readouterr().err


def test_a_model_that_fails_is_told(tmp_path, capsys):
    ItemSet("own", ITEMS, ()).write(tmp_path / "set")
    model = tmp_path / "broken.py"
    model.write_text(MODEL.replace("text = messages[-1].text", 'raise ValueError("oops")'))
    command = ["items", str(tmp_path / "set"), "-o", str(tmp_path / "out"), "--models"]
    assert run_command_line([*command, f"{model}:Careful"]) == 3
    assert "oops" in capsys.readouterr().err
