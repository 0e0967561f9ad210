"""Packages of others add worlds, tasks, policies, filters, suites and commands."""

import json
import os
import re
import tomllib
from importlib.metadata import entry_points
from pathlib import Path

import pytest
from tests.installing import install

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.errors import InputError, UnknownNameError
from beliefnest.importing import installed_names
from beliefnest.prompts import Renderer
from beliefnest.prompts.builtin import BUILT_IN
from beliefnest.prompts.filterset import installed_filters
from beliefnest.worlds.names import check_world

PAGE = (Path(__file__).parents[2] / "docs" / "plugins.md").read_text(encoding="utf-8")
STORY = """1 Sally entered the kitchen.
2 Anne entered the kitchen.
3 The apple is in the blue_box.
4 Sally exited the kitchen.
5 Anne moved the apple to the red_box.
6 Anne exited the kitchen."""


@pytest.fixture
def garden(tmp_path, monkeypatch):
    """Install the package of the page."""
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    (declared,) = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    (tmp_path / "garden.py").write_text(code, encoding="utf-8")
    groups = tomllib.loads(declared)["project"]["entry-points"]
    lines = (
        f"[{group}]\n" + "".join(f"{name} = {value}\n" for name, value in named.items())
        for group, named in groups.items()
    )
    install(tmp_path, "garden", "\n".join(lines))
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.chdir(tmp_path)


@pytest.mark.usefixtures("garden")
def test_a_package_adds_one_of_each(capsys):
    assert run_command_line(["list", "--json"]) == 0
    shown = json.loads(capsys.readouterr().out)
    added = (("worlds", "meadow"), ("tasks", "weeding"), ("suites", "riddles"))
    assert all(name in shown[kind] for kind, name in added)
    assert run_command_line(["water", "--times", "2"]) == 0
    assert capsys.readouterr().out == "drip drip \n"
    assert run_command_line(["--help"]) == 0
    assert re.search(r"Of other packages:\n +water +garden\n", capsys.readouterr().out)
    play = [
        "play",
        "weeding",
        "--world",
        "meadow",
        "--agent",
        "bob=wait",
        "--rounds",
        "1",
        "--json",
    ]
    assert run_command_line([*play, "--set", "weeds=3"]) == 1
    assert json.loads(capsys.readouterr().out)["success"] is False
    row = {"story": STORY, "question": "Where is the apple really?", "answer": "red_box"}
    Path("riddles.json").write_text(json.dumps([row]), encoding="utf-8")
    assert (
        run_command_line(["suite", "riddles", "--data", "riddles.json", "--world", "meadow"]) == 0
    )
    # A process looks for filters once, when it renders first.
    renderer = Renderer(installed_filters(BUILT_IN))
    scenario = bn.Scenario.load("sally-anne", condition=1)
    with bn.Nest.open(scenario, world="meadow", renderer=renderer) as nest:
        assert nest["/sally"].render("{{ branch | loud }}") == "SALLY"


def test_what_cannot_be_used_is_told(tmp_path, monkeypatch):
    site = tmp_path / "site"
    install(site, "one", "[beliefnest.worlds]\nmars = no_such_module:mars\n")
    monkeypatch.syspath_prepend(str(site))
    check = r"the world 'mars' of the installed package one \(no_such_module:mars\) cannot be imp"
    with pytest.raises(InputError, match=check):
        check_world("mars")
    with pytest.raises(UnknownNameError, match="there are embedded, scripted, mars, embedded://"):
        check_world("venus")
    install(site, "other", "[beliefnest.worlds]\nmars = json:loads\n")
    monkeypatch.syspath_prepend(str(site))
    with pytest.raises(InputError, match="several installed packages declare 'mars'"):
        check_world("mars")


def test_what_is_no_task_and_no_suite_is_refused_in_one_line(tmp_path, monkeypatch, capsys):
    declared = "[beliefnest.tasks]\nbare = bare\n[beliefnest.suites]\nlists = bare:read\n"
    install(tmp_path, "bare", declared)
    (tmp_path / "bare.py").write_text("def read(path, rows):\n    return []\n", encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.chdir(tmp_path)
    assert run_command_line(["play", "bare"]) == 2
    assert "the task 'bare' of the installed package bare (bare) has no" in " ".join(
        capsys.readouterr().err.split()
    )
    assert run_command_line(["suite", "lists", "--data", "bare.py"]) == 2
    assert "the suite lists read list, no ReadStories" in capsys.readouterr().err


def test_a_name_of_beliefnests_own_is_told_to_be_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    taken = {
        "tasks": "joint-lift",
        "policies": "search",
        "commands": "run",
        "suites": "food-trucks",
    }
    text = "".join(f"[beliefnest.{group}]\n{name} = other:thing\n" for group, name in taken.items())
    install(tmp_path, "the-other", f"{text}free = other:thing\n")
    monkeypatch.syspath_prepend(tmp_path)
    assert run_command_line(["list", "--json"]) == 0
    lines = json.loads(capsys.readouterr().out)["hidden"]
    assert [
        line.partition(" of the installed package the-other (other:thing)")[0] for line in lines
    ] == [
        "the command 'run'",
        "the policy 'search'",
        "the suite 'food-trucks'",
        "the task 'joint-lift'",
    ]
    assert all("is not used: BeliefNest has a " in line for line in lines)


def test_what_packages_declare_is_read_anew_only_when_one_is_installed(tmp_path, monkeypatch):
    read = []

    def counted(**chosen):
        read.append(chosen)
        return entry_points(**chosen)

    monkeypatch.setattr("beliefnest.importing.entry_points", counted)
    monkeypatch.syspath_prepend(str(tmp_path))
    for number, name in enumerate(("pond", "meadow"), start=1):
        install(tmp_path, name, f"[beliefnest.worlds]\n{name} = {name}:World\n")
        os.utime(tmp_path, (number, number))  # Installed in one tick of the clock, they differ.
        assert {name} < {*installed_names("beliefnest.worlds")}
        assert name not in installed_names("beliefnest.tasks")
        assert len(read) == number
