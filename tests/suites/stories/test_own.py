"""One's own stories: JSON lines, as sentences and as objects, in both worlds."""

import json

import pytest
from msgspec.structs import replace
from tests.profiles import few_by_day

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.llm.claim_reader import claims_from_model
from beliefnest.llm.resolve import Connection, open_model
from beliefnest.suites.stories.explaining import explain_answer
from beliefnest.suites.stories.floor_plan import lay_out
from beliefnest.suites.stories.own import read_own
from beliefnest.suites.stories.played_story import PlayedStory
from beliefnest.suites.stories.suite import answer_story

TOLD = {
    "name": "told",
    "events": [
        "Sally and Anne entered the den.",
        "The pear is in the box.",
        {"event": "door", "agent": "Anne", "room": "den", "open": False},
        {"event": "leave", "agents": ["Sally"], "room": "den"},
        "Anne opened the door of the den.",
        {"event": "move", "agent": "Anne", "thing": "pear", "container": "jar"},
        "Anne exited the den.",
        {
            "event": "whisper",
            "agent": "Anne",
            "hearer": "Sally",
            "thing": "pear",
            "container": "tin",
        },
        {"event": "wait"},
    ],
    "questions": [
        {"question": "Where is the pear really?", "answer": "jar"},
        {"believers": ["Sally"], "thing": "pear", "answer": "tin"},
        {"believers": ["Anne"], "thing": "pear", "answer": "jar"},
        {"question": "Where does Anne think Sally thinks the pear is?", "answer": "tin"},
        {"question": "Does Sally think the door of the den is open?", "answer": "shut"},
        {"believers": ["Anne"], "door": "den", "answer": "open"},
    ],
}
LOOKING = {
    "name": "looking",
    "containers": "opaque",
    "events": [
        {"event": "enter", "agents": ["Sally", "Anne"], "room": "den"},
        {"event": "is", "thing": "pear", "place": "box"},
        {"event": "open", "agent": "Sally", "container": "box"},
    ],
    "questions": [
        {"believers": ["Sally"], "thing": "pear", "answer": "box"},
        {"believers": ["Anne"], "thing": "pear", "answer": None},
        {"believers": ["Anne", "Sally"], "thing": "pear", "answer": None},
    ],
}


@pytest.fixture
def file(tmp_path):
    def write(*stories):
        path = tmp_path / "own.jsonl"
        path.write_text("\n".join(json.dumps(story) for story in stories) + "\n")
        return path

    return write


@pytest.mark.parametrize("world", ["scripted", "embedded"])
def test_own_stories_are_answered_as_they_say(file, world: str) -> None:
    judged = [
        each
        for story in read_own(file(TOLD, LOOKING)).whole()
        for each in answer_story(story, world)
    ]
    assert [each.why_not for each in judged if not each.ok] == []
    assert len(judged) == 9


def test_the_command_lists_what_is_answered_otherwise(file, capsys) -> None:
    questions = [{"believers": ["Sally"], "door": "den", "answer": "open"}]
    path = file(LOOKING, {**TOLD, "questions": questions})
    assert run_command_line(["suite", "stories", "--data", str(path)]) == 1
    out = capsys.readouterr().out
    assert "row 2: Sally thinks the door of the den is" in out
    assert "the door of the den is shut in /Sally, expected open" in out
    assert run_command_line(["suite", "stories", "--data", str(path), "--rows", "1"]) == 0


