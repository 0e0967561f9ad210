"""Answers of people as rows of the study: joined, judged, in one table with models."""

import csv
import json
import math
import zipfile

import pytest
from tests.studies.transfer import STUDY, TRANSFER, answers_of, content_of, transfer_in

import beliefnest as bn
from beliefnest.studies.counting import count_rows

pytestmark = pytest.mark.usefixtures("kept_worlds")


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """Folder with a study and its page, which shows stories."""
    folder = tmp_path_factory.mktemp("page")
    bn.Study.load(transfer_in(folder)).participants(folder / "page", "story")
    return folder


@pytest.fixture
def study(page):
    return bn.Study.load(page / "study.yaml")


def in_json(file, answers):
    file.write_text(json.dumps(list(answers)), encoding="utf-8")
    return file


def in_csv(file, answers):
    rows = [
        {name: json.dumps(v) if isinstance(v, list) else v for name, v in each.items()}
        for each in answers
    ]
    with file.open("w", encoding="utf-8", newline="") as out:
        writer = csv.DictWriter(out, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    return file


@pytest.fixture
def answers(page, tmp_path):
    """Folder of answers of three people: two are right, one thinks that Sally knows all."""
    content = content_of(page / "page")
    folder = tmp_path / "answers"
    folder.mkdir()
    in_json(folder / "a.json", answers_of(content, "anna", 1))
    in_csv(folder / "b.csv", answers_of(content, "ben", 2))
    in_csv(folder / "c.csv", answers_of(content, "cleo", 1, right=False))
    return folder


def test_people_and_models_stand_in_one_table_and_one_figure(study, answers, tmp_path):
    result, notes = study.read_participants(tmp_path / "out", [answers])
    assert notes == ()
    people = {(row["participant"], row["condition"], row["probe"]): row for row in result.rows}
    assert len(people) == len(result.rows) == 12
    assert {row["model"] for row in people.values()} == {"people"}
    assert people["anna", 1, "belief"]["ok"] is True
    assert people["cleo", 1, "belief"]["ok"] is False
    assert people["cleo", 1, "belief"]["why_not"] == "answered 'chest'"
    assert people["ben", 2, "own"]["answered"] == "chest; anne"
    # A probe is right if all its questions are.
    assert people["cleo", 1, "own"]["answered"] == "chest; anne"
    assert people["cleo", 1, "own"]["ok"] is False
    study.run(tmp_path / "out", jobs=1)
    both = bn.StudyResult.read(tmp_path / "out")
    models = [row for row in both.rows if row["model"] == "offline"]
    assert {row["participant"] for row in models} == {None}
    assert {row["variation"] for row in models} == {row["variation"] for row in people.values()}
    asked = [row for row in models if row["probe"] != "act"]
    for row in asked:
        twins = [each for each in both.rows if each["participant"] and _same(each, row)]
        assert twins
        assert {each["expected"] for each in twins} == {row["expected"]}
        assert {each["seed"] for each in twins} == {row["seed"]}
    summary = both.summary(by=["model"])
    assert dict(zip(summary["model"], summary["judged"], strict=True)) == {
        "people": 12,
        "offline": 12,
    }
    assert both.frame()["participant"].isna().sum() == 12


def _same(one, other):
    names = ("scenario", "condition", "variation", "probe", "path", "task")
    return all(one[name] == other[name] for name in names)


def test_models_are_compared_with_all_people_of_the_same_cell(study, answers, tmp_path):
    study.run(tmp_path / "out", jobs=1)
    result, _ = study.read_participants(tmp_path / "out", [answers])
    (pairs,) = result.compared("model", ["probe"])[:1]
    assert {pairs["one"], pairs["other"]} == {"offline", "people"}
    # In two of the four cells two people answered, in the others one.
    assert (pairs["pairs"], pairs["variations"]) == (6, 2)
    conditions = result.compared("condition", ["model"])
    assert {each["model"] for each in conditions} == {"offline", "people"}


def test_all_answers_with_times_are_in_a_table_of_their_own(study, answers, tmp_path):
    result, _ = study.read_participants(tmp_path / "out", [answers])
    with (result.folder.path / "people.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 18
    assert {row["rt"] for row in rows} == {"1234"}
    wrong = [row for row in rows if row["right"] == "False"]
    assert {row["participant"] for row in wrong} == {"cleo"}
    assert {row["question"] for row in wrong} == {"1.1", "2.1"}


def test_reading_again_replaces_people_of_that_name_only(study, answers, tmp_path):
    out = tmp_path / "out"
    study.read_participants(out, [answers])
    study.read_participants(out, [answers / "a.json"], "crowd")
    result, _ = study.read_participants(out, [answers / "b.csv"])
    found = {(row["model"], row["participant"]) for row in result.rows}
    assert found == {("people", "ben"), ("crowd", "anna")}
    assert len(result.folder.names()) == 4
    with pytest.raises(bn.InputError, match="which is a model of the study"):
        study.read_participants(out, [answers], "offline")


def test_pseudonyms_replace_ids_in_all_files(page, study, tmp_path):
    content = content_of(page / "page")
    for number, name in ((2, "secret-b"), (1, "secret-a")):
        in_json(tmp_path / f"{number}.json", answers_of(content, name, number))
    files = [tmp_path / "2.json", tmp_path / "1.json"]
    result, _ = study.read_participants(tmp_path / "out", files, pseudonyms=True)
    result.write_page(tmp_path / "out" / "page.html")
    lists = {(row["participant"], row["list"]) for row in result.rows}
    assert lists == {("p1", 1), ("p2", 2)}
    for file in result.folder.path.rglob("*.*"):
        assert b"secret" not in file.read_bytes()


@pytest.mark.parametrize(
    ("separator", "encoding"), [(",", "utf-8"), (";", "utf-8-sig"), ("\t", "utf-16")]
)
def test_a_list_of_exclusions_is_counted_wherever_it_comes_from(
    study, answers, tmp_path, separator, encoding
):
    rows = [
        ["note", "id", "reason"],
        ["", "cleo", "said that she guessed"],
        ["", "ben", "failed the check"],
    ]
    excluded = tmp_path / "excluded.csv"
    excluded.write_bytes("\r\n".join(map(separator.join, rows)).encode(encoding))
    out = tmp_path / "out"
    result, notes = study.read_participants(out, [answers], exclude=excluded, pseudonyms=True)
    assert {row["participant"] for row in result.rows} == {"p1"}
    told = "2 participants by a list (1 for 'failed the check', 1 for 'said that she guessed')"
    assert notes == (f"excluded: {told}",)
    methods = result.methods()
    assert "Of 1 participant who began" in methods
    assert f"Excluded were {told}" in methods
    assert "Further participants or answers that were left out of the files by hand" in methods
    # A bundle of the folder keeps the numbers, and no id.
    result.bundle(tmp_path / "study.zip")
    with zipfile.ZipFile(tmp_path / "study.zip") as bundled:
        texts = [bundled.read(name) for name in bundled.namelist()]
    assert any(b"failed the check" in text for text in texts)
    assert not any(b"cleo" in text for text in texts)
    # Without the list, they count again.
    result, notes = study.read_participants(out, [answers])
    assert len({row["participant"] for row in result.rows}) == 3
    assert "by a list" not in result.methods()
    assert "Nothing" not in result.methods()


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("participant;reason\nCleo;guessed\n", r"2, column participant: nobody .* is 'Cleo'; corr"),
        (
            "participant,reason\n5E+23,x\n",
            "2, column participant: nobody .* is '5E[+]23', which is a number in scientific",
        ),
        ("participant,reason\ncleo,\n", "2, column reason: is empty; say why 'cleo'"),
        ("participant,reason\ncleo,a\ncleo,b\n", "3, column reason: 'cleo' is excluded for 'a'"),
        ("name,reason\ncleo,a\n", "1 has no column 'participant'"),
    ],
)
def test_a_list_that_does_not_fit_the_answers_is_refused(study, answers, tmp_path, text, told):
    excluded = tmp_path / "excluded.csv"
    excluded.write_text(text, encoding="utf-8")
    with pytest.raises(bn.InputError, match=f"excluded.csv:{told}"):
        study.read_participants(tmp_path / "out", [answers], exclude=excluded)
    assert not (tmp_path / "out" / "people.json").exists()


