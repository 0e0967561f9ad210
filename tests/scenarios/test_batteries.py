"""The tasks of the field that come with the program: each comes out as the task says, and why."""

import time

import pytest

import beliefnest as bn
from beliefnest.llm.offline import OfflineModel
from beliefnest.scenarios.outcome import Outcome
from beliefnest.scenarios.running import run_scenario

pytestmark = pytest.mark.usefixtures("kept_worlds")

CONDITIONS = [
    (name, condition)
    for name, count in {
        "unexpected-contents": 3,
        "unexpected-transfer": 3,
        "bake-sale": 2,
        "birthday-puppy": 2,
        "lie": 3,
        "knowledge-access": 2,
        "double-bluff": 2,
        "food-trucks": 3,
    }.items()
    for condition in range(1, count + 1)
]
# For each claim made: is it false, a lie, and who of the others took it up.
CLAIMS = {
    ("lie", 1): [(True, True, {"/max": True, "/nora/max": True})],
    ("lie", 2): [(True, True, {"/max": False, "/nora/max": False})],
    ("lie", 3): [(True, True, {"/max": False, "/nora/max": False})],
    ("birthday-puppy", 1): [(True, True, {"/peter": True})],
    ("double-bluff", 1): [
        (False, False, {"/spy": True, "/captor": False, "/captor/spy": False}),
        (False, False, {"/captor": False, "/spy/captor": False}),
    ],
    ("double-bluff", 2): [(False, False, {"/captor": True, "/spy/captor": True})],
    ("unexpected-transfer", 3): [(False, False, {"/max": True, "/grandfather/max": True})],
}


def played(nest: bn.Nest, scenario: bn.Scenario) -> Outcome:
    return run_scenario(
        nest, scenario, OfflineModel(), 0, time.perf_counter(), lambda what, done, total: None
    )


@pytest.mark.parametrize(("name", "condition"), CONDITIONS)
def test_a_task_comes_out_as_people_answer_it(name: str, condition: int) -> None:
    scenario = bn.Scenario.load(name, condition)
    with bn.Nest.open(scenario) as nest:
        outcome = played(nest, scenario)
        assert outcome.ok, [probe for probe in outcome.probes if not probe.ok]
        told = nest.claims()
        for claim, (false, lie, taken_up) in zip(
            told, CLAIMS.get((name, condition), []), strict=False
        ):
            assert (claim.false, claim.lie) == (false, lie)
            assert {path: claim.taken_up(path) for path in taken_up} == taken_up
        assert len(told) >= len(CLAIMS.get((name, condition), []))


def test_one_s_own_past_belief_of_the_tube_is_kept() -> None:
    scenario = bn.Scenario.load("unexpected-contents", 1)
    tube = (3, 1, 2)
    with bn.Nest.open(scenario) as nest:
        start = nest.tick
        nest.play()
        before, after = nest.at(start)["/child"].state, nest["/child"].state
    assert before.containers[tube].items == {"cookie": 1}
    assert after.containers[tube].items == {"feather": 1}


@pytest.mark.parametrize("name", sorted({name for name, _ in CONDITIONS}))
def test_no_prior_and_no_task_tells_the_answer(name: str) -> None:
    for scenario in bn.Scenario.load_all(name):
        for belief in scenario.setting.initial_beliefs:
            # Common ground alone, the same for everybody at every depth.
            assert belief.path == ("**",)
        for probe in scenario.probes:
            assert not any(character.isdigit() for character in probe.task or ""), probe.task
