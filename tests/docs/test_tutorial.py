"""The tutorial, from an empty folder to its end, as it is written."""

import json
import re
import shlex
from pathlib import Path

import pytest

from beliefnest.cli.app import run_command_line

pytestmark = pytest.mark.usefixtures("kept_worlds")

ROOT = Path(__file__).parents[2]
TUTORIAL = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", TUTORIAL, re.DOTALL)


def commands(block: str) -> list[list[str]]:
    lines = [line[2:] for line in block.splitlines() if line.startswith("$ ")]
    return [shlex.split(line)[1:] for line in lines if line.startswith("beliefnest ")]


def test_it_leads_from_an_empty_folder_to_a_result(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    start, inside, study = blocks("console")
    for arguments in commands(start):
        assert run_command_line(arguments) == 0
    assert start.splitlines()[1] in capsys.readouterr().out
    written = Path("boxes.yaml").read_text(encoding="utf-8")
    assert [run["ok"] for run in json.loads(Path("first/run.json").read_text())["runs"]] == [
        True,
        True,
    ]
    for arguments in commands(inside):
        assert run_command_line(arguments) == 0
    assert "Blocks seen so far:" in capsys.readouterr().out

    code = blocks("python")[0]
    exec(compile(code, "tutorial", "exec"), {"__name__": "tutorial"})
    claims = re.findall(r"print\(.*\)  # (.*)", code)
    assert capsys.readouterr().out.splitlines() == claims

    perception, step, expectation = blocks("yaml")
    changed = re.sub(r"perception: .*\n", perception, written)
    changed = changed.replace("\n# Expected states", f"{step}\n# Expected states")
    changed = changed.replace("\n# Requests to a model", f"{expectation}\n# Requests to a model")
    assert len(changed.splitlines()) == len(written.splitlines()) + 5
    Path("boxes.yaml").write_text(changed, encoding="utf-8")
    assert run_command_line(["run", "boxes.yaml", "--out", "changed"]) == 0

    (repeated,) = commands(study)
    without_key = [re.sub(r"openai:[^,]*,", "", each) for each in repeated]
    without_key[without_key.index("10")] = "2"
    assert run_command_line(without_key) == 0
    assert "95 % interval" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("name", "hint"), [("a/b", "letters"), ("sally-anne", "built-in"), ("taken", "exists already")]
)
def test_a_new_scenario_overwrites_nothing(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    name: str,
    hint: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("taken.yaml").write_text("mine", encoding="utf-8")
    assert run_command_line(["new", name]) == 2
    assert hint in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["taken.yaml"]
    assert Path("taken.yaml").read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize("paper", ["tutorial.md", "models.md", "help-sally.md", "ice-cream-van.md"])
def test_links_lead_somewhere(paper: str) -> None:
    file = ROOT / "docs" / paper
    for target in re.findall(r"\]\(([^)#]+)\)", file.read_text(encoding="utf-8")):
        if "://" not in target:
            assert (file.parent / target).exists(), target
