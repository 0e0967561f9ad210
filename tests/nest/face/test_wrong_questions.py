"""Questions about minds and histories that have no answer: each error says what to do."""

import random
import re

import pytest

import beliefnest as bn
from beliefnest.errors import InputError, TickError

GOAL = {"goals": {"g": {"at": (2, 1, 0)}}, "utilities": {"g": 10}}
IDLE = {"a": {"idle": ""}}


@pytest.fixture(scope="module")
def nest():
    """Give a nest of two rooms with a wall between, and Anne in one of them."""
    blocks = {(x, 0, z): "stone" for x in range(6) for z in range(2)}
    blocks |= {(3, y, z): "bricks" for y in (1, 2) for z in (0, 1)}
    world = bn.ScriptedWorld(
        box=((0, 0, 0), (5, 2, 1)),
        blocks=blocks,
        agents={"a": (0.5, 1, 0.5), "b": (5.5, 1, 0.5)},
    )
    with bn.Nest(world) as opened:
        world.step(10)
        yield opened


def reachable():
    return bn.MindModel("a", **GOAL)


def behind():
    return bn.MindModel("a", goals={"g": {"at": (5, 1, 0)}}, utilities={"g": 10})


QUESTIONS = {
    "no model": (lambda sim: sim.infer("a"), InputError, "give a MindModel"),
    "behind a wall": (lambda sim: sim.infer(behind()), InputError, "can be reached by a"),
    "imagined behind a wall": (
        lambda sim: sim.imagine(0, actors={"a": {"x": behind()}}, n=2),
        InputError,
        "can be reached by a",
    ),
    "no evidence": (
        lambda sim: sim.imagine(0, actors=IDLE, evidence=[]),
        InputError,
        "give a list of conditions, or None",
    ),
    "ever": (
        lambda sim: sim.imagine(
            0, actors=IDLE, evidence=[{"agent": "a", "at": (0, 1, 0), "ever": True}]
        ),
        InputError,
        "has the key 'ever'; its keys are path, container",
    ),
    "nothing to share": (
        lambda sim: sim.imagine(0, actors=IDLE, n=1).share([]),
        InputError,
        "give a mapping",
    ),
    "a number to share": (
        lambda sim: sim.imagine(0, actors=IDLE, n=1).share(3),
        InputError,
        "give a mapping",
    ),
    "later than now": (
        lambda sim: sim.imagine(0, until=50, actors=IDLE),
        TickError,
        "in the future; / is at 10",
    ),
    "no tick": (lambda sim: sim.infer(reachable()).at(None), TickError, "whole number"),
    "a word as tick": (
        lambda sim: sim.infer(reachable()).mean("utility.g", "now"),
        TickError,
        "whole number",
    ),
    "a word as seed": (
        lambda sim: sim.infer(reachable()).sample_paths(1, "x"),
        InputError,
        "whole number from 0",
    ),
    "joint of nothing": (
        lambda sim: sim.infer(reachable()).joint(),
        InputError,
        "there are utility.g, cell",
    ),
}


@pytest.mark.parametrize("name", QUESTIONS)
def test_wrong_questions_are_refused_with_advice(nest, name):
    ask, kind, advice = QUESTIONS[name]
    with pytest.raises(kind, match=re.escape(advice)):
        ask(nest["/"])


def test_a_sequence_of_goals_is_refused_with_advice():
    goals = {"g": [{"at": (2, 1, 0)}, {"at": (0, 1, 0)}]}
    with pytest.raises(InputError, match="one after the other is a program or a policy"):
        bn.MindModel("a", goals=goals, utilities={"g": 10})


def test_a_way_that_another_agent_may_open_is_no_error(nest):
    actors = {"a": {"x": behind()}, "b": {"idle": ""}}
    anything = [{"agent": "b", "at": (5, 1, 0)}]
    assert nest["/"].imagine(0, actors=actors, n=2, evidence=anything).impossible is None


def test_policies_get_random_numbers_of_their_history(nest):
    def walks(seed):
        seen = []

        def policy(simulator, random):
            seen.append(random.random())
            return f"await waitTicks(bot, {random.randint(1, 3)})"

        nest["/"].imagine(
            0,
            until=6,
            actors={"a": {"waits": policy}},
            evidence=[{"agent": "b", "at": (5, 1, 0)}],
            n=3,
            seed=seed,
        )
        return seen

    assert walks(1) == walks(1) != walks(2)
    assert len(set(walks(1))) == len(walks(1)) >= 6


def test_policies_without_the_parameter_get_the_simulator_alone(nest):
    chance = random.Random(0)

    def policy(simulator, chance=chance):
        return "" if simulator.tick else f"await waitTicks(bot, {chance.randint(1, 3)})"

    imagined = nest["/"].imagine(0, actors={"a": {"waits": policy}}, n=2)
    assert imagined.failed == {}
