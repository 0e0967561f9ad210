"""Shortcuts: rules without beliefs, and the tasks that must not be won by them."""

import functools
import json
import math
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.profiles import at_night, few_by_day

import beliefnest as bn
from beliefnest.cli.app import run_command_line
from beliefnest.episodes.policies import resolve_policy
from beliefnest.episodes.shortcuts import policy_of, rules_of, trained_rule
from beliefnest.episodes.tasks import generated
from beliefnest.episodes.trials import wins_of

FUNCTIONAL = Path(__file__).parents[2] / "examples" / "functional"
SEEDS = at_night(20, 6)
BALANCED = ("watchman", "kitchen", "joint-lift")
"""Tasks whose right choice is any but the nearest: a rule wins at most about a third."""
SPOKEN = ("help-find", "hide-and-seek", "tell-what-is-needed", "recipe")
"""Tasks in which one of some true things is to be said: a rule that speaks wins a third or less."""


def rules(name: str) -> list[str]:
    return [rule for rule in rules_of(bn.Task.load(name)) if "any" not in rule]


RULES = [(name, rule) for name in (*BALANCED, *SPOKEN, "blueprint") for rule in rules(name)]


@pytest.mark.parametrize(("name", "rule"), few_by_day(RULES[:: at_night(1, 5)], 2))
def test_no_rule_without_beliefs_wins_a_balanced_task(name: str, rule: str) -> None:
    (won,) = wins_of(lambda seed: bn.Task.load(name, seed), [policy_of(rule)], range(SEEDS))
    # A shortcut wins all; chance wins so many in less than one of a hundred cases.
    assert won <= at_night(14, 5)


def test_rules_say_what_is_false_where_the_goal_is_a_false_belief() -> None:
    document = bn.Task.scenario_document(str(FUNCTIONAL / "mislead.yaml"))
    assert document is not None

    def of_seen(move: int) -> bn.Task:
        return bn.Task.instance_of(document, 1000, 1, {"seen": move})

    # Each names another one of three things, of which one is right in each instance.
    for key in ("first", "nearest", "farthest"):
        assert wins_of(of_seen, [f"rule:{key}+plan:tell"], range(3)) == [1]


@pytest.mark.parametrize("name", few_by_day(BALANCED))
def test_the_right_place_is_spread_over_all_ranks(name: str) -> None:
    ranks = set()
    for seed in range(200):
        columns, near, right = choice_of(name, bn.Task.load(name, seed))
        assert right != near
        # The deadline of joint-lift is that of two lifts.
        assert name != "joint-lift" or 2 * near - right in columns
        by_distance = sorted(columns, key=lambda x: (abs(x - near), x))
        ranks.add((columns.index(right), by_distance.index(right)))
    everywhere = set(range(len(columns)))
    # The nearest lift is always the one in the middle.
    assert {place for place, _ in ranks} == everywhere - ({2} if name == "joint-lift" else set())
    assert {rank for _, rank in ranks} == everywhere - {0}


def test_a_builder_has_not_seen_one_of_its_models() -> None:
    for seed in range(20):
        task = bn.Task.load("blueprint", seed)
        (shared,) = task.form.scenario["initial_beliefs"]
        shown = {tuple(each["at"]) for each in shared["blocks"]}
        models = [tuple(each.like) for each in task.form.goal.reach if each.like]
        unseen = Counter(at[0] for at in models if at not in shown)
        assert sorted(unseen.values()) == [1, 1]
        assert task.form.goal.messages == 2 < len(models)


@pytest.mark.parametrize("name", SPOKEN)
def test_what_is_to_be_said_is_any_of_the_true_things(name: str) -> None:
    seeds, ranks = 900, Counter[tuple[str, str, int]]()
    for seed in range(seeds):
        scene = generated(name, seed, {})["scenario"]
        for speaker, things, right in things_to_say(name, scene):
            ranks[speaker, "order", things.index(right)] += 1
            for agent, form in scene["agents"].items():
                nearest = sorted(things, key=lambda at, feet=form["position"]: math.dist(at, feet))
                ranks[speaker, agent, nearest.index(right)] += 1
    # A third each, within four standard deviations of the draws. What is in the room of a cook
    # is nearer to it than the two things in the other room, of which one is to be said.
    part = 1 / 2 if name == "recipe" else 1 / 3
    most = seeds * part + 4 * math.sqrt(seeds * part * (1 - part))
    assert max(ranks.values()) < most
    assert name == "recipe" or (len(ranks) == 9 and min(ranks.values()) > 2 * seeds / 3 - most)


