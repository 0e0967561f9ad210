"""Audit of published sets: labels that are wrong, undetermined, or of stories that are not read."""

import json

import msgspec
import pytest
from tests.studies.items.building import invented

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


OTHER_WORDS = (
    "When Jackson returns, where will he look for the boots?",
    "When Jackson comes back to the hall, where will Jackson first look for his boots?",
    "Where will Jackson look for the boots first when he returns?",
    "In which container will Jackson look for the boots?",
    "Which container will Jackson open to find the boots?",
    "Where is Jackson going to look for the boots?",
    "Where does Jackson believe the boots to be?",
    "Does Jackson believe that the boots is in the pantry or in the bathtub?",
    "From Jackson\u2019s perspective, where is the boots precisely located by the end?",
    "According to Jackson, where is the boots?",
)


@pytest.mark.parametrize("asked", OTHER_WORDS)
def test_false_beliefs_are_asked_for_in_many_words(tmp_path, asked):
    told = STORY.replace("Chloe moved", "Then Chloe moved")
    questions = [{"question": asked, "true_answer": each} for each in ("bathtub", "pantry")]
    file = tmp_path / "rows.json"
    file.write_text(json.dumps([{"scenario": told, "questions": questions}]), encoding="utf-8")
    done = audit(read_published(file))
    ((wrong,), items) = (done.wrong, done.items)
    assert (items, wrong.row, wrong.answer, done.unread) == (2, 2, "bathtub", ())


AWAY = (
    "{begin} While Jackson is away, Chloe moves the boots to the pantry.",
    "{begin} Chloe moves the boots from the bathtub to the pantry while Jackson is outside.",
    "{begin} After Jackson leaves, Chloe moves the boots to the pantry.",
    "{begin} Chloe moved the boots to the pantry after Jackson left the hall.",
    "{begin} Jackson leaves. When Jackson is gone, Chloe then puts the boots on the pantry.",
    "{begin} Once Jackson has left, Chloe takes the boots and puts it in the pantry.",
    "Chloe is in the hall. Jackson puts the boots in the bathtub and leaves the hall. "
    "Chloe moves the boots to the pantry.",
    "Chloe is in the hall. Jackson put the boots on the bathtub before leaving the hall. "
    "Then Chloe moves the boots to the pantry.",
    "Jackson has a pair. {begin} Jackson exited the hall. Jackson entered the attic. "
    "While Jackson is gone, Chloe moved the boots to the pantry.",
)


@pytest.mark.parametrize("told", AWAY)
def test_what_happens_while_somebody_is_away_is_unseen(tmp_path, told):
    begin = "Jackson and Chloe are in the hall. The boots is in the bathtub."
    story = told.format(begin=begin)
    rows = [
        {"story": story, "question": asked, "answer": each}
        for asked in (SEES, "Where do you think Jackson will look for the boots upon returning?")
        for each in ("bathtub", "pantry")
    ]
    rows += [{"story": story, "question": "Where is the boots really?", "answer": "pantry"}]
    file = tmp_path / "rows.json"
    file.write_text(json.dumps(rows), encoding="utf-8")
    done = audit(read_published(file))
    assert (done.items, done.undetermined, done.unread) == (5, (), ())
    assert [(each.row, each.answer) for each in done.wrong] == [(2, "bathtub"), (4, "bathtub")]


@pytest.mark.parametrize(
    "told",
    [
        "Chloe secretly moved the boots to the pantry.",
        "Unknown to Jackson, Chloe moved the boots to the pantry.",
        "While he is away, Chloe moved the boots to the pantry.",
        "While Jackson is asleep, Chloe moved the boots to the pantry.",
        "Chloe moved the boots to the pantry because Jackson left.",
    ],
)
def test_clauses_of_which_nothing_follows_stay_unread(tmp_path, told):
    file = tmp_path / "rows.json"
    begin = STORY.partition(" Jackson exited")[0]
    row = {"story": f"{begin} {told}", "question": SEES, "answer": "bathtub"}
    file.write_text(json.dumps([row]), encoding="utf-8")
    done = audit(read_published(file))
    assert (done.items, done.wrong, len(done.unread)) == (0, (), 1)
    assert told in done.unread[0].faults[0]


def test_a_room_as_a_label_is_not_compared_with_containers(tmp_path):
    file = tmp_path / "rows.json"
    asked = "In which room does Jackson think the boots is?"
    file.write_text(json.dumps([{"story": STORY, "question": asked, "answer": "the hall"}]))
    done = audit(read_published(file))
    assert (done.wrong, done.undetermined) == ((), ())
    assert "has the answer 'hall', a room; give the container in it" in done.unread[0].faults[0]


@pytest.mark.parametrize("asked", ["When Jackson returns, what will he say?", "Is he glad?"])
def test_other_questions_stay_unread(tmp_path, asked):
    file = tmp_path / "rows.json"
    file.write_text(json.dumps([{"story": STORY, "question": asked, "answer": "yes"}]), "utf-8")
    (unread,) = audit(read_published(file)).unread
    assert "is no question about a story" in unread.faults[0]


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


LIE = """\
1 Ann entered the den.
2 The nut is in the box.
3 Ann said that the nut is in the jar.
4 Where is the nut really?\tLABEL
5 Where was the nut at the beginning?\tLABEL
6 Where does Ann think the nut is?\tLABEL
"""


