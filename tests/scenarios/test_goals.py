"""Goals in scenario files: on reality and beliefs, with the tick at which they came true."""

from pathlib import Path
from typing import Any

import pytest

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.episodes.policies import Scripted
from beliefnest.scenarios.sources import read_document
from beliefnest.studies.variation import Variation

FETCH = """\
name: fetch
description: Ann brings the apple, and tells Eve where it is.
box: [[0, 0, 0], [12, 3, 6]]
blocks: [{block: stone, fill: [[0, 0, 0], [12, 0, 6]]}]
static_blocks: [stone]
parameters: {spot: {default: [11, 1, 5]}}
perception: {testimony: accept}
containers: [{at: [1, 1, 1], items: {apple: 1}}, {at: "${spot}"}]
agents:
  ann: {position: [4.5, 1, 3.5], facing: north}
  eve: {position: [6.5, 1, 5.5], facing: north}
probes:
  - {path: /ann, acts_in: /, agent: ann, task: Get an apple., expect: {opens: [1, 1, 1]}}
episode:
  goal:
    reach:
      - {container: "${spot}", items: {apple: 1}}
      - {path: /eve, container: "${spot}", items: {apple: 1}}
      - {path: /ann/eve, agent: ann, at: "${spot}", within: 4}
    never: [{agent: eve, items: {apple: 1}}]
  goals: {eve: {}}
  policies: {eve: "search:0"}
  talk: [ann]
  rounds: 8
  round_ticks: 10
conditions:
  1: {}
  2: {description: No time., episode: {rounds: 1, round_ticks: 5}}
"""
BRING = """\
await getItemFromChest(bot, new Vec3(1, 1, 1), {apple: 1})
await depositItemIntoChest(bot, new Vec3(11, 1, 5), {apple: 1})
await say(bot, 'There.', [located('apple', new Vec3(11, 1, 5))])
"""


@pytest.fixture
def fetch(tmp_path: Path) -> str:
    file = tmp_path / "fetch.yaml"
    file.write_text(FETCH)
    return str(file)


def test_goals_of_a_scenario_are_checked_at_every_tick(fetch: str) -> None:
    bring = Scripted([BRING, BRING, BRING])
    with bn.Episode(bn.Scenario.load(fetch, condition=1), {"ann": bring}) as episode:
        assert episode.task.players == ("ann",)
        assert episode.play().success
        apple, told, seen, stolen = (tick for _, tick in episode.conditions)
        nest = episode.nest
        assert apple is not None and told is not None and seen is not None and stolen is None
        assert nest.at(apple)["/"].state.containers[(11, 1, 5)].items == {"apple": 1}
        assert nest.at(apple - 1)["/"].state.containers[(11, 1, 5)].items == {}
        before = nest.at(told - 1)["/eve"].state.containers[(11, 1, 5)].items
        after = nest.at(told)["/eve"].state.containers[(11, 1, 5)].items
        assert (before, after) == ({}, {"apple": 1})
        assert episode.ticks == max(apple, told, seen) - episode.start
    with bn.Episode(bn.Task.load(fetch, condition=2), {"ann": bring}) as hurried:
        assert hurried.play().rounds == 1
        assert not hurried.success


def test_a_goal_is_to_be_reached_within_its_ticks(fetch: str) -> None:
    def goal(ticks: int) -> dict[str, object]:
        return {"reach": [{"container": [11, 1, 5], "items": {"apple": 1}}], "ticks": ticks}

    scenario = bn.Scenario.load(fetch, condition=1)
    with bn.Episode(bn.Task.of(scenario, goal=goal(60)), {"ann": Scripted([BRING])}) as episode:
        taken = episode.play().ticks
        assert episode.success
    for ticks, success in ((taken, True), (taken - 1, False)):
        task = bn.Task.of(scenario, goal=goal(ticks))
        with bn.Episode(task, {"ann": Scripted([BRING])}) as episode:
            assert episode.view("ann").ticks_left == ticks
            assert episode.play().success is success
            assert str(task.goal).endswith(f"within {ticks} ticks")
    assert task.at_pace(5).goal.ticks == 5 * (taken - 1)
    with pytest.raises(bn.ScenarioError, match="nothing to `reach`"):
        bn.Task.of(scenario, goal={"ticks": 3})


def test_goals_go_where_the_scene_goes(fetch: str) -> None:
    mirrored = Variation({"symmetry": "mirrored", "agents": {"ann": "zoe"}})
    scenario = bn.Scenario.varied(read_document(fetch), 1, None, mirrored.scene)
    task = bn.Task.of(scenario)
    assert task.players == ("zoe",)
    assert str(task.goal.reach[0]) == "1 apple in the container at (1, 1, 5)"
    assert str(task.goal.reach[2]) == "/zoe/eve: zoe within 4 of (1, 1, 5)"
    moved = bn.Task.load(fetch, spot=[9, 1, 1])
    assert str(moved.goal.reach[0]) == "1 apple in the container at (9, 1, 1)"


