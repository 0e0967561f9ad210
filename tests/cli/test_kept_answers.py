"""Kept answers stand in for a model: without its key, its address, and all else of a run."""

import json
import shutil
from pathlib import Path
from typing import Any

import pytest
from tests.llm.conftest import FakeOpenAI, serving
from tests.studies.small import study_in

from beliefnest.cli.app import run_command_line

pytestmark = pytest.mark.usefixtures("kept_worlds")

GOOD = "```javascript\nawait getItemFromChest(bot, new Vec3(1, 1, 1), {diamond: 1});\n```"
STUDY = "scenarios: [small.yaml]\nmodels: ['compatible:m']\nworld: scripted\n"


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Make a folder with a study of a model that can no longer be asked."""
    monkeypatch.chdir(tmp_path)
    with serving() as served, pytest.MonkeyPatch.context() as there:
        served.will(FakeOpenAI.says(GOOD))
        there.setenv("COMPATIBLE_BASE_URL", served.url)
        assert study("done", "--record") == 0
    return tmp_path / "done"


def study(out: str, *more: str) -> int:
    file = study_in(Path(), STUDY)
    return run_command_line(["study", str(file), "--out", out, "--jobs", "1", *more])


def rows(out: str) -> list[dict[str, Any]]:
    cells = sorted(Path(out, "cells").glob("*.json"))
    return [json.loads(cell.read_text()) for cell in cells]


@pytest.fixture
def only_answers(kept: Path) -> Path:
    """Copy the kept answers alone to the folder where a run or a study begins."""
    begun = kept.with_name("begun")
    shutil.copytree(kept / "answers", begun / "answers")
    shutil.rmtree(kept)
    return begun


def test_a_study_is_played_from_kept_answers_alone(only_answers: Path) -> None:
    assert study("begun") == 0
    assert [row["error"] for row in rows("begun")] == [None]


def test_a_run_is_played_from_kept_answers_alone(only_answers: Path) -> None:
    file = next(iter(only_answers.parent.glob("small.yaml")))
    key = json.loads(next((only_answers / "answers").iterdir()).read_text())["sampling"]["seed"]
    run = ["run", str(file), "--model", "compatible:m", "--world", "scripted", "--seed", str(key)]
    assert run_command_line([*run, "--out", str(only_answers)]) == 0
    report = json.loads((only_answers / "run.json").read_text())
    assert report["status"] == "done"
    assert run_command_line([*run, "--out", "other", "--answers", "begun/answers"]) == 0


def test_what_is_not_kept_needs_the_model(
    only_answers: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = ["run", "sally-anne", "--condition", "1", "--model", "compatible:m"]
    run += ["--world", "scripted", "--out"]
    assert run_command_line([*run, "begun"]) == 3
    told = capsys.readouterr().err
    assert "the cache has no answer of compatible:m to this prompt" in told
    assert "set COMPATIBLE_BASE_URL" in told
    assert run_command_line([*run, "new"]) == 3
    assert "kept" not in capsys.readouterr().err
    assert not Path("new").exists()
    assert run_command_line([*run, "fresh", "--answers", "begun/answers", "--cache", "off"]) == 3
    assert not Path("fresh").exists()


def test_the_recorded_runs_of_a_study_are_replayed(
    kept: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    capsys.readouterr()
    assert run_command_line(["replay", "done", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["same"]
    assert {row["store"] for row in told["timelines"]} == {
        str(store.relative_to(kept.parent)) for store in (kept / "runs").glob("*.bn")
    }


def test_a_study_without_recorded_runs_says_what_to_do(
    kept: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.rmtree(kept / "runs")
    capsys.readouterr()
    assert run_command_line(["replay", "done"]) == 2
    told = capsys.readouterr().err
    assert "holds a study whose runs were not recorded" in told
    assert "--record" in told
    assert str(Path("done", "answers")) in told
    # The advice of the message works.
    shutil.copytree(kept / "answers", "again/answers")
    assert study("again", "--record") == 0
    assert run_command_line(["replay", "again"]) == 0


def test_run_and_study_keep_the_versions_of_all_that_matters(kept: Path) -> None:
    run = ["run", "sally-anne", "--condition", "3", "--out"]
    assert run_command_line([*run, "embedded"]) == 0
    versions = json.loads(Path("embedded/run.json").read_text())["versions"]
    own = {"beliefnest", "python", "platform", "numba", "numpy"}
    assert own | {"node", "minecraft", "mineflayer"} <= versions.keys()
    assert own <= json.loads((kept / "study.json").read_text())["versions"].keys()
