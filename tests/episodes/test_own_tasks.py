"""Tasks and policies of one's own: instances by rules, exports, and classes named in texts."""

from pathlib import Path

import msgspec
import pytest

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.episodes.policies import resolve_policy

HUNT = """
name: hunt
box: [[0, 0, 0], [12, 3, 8]]
parameters:
  box: {default: [2, 1, 2]}
  lure: {default: [9, 1, 2]}
  start: {default: [3, 1, 6]}
  what: {default: diamond, values: [diamond, emerald, apple]}
  other: {default: apple, values: [diamond, emerald, apple]}
instances:
  box: {within: [[1, 1, 1], [11, 1, 7]], apart: 3, hidden_from: [bob], reached_by: [bob]}
  lure: {within: [[1, 1, 1], [11, 1, 7]], apart: 3, seen_by: [bob]}
  start: {within: [[1, 1, 1], [5, 1, 7]]}
  what:
  other: {differs_from: [what]}
blocks:
  - {block: stone, fill: [[0, 0, 0], [12, 0, 8]]}
  - {block: bricks, fill: [[6, 1, 0], [6, 3, 5]]}
containers:
  - {label: chest, at: "${box}", items: {"${what}": 1}}
  - {label: barrel, at: "${lure}", block: barrel, items: {"${other}": 1}}
agents:
  ann: {position: ["${start[0] + 0.5}", 1, "${start[2] + 0.5}"], facing: east}
  bob: {position: [9.5, 1, 3.5], facing: south}
static_blocks: [stone, bricks]
episode:
  goal: {reach: [{agent: bob, items: {"${what}": 1}}]}
  policies: {ann: "random"}
  rounds: 8
conditions:
  1: {}
  2: {agents: {bob: {position: [9.5, 1, 6.5]}}}
"""

OWN = """
from dataclasses import dataclass, field


@dataclass
class Greeter:
    word: str = "hello"
    seen: list[int] = field(default_factory=list)

    def act(self, view):
        self.seen.append(view.round)
        return f"await say(bot, '{self.word}')"


def shouter():
    return Greeter("HELLO")


class Mute:
    pass


class Needy:
    def __init__(self, word):
        self.word = word
"""


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("own.py").write_text(OWN, encoding="utf-8")
    Path("hunt.yaml").write_text(HUNT, encoding="utf-8")
    return tmp_path


def test_instances_keep_the_rules_of_places(own: Path) -> None:
    found = []
    for seed in range(12):
        scene = bn.Task.load("hunt.yaml", seed).scenario.setting.snapshot
        (box, held), (lure, lured) = scene.containers.items()
        found.append((box, lure, scene.agents["ann"].position, *held, *lured))
        assert abs(box[0] - lure[0]) + abs(box[2] - lure[2]) >= 3
        assert 6 not in (box[0], lure[0]) or max(box[2], lure[2]) > 5  # not in the wall
        assert held != lured
        # Bob stands east of the wall, whose gap is in the south: what he sees is no secret.
        assert lure[0] > 6 or lure[2] > 5
        with bn.Nest.open(bn.Task.load("hunt.yaml", seed).scenario, world="scripted") as nest:
            assert box not in nest["/bob"].state.containers
            assert lure in nest["/bob"].state.containers
    assert len(set(found)) == 12
    assert bn.Task.load("hunt.yaml", 3).plain() == bn.Task.load("hunt.yaml", 3).plain()


def test_an_instance_is_the_same_under_all_conditions_and_given_values_stay(own: Path) -> None:
    first, second = (
        bn.Task.load("hunt.yaml", 5, condition=number).form.scenario for number in (1, 2)
    )
    assert first["containers"] == second["containers"]
    assert first["agents"]["ann"] == second["agents"]["ann"]
    assert first["agents"]["bob"] != second["agents"]["bob"]
    given = bn.Task.load("hunt.yaml", 5, box=[1, 1, 1]).form.scenario
    assert given["containers"][0]["at"] == [1, 1, 1]
    # A given value may be the default of a parameter that is drawn.
    on_default = bn.Task.load("hunt.yaml", 5, box=[9, 1, 2]).form.scenario["containers"]
    assert on_default[0]["at"] == [9, 1, 2] != on_default[1]["at"]
    with pytest.raises(bn.ScenarioError, match="no parameter 'bax'; did you mean 'box'"):
        bn.Task.load("hunt.yaml", 5, bax=[1, 1, 1])


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("  what:\n", "  whom:\n", "hunt.yaml:14: instances.whom: is no parameter; declared are"),
        ("apart: 3, hidden", "far: 3, hidden", "instances.box.far: unknown key; keys are apart"),
        ("hidden_from: [bob]", "hidden_from: [eve]", "there is no agent 'eve'; agents are ann, "),
        ("apart: 3, hidden", "apart: 30, hidden", "none of 2000 draws keeps the rules; most often"),
        ("  what:\n", "  what: {seen_by: [bob]}\n", "is a rule for places; give `within`, too"),
        ("  2: {", "  2: {instances: {box: {}}, ", "stands under a condition; put it at the top"),
        ("  2: {", "  2: {agnts: {}, ", "agnts: unknown key; did you mean 'agents'?"),
        ("bob, items", "eve, items", "'eve'"),
    ],
)
def test_wrong_rules_are_refused(own: Path, old: str, new: str, told: str) -> None:
    assert old in HUNT
    Path("hunt.yaml").write_text(HUNT.replace(old, new), encoding="utf-8")
    with pytest.raises(bn.BeliefNestError, match=r"hunt\.yaml:\d+: ") as caught:
        bn.Task.load("hunt.yaml", 1, condition=2)
    assert told in str(caught.value)
    # Mistakes of the file are told as such, and not as what most draws break.
    assert ("draws" in str(caught.value)) is ("draws" in told)


