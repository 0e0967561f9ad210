"""Goals that are no common knowledge: what views tell of them, and how policies infer them."""

from pathlib import Path

import msgspec
import pytest
from tests.profiles import at_night

import beliefnest as bn
from beliefnest.episodes.policies.infer import goals_of_planner, posterior
from beliefnest.episodes.policies.model import ModelPolicy
from beliefnest.episodes.tasks import parameters_of
from beliefnest.llm.offline import OfflineModel

HIDDEN = [name for name in bn.Task.names() if not bn.Task.load(name).form.goals_known]
SEEDS = at_night(50, 2)

TASK = """\
name: bring
scenario:
  name: bring
  box: [[0, 0, 0], [12, 3, 12]]
  blocks: [{block: stone, fill: [[0, 0, 0], [12, 0, 12]]}]
  agents:
    ann: {position: [2.5, 1, 6.5]}
    bob: {position: [6.5, 1, 6.5]}
goal: {reach: [{agent: bob, at: [11, 1, 1]}]}
goals:
  ann: {helps: bob}
goals_known: false
possible_goals:
  bob:
    north: {reach: [{agent: bob, at: [11, 1, 1]}]}
    south: {reach: [{agent: bob, at: [11, 1, 11]}]}
"""


def with_goal(task: bn.Task, number: int) -> bn.Task:
    """Return a task in which the other agent has another one of its possible goals."""
    plain = task.plain()
    ((_, possible),) = plain["possible_goals"].items()
    return bn.Task.from_mapping({**plain, "goal": list(possible.values())[number]}, task.seed)


def played(task: bn.Task, policy: str) -> bool:
    with bn.Episode(task, dict.fromkeys(task.players, policy)) as episode:
        return episode.play().success


@pytest.mark.parametrize("seed", range(SEEDS))
@pytest.mark.parametrize("name", HIDDEN)
def test_who_infers_reaches_the_goal_as_who_knows_all_does(name: str, seed: int) -> None:
    task = bn.Task.load(name, seed=seed)
    assert played(task, f"infer:{task.order}")
    assert played(task, "omniscient:search")


@pytest.mark.parametrize("name", HIDDEN)
def test_who_does_not_infer_reaches_it_by_luck_alone(name: str) -> None:
    task = bn.Task.load(name, seed=0)
    seeds = range(at_night(50, 6))
    reached = [played(bn.Task.load(name, seed=seed), f"search:{task.order}") for seed in seeds]
    assert sum(reached) < 0.75 * len(reached)


@pytest.mark.parametrize("name", HIDDEN)
def test_a_task_of_another_size_can_be_inferred_too(name: str) -> None:
    # One size of each, the smallest other one, at night all of them.
    for key, (usual, low, high) in parameters_of(name).items():
        for value in sorted({low, high} - {usual})[: at_night(2, 1)]:
            task = bn.Task.load(name, seed=1, **{key: value})
            assert played(task, f"infer:{task.order}"), (key, value)


@pytest.mark.parametrize("policy", ["infer:1", "search:1", "infer:0", "random", "model:offline:1"])
def test_nothing_of_a_hidden_goal_shows_before_anybody_has_moved(policy: str) -> None:
    task = bn.Task.load("watch-and-help", seed=3)
    seen = []
    for number in (0, 1):
        with bn.Episode(with_goal(task, number), {"anne": policy, "bob": "random"}) as episode:
            view = episode.play(0).view("anne")
            prompt = ModelPolicy(OfflineModel(), 2).prompt(view)
            states = [view.state, view.about("bob"), view.about("bob", "anne")]
            told = (view.brief, view.goal, view.ticks_left, view.claims, prompt)
            first = episode._policies["anne"].act(view)
            seen.append((told, states, first, posterior(view, 1)))
    assert seen[0] == seen[1]
    assert set(seen[0][0][0].goals) == {"anne"}


def test_who_sees_all_is_told_all_goals() -> None:
    task = bn.Task.load("watch-and-help", seed=3)
    with bn.Episode(task, {"anne": "omniscient:search"}) as episode:
        brief = episode.play(0).view("anne").brief
    assert brief.goals == {"anne": task.goal, "bob": task.goal}
    assert not brief.possible_goals and not brief.hides_goals


def test_possible_goals_are_as_likely_until_the_other_moves(tmp_path: Path) -> None:
    file = tmp_path / "bring.yaml"
    file.write_text(TASK)
    task = bn.Task.load(str(file))
    with bn.Episode(task, {"ann": "infer:1", "bob": "search:0"}) as episode:
        before = posterior(episode.play(0).view("ann"), 1)
        assert before["bob"] == pytest.approx({"north": 0.5, "south": 0.5})
    with bn.Episode(task, {"ann": "infer:1", "bob": "search:0"}) as episode:
        episode.nest["/"].step(1)
        assert episode.play(1).success
        assert posterior(episode.view("ann"), 1)["bob"]["north"] > 0.95


