"""Figure 1 of the paper: what each agent sees, and takes the other to see."""

import time
from dataclasses import replace

import pytest

import beliefnest as bn
from beliefnest.errors import ScenarioError
from beliefnest.facts.kinds import BlockIs, StatedFact
from beliefnest.llm.offline import OfflineModel
from beliefnest.scenarios.running import run_scenario

BLOCKS = {"red": (4, 1, 2), "green": (6, 1, 7), "blue": (8, 1, 2)}
FIGURE = {
    "/": {"red", "green", "blue"},
    "/agent_1": {"red", "green"},
    "/agent_2": {"green", "blue"},
    "/agent_1/agent_2": {"green"},
    "/agent_2/agent_1": {"green"},
}
WALKED = {
    **FIGURE,
    "/agent_1": {"red", "green", "blue"},
    "/agent_1/agent_2": {"green", "blue"},
    "/agent_2/agent_1": {"green", "blue"},
}


def judged(nest, scenario):
    outcome = run_scenario(
        nest, scenario, OfflineModel(), 0, time.perf_counter(), lambda what, done, total: None
    )
    return [each.ok for each in outcome.expectations]


@pytest.mark.parametrize(("condition", "known"), [(1, FIGURE), (2, WALKED)])
def test_each_holds_what_the_figure_shows(condition, known):
    scenario = bn.Scenario.load("red-green-blue", condition)
    with bn.Nest.open(scenario, "scripted") as nest:
        assert judged(nest, scenario) == [True] * 12
        for path, colours in known.items():
            blocks = nest[path].state.blocks
            held = {name: blocks[place] for name, place in BLOCKS.items()}
            assert held == {name: f"{name}_wool" if name in colours else None for name in BLOCKS}
            assert all(agent.position for agent in nest[path].state.agents.values())


def test_a_block_that_is_another_or_unknown_is_not_as_expected():
    scenario = bn.Scenario.load("red-green-blue", 1)
    states = [("red", "blue_wool"), ("red", None), ("blue", "air")]
    wrong = [BlockIs(BLOCKS[name], state) for name, state in states]
    expectations = tuple(StatedFact(fact, ("agent_1",)) for fact in wrong)
    scenario = replace(scenario, expectations=expectations)
    with bn.Nest.open(scenario, "scripted") as nest:
        assert judged(nest, scenario) == [False] * 3


def test_an_expectation_of_a_block_names_one_that_there_is():
    small = {
        "name": "room",
        "box": [[0, 0, 0], [2, 2, 2]],
        "agents": {"ann": {"position": [1.5, 0, 1.5]}},
    }
    for entry, told in (
        ({"block": [0, 0, 0], "state": "fog"}, "fog"),
        ({"block": [9, 0, 0], "state": "stone"}, "outside the box"),
        ({"block": [0, 0, 0], "sign": [0, 0, 0]}, "block and state"),
    ):
        with pytest.raises(ScenarioError, match=told):
            bn.Scenario.from_mapping({**small, "expectations": [{"path": "/ann", **entry}]})
