"""Audit of published sets: labels that are wrong, undetermined, or of stories that are not read."""

import json

import pytest

from beliefnest.cli.app import run_command_line
from beliefnest.suites.stories.audit import audit, read_published

STORY = (
    "Jackson entered the hall. Chloe entered the hall. The boots is in the bathtub. "
    "Jackson exited the hall. Jackson entered the dining_room. Chloe moved the boots to the pantry."
)
SEES = "Where will Jackson look for the boots?"
FIRST = "Where was the boots at the beginning?"
TOMI = """\
1 Jackson entered the hall.
2 Chloe entered the hall.
3 The boots is in the bathtub.
4 Jackson exited the hall.
5 Chloe moved the boots to the pantry.
6 {question}\t{label}\t1
"""


def inspect_rows(label):
    return "\n".join(
        json.dumps({"input": f"{STORY} {asked}", "target": target})
        for asked, target in ((FIRST, "bathtub"), (SEES, label))
    )


def open_tom(label):
    asked = {"question": SEES, "type": "location", "answer": label}
    return json.dumps([{"narrative": STORY, "question": asked}])


def with_letters(label):
    options = ["pantry", "bathtub"]
    letter = "AB"[options.index(label)]
    return json.dumps(
        {"data": [{"story": STORY, "question": SEES, "choices": options, "answer": letter}]}
    )


def bare(label):
    other = "The pantry." if "bath" in label else "The bathtub."
    return f"{STORY};{SEES};In the {label}.;{other}\n"


def with_names(label):
    return f'story,question,answer\n"{STORY}",{SEES},the {label}\n'


FORMS = {
    "inspect.jsonl": inspect_rows,
    "opentom.json": open_tom,
    "letters.json": with_letters,
    "bigtom.csv": bare,
    "names.csv": with_names,
    "tomi.txt": lambda label: TOMI.format(question=SEES, label=label),
}


@pytest.mark.parametrize("name", FORMS)
def test_right_labels_follow_and_wrong_ones_are_found(tmp_path, name):
    """Jackson leaves before the boots are moved, and looks where he saw them."""
    file = tmp_path / name
    file.write_text(FORMS[name]("bathtub"), encoding="utf-8")
    done = audit(read_published(file))
    assert (done.wrong, done.undetermined, done.unread) == ((), (), ())
    items = done.items
    assert items == (2 if name == "inspect.jsonl" else 1)
    file.write_text(FORMS[name]("pantry"), encoding="utf-8")
    done = audit(read_published(file))
    ((wrong,), undetermined) = (done.wrong, done.undetermined)
    assert (wrong.question, wrong.label, wrong.answer) == (SEES, "pantry", "bathtub")
    assert "wrong in the data" in wrong.why[0]
    assert undetermined == ()


def test_what_hearers_believe_is_an_assumption(tmp_path, capsys):
    told = (
        "Ann and Bob entered the den. The pear is in the box. Ann left the den. "
        "Bob told Ann that the pear is in the jar."
    )
    row = {"story": told, "question": "Where will Ann look for the pear?", "answer": "jar"}
    file = tmp_path / "told.json"
    file.write_text(json.dumps([row]), encoding="utf-8")
    assert run_command_line(["suite", "audit", str(file), "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert (found["items"], found["wrong"], found["unread"]) == (1, [], [])
    (undetermined,) = found["undetermined"]
    assert (undetermined["label"], undetermined["answer"]) == ("jar", "box")
    assert "hearers believe" in undetermined["assumption"]


def test_sentences_that_are_not_read_are_named(tmp_path, capsys):
    rows = [
        {"input": "Noor makes a cappuccino. Where is the milk?", "target": "jug"},
        {"input": STORY, "target": "pantry"},
        {"narrative": STORY, "question": SEES},
        {"input": f"{STORY} {SEES}", "target": "bathtub"},
    ]
    file = tmp_path / "rows.jsonl"
    file.write_text("\n".join(map(json.dumps, rows)), encoding="utf-8")
    assert run_command_line(["suite", "audit", str(file)]) == 1
    out = capsys.readouterr().out
    assert "row 1: sentence 1: 'Noor makes a cappuccino.' is no sentence of a story" in out
    assert "row 2" in out
    assert "asks no question" in out
    assert "row 3: has no answer: columns are narrative, question" in out
    assert "1 item answered: 0 wrong, 0 undetermined; 3 could not be read" in out


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["none.json"], "none.json cannot be read"),
        (["empty.json"], "holds no rows"),
        (["broken.json"], "is no JSON"),
        (["empty.json", "--rows", "1"], "--rows is for suites"),
        ([], "0 files are given"),
    ],
)
def test_wrong_use(tmp_path, monkeypatch, capsys, arguments, told):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty.json").write_text("[]", encoding="utf-8")
    (tmp_path / "broken.json").write_text('[{"story": ', encoding="utf-8")
    assert run_command_line(["suite", "audit", *arguments]) == 2
    assert told in capsys.readouterr().err
