"""Goals that are no common knowledge: what views tell of them, and how policies infer them."""

from pathlib import Path

import msgspec
import pytest
import yaml
from tests.profiles import at_night, few_by_day

import beliefnest as bn
from beliefnest.episodes.policies.course_planner import USUAL
from beliefnest.episodes.policies.infer import goals_of_planner, likelihoods_of_traces, posterior
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


CELLAR = """\
name: cellar
scenario:
  name: cellar
  box: [[0, 0, 0], [16, 3, 8]]
  blocks:
    - {block: stone, fill: [[0, 0, 0], [16, 0, 8]]}
    - {block: stone, fill: [[0, 1, 4], [16, 3, 4]]}
    - {block: "oak_door[facing=north,half=lower,open=false]", at: [3, 1, 4]}
    - {block: "oak_door[facing=north,half=upper,open=false]", at: [3, 2, 4]}
  static_blocks: [stone]
  containers: [{at: [1, 1, 1], items: {apple: 1}}]
  agents:
    ann: {position: [4.5, 1, 6.5]}
    dan: {position: [2.5, 1, 6.5]}
  perception: {max_visible_distance: 6}
  initial_beliefs: [{path: /**, containers: [{at: [1, 1, 1], items: {apple: 1}}]}]
  script:
    - {agent: dan, program: "await goToPosition(bot, new Vec3(15, 1, 7), 0)"}
    - {agent: ann, program: "await goToPosition(bot, new Vec3(3, 1, 1), 0)"}
    - {agent: dan, program: "await goToPosition(bot, new Vec3(6, 1, 6), 0)"}
goal: {reach: [{agent: dan, at: [15, 1, 6]}]}
goals: {ann: {reach: [{agent: ann, at: [3, 1, 1]}]}}
goals_known: false
possible_goals:
  ann:
    down: {reach: [{agent: ann, at: [3, 1, 1]}]}
    out: {reach: [{agent: ann, at: [4, 1, 6]}]}
"""
"""Ann goes through a door while Dan is too far away to see it, and Dan comes back."""


def with_goal(task: bn.Task, number: int) -> bn.Task:
    """Return a task in which the other agent has another one of its possible goals."""
    plain = task.plain()
    ((_, possible),) = plain["possible_goals"].items()
    return bn.Task.from_mapping({**plain, "goal": list(possible.values())[number]}, task.seed)


def played(task: bn.Task, policy: str) -> bool:
    with bn.Episode(task, dict.fromkeys(task.players, policy)) as episode:
        return episode.play().success


@pytest.mark.parametrize("seed", few_by_day(range(SEEDS)))
@pytest.mark.parametrize("name", HIDDEN)
def test_who_infers_reaches_the_goal_as_who_knows_all_does(name: str, seed: int) -> None:
    task = bn.Task.load(name, seed=seed)
    assert played(task, f"infer:{task.order}")
    assert played(task, "omniscient:search")


@pytest.mark.long
@pytest.mark.parametrize("name", HIDDEN)
def test_who_does_not_infer_reaches_it_by_luck_alone(name: str) -> None:
    task = bn.Task.load(name, seed=0)
    seeds = range(at_night(50, 4))
    reached = [played(bn.Task.load(name, seed=seed), f"search:{task.order}") for seed in seeds]
    assert sum(reached) < 0.75 * len(reached)


@pytest.mark.long
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


class Chatty:
    """Policy that says something in each round."""

    def act(self, view: bn.AgentView) -> str:
        """Return the program."""
        return f"await say(bot, 'round {view.round}')"


def test_who_is_no_player_uses_up_no_message(tmp_path: Path) -> None:
    file = tmp_path / "bring.yaml"
    file.write_text(f"{TASK.replace(']}]}', ']}], messages: 0}')}players: [ann]\n")
    policies = {"ann": "search:0", "bob": Chatty()}
    with bn.Episode(bn.Task.load(str(file)), policies) as episode:
        courses = episode.play(2).search_trace("ann", 1).courses
    assert courses[0].score[0] < 2  # not violated


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
        assert goals_of_planner(goals["belief"], "bob", state, state) == []
        assert goals_of_planner(goals["north"], "bob", state, state) == [{"at": (11, 1, 1)}]
    assert found["belief"] == pytest.approx(1 / 3)
    assert found["north"] > 0.6


