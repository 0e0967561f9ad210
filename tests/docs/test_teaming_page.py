"""The page about a day with a team (teaming.md): its files play, and print what it shows."""

import ast
import re
import shlex
import sys
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
import yaml
from tests.profiles import NIGHTLY, at_night

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.env import parallel_env

pytestmark = pytest.mark.usefixtures("kept_worlds")

PAGE = (Path(__file__).parents[2] / "docs" / "days" / "teaming.md").read_text(encoding="utf-8")
CODE = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
TABLE, ENVIRONMENT = (block for block in CODE if not block.startswith("# "))
FILES = {
    block.splitlines()[0].removeprefix("# "): block
    for block in re.findall(r"```(?:python|yaml)\n(.*?)```", PAGE, re.DOTALL)
    if block.startswith("# ")
}
PLAYED, EXPLAINED, _, TRAINED = re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL)
COMMANDS = [shlex.split(line) for line in re.findall(r"^\$ beliefnest (.*)", PAGE, re.MULTILINE)]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name, text in FILES.items():
        Path(name).write_text(text, encoding="utf-8")
    return tmp_path


def command(*words: str) -> list[str]:
    (found,) = (each for each in COMMANDS if set(words) <= set(each))
    return found


def told(text: str) -> str:
    return " ".join(text.split())


def check_shown(block: str, out: str) -> None:
    """Check that the output has the lines of a block, in order; `...` stands for anything."""
    place = 0
    for line in block.splitlines():
        for part in filter(None, map(told, line.split("..."))):
            found = out.find(part, place)
            assert found >= 0, part
            place = found


def test_the_task_is_played_and_explained_as_the_page_shows(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command_line(command("--out", "run")) == 0
    check_shown(PLAYED, told(capsys.readouterr().out))
    assert run_command_line(command("ria=search:0", "gil=search:0")) == 1
    assert run_command_line(command("--explain")) == 1
    check_shown(EXPLAINED, told(capsys.readouterr().out))
    assert run_command_line(command("--png", "gil-ria.png")) == 0
    assert run_command_line(command("gil=team.py:Porter")) == 0
    assert "goal reached after 42 ticks" in capsys.readouterr().out
    assert run_command_line(command("gil=learned.py:Learned")) == 0


def test_the_environment_is_as_the_page_says(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    names: dict[str, Any] = {"__name__": "example"}
    exec(compile(ENVIRONMENT, "example", "exec"), names)
    said = re.findall(r"print\(.*\)  # (.*)", ENVIRONMENT)
    assert capsys.readouterr().out.splitlines() == said
    names["turns"].close()
    names["copies"].close()


def trainer(folder: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Return the names of train.py."""
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.delitem(sys.modules, "learned", raising=False)
    names: dict[str, Any] = {"__name__": "train"}
    exec(compile(FILES["train.py"], "train.py", "exec"), names)
    monkeypatch.delitem(sys.modules, "learned")
    return names


def learned_weights() -> tuple[float, ...]:
    (line,) = re.findall(r"^WEIGHTS = (.*)", FILES["learned.py"], re.MULTILINE)
    assert f"WEIGHTS = {line}" in TRAINED
    weights: tuple[float, ...] = ast.literal_eval(line)
    return weights


def test_the_weights_of_the_page_earn_what_it_says(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    there = trainer(folder, monkeypatch)
    with closing(parallel_env("vault.yaml", actions="programs")) as env:
        # The diamond of instance 1 is in the chest that is nearest to the door.
        earned = [there["play"](env, learned_weights(), seed)[0] for seed in (0, 1)]
        assert earned == [pytest.approx(4.9), pytest.approx(1.9)]
        assert there["play"](env, (0.0,) * 8, 0)[0] < 1
        assert len(there["train"](env, generations=1, drawn=3, kept=2)) == 8
    assert capsys.readouterr().out.startswith("0: mean ")


@pytest.mark.long
def test_the_training_prints_what_the_page_shows(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    there = trainer(folder, monkeypatch)
    # Each generation is drawn by the one before.
    generations = at_night(10, 2)
    with closing(parallel_env("vault.yaml", actions="programs")) as env:
        weights = there["train"](env, generations)
    printed = told(capsys.readouterr().out)
    if NIGHTLY:
        assert weights == learned_weights()
        check_shown(TRAINED.rpartition("WEIGHTS")[0], printed)
    else:
        assert printed == told("\n".join(TRAINED.splitlines()[:generations]))


@pytest.mark.extra("matplotlib")
@pytest.mark.long
def test_the_study_has_the_table_and_the_figure_of_the_page(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = yaml.safe_load(FILES["study.yaml"])
    Path("study.yaml").write_text(yaml.safe_dump({**study, "seeds": 3}), encoding="utf-8")
    assert run_command_line([*command("study.yaml"), "--jobs", "1"]) == 1
    capsys.readouterr()
    exec(compile(TABLE, "example", "exec"), {"__name__": "example"})
    assert "rules" in capsys.readouterr().out
    right = bn.StudyResult.read("vault-study").summary(by=["policy"]).set_index("policy")["right"]
    assert dict(right.drop("random")) == {
        "search:0": 0, "search:1": 3, "search:2": 3, "omniscient:search": 3, "rules": 3,
    }  # fmt: skip
    assert "<svg" in Path("vault-study.svg").read_text(encoding="utf-8")
