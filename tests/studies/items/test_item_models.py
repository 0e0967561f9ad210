"""Models on a set of items: what they are asked, how answers count, and files of results."""

import json

import pytest
from tests.studies.items.building import invented

from beliefnest.cli.app import run_command_line
from beliefnest.llm.messages import Answer
from beliefnest.studies.items.asking import judged_answer, prompt_of
from beliefnest.studies.items.item_set import ItemSet
from beliefnest.studies.items.people import people_cells
from beliefnest.studies.items.record import ItemRecord, item_id
from beliefnest.studies.items.results import PublishedSet
from beliefnest.world.words import counted

pytestmark = pytest.mark.usefixtures("kept_worlds")

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
    own = {"text": text, "right": right, "order": order, "seed": number, "skeleton": str(number)}
    return invented(id=item_id(f"scene {number}", "1.1"), **own)


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
    words = [*["is no result"] * 3, *words, f"has a result of {ITEMS[0].id} before"]
    numbers = [8, 9, 10, 1, 2, 3, 4, 5, 7]
    for fault, number, word in zip(report["faults"], numbers, words, strict=True):
        assert f":{number}: " in fault and word in fault
    assert report["missing"] == {lines[0]["model"]: 5, "first-option": 4}
    assert [each["right"] for each in report["models"] if "order" not in each] == [0, 0]


def test_lines_of_others_stay_in_the_file_of_results(tmp_path, capsys):
    ItemSet("own", ITEMS, ()).write(tmp_path / "set")
    results = tmp_path / "out" / "results.jsonl"
    command = ["items", str(tmp_path / "set"), "-o", str(tmp_path / "out"), "--jobs", "1"]
    assert run_command_line([*command, "--models", "first-option"]) == 0
    own = results.read_text(encoding="utf-8")
    theirs = own.replace('"first-option"', '"theirs"').rstrip("\n")
    results.write_text(f"{own}{theirs}\n{{not json", encoding="utf-8")
    for _ in range(2):
        assert run_command_line([*command, "--models", "first-option"]) == 0
        assert results.read_text(encoding="utf-8") == f"{own}{theirs}\n{{not json\n"
    assert run_command_line([*command, "--models", "chance"]) == 0
    lines = results.read_text(encoding="utf-8")
    assert lines.endswith(f"{own}{theirs}\n{{not json\n")
    assert lines.count('"chance"') == len(ITEMS)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--models", "first-option"], "with -o"),
        (["--models", "first-option,first-option", "-o", "OUT"], "each model once"),
        (["--models", "nobody", "-o", "OUT"], "no model 'nobody'"),
        (["--models", "first-option,", "-o", "OUT"], "each model once"),
        (["--verify-results", "nowhere.jsonl"], "no file of results"),
        (["--verify-results", "nowhere.jsonl", "-o", "OUT"], "--out belongs to `beliefnest items"),
        (["-o", "OUT"], "add --models"),
    ],
)
def test_wrong_input_is_refused(options, words, tmp_path, capsys):
    ItemSet("own", ITEMS, ()).write(tmp_path / "set")
    own = [each.replace("OUT", str(tmp_path / "out")) for each in options]
    assert run_command_line(["items", str(tmp_path / "set"), *own]) == 2
    assert words in capsys.readouterr().err


