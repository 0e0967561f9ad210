"""Slips that writers of programs make often are named as such, in both worlds."""

from typing import Any

import pytest
from tests.shared_worlds import WORLDS

import beliefnest as bn

pytestmark = pytest.mark.usefixtures("kept_worlds")

ROOM: dict[str, Any] = {
    "name": "room",
    "box": [[0, 0, 0], [9, 3, 6]],
    "agents": {"ann": {"position": [1.5, 1, 3.5]}},
    "blocks": [{"block": "stone", "fill": [[0, 0, 0], [9, 0, 6]]}],
    "containers": [{"at": [3, 1, 3], "items": {}}],
}
AWAY = "goToPosition(bot, new Vec3(50, 1, 1))"
FAILS = {
    "a name that is nearly right": (
        "await goToPositon(bot, new Vec3(1, 1, 1))",
        "did you mean goToPosition?",
    ),
    "a failure that nothing waits for": (f"{AWAY}\nawait bot.waitForTicks(9)", "write await, or"),
    "a value that is not there yet": (
        "const chest = bot.openContainer(bot.blockAt(new Vec3(3, 1, 3)))\nchest.containerItems()",
        "openContainer had not ended yet: was await forgotten",
    ),
}


@pytest.fixture(params=WORLDS, scope="module")
def ann(request):
    with bn.Nest.open(bn.Scenario.from_mapping(ROOM), world=request.param) as nest:
        yield lambda code: nest["/"].run("ann", code)


@pytest.mark.parametrize("slip", FAILS)
def test_a_slip_is_named(ann, slip):
    code, said = FAILS[slip]
    result = ann(code)
    assert not result.ok
    assert said in result.error.message


def test_a_call_that_nothing_waited_for_is_named_where_the_program_ended_well(ann):
    result = ann("goToPosition(bot, new Vec3(8, 1, 1))")
    assert result.ok
    assert result.hint is not None
    assert "goToPosition" in result.hint
    assert "was await forgotten?" in repr(result)


@pytest.mark.parametrize(
    "code",
    [
        f"await {AWAY}.catch(() => {{}})",
        f"try {{ await {AWAY} }} catch (error) {{ console.log(error.message) }}",
        f"await Promise.allSettled([{AWAY}, bot.waitForTicks(2)])",
        "bot.chat('hello')",
        "await doNothing(bot)",
    ],
)
def test_who_waits_or_says_hears_of_no_slip(ann, code):
    result = ann(code)
    assert result.ok, result.error
    assert result.hint is None


def test_what_is_no_scenario_is_told_how_to_load_one():
    with pytest.raises(bn.BeliefNestError, match=r"bn\.Scenario\.load\('sally-anne'\)"):
        bn.Nest.open("sally-anne")
    with pytest.raises(bn.BeliefNestError, match=r"with bn\.Nest\.open\(scenario\)"):
        bn.Nest(bn.Scenario.load("sally-anne"))
