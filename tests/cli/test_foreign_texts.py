"""Texts of files on a terminal and in tables: no control characters, and no formulas."""

import csv
import io
import json

import pytest
from tests.studies.small import study_in

from beliefnest.cli.app import run_command_line
from beliefnest.cli.console import print_table, stdout
from beliefnest.cli.terminal_text import say
from beliefnest.studies.plainframe import Typed, csv_text

TITLE = "\x1b]0;owned\x07\x9b31m\u202e"


def test_what_is_said_commands_no_terminal(capsys):
    say(f"a {TITLE}\nb\n")
    out = capsys.readouterr().out
    assert out == "a \\u001b]0;owned\\u0007\\u009b31m\\u202e\nb\n"


def test_tables_command_no_terminal(capsys):
    from rich.table import Table

    table = Table(f"head {TITLE}")
    table.add_row(f"cell {TITLE}")
    print_table(stdout(), table)
    stdout().print(f"line {TITLE}", markup=False)
    out = capsys.readouterr().out
    assert not set("\x1b\x07\x9b\u202e") & set(out)
    assert out.count("owned") == 3


@pytest.mark.usefixtures("kept_worlds")
def test_methods_of_a_study_of_somebody_else_command_no_terminal(tmp_path, capsys):
    study = study_in(tmp_path, "scenarios: [small.yaml]\nworld: scripted\n")
    out = tmp_path / "out"
    assert run_command_line(["study", str(study), "--jobs", "1", "--out", str(out)]) in (0, 1)
    plan = json.loads((out / "study.json").read_text(encoding="utf-8"))
    plan["versions"] = {"beliefnest": TITLE, TITLE: "1"}
    (out / "study.json").write_text(json.dumps(plan), encoding="utf-8")
    capsys.readouterr()
    for command in (["methods", str(out)], ["reproduce", str(out)], ["stats", str(out)]):
        run_command_line(command)
        told = "".join(capsys.readouterr())
        assert not set("\x1b\x07\x9b\u202e") & set(told)


@pytest.mark.parametrize("text", ["=1+1", "+1+cmd|' /C calc'!A0", "@SUM(A1)", "-x", "\t=1", " =1"])
def test_no_cell_and_no_header_is_a_formula(text):
    rows = list(csv.reader(io.StringIO(csv_text({text: Typed([text, "plain"])}))))
    assert rows == [[f"'{text}"], [f"'{text}"], ["plain"]]


@pytest.mark.parametrize("text", ["-2,-51,-4", "-1.5", "+3"])
def test_numbers_stay_numbers(text):
    assert csv_text({"x": Typed([text, "plain"])}).splitlines()[1].strip('"') == text