def test_a_goal_that_the_planner_cannot_express_keeps_its_share(tmp_path: Path) -> None:
    file = tmp_path / "bring.yaml"
    belief = "    belief: {reach: [{path: /ann, agent: bob, at: [2, 1, 2]}]}\n"
    file.write_text(TASK + belief)
    task = bn.Task.load(str(file))
    with bn.Episode(task, {"ann": "infer:1", "bob": "search:0"}) as episode:
        episode.play(1)
        found = posterior(episode.view("ann"), 1)["bob"]
        state = episode.view("ann").about("bob")
        goals = task.possible_goals["bob"]
        assert goals_of_planner(goals["belief"], "bob", state) == []
        assert goals_of_planner(goals["north"], "bob", state) == [{"at": (11, 1, 1)}]
    assert found["belief"] == pytest.approx(1 / 3)
    assert found["north"] > 0.6


def test_where_goals_are_known_who_infers_does_as_who_searches() -> None:
    task = bn.Task.load("help-find", seed=2)
    programs = []
    for policy in ("infer:1", "search:1"):
        with bn.Episode(task, {"anne": policy}) as episode:
            assert episode.play().success
            programs.append([part.decisions["anne"].program for part in episode.parts])
    assert programs[0] == programs[1]


def test_who_has_what_it_wants_rests() -> None:
    content = {
        "name": "rest",
        "scenario": {
            "name": "rest",
            "box": [[0, 0, 0], [8, 3, 8]],
            "blocks": [{"block": "stone", "fill": [[0, 0, 0], [8, 0, 8]]}],
            "containers": [{"at": [1, 1, 1], "items": {"apple": 1}}],
            "agents": {"ann": {"position": [4.5, 1, 4.5]}, "bob": {"position": [6.5, 1, 6.5]}},
            "initial_beliefs": [
                {"path": "/**", "containers": [{"at": [1, 1, 1], "items": {"apple": 1}}]}
            ],
        },
        "goal": {"reach": [{"agent": "bob", "at": [1, 1, 6]}]},
        "goals": {"ann": {"reach": [{"container": [1, 1, 1], "items": {"apple": 1}}]}},
    }
    # A planner used to take the apple out, so as to put it in.
    with bn.Episode(bn.Task.from_mapping(content), {"ann": "search:0"}) as episode:
        episode.play(1)
        assert episode.parts[0].decisions["ann"].program == ""


def test_an_episode_of_who_infers_goes_on_and_replays(tmp_path: Path) -> None:
    task, store = bn.Task.load("watch-and-help", seed=3), tmp_path / "e.bn"
    with bn.Episode(task, {"anne": "infer:1"}) as whole:
        whole.play()
    with bn.Episode(task, {"anne": "infer:1"}, store=store) as episode:
        episode.play(2)
    with bn.Episode.resume(store) as episode:
        episode.play()
        assert msgspec.to_builtins(episode.parts) == msgspec.to_builtins(whole.parts)
    with bn.Episode.replay(store) as again:
        assert again.play().ticks == whole.ticks


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("goals_known: false", "goals_known: true", "bring.yaml:13: .*set `goals_known: false`"),
        (
            "possible_goals:\n",
            "possible_goals:\n  zoe: {x: {}}\n",
            "bring.yaml:14: .*'zoe' is none",
        ),
        ("helps: bob", "helps: zoe", "bring.yaml:11: .*'zoe' is none"),
        ("helps: bob", "helps: ann", "bring.yaml:11: .*'ann' has no goal of its own"),
        ("{helps: bob}", "{helps: bob, ticks: 3}", "bring.yaml:11: .*beside other keys"),
        (
            "north: {reach: [{agent: bob, at: [11",
            "north: {reach: [{agent: bob, at: [9",
            "14: .*lacks",
        ),
        ("at: [11, 1, 11]", "at: [11, 9, 11]", "bring.yaml:16: .*outside"),
        ("{reach: [{agent: bob, at: [11, 1, 11]}]}", "{helps: ann}", "bring.yaml:14: .*helps"),
        ("goal: {reach: [{agent: bob, at: [11, 1, 1]}]}", "goal: {helps: bob}", "9: .*`reach`"),
        ("south: {reach: [{agent: bob", "south: {raech: [{agent: bob", "bring.yaml:16: .*raech"),
    ],
)
def test_what_is_wrong_with_possible_goals_is_told_by_line(
    tmp_path: Path, old: str, new: str, told: str
) -> None:
    file = tmp_path / "bring.yaml"
    assert old in TASK
    file.write_text(TASK.replace(old, new))
    with pytest.raises(bn.ScenarioError, match=told):
        bn.Task.load(str(file))
