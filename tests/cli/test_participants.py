"""`beliefnest participants`: a page for people, and their answers in the tables of the study."""

import csv
import json

import pytest
from tests.studies.transfer import answers_of, content_of, transfer_in

from beliefnest.cli.app import run_command_line

pytestmark = pytest.mark.usefixtures("kept_worlds")


def run(*arguments):
    return run_command_line(["participants", *map(str, arguments)])


def test_from_the_page_to_the_statistics(tmp_path, capsys):
    study = transfer_in(tmp_path)
    page, out = tmp_path / "page", tmp_path / "out"
    assert run(study, "-o", page, "--show", "story") == 0
    told = capsys.readouterr()
    assert told.out.splitlines() == [
        "transfer: probe 'act' is left out: it asks for a program, which people do not write",
        f"{page / 'index.html'}: 4 items with 12 questions, in lists of 2 and 2; open it with "
        "?participant=ID",
    ]
    assert "(4/4)" in told.err
    content = content_of(page)
    (tmp_path / "data").mkdir()
    for number, name in enumerate(("anna", "ben"), 1):
        answers = list(answers_of(content, name, number, right=name == "anna"))
        (tmp_path / "data" / f"{name}.json").write_text(json.dumps(answers), encoding="utf-8")
    assert run(study, "--read", tmp_path / "data", "-o", out, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found == {
        "study_dir": str(out),
        "participants": 2,
        "rows": 8,
        "right": 6,
        "notes": [],
    }
    with (out / "rows.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["participant"] for row in rows] == ["anna"] * 4 + ["ben"] * 4
    # Models play in the same folder; the exit status is about them alone.
    assert run_command_line(["study", str(study), "--out", str(out), "--jobs", "1"]) == 1
    capsys.readouterr()
    command = ["stats", str(out), "--between", "model", "--json"]
    assert run_command_line(command) == 0
    stats = json.loads(capsys.readouterr().out)
    judged = [(each["model"], each["judged"]) for each in stats["summary"]]
    assert sum(count for name, count in judged if name == "offline") == 12
    assert sum(count for name, count in judged if name == "people") == 8
    pairs = [each["pairs"] for each in stats["differences"]["model"]]
    assert sum(pairs) == 8
    assert (out / "people.csv").is_file()
    text = (out / "study.html").read_text(encoding="utf-8")
    assert "2 participants;" in text
    assert "over variations and participants" in text


def test_errors_say_what_to_do(tmp_path, capsys):
    study = transfer_in(tmp_path)
    none = tmp_path / "none.csv"
    assert run(study, "--read", none, "-o", tmp_path / "out") == 2
    assert f"{none} cannot be read" in capsys.readouterr().err
    assert run(study, "--read", none, "-o", tmp_path / "out", "--post", "https://x.org") == 2
    assert "--post belongs to writing a page" in capsys.readouterr().err
    assert run(study, "-o", tmp_path / "page", "--pseudonyms") == 2
    assert "--pseudonyms belongs to reading answers" in capsys.readouterr().err
    assert run(study, "-o", tmp_path / "page", "--exclude", none) == 2
    assert "--exclude belongs to reading answers" in capsys.readouterr().err
    assert run(study) == 2
    assert "--out" in capsys.readouterr().err
