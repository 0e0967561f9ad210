"""The built-in experiment with speech, as a user runs it."""

import json
from pathlib import Path

import pytest

from beliefnest.cli.app import run_command_line


def test_the_table_has_a_column_for_each_condition(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run_command_line(["run", "ice-cream-van", "--out", "r"]) == 0
    rows = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    assert "condition 1 2 3" in rows
    # A long name of a row goes on in the line below.
    deepest = rows.index("/observer/john/mary")
    assert rows[deepest - 1] == "'location B' in not heard heard not heard"
    runs = json.loads(Path("r/run.json").read_text(encoding="utf-8"))["runs"]
    expected = [probe["expected"]["arrives"] for run in runs for probe in run["probes"][:1]]
    assert expected == [[4.5, 1, 4.5], [20.5, 1, 16.5], [4.5, 1, 4.5]]
