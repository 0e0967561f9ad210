"""The ice cream van, acted and spoken by bots: who heard what, and where Mary goes."""

import math
import time
from importlib.resources import files
from typing import Any

import pytest
from ruamel.yaml import YAML

import beliefnest as bn
from beliefnest.llm.offline import OfflineModel
from beliefnest.scenarios.outcome import Outcome
from beliefnest.scenarios.running import run_scenario
from beliefnest.scenarios.sources import builtin_names

pytestmark = pytest.mark.usefixtures("kept_worlds")

A, B = (4.5, 1.0, 4.5), (20.5, 1.0, 16.5)
STAYS, GOES, HELLO = (
    "I will stay at location A today.",
    "I am going to location B now.",
    "Hello Mary, I am going to location B.",
)
NEAR = 3.0
HEARD = {
    1: {
        "/observer": [STAYS, GOES, HELLO],
        "/observer/john": [STAYS, GOES],
        "/observer/mary": [STAYS, HELLO],
        "/observer/john/mary": [STAYS],
        "/observer/mary/john": [STAYS],
        "/john": [STAYS, GOES],
        "/mary": [STAYS, HELLO],
        "/john/mary": [STAYS],
    },
    2: {
        "/observer/john": [STAYS, GOES, HELLO],
        "/observer/mary": [STAYS, HELLO],
        "/observer/john/mary": [STAYS, HELLO],
        "/john/mary": [STAYS, HELLO],
    },
    3: {
        "/observer": [STAYS, GOES],
        "/observer/john": [STAYS, GOES],
        "/observer/mary": [STAYS],
        "/observer/john/mary": [STAYS],
        "/mary": [STAYS],
    },
}
SELLER = {
    1: {"/": B, "/observer": B, "/mary": B, "/observer/mary": B, "/observer/john/mary": A},
    2: {"/": B, "/observer/mary": B, "/observer/john": B, "/observer/john/mary": B},
    3: {"/": B, "/observer": B, "/mary": A, "/observer/mary": A, "/observer/john/mary": A},
}
ARRIVES = {1: [A, B, B], 2: [B, B, B], 3: [A, A, A]}


def ask(nest: bn.Nest, scenario: bn.Scenario) -> Outcome:
    return run_scenario(
        nest, scenario, OfflineModel(), 0, time.perf_counter(), lambda what, done, total: None
    )


@pytest.mark.parametrize("condition", [1, 2, 3])
def test_each_agent_heard_what_it_was_there_for_at_every_depth(condition: int) -> None:
    scenario = bn.Scenario.load("ice-cream-van", condition)
    with bn.Nest.open(scenario) as nest:
        outcome = ask(nest, scenario)
        heard = {path: [text for _, _, text in nest[path].state.chat] for path in HEARD[condition]}
        seller = {path: nest[path].state.agents["seller"].position for path in SELLER[condition]}
    assert heard == HEARD[condition]
    for path, place in SELLER[condition].items():
        believed = seller[path]
        assert believed is not None
        assert math.dist(believed, place) < 1, path
    for probe, place in zip(outcome.probes, ARRIVES[condition], strict=True):
        assert probe.arrived is not None
        assert math.dist(probe.arrived, place) < NEAR, probe.probe.label
    assert outcome.ok


def test_john_sees_nothing_of_the_meeting_and_mary_nothing_of_the_leaving() -> None:
    scenario = bn.Scenario.load("ice-cream-van", 1)
    with bn.Nest.open(scenario) as nest:
        nest.play()
        told = {text: tick for tick, _, text in nest["/"].state.chat}
        leaving, meeting = nest.at(told[GOES]), nest.at(told[HELLO])
        assert leaving["/john"].state.agents["seller"].current
        assert not leaving["/john"].state.agents["mary"].current
        assert not leaving["/mary"].state.agents["seller"].current
        assert meeting["/mary"].state.agents["seller"].current
        assert not meeting["/mary"].state.agents["john"].current
        assert not meeting["/john"].state.agents["seller"].current
        assert not meeting["/john"].state.agents["mary"].current
        for past in (leaving, meeting):
            assert all(agent.current for agent in past["/observer"].state.agents.values())


def test_the_task_tells_the_places_and_not_where_the_seller_is() -> None:
    scenario = bn.Scenario.load("ice-cream-van", 1)
    tasks = {probe.task for probe in scenario.probes}
    assert tasks == {
        "Go to the ice cream seller. Location A is at (4, 1, 4). Location B is at (20, 1, 16)."
    }


def exchanged(value: Any) -> Any:
    """Exchange the names of the two locations in all that a scenario says."""
    if isinstance(value, dict):
        return {key: exchanged(child) for key, child in value.items()}
    if isinstance(value, list):
        return [exchanged(child) for child in value]
    if isinstance(value, str):
        swapped = value.replace("ocation A", "ocation ?").replace("ocation B", "ocation A")
        return swapped.replace("ocation ?", "ocation B")
    return value


def test_the_answers_do_not_hang_on_the_names_of_the_places() -> None:
    assert "ice-cream-van" in builtin_names()
    text = (files("beliefnest.scenarios") / "builtin" / "ice-cream-van.yaml").read_text("utf-8")
    scenario = bn.Scenario.from_mapping(exchanged(YAML(typ="safe").load(text)), 1)
    with bn.Nest.open(scenario) as nest:
        outcome = ask(nest, scenario)
    assert [probe.ok for probe in outcome.probes] == [True, True, True]
    assert outcome.ok