@pytest.mark.parametrize(
    ("damaged", "words"),
    [
        (lambda lines: [lines[0], lines[1][:90], *lines[2:]], "items.jsonl:2 cannot be read"),
        (lambda lines: [*lines[:-1], lines[-1][:90]], "items.jsonl:5 cannot be read"),
        (lambda lines: lines[1:], "has 4 items, and set.json says 5"),
        (lambda lines: [*lines[1:], lines[0]], "its digest is another"),
    ],
)
def test_a_damaged_set_is_not_asked(damaged, words, tmp_path, capsys):
    ItemSet("own", ITEMS, ()).write(tmp_path / "set")
    file = tmp_path / "set" / "items.jsonl"
    file.write_text("\n".join(damaged(file.read_text(encoding="utf-8").splitlines())), "utf-8")
    command = ["items", str(tmp_path / "set"), "--models", "chance", "-o", str(tmp_path / "out")]
    assert run_command_line(command) == 2
    told = capsys.readouterr().err
    assert words in told and "--verify" in told
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "other",
    [ItemSet("own", ITEMS[:3], ()), ItemSet("trial", ITEMS, ()), ItemSet("own", ITEMS, (), 0, "2")],
)
def test_results_of_another_set_are_not_replaced(other, tmp_path, capsys):
    ItemSet("own", ITEMS, ()).write(tmp_path / "set")
    other.write(tmp_path / "other")
    options = ["--models", "first-option", "-o", str(tmp_path / "out"), "--jobs", "1"]
    assert run_command_line(["items", str(tmp_path / "set"), *options]) == 0
    before = (tmp_path / "out" / "results.jsonl").read_bytes()
    assert run_command_line(["items", str(tmp_path / "other"), *options]) == 2
    told = capsys.readouterr().err
    assert "the set own 1.0.0 (" in told and f"this one is {other.name} {other.version} (" in told
    assert (tmp_path / "out" / "results.jsonl").read_bytes() == before


def test_results_of_a_set_without_a_digest_are_not_replaced(tmp_path, capsys):
    ItemSet("own", ITEMS, ()).write(tmp_path / "set")
    command = ["items", str(tmp_path / "set"), "--models", "chance", "-o", str(tmp_path / "out")]
    assert run_command_line(command) == 0
    plan = tmp_path / "out" / "study.json"
    content = json.loads(plan.read_text(encoding="utf-8"))
    del content["digest"]
    plan.write_text(json.dumps(content), encoding="utf-8")
    assert run_command_line(command) == 2
    assert "has results of the set own 1.0.0 (unknown)" in " ".join(capsys.readouterr().err.split())


def answer(participant, number, response, **values):
    """Return a row of the page for participants."""
    row = {"participant": participant, "cell": f"scene {number}", "question": "1.1"}
    own = {"response": response, "options": ["box", "bag"], "started": f"2026-01-0{participant}"}
    return {**row, **own, **values}