WENT, CAME_BACK = "new Vec3(3, 1, 1), 0)", "new Vec3(6, 1, 6), 0)"
LEFT = "goToPosition(bot, new Vec3(15, 1, 7), 0)"


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, [1, 1 / 9]),
        ({WENT: "new Vec3(6, 1, 7), 0)"}, [1, 1]),
        ({CAME_BACK: "new Vec3(14, 1, 6), 0)"}, [1, 1]),
        ({LEFT: "openDoor(bot, new Vec3(3, 1, 4))"}, [1, 1]),
        ({LEFT: "waitTicks(bot, 1)"}, [1, 1]),
    ],
    ids=["a trace", "nothing changed", "not found", "its own deed", "seen to be done"],
)
@pytest.mark.parametrize("order", [0, 1])
def test_a_door_opened_unseen_tells_who_went_through(
    changes: dict[str, str], expected: list[float], order: int
) -> None:
    text = CELLAR
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    with bn.Episode(bn.Task.from_mapping(yaml.safe_load(text)), {"dan": "infer:1"}) as episode:
        view, supposed = episode.play(0).view("dan"), [{"ann": "down"}, {"ann": "out"}]
        found = likelihoods_of_traces(view, view.imagine(order, 0), order, USUAL, supposed)
    # Found is what a goal leads to with probability 0.9; of likelihoods only the ratio counts.
    assert [each / max(found) for each in found] == pytest.approx(expected)


def test_a_taker_may_be_seen_elsewhere_later() -> None:
    content = yaml.safe_load(CELLAR)
    chest, far = "new Vec3(1, 1, 1)", "await goToPosition(bot, new Vec3({}, 1, 1), 0)"
    script = content["scenario"]["script"]
    script[1]["program"] = f"await getItemFromChest(bot, {chest}, {{apple: 1}})\n{far.format(15)}"
    look = f"await goToPosition(bot, {chest}, 2)\nawait bot.openContainer(bot.blockAt({chest}))"
    script[2]["program"] = f"{look}\n{far.format(11)}"
    wanted = {"reach": [{"agent": "ann", "items": {"apple": 1}}]}
    content["goals"] = {"ann": wanted}
    content["possible_goals"]["ann"]["apple"] = wanted
    with bn.Episode(bn.Task.from_mapping(content), {"dan": "infer:1"}) as episode:
        view = episode.play(0).view("dan")
        assert view.state.agents["ann"].current
        # For the planner an act ends the course, so that a taker would still be beside the chest.
        assert posterior(view, 1)["ann"]["apple"] > 0.8


def test_a_past_belief_is_a_world_as_it_was_known_then() -> None:
    with bn.Episode(bn.Task.from_mapping(yaml.safe_load(CELLAR)), {"dan": "infer:1"}) as episode:
        view = episode.play(0).view("dan")
        then, now = view.imagine(1, tick=0), view.imagine(1)
        assert (then.tick, view.imagine(1, tick=3).tick, now.tick) == (0, 3, view.tick)
        where = then.world.agents["dan"].position, now.world.agents["dan"].position
        assert where == ((2.5, 1, 6.5), view.state.agents["dan"].position)
        door = then.world.box.index((3, 1, 4))
        assert then.world.blocks[door] != now.world.blocks[door]
        assert then.view(("ann",)).containers.keys() == {(1, 1, 1)}
        with pytest.raises(bn.TickError, match="in the future"):
            view.imagine(1, tick=view.tick + 1)


def test_a_door_that_opens_by_hand_is_no_obstacle_to_planners() -> None:
    for kind, opens in (("oak", True), ("iron", False)):
        content = yaml.safe_load(CELLAR.replace("oak_door", f"{kind}_door"))
        content["scenario"]["script"] = []
        with bn.Episode(bn.Task.from_mapping(content), {"dan": "infer:1"}) as episode:
            mind = episode.play(0).view("dan").imagine(1)
            assert mind.may_reach("ann", (1, 1, 1)) is opens


def test_nobody_waits_for_deeds_that_it_would_not_see() -> None:
    task = bn.Task.load("what-happened-here", seed=1)
    with bn.Episode(task, {"dan": "infer:1"}) as episode:
        episode.play(1)
        assert episode.parts[0].decisions["dan"].program


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
        ("{helps: bob}", "{helps: bob, ticks: 3}", "bring.yaml:11: .*has nothing to `reach`"),
        (
            "{helps: bob}",
            "{helps: bob, never: [{agent: bob, at: [11, 1, 1]}]}",
            "bring.yaml:11: .*beside other keys",
        ),
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