def test_any_scenario_can_be_played_with_rules_of_its_player() -> None:
    scenario = bn.Scenario.load("sally-anne", condition=1)
    goal = {"reach": [{"agent": "sally", "items": {"diamond": 1}}]}
    task = bn.Task.of(
        scenario, goal=goal, rounds=4, policies={"anne": "random", "observer": "random"}
    )
    with bn.Episode(task, {"sally": "search:0"}) as episode:
        assert episode.start > 0, "the script comes first"
        assert episode.play().success
    with pytest.raises(bn.ScenarioError, match="task sally-anne: there is no goal"):
        bn.Task.of(scenario)


def test_planners_empty_a_container(tmp_path: Path) -> None:
    file = tmp_path / "fetch.yaml"
    file.write_text(FETCH.replace("accept}", "accept, containers: transparent}"))
    goal = {
        "reach": [{"container": [1, 1, 1], "items": {}}, {"agent": "eve", "items": {}}],
        "never": [{"path": "/ann", "container": [1, 1, 1], "items": {"apple": 2}}],
    }
    task = bn.Task.of(bn.Scenario.load(str(file), condition=1), goal=goal)
    assert [str(each) for each in task.goal.reach] == [
        "nothing in the container at (1, 1, 1)",
        "eve has nothing",
    ]
    with bn.Episode(task, {"ann": "search:0"}) as episode:
        assert episode.play().success
        assert episode.nest["/ann"].state.agents["ann"].inventory == {"apple": 1}


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("path: /eve,", "path: /bob,", "fetch.yaml:18: episode.goal.reach.1..path: .*bob"),
        ("talk: [ann]", "talk: [bob]", "fetch.yaml:14: episode: 'bob' is none of the agents"),
        (
            "rounds: 8",
            "rounds: none",
            "fetch.yaml:24: episode.rounds: expected an integer, got",
        ),
        ("rounds: 8", "round: 8", "fetch.yaml:24: .*did you mean 'rounds'"),
        ("agent: eve, items: {apple: 1}", "block: [1, 1, 1], state: chst", "fetch.yaml:20: .*chst"),
        (
            "eve, items: {apple: 1}",
            "eve, items: {appel: 1}",
            "fetch.yaml:20: .*never.0..items.appel: no item",
        ),
        (
            "eve, items: {apple: 1}",
            "eve, items: {apple: 0}",
            "fetch.yaml:20: .*the count is 0; it must be at least 1",
        ),
        ("agent: eve, items", "container: [2, 1, 2], items", "fetch.yaml:20: .*no container"),
        ("agent: eve, items: {apple: 1}", "agent: eve, at: [2, 9, 2]", "fetch.yaml:20: .*outside"),
        ("agent: eve, items: {apple: 1}", "agent: eve, position: [2, 1, 2]", ":20: .*write 'at'"),
        ("{path: /eve,", "{believed: /eve,", ":18: .*unknown key; write 'path'"),
        (
            "eve, items: {apple: 1}",
            "eve, items: apple",
            r":20: .*a mapping such as {diamond: 1}, got",
        ),
        (
            "agent: eve, items",
            "container: eve, items",
            r":20: .*a list such as \[1, 2, 3\], got 'eve'",
        ),
        (
            "agent: eve, items",
            "container: [2, 1], items",
            r":20: .*such as \[1, 2, 3\], got \[2, 1\]",
        ),
        ("never: [{agent: eve, items: {apple: 1}}]", "never: eve", ":20: .*a list such as"),
    ],
)
def test_what_is_wrong_with_goals_is_told_by_line(
    tmp_path: Path, old: str, new: str, told: str
) -> None:
    file = tmp_path / "fetch.yaml"
    assert old in FETCH
    file.write_text(FETCH.replace(old, new))
    with pytest.raises(bn.ScenarioError, match=told):
        bn.Scenario.load(str(file))


@pytest.mark.parametrize(
    ("rules", "told"),
    [
        ({"goal": {"reach": [{"agent": "eve", "at": [2, 1, 2], "withn": 3}]}}, "'within'"),
        ({"goals": {"eve": {"reech": []}}}, r"episode.goals.eve.reech: .*did you mean 'reach'"),
        ({"goal": {"reach": {"agent": "eve"}}}, "a list such as"),
        ({"gaol": {}}, "did you mean 'goal'"),
    ],
)
def test_what_is_wrong_with_rules_in_python_is_told_by_key(
    fetch: str, rules: dict[str, Any], told: str
) -> None:
    with pytest.raises(bn.ScenarioError, match=told):
        bn.Task.of(bn.Scenario.load(fetch, condition=1), **rules)


def test_the_command_plays_scenarios(
    fetch: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "bring.js").write_text(BRING)
    policy = f"ann=program:{tmp_path / 'bring.js'}"
    assert run_command_line(["play", fetch, "--agent", policy, "--condition", "1"]) == 0
    assert "/eve: 1 apple in the container at (11, 1, 5): at tick" in capsys.readouterr().out
    assert run_command_line(["play", fetch, "--agent", policy, "--condition", "2"]) == 1
    assert "not to be: eve has 1 apple: at no tick" in capsys.readouterr().out
    assert run_command_line(["play", fetch, "--set", "spot=[9, 1, 1]", "--rounds", "0"]) == 1
    assert "container at (9, 1, 1): at no tick" in capsys.readouterr().out
    assert run_command_line(["play", "help-find", "--condition", "2"]) == 2
