"""Joint action: what Anne foresees, plans and does, judged in the simulators it happens in."""

import time

import beliefnest as bn
from beliefnest.llm.offline import OfflineModel
from beliefnest.scenarios.running import run_scenario

LEFT, RIGHT = (-2, -51, -4), (2, -51, -4)


def possessions(nest: bn.Nest, path: str, branch: str) -> dict[str, int]:
    """Return Sally's possessions at the end of a branch."""
    simulator = nest[path]
    before = simulator.branch
    simulator.switch(branch)
    try:
        return dict(simulator.state.agents["sally"].inventory)
    finally:
        simulator.switch(before)


def test_anne_foresees_what_sally_will_do_and_helps_her() -> None:
    scenario = bn.Scenario.load("help-sally")
    with bn.Nest.open(scenario) as nest:
        outcome = run_scenario(
            nest, scenario, OfflineModel(), 0, time.perf_counter(), lambda what, done, total: None
        )
        prediction, plan, action = outcome.probes
        assert possessions(nest, "/anne", prediction.branch).get("diamond", 0) == 0
        assert possessions(nest, "/anne", plan.branch) == {"diamond": 1}
        assert possessions(nest, "/", action.branch) == {"diamond": 1}
        # None of it is real: all were branches.
        assert nest["/"].state.containers[RIGHT].items == {"diamond": 1}
        assert not nest["/"].state.agents["sally"].inventory
    assert prediction.opened == (LEFT,)
    assert plan.opened == (RIGHT,)
    assert plan.program == action.program
    assert "I want to get a diamond" in plan.prompt
    assert outcome.ok