def test_people_stand_beside_models(tmp_path, capsys):
    """Two participants answer; one of them twice, and once to a question that is held out."""
    ItemSet("own", ITEMS, ()).write(tmp_path / "set")
    rows = [answer("7", each, "box") for each in (0, 1, 4)]
    rows += [answer("5", 0, "bag"), answer("5", 0, "box", started="later"), answer("5", 9, "bag")]
    (tmp_path / "answers.json").write_text(json.dumps(rows), encoding="utf-8")
    out = tmp_path / "out"
    command = ["items", str(tmp_path / "set"), "--models", "first-option", "-o", str(out)]
    people = ["--people", str(tmp_path / "answers.json")]
    for _ in range(2):
        assert run_command_line([*command, *people, "--jobs", "1"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "not counted: 1 answer of people to no item of the set" in text
    assert "participant p1 took part more than once" in text
    assert run_command_line([*command, *people, "--jobs", "1", "--json"]) == 0
    groups = json.loads(capsys.readouterr().out)["models"]
    own = {each.get("order"): each for each in groups if each["model"] == "people"}
    assert {n: (each["judged"], each["right"]) for n, each in own.items()} == {
        None: (4, 2),
        1: (3, 1),
        2: (1, 1),
    }
    # Results are those of models; rows are those of all.
    assert len((out / "results.jsonl").read_text().splitlines()) == len(ITEMS)
    assert run_command_line(["stats", str(out), "--between", "model", "--json"]) == 0
    (pair,) = json.loads(capsys.readouterr().out)["differences"]["model"]
    assert (pair["pairs"], pair["only_other"], pair["only_one"]) == (4, 2, 1)
    assert run_command_line([*command, "--jobs", "1", "--json"]) == 0
    assert {each["model"] for each in json.loads(capsys.readouterr().out)["models"]} == {
        "first-option"
    }


def test_answers_to_items_that_are_held_out_are_told_as_such(tmp_path):
    made = ItemSet("own", ITEMS, (), 0.5)
    made.write(tmp_path / "set")
    kept = [each.seed for each in made.parts["held-out"]]
    items = PublishedSet.read(tmp_path / "set")
    rows = [answer("7", each.seed, "box") for each in items.choices]
    rows += [answer("7", each, "box") for each in (*kept, *kept, 9)]
    file = tmp_path / "answers.json"
    file.write_text(json.dumps(rows), encoding="utf-8")
    cells, notes = people_cells(items.name, items.choices, items.held_out, [file])
    assert len(cells) == len(items.choices)
    hidden = counted(len(kept), "answer")
    assert notes == [
        f"not counted: {hidden} of people to items that are held out",
        "not counted: 1 answer of people to no item of the set",
    ]


def test_the_gap_to_acting_stands_at_its_order(tmp_path, capsys):
    ItemSet("own", ITEMS, ()).write(tmp_path / "set")
    row = {"order": 1, "literal": {"rate": 0.9}, "functional": {"rate": 0.5}}
    pairs = [{**row, "family": each, "difference": 0.4, "p": 0.01} for each in ("tell", "")]
    content = json.dumps({"model": "first-option", "pairs": pairs})
    (tmp_path / "functional.json").write_text(content, encoding="utf-8")
    command = ["items", str(tmp_path / "set"), "-o", str(tmp_path / "out"), "--jobs", "1"]
    command += ["--gap", str(tmp_path)]
    assert run_command_line([*command, "--models", "first-option"]) == 0
    lines = capsys.readouterr().out.splitlines()
    (line,) = (each for each in lines if "+40% (p 0.010)" in each)
    assert line.split()[:2] == ["first-option", "1"] and "50%" in line
    assert run_command_line([*command, "--models", "chance"]) == 2
    assert "has episodes of 'first-option', and --models is chance" in capsys.readouterr().err
    (tmp_path / "functional.json").write_text('{"certificates": []}', encoding="utf-8")
    assert run_command_line([*command, "--models", "chance"]) == 2
    assert f"{tmp_path} has no model: run `beliefnest items STUDY" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ([answer("7", 0, "barrel")], "'barrel' is none of the options bag, box"),
        ([answer("7", 0, "box"), answer("7", 0, "bag")], "keep one of the two files"),
        ([answer("7", 8, "box")], "has no answer to an item of own"),
        ([{"participant": "7"}], "column cell: is empty"),
    ],
)
def test_answers_of_people_that_do_not_fit_are_refused(rows, words, tmp_path, capsys):
    ItemSet("own", ITEMS, ()).write(tmp_path / "set")
    (tmp_path / "answers.json").write_text(json.dumps(rows), encoding="utf-8")
    command = ["items", str(tmp_path / "set"), "--models", "chance", "-o", str(tmp_path / "out")]
    assert run_command_line([*command, "--people", str(tmp_path / "answers.json")]) == 2
    assert words in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.extra("matplotlib")
@pytest.mark.parametrize("models", ["first-option", "chance,first-option"])
def test_a_figure_names_its_models_and_the_level_of_chance(models, tmp_path, capsys):
    ItemSet("own", ITEMS[:2], ()).write(tmp_path / "set")
    out = tmp_path / "out"
    command = ["items", str(tmp_path / "set"), "-o", str(out), "--models", models, "--jobs", "1"]
    mpl = pytest.importorskip("matplotlib")
    with mpl.rc_context({"svg.fonttype": "none"}):
        assert run_command_line(command) == 0
    drawn = (out / "accuracy.svg").read_text(encoding="utf-8")
    for name in ("chance level", *models.split(",")):
        assert drawn.count(f">{name}</text>") == 1


def test_a_model_that_fails_is_told(tmp_path, capsys):
    ItemSet("own", ITEMS, ()).write(tmp_path / "set")
    model = tmp_path / "broken.py"
    model.write_text(MODEL.replace("text = messages[-1].text", 'raise ValueError("oops")'))
    command = ["items", str(tmp_path / "set"), "-o", str(tmp_path / "out"), "--models"]
    assert run_command_line([*command, f"{model}:Careful"]) == 3
    assert "oops" in capsys.readouterr().err