def test_a_parameter_cannot_be_called_participant(page, tmp_path):
    text = TRANSFER.replace("  item: {", "  participant: {default: 1, values: [1, 2]}\n  item: {")
    varied = STUDY.replace("variations: {", "variations: {participant: [1, 2], ")
    study = bn.Study.load(transfer_in(tmp_path, varied, text))
    file = in_json(tmp_path / "a.json", answers_of(content_of(page / "page"), "anna", 1))
    with pytest.raises(bn.InputError, match="'participant' has the name of the column"):
        study.read_participants(tmp_path / "out", [file])


def test_positions_of_options_are_those_that_people_saw(study, answers, tmp_path):
    result, _ = study.read_participants(tmp_path / "out", [answers])
    counted = {each["right_at"]: each for each in result.counted_positions(["model"])}
    # `anne` stands first, and so does `chest`, which is right in condition 2.
    assert counted[1]["chosen_1"] == counted[1]["asked"] == 9
    assert (counted[2]["chosen_1"], counted[2]["chosen_2"]) == (1, 2)


def test_sessions_that_repeat_or_end_early_are_told(page, study, tmp_path):
    content = content_of(page / "page")
    whole = list(answers_of(content, "anna", 1))
    in_json(tmp_path / "1.json", whole)
    in_csv(tmp_path / "2.csv", whole)
    again = [{**each, "started": "2026-11-23T11:00:00.000Z"} for each in whole]
    in_json(tmp_path / "3.json", again)
    # Of the second item, one of two questions of a probe.
    part = list(answers_of(content, "ben", 2))[:5]
    in_json(tmp_path / "4.json", part)
    files = [tmp_path / name for name in ("1.json", "2.csv", "3.json", "4.json")]
    result, notes = study.read_participants(tmp_path / "out", files)
    assert notes == (
        "participant anna took part more than once; only the session that began first "
        "(2026-11-23T10:00:01.000Z) counts",
        "6 answers stood in several files and counted once",
        "participant ben answered 5 of 6 questions",
    )
    own = [row["probe"] for row in result.rows if row["participant"] == "ben"]
    assert own == ["belief", "own", "belief"]