@pytest.mark.parametrize(
    ("change", "what"),
    [
        (
            {"events": [{"event": "juggle"}]},
            "line 1: event 1: .*'juggle'; allowed are enter,",
        ),
        ({"events": [{"event": "wisper"}]}, "event 1: .*'wisper'; did you mean 'whisper'"),
        ({"events": ["Sally juggled."]}, "line 1: event 1: 'Sally juggled.'"),
        ({"event": []}, "line 1: event: unknown key; did you mean 'events'"),
        ({"testimony": "maybe"}, "testimony: .*'maybe'; allowed are none, accept, informed"),
        ({"events": []}, "the story is empty"),
        ({"colour": "red"}, "colour"),
        ({"questions": [{"thing": "pear", "answer": "barn"}]}, "'barn' is no possible answer"),
        ({"questions": [{"door": "den", "answer": "ajar"}]}, "'ajar' is no possible answer"),
        ({"questions": [{"door": "hall", "answer": "open"}]}, "door of the hall"),
        ({"questions": [{"thing": "pear", "door": "den", "answer": "open"}]}, "must have one of"),
        ({"questions": [{"believers": ["Zoe"], "thing": "pear", "answer": None}]}, "Zoe is not"),
    ],
)
def test_what_is_wrong_is_said_with_the_line(file, change, what: str) -> None:
    with pytest.raises(bn.InputError, match=what):
        read_own(file({**TOLD, **change})).whole()


def test_a_door_that_is_open_already_is_a_fault(file) -> None:
    events = ["Sally entered the den.", "Sally opened the door of the den."]
    with pytest.raises(bn.InputError, match=r"event 2: .*is open already"):
        read_own(file({"events": events, "questions": []})).whole()


SIGNS = {
    "name": "a note",
    "events": [
        "Sally and Anne entered the den.",
        "The pear is in the box.",
        'Anne wrote "pears" on the sign of the den.',
        "Sally exited the den.",
        {"event": "write", "agent": "Anne", "room": "den", "text": "no\npears"},
        "Anne exited the den.",
        "Cid entered the attic.",
    ],
    "questions": [
        {"question": "What does the sign of the den really say?", "answer": "no\npears"},
        {"question": "What does Sally think the sign of the den says?", "answer": "pears"},
        {"believers": ["Anne", "Sally"], "sign": "den", "answer": "pears"},
        {"believers": ["Cid"], "sign": "den", "answer": None},
    ],
}


LONG = f'Anne wrote "{"x" * 46}" on the sign of the den.'


@pytest.mark.parametrize("world", few_by_day(["scripted", "embedded"]))
def test_what_is_written_on_a_sign_is_known_to_who_saw_it(tmp_path, world):
    file = tmp_path / "stories.jsonl"
    file.write_text(json.dumps(SIGNS))
    (told,) = read_own(file).whole()
    asked = [item.question for item in told.items]
    with PlayedStory.play(told.story, world, asked=asked) as played:
        for item in told.items:
            answer = played.answer(item.question)
            assert answer.text == item.expected, item.question.text
        wrong = told.items[1]
        lines = explain_answer(played, wrong.question, played.answer(wrong.question), "no\npears")
        assert lines[0] == ('the sign of the den says "pears" in /Sally, expected "no / pears"')


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (
            {"events": ["Anne exited the den.", 'Anne wrote "x" on the sign of the den.']},
            "Anne is in no room",
        ),
        ({"questions": [{"sign": "attic", "answer": "x"}]}, "nobody writes on a sign of the attic"),
        (
            {"questions": [{"sign": "den", "answer": "x"}]},
            "'x' is no possible answer; answers are '', 'no\\\\npears', 'pears'",
        ),
        (
            {"events": [*SIGNS["events"][:2], f'Anne wrote "{"x" * 46}" on the sign of the den.']},
            "46",
        ),
        (
            {
                "events": [
                    *SIGNS["events"][:2],
                    'Anne wrote "1\n2\n3\n4\n5" on the sign of the den.',
                ]
            },
            "event 3: .*a text of 5 lines",
        ),
    ],
)
def test_what_cannot_be_on_a_sign_is_named(tmp_path, change, fault):
    file = tmp_path / "stories.jsonl"
    file.write_text(json.dumps(SIGNS | change))
    with pytest.raises(bn.InputError, match=fault):
        read_own(file).whole()


def test_what_a_sentence_writes_on_a_sign_stays_as_it_is(tmp_path):
    file = tmp_path / "stories.jsonl"
    events = [*SIGNS["events"][:2], 'Anne wrote "a  b\nc" on the  sign of the den.']
    asked = {"sign": "den", "believers": ["Sally"], "answer": "a  b\nc"}
    file.write_text(json.dumps({"events": events, "questions": [asked]}))
    (told,) = read_own(file).whole()
    assert all(judged.ok for judged in answer_story(told, "scripted", 0))