@pytest.mark.parametrize(("label", "wrong"), [("box", 0), ("jar", 2), ("crate", 3)])
def test_what_is_said_excuses_only_what_it_may_change(tmp_path, label, wrong):
    """Words change neither reality nor the beginning, and name no crate."""
    file = tmp_path / "lie.txt"
    file.write_text(LIE.replace("LABEL", label), encoding="utf-8")
    done = audit(read_published(file))
    assert (done.items, len(done.wrong)) == (3, wrong)
    assert len(done.undetermined) == (label == "jar")


def test_words_about_another_thing_excuse_nothing(tmp_path):
    file = tmp_path / "other.txt"
    text = LIE.replace("LABEL", "box").replace("that the nut", "that the fig")
    file.write_text(text.replace("2 The", "2 The fig is in the jar.\n2 The"), encoding="utf-8")
    assert not audit(read_published(file)).wrong
    file.write_text(file.read_text().replace("\tbox", "\tjar"), encoding="utf-8")
    assert len(audit(read_published(file)).wrong) == 3


@pytest.mark.parametrize(
    ("label", "wrong"),
    [
        ("in the red box of the den", 0),
        ("The pear is in the red box.", 0),
        ("the red_box", 0),
        (["red box", "the red box"], 0),
        ("the box", 1),
    ],
)
def test_labels_name_a_place_in_their_own_words(tmp_path, label, wrong):
    told = "Ann entered the den. The pear is in the red box. The fig is in the box."
    chat = [
        {"role": "system", "content": "Answer."},
        {"role": "user", "content": told + " Where is the pear?"},
    ]
    for row in ({"input": f"{told} Where is the pear?"}, {"input": chat}):
        file = tmp_path / "rows.jsonl"
        file.write_text(json.dumps({**row, "target": label}), encoding="utf-8")
        done = audit(read_published(file))
        assert (done.items, len(done.wrong), done.unread) == (1, wrong, ())


WORDED = """\
Lea will look in the red box, because she did not see Noah move it to the drawer.
the red box, not the blue box
Lea will look in the red box since she never saw it moved.
She thinks it's still in the red box
In the red box rather than the drawer
where she put it: the red box
A) red box"""
OPEN = """\
In the red one
box
the box that is red
The red box (she doesn't know about the drawer)
Not in the drawer, but in the red box
red box; the drawer is where it really is
It was moved to the drawer, but Lea does not know.
It is in the drawer since Noah moved it, but Lea will look in the red one.
The drawer is not where Lea will look.
Anywhere but in the drawer
where she left it
not in the drawer"""


def test_right_labels_are_never_wrong_for_their_words(tmp_path):
    """A label that names no one place without doubt is not read."""
    told = (
        "Lea and Noah entered the den. The pear is in the red box. The nut is in the blue box. "
        "The fig is in the drawer. Lea left the den. Noah moved the pear to the drawer."
    )
    wrong = ["The drawer", "Lea will look in the drawer, because it is there.", "the blue box"]
    labels = [*WORDED.splitlines(), *wrong, *OPEN.splitlines()]
    asked = "Where will Lea look for the pear?"
    rows = [{"story": told, "question": asked, "answer": each} for each in labels]
    file = tmp_path / "rows.json"
    file.write_text(json.dumps(rows), encoding="utf-8")
    done = audit(read_published(file))
    assert [each.row for each in done.wrong] == [8, 9, 10]
    assert (done.items, done.undetermined, len(done.unread)) == (10, (), 12)
    assert "has the answer 'In the red one', which does not name one" in done.unread[0].faults[0]


def test_sentences_that_are_not_read_are_named(tmp_path, capsys):
    rows = [
        {"input": "Noor makes a cappuccino. Where is the milk?", "target": "jug"},
        {"input": STORY, "target": "pantry"},
        {"narrative": STORY, "question": SEES},
        {"input": f"{STORY} {SEES}", "target": "bathtub"},
        {"input": f"{STORY} {SEES}", "target": " "},
    ]
    file = tmp_path / "rows.jsonl"
    file.write_text("\n".join(map(json.dumps, rows)), encoding="utf-8")
    assert run_command_line(["suite", "audit", str(file)]) == 1
    out = capsys.readouterr().out
    assert "row 1: sentence 1: 'Noor makes a cappuccino.' is no sentence of a story" in out
    assert "row 2" in out
    assert "asks no question" in out
    assert "row 3: has no text of the answer, which is read from answer, target" in out
    assert "row 5: has an empty answer; write it" in out
    assert "1 item answered: 0 wrong, 0 undetermined; 4 could not be read" in out


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["none.json"], "none.json cannot be read"),
        (["empty.json"], "holds no rows"),
        (["nothing.csv"], "nothing.csv is empty; give rows"),
        (["broken.json"], "is no JSON"),
        (["empty.json", "--rows", "1"], "--rows is for suites"),
        (["empty.json", "--limit", "0"], "--limit is for suites"),
        (["empty.json", "--world", "nowhere"], "--world is for suites"),
        (["items.jsonl"], "check it by `beliefnest items STUDY -o SET --verify`"),
        ([], "0 files are given"),
    ],
)
def test_wrong_use(tmp_path, monkeypatch, capsys, arguments, told):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty.json").write_text("[]", encoding="utf-8")
    (tmp_path / "nothing.csv").touch()
    (tmp_path / "items.jsonl").write_bytes(msgspec.json.encode(invented()) + b"\n")
    (tmp_path / "broken.json").write_text('[{"story": ', encoding="utf-8")
    assert run_command_line(["suite", "audit", *arguments]) == 2
    assert told in capsys.readouterr().err


def test_an_audit_is_named_where_a_suite_is_misspelt(capsys):
    assert run_command_line(["suite", "audti", "rows.json"]) == 2
    assert "'audit'" in capsys.readouterr().err