def changed(answers, **values):
    first, *rest = answers
    return [{**first, **values}, *rest]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"cell": "0123"}, r"bad.json, entry 1, column cell: '0123' is no cell of this study"),
        ({"question": "9.9"}, r"entry 1, column question: .* has no question 9.9"),
        ({"response": "attic"}, r"entry 1, column response: 'attic' is none of the options"),
        ({"options": ["chest"]}, r"entry 1, column options: must be left box, chest"),
        ({"options": 7}, r"entry 1, column options: is 7; it must be a list of texts"),
        ({"participant": ""}, r"entry 1, column participant: is empty"),
        ({"response": ["chest"]}, r"entry 1, column response: is \['chest'\]; it must be a text"),
    ],
)
def test_damaged_answers_are_named_by_file_row_and_column(page, study, tmp_path, values, message):
    answers = changed(answers_of(content_of(page / "page"), "anna", 1), **values)
    file = in_json(tmp_path / "bad.json", answers)
    with pytest.raises(bn.InputError, match=message):
        study.read_participants(tmp_path / "out", [file])


def test_damaged_files_are_named(page, study, tmp_path):
    answers = list(answers_of(content_of(page / "page"), "anna", 1))
    bad = in_csv(tmp_path / "bad.csv", [*answers[:2], {**answers[2], "response": "attic"}])
    bad.write_text(bad.read_text("utf-8").replace("anne", "attic"), encoding="utf-8")
    cases = {
        "missing.csv": (None, "cannot be read"),
        "short.csv": ("participant,cell\n1,2\n", r"short\.csv:1 has no column 'question'"),
        "cut.json": ('[{"participant": ', "is no JSON list"),
        "other.json": ('[{"trial_type": "html"}]', "has no answers"),
    }
    for name, (text, message) in cases.items():
        if text is not None:
            (tmp_path / name).write_text(text, encoding="utf-8")
        with pytest.raises(bn.InputError, match=message):
            study.read_participants(tmp_path / "out", [tmp_path / name])
    with pytest.raises(bn.InputError, match=r"bad\.csv:4, column response"):
        study.read_participants(tmp_path / "out", [bad])
    other = in_json(tmp_path / "x.json", changed(answers, response="left box"))
    plain = in_json(tmp_path / "y.json", changed(answers, response="chest"))
    with pytest.raises(bn.InputError, match=r"y\.json, entry 1, column response: .*x\.json"):
        study.read_participants(tmp_path / "out", [other, plain])
    (tmp_path / "empty").mkdir()
    with pytest.raises(bn.InputError, match=r"no \.csv or \.json file"):
        study.read_participants(tmp_path / "out", [tmp_path / "empty"])
    assert not (tmp_path / "out").exists()


def test_answers_to_another_version_of_the_study_are_refused(page, tmp_path):
    file = in_json(tmp_path / "a.json", answers_of(content_of(page / "page"), "anna", 1))
    other = bn.Study.load(transfer_in(tmp_path, scenario=TRANSFER.replace("0, 3.5]", "0, 2.5]")))
    with pytest.raises(bn.InputError, match="have changed since this participant's page"):
        other.read_participants(tmp_path / "out", [file])
    # More models and repeats change no cell.
    more = bn.Study.load(transfer_in(tmp_path, f"{STUDY}repeats: 2\n"))
    result, notes = more.read_participants(tmp_path / "out", [file])
    assert (len(result.rows), notes) == (4, ())