def things_to_say(
    name: str, scene: dict[str, Any]
) -> Iterator[tuple[str, list[tuple[int, ...]], tuple[int, ...]]]:
    """Yield for each speaker the places of true things to say, and the one that helps."""
    shared, *own = (
        {tuple(each["at"]): each for each in entry["containers"]}
        for entry in scene["initial_beliefs"]
    )
    for entry, known in zip(scene["initial_beliefs"][1:], own, strict=True):
        things = sorted(
            at
            for at, each in {**shared, **known}.items()
            if each["items"] and "book" not in each["items"]
        )
        if name == "hide-and-seek":
            # The hearer may look for it there.
            (right,) = [at for at in things if at in shared and not shared[at]["complete"]]
        else:
            # The hearer does not know of it.
            (right,) = [at for at in things if not shared.get(at, {"items": ()})["items"]]
        yield entry["path"], things, right


def choice_of(name: str, task: bn.Task) -> tuple[list[int], int, int]:
    """Return the columns of the places to choose from, the nearest, and the right one."""
    scene = task.form.scenario
    if name == "joint-lift":
        (_, known) = scene["initial_beliefs"]
        sites = task.form.goal.reach[0].sites
        columns = [(site[0][0] + site[1][0]) // 2 for site in sites]
        right = sum(lever["at"][0] for lever in known["blocks"]) // 2
        return columns, int(scene["agents"]["anne"]["position"][0]), right
    kind, agent = ("hatch", "cook") if name == "kitchen" else ("coffer", "spy")
    columns = sorted(each["at"][0] for each in scene["containers"] if each["label"] == kind)
    # The window, or the stone, is in front of the right one as the other agent sees it.
    (x0, _, z0), (x1, _, _) = scene["blocks"][2]["fill"]
    other = scene["agents"]["waiter" if name == "kitchen" else "watchman"]["position"]
    eye, z = (x0 + x1) / 2, 3
    behind = {x: x + (other[0] - 0.5 - x) * (z0 - z) / (other[2] - z) for x in columns}
    right = min(columns, key=lambda x: abs(behind[x] - eye))
    return columns, int(scene["agents"][agent]["position"][0]), right


def test_a_shortcut_of_ones_own_task_is_found(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "mine.yaml"
    chests = [{"at": [1, 1, 3], "items": {"apple": 1}}, {"at": [9, 1, 3], "items": {"apple": 1}}]
    goal = {"reach": [{"agent": "ann", "items": {"apple": 1}}]}
    content = {
        "name": "mine",
        "box": [[0, 0, 0], [10, 3, 6]],
        "blocks": [{"block": "stone", "fill": [[0, 0, 0], [10, 0, 6]]}],
        "containers": chests,
        "agents": {"ann": {"position": [3.5, 1, 3.5]}},
        "initial_beliefs": [
            {"path": "/**", "containers": [{**each, "complete": True} for each in chests]}
        ],
        "episode": {"goal": goal, "rounds": 8, "order": 1},
    }
    file.write_text(json.dumps(content), encoding="utf-8")

    def load(seed: int) -> bn.Task:
        return bn.Task.load(str(file), seed)

    assert wins_of(load, ["rule:nearest", "rule:farthest"], range(1)) == [1, 1]
    assert wins_of(load, [policy_of(trained_rule(load, range(1), tries=2))], range(1)) == [1]
    command = ["play", str(file), "--baselines", "--seeds", "1", "--json"]
    assert run_command_line(command) == 1
    found = json.loads(capsys.readouterr().out)["baselines"]
    assert {each["policy"]: each["right"] for each in found}["rule:farthest"] == 1


def test_rules_speak_where_players_may() -> None:
    names = rules_of(bn.Task.load("help-find"))
    assert {"any+plan:tell-all", "any+plan", "farthest-sally+plan:tell"} < {*names}
    # To say everything is against its rules, or not: that is what the trial is for.
    load = functools.partial(bn.Task.load, "help-find")
    assert wins_of(load, ["rule:any+plan"], range(1)) == [0]


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("rule:nearset", "there is no rule 'nearset'; rules are nearest, farthest"),
        ("rule:nearest+x", "there is no rule 'x'"),
        ("rule:x", "nearest+farthest takes from the one and puts into the other; first:tell"),
        ("rule:plan:tell", "there is no rule 'plan'; rules are"),
        ("rule:linear=a/b", "there is no rule 'linear=a/b'"),
        ("rule:first:shout", "'shout' in the rule 'first:shout' is unknown; give tell or tell-all"),
    ],
)
def test_what_is_no_rule_is_refused(
    name: str, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(bn.UnknownNameError, match=re.escape(message)):
        resolve_policy(name)
    assert run_command_line(["play", "watchman", "--agent", f"spy={name}"]) == 2
    assert message in capsys.readouterr().err