def test_seeds_of_a_study_are_instances_of_a_file(own: Path) -> None:
    study = bn.Study(tasks="hunt.yaml", policies=["own.py:Greeter"], seeds=3, conditions=[1])
    frame = study.run("out", jobs=1).frame()
    assert list(frame["instance"]) == [0, 1, 2]
    assert frame["copy_of"].isna().all()
    assert set(frame["policy"]) == {"own.py:Greeter"}


def test_exported_tasks_play_as_the_built_in_ones(own: Path) -> None:
    for name in bn.Task.names():
        task = bn.Task.load(name, seed=4)
        Path(f"{name}.yaml").write_text(task.text(), encoding="utf-8")
        read = bn.Task.load(f"{name}.yaml")
        written = task.plain()
        written["scenario"]["description"] = written["description"]
        assert read.plain() == msgspec.to_builtins(written)


def test_play_exports_once(own: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = ["play", "help-find", "--seed", "2", "--set", "chests=3", "--export", "help.yaml"]
    assert run_command_line(command) == 0
    assert run_command_line(["play", "help.yaml", "--agent", "anne=search:1"]) == 0
    assert run_command_line(command) == 2
    assert "help.yaml exists already; choose another name" in capsys.readouterr().err


def test_classes_and_functions_play_by_their_names(
    own: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(own))
    policies = {"bob": "own:Greeter", "ann": "own.py:shouter"}
    with bn.Episode(bn.Task.load("hunt.yaml", 1), policies, store="e.bn") as episode:
        episode.play(2)
        said = [(speaker, text) for _, speaker, text in episode.nest["/"].state.chat]
    assert sorted(said) == [("ann", "HELLO")] * 2 + [("bob", "hello")] * 2
    with bn.Episode.resume("e.bn") as episode:
        assert episode.play(1).rounds == 3


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("own.py:Absent", "no policy 'Absent'; it defines Greeter, shouter, Mute, Needy"),
        ("own.py:Greter", "own.py has no policy 'Greter'; did you mean 'Greeter'?"),
        ("needs.py:Greeter", "'other_file' (to import modules beside it, put its folder into"),
        ("serch:1", "there is no policy 'serch:1'; did you mean search:1?"),
        ("absent.py:Greeter", "there is no file absent.py"),
        ("absent_module:Greeter", "there is no module 'absent_module' for a policy; put its"),
        ("own.py:Mute", "Mute has no method act"),
        ("own.py:Needy", "cannot be called without arguments"),
        ("broken.py:Greeter", "cannot be imported: SyntaxError"),
        ("omniscient:Greeter", "there is no policy 'omniscient:Greeter'; write omniscient:search"),
        ("search", "there is no policy 'search'; write search:ORDER"),
        ("program", "there is no policy 'program'; write program:FILE"),
    ],
)
def test_what_is_no_policy_is_refused(own: Path, name: str, told: str) -> None:
    Path("broken.py").write_text("class Greeter(", encoding="utf-8")
    Path("needs.py").write_text("import other_file", encoding="utf-8")
    with pytest.raises(bn.BeliefNestError) as caught:
        resolve_policy(name)
    assert told in str(caught.value)


def test_an_agent_that_is_no_player_gets_its_policy_from_the_file_or_the_caller(
    own: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = HUNT.replace('policies: {ann: "random"}', "players: [bob]")
    Path("half.yaml").write_text(text, encoding="utf-8")
    command = ["play", "half.yaml", "--rounds", "1", "--agent"]
    assert run_command_line([*command, "bob=random"]) == 2
    assert "ann is no player and has no policy" in capsys.readouterr().err
    assert run_command_line([*command, "ann=random"]) in (0, 1)
    study = bn.Study(tasks=["half.yaml"], policies=["random", {"ann": "random", "bob": "random"}])
    assert {each.why for each in study.plan().invalid} == {
        "ann is no player and has no policy; give it one in the file, under `policies`, or with "
        "--agent ann=POLICY"
    }
    assert {cell.plain()["key"]["player"] for cell in study.plan().cells} == {
        "ann=random,bob=random"
    }
    both = text.replace("players: [bob]", "players: [bob]\n  policies: {bob: random}")
    Path("both.yaml").write_text(both, encoding="utf-8")
    with pytest.raises(bn.ScenarioError, match="bob is one of `players` and has a policy"):
        bn.Task.load("both.yaml")
