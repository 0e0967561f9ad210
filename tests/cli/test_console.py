"""Results keep to the width they are given, cut no label, and carry no colours into files."""

import re
from collections import Counter
from pathlib import Path

import pytest
from rich.table import Table

from beliefnest.cli.app import run_command_line
from beliefnest.cli.console import folded, print_table, progress_on, stdout

pytestmark = pytest.mark.usefixtures("kept_worlds")


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "run"
    asked = ["run", "sally-anne", "--condition", "1", "--condition", "2", "--out", str(folder)]
    assert run_command_line(asked) == 0
    return folder


@pytest.mark.parametrize("columns", [60, 80])
def test_no_label_is_cut_and_no_line_is_wider(
    run: Path, columns: int, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", str(columns))
    for asked in (["show", str(run), "--path", "/sally"], ["list"]):
        assert run_command_line(asked) == 0
        lines = capsys.readouterr().out.splitlines()
        assert max(map(len, lines)) <= columns
        assert not any("\u2026" in line for line in lines)


def test_a_run_is_told_in_eighty_columns(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    asked = ["run", "sally-anne", "--condition", "1", "--out", str(tmp_path / "run")]
    assert run_command_line(asked) == 0
    table = capsys.readouterr().out.partition("sally-anne")[2]
    assert "\u2026" not in table
    labels = Counter(re.findall(r"^  (\S.*?)   ", table, re.MULTILINE))
    assert "diamond in /observer/sally" in labels
    assert not [label for label, count in labels.items() if count > 1]


def test_files_get_no_colours_whatever_the_environment_says(
    run: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("FORCE_COLOR", "CLICOLOR_FORCE", "TTY_COMPATIBLE"):
        monkeypatch.setenv(name, "1")
    assert run_command_line(["show", str(run)]) == 0
    with progress_on("title") as say:
        say("doing", 0, 1)
    captured = capsys.readouterr()
    assert "\x1b" not in captured.out + captured.err
    assert captured.err == "title: doing (0/1)\n"


def test_a_phase_with_the_same_total_is_shown_anew(capsys: pytest.CaptureFixture[str]) -> None:
    with progress_on("title") as say:
        for phase in ("search", "rules"):
            for done in range(61):
                say(phase, done, 60)
    lines = capsys.readouterr().err.splitlines()
    assert [lines[0], lines[21]] == ["title: search (0/60)", "title: rules (0/60)"]
    assert len(lines) == 42


def test_every_condition_of_a_folder_is_shown(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command_line(["show", str(run), "--path", "/sally"]) == 0
    printed = capsys.readouterr().out
    assert printed.index("condition 1") < printed.index("condition 2")
    file = tmp_path / "f.svg"
    assert run_command_line(["show", str(run), "--path", "/sally", "--svg", str(file)]) == 0
    assert {"condition 1", "condition 2"} <= set(re.findall(r"condition \d", file.read_text()))
    assert run_command_line(["show", str(run), "--json"]) == 2
    assert "name one of" in capsys.readouterr().err


def test_cells_are_folded(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "24")
    table = Table("a", "b")
    table.add_row("x" * 30, "y" * 30)
    stdout().print(folded(table))
    assert capsys.readouterr().out.count("x") == 30


def test_a_table_without_room_for_its_words_is_printed_as_lists(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    headings = [f"/believer/of/{name}" for name in ("ann", "bob", "cid", "dan", "eve", "flo")]
    for columns, is_list in (("80", True), ("140", False)):
        monkeypatch.setenv("COLUMNS", columns)
        table = Table(*headings, title="beliefs")
        table.add_row(*(f"diamond {number}" for number in range(len(headings))))
        print_table(stdout(), table)
        printed = capsys.readouterr().out
        assert "diamond 5" in " ".join(printed.split())
        assert max(map(len, printed.splitlines())) <= int(columns)
        assert ("/believer/of/ann  diamond 0" in printed) is is_list
        assert all(heading in printed for heading in headings)


def test_a_table_in_a_pipe_breaks_no_word(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    words = [f"a-name-of-{'x' * 20}-{number}" for number in range(9)]
    table = Table(*words, title="wide")
    table.add_row(*(f"{word}-below and more" for word in words))
    print_table(stdout(), table)
    printed = capsys.readouterr().out.split()
    assert {*words, *(f"{word}-below" for word in words)} <= set(printed)