def test_files_of_jspsych_are_read_without_the_trials_of_others(page, study, tmp_path):
    answers = [
        {"trial_type": "html-button-response", "response": "0", "participant": "anna"},
        *answers_of(content_of(page / "page"), "anna", 1),
    ]
    result, _ = study.read_participants(tmp_path / "out", [in_json(tmp_path / "a.json", answers)])
    assert len(result.rows) == 4


def test_supplement_and_methods_tell_of_people(study, answers, tmp_path):
    study.run(tmp_path / "out", jobs=1)
    result, _ = study.read_participants(tmp_path / "out", [answers])
    assert (
        "`people` are 3 participants who answered the same questions on a page with stories, "
        "which gave 12 rows, on 2026-11-23 (UTC)." in result.methods()
    )
    assert "This makes 4 cells and 12 rows" in result.methods()
    again = result.reproduce()
    assert (again.is_equal, again.cells, again.rows) == (True, 4, 12)
    unpacked = tmp_path / "unpacked"
    with zipfile.ZipFile(result.bundle(tmp_path / "s.zip")) as archive:
        archive.extractall(unpacked)
    assert (unpacked / "people.csv").is_file()
    assert bn.StudyResult.read(unpacked).rows == result.rows
    assert bn.StudyResult.read(unpacked).reproduce().is_equal


def test_merged_shards_keep_people(study, answers, tmp_path):
    study.run(tmp_path / "one", jobs=1, shard=(1, 2))
    study.read_participants(tmp_path / "two", [answers])
    study.take_over(tmp_path / "all", [tmp_path / "one", tmp_path / "two"])
    result = study.run(tmp_path / "all", jobs=1)
    assert len([row for row in result.rows if row["model"] == "people"]) == 12
    assert len([row for row in result.rows if row["model"] == "offline"]) == 12


def test_a_folder_that_was_changed_by_hand_is_refused(study, answers, tmp_path):
    result, _ = study.read_participants(tmp_path / "out", [answers])
    file = result.folder.path / "people.json"
    file.write_text(
        '{"form": "beliefnest people 1", "cells": [1], "sessions": {}}', encoding="utf-8"
    )
    with pytest.raises(bn.InputError, match=r"people\.json is damaged"):
        _ = bn.StudyResult.read(result.folder.path).rows
    file.write_text('{"form": "another"}', encoding="utf-8")
    with pytest.raises(bn.InputError, match=r"people\.json was written by another version"):
        _ = bn.StudyResult.read(result.folder.path).rows


def test_intervals_of_people_are_clustered_both_ways(study, answers, tmp_path):
    result, _ = study.read_participants(tmp_path / "out", [answers])
    (counted,) = count_rows(result.rows, ["model"])
    assert counted["interval"] == "two-way bootstrap"
    assert math.isclose(counted["accuracy"], 10 / 12)
    assert counted["low"] < 10 / 12 <= counted["high"] == 1


def test_answers_that_a_spreadsheet_has_saved_are_read_or_refused_with_their_row(
    study, answers, tmp_path
):
    text = (answers / "b.csv").read_text(encoding="utf-8")
    rows = list(csv.reader(text.splitlines()))

    def saved(name, delimiter, end, encoding, changed=lambda column, cell: cell):
        file = tmp_path / name
        cells = [[changed(c, v) for c, v in zip(rows[0], row, strict=True)] for row in rows[1:]]
        with file.open("w", encoding=encoding, newline="") as out:
            csv.writer(out, delimiter=delimiter, lineterminator=end).writerows([rows[0], *cells])
        return file

    plain, _ = study.read_participants(tmp_path / "plain", [answers / "b.csv"])
    for number, form in enumerate(
        [(";", "\r\n", "utf-8-sig"), ("\t", "\r\n", "utf-16"), (";", "\r", "cp1252")]
    ):
        file = saved(f"{number}.csv", *form)
        result, notes = study.read_participants(tmp_path / f"out{number}", [file])
        assert notes == ()
        assert result.rows == plain.rows
    for spoilt in ("5E+23", "1,23457E+15", "01. Mrz"):
        file = saved(
            "spoilt.csv",
            ";",
            "\n",
            "utf-8",
            lambda c, v, to=spoilt: to if c == "participant" else v,
        )
        with pytest.raises(bn.InputError, match=r"spoilt\.csv:2, column participant: '.*' is a"):
            study.read_participants(tmp_path / "never", [file])
    entries = [{**each, "participant": "5E+23"} for each in json.loads(
        (answers / "a.json").read_text(encoding="utf-8"))]  # fmt: skip
    with pytest.raises(bn.InputError, match=r"spoilt\.json, entry 1, column participant: '5E\+23'"):
        study.read_participants(tmp_path / "never", [in_json(tmp_path / "spoilt.json", entries)])