@pytest.mark.parametrize("world", few_by_day(["scripted", "embedded"]))
def test_a_model_may_read_what_is_told(file, tmp_path, world, capsys):
    story = {
        "events": [
            "Sally and Anne entered the den.",
            "The pear is in the box.",
            "The ball is in the jar.",
            "Sally exited the den.",
            "Anne exited the den.",
            "Anne told Sally that the pear is in the jar.",
        ],
        "questions": [{"believers": ["Sally"], "thing": "pear", "answer": "jar"}],
    }
    path = file(story)
    (told,) = read_own(path).whole()
    plan = lay_out(told.story)
    place = next(at for where, at in plan.places.items() if where.container == "jar")
    claim = {"kind": "located", "item": plan.items["pear"], "place": place}
    answers = tmp_path / "answers.json"
    suite = ["suite", "stories", "--data", str(path), "--world", world, "--json"]
    for claims, status, unread in (([claim], 0, []), ([], 1, []), ("none", 1, [1])):
        answers.write_text(json.dumps([json.dumps({"claims": claims})]))
        assert run_command_line([*suite, "--claims-from", f"scripted:{answers}"]) == status
        assert json.loads(capsys.readouterr().out)["unread"] == unread
    reader = claims_from_model(open_model(f"scripted:{answers}", {}, Connection()))
    knowing = replace(told.knowing, claims_from=reader)
    with PlayedStory.play(told.story, knowing=knowing) as played:
        (asked,) = played.nest.prompts()
        assert f"{plan.items['pear']} (called pear)" in asked.messages[1][1]
        assert f"[{', '.join(map(str, place))}]: jar of the den" in asked.messages[1][1]


HANDS = {
    "events": [
        "Sally put the pear in the box.",
        "Sally left.",
        "Anne took it out of the box.",
        {"event": "put", "agent": "Anne", "thing": "it", "container": "jar"},
        "Anne told Sally that the pear is in the jar.",
    ],
    "questions": [
        {"question": "Where does Sally think the pear is?", "answer": "box"},
        {"question": "Where does Anne think Sally thinks the pear is?", "answer": "box"},
        {"question": "Where is the pear really?", "answer": "jar"},
    ],
}


@pytest.mark.parametrize("world", ["scripted", "embedded"])
def test_agents_act_without_an_entry_and_things_pass_through_hands(file, world: str) -> None:
    (story,) = read_own(file(HANDS)).whole()
    assert [each.why_not for each in answer_story(story, world) if not each.ok] == []


def test_who_cannot_hear_what_is_told_is_said(file, capsys) -> None:
    assert run_command_line(["suite", "stories", "--data", str(file(HANDS)), "--json"]) == 0
    (note,) = json.loads(capsys.readouterr().out)["notes"]
    assert note.startswith("row 1: event 5: ")
    assert note.endswith("Sally is not there; nobody hears it")


def test_the_rest_of_a_file_is_answered(file, capsys) -> None:
    bad = {**HANDS, "events": [*HANDS["events"], "Anne juggled.", "Anne sang."]}
    odd = {**HANDS, "questions": [*HANDS["questions"], {"question": "Who?", "answer": None}]}
    path = file(bad, HANDS, odd)
    path.write_text(path.read_text() + "{\n")
    assert run_command_line(["suite", "stories", "--data", str(path), "--json"]) == 1
    report = json.loads(capsys.readouterr().out)
    faults = [each["faults"] for each in report["not_read"]]
    assert [[fault[: fault.index(": ")] for fault in each] for each in faults] == [
        [f"{path}, line 1"] * 2,
        [f"{path}, line 3"],
        [f"{path}, line 4"],
    ]
    assert ["event 6" in faults[0][0], "event 7" in faults[0][1]] == [True, True]
    assert (report["unread_items"], report["all"]["right"]) == (5, 6)
    assert run_command_line(["suite", "stories", "--data", str(path), "--strict"]) == 2
    assert f"{path}, line 1: event 6: 'Anne juggled.'" in capsys.readouterr().err
