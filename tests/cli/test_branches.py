"""The tree of a run's timelines on the command line."""

import json
from pathlib import Path

import pytest

import beliefnest as bn
from beliefnest.cli.app import run_command_line


@pytest.fixture
def store(tmp_path: Path) -> Path:
    world = bn.ScriptedWorld(((0, 0, 0), (4, 3, 4)), agents={"sally": (1.5, 1, 1.5)})
    path = tmp_path / "run.bn"
    nest = bn.Nest(world, store=path)
    world.step(10)
    sally = nest["/sally"]
    sally.switch("walk")
    sally.step(5)
    sally.switch("again", at=12)
    sally.describe("again", "from the [middle]")
    nest.close()
    return path


def test_each_timeline_hangs_below_its_base(
    store: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command_line(["branches", str(store)]) == 0
    _, main, walk, again = capsys.readouterr().out.splitlines()
    assert main.endswith("/  main  ticks 0 to 10  (selected)")
    assert walk.endswith("/sally  walk  ticks 10 to 15")
    assert again.endswith("/sally  again  ticks 12 to 12  (selected)  from the [middle]")
    assert main.index("/") < walk.index("/") < again.index("/")


def test_json_names_bases_and_ticks(store: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command_line(["branches", str(store), "--json"]) == 0
    (run,) = json.loads(capsys.readouterr().out)
    main, walk, again = run["timelines"]
    assert main["base"] is None
    assert walk["base"] == {"path": "/", "branch": "main", "tick": 10}
    assert again["base"] == {"path": "/sally", "branch": "walk", "tick": 12}
    assert [t["head"] for t in run["timelines"]] == [10, 15, 12]


def test_a_run_that_is_not_there_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command_line(["branches", "nowhere"]) == 2
    assert "nowhere" in capsys.readouterr().err
