"""Nobody's body, and nothing that programs read, tells of others' programs, branches or resumes."""

import pytest
from tests.profiles import at_night

import beliefnest as bn
from beliefnest.worlds.by_name import Worlds

ROOM = {
    "name": "behind-a-wall",
    "box": [[0, 0, 0], [10, 4, 10]],
    "blocks": [
        {"block": "stone", "fill": [[0, 0, 0], [10, 0, 10]]},
        {"block": "bricks", "fill": [[0, 1, 6], [10, 3, 6]]},
    ],
    "agents": {"ann": {"position": [3.5, 1, 3.5]}, "bob": {"position": [3.5, 1, 8.5]}},
    "static_blocks": ["stone", "bricks"],
    "perception": {"hearing": "sight"},
}
TURNING = "bot.look(3, 0.4); await bot.waitForTicks(2)"
SLIDING = """
bot.setControlState('sprint', true); bot.setControlState('forward', true)
await bot.waitForTicks(8)
"""
JUMPING = "bot.setControlState('jump', true); await bot.waitForTicks(3)"
UNAWAITED = "goToPosition(bot, new Vec3(8, 1, 1), 0); await bot.waitForTicks(5); bot.look(1, 0)"
MOVES = """
let ticks = 0
const at = []
bot.on('physicsTick', () => { ticks += 1 })
bot.on('move', () => at.push(ticks))
await bot.waitForTicks(45)
console.log(at.join())
"""


@pytest.fixture(scope="module")
def worlds():
    with Worlds(0) as lending:
        yield lending


def opened(worlds, **more):
    return bn.Nest.open(bn.Scenario.from_mapping(ROOM), worlds=worlds, **more)


def seen_by_ann(worlds, anns, bob, senses):
    """Return Ann's beliefs about herself after each of her programs, beside one of Bob's."""
    with opened(worlds) as nest:
        found = []
        for ann in anns:
            result = nest["/"].run_all({"ann": ann, "bob": bob}, senses=senses)
            state = nest["/ann"].state
            own = state.agents["ann"]
            pose = (own.position, own.yaw, own.pitch, own.on_ground, own.inventory)
            found.append((pose, state.agents["bob"].position, result["ann"].ticks))
        return found


@pytest.mark.parametrize("senses", ["world", "percepts"])
@pytest.mark.parametrize("program", [TURNING, SLIDING, JUMPING, UNAWAITED])
def test_what_ann_reads_does_not_tell_how_long_bob_was_busy_behind_a_wall(worlds, program, senses):
    anns = [program, "", program, SLIDING]
    idle = seen_by_ann(worlds, anns, "", senses)
    for ticks in at_night([1, 7, 33, 60], [60]):
        assert seen_by_ann(worlds, anns, f"await bot.waitForTicks({ticks})", senses) == idle


def test_a_run_ends_once_those_whose_programs_ended_in_the_air_stand(worlds):
    with opened(worlds) as nest:
        result = nest["/"].run("ann", JUMPING)
        assert result.ticks < 6 < nest["/"].tick
        own = nest["/"].state.agents["ann"]
        assert own.position[1] == 1
        assert own.on_ground


def test_neither_another_branch_nor_a_resume_moves_when_a_bot_tells_where_it_is(worlds, tmp_path):
    def moves(nest):
        return nest["/"].run("ann", MOVES).log

    with opened(worlds, store=tmp_path / "stayed.bn") as nest:
        nest["/"].run("ann", "await bot.waitForTicks(7)")
        expected = moves(nest), moves(nest)
    with opened(worlds, store=tmp_path / "away.bn") as nest:
        nest["/"].run("ann", "await bot.waitForTicks(7)")
        nest["/"].switch("empty")
        nest["/"].switch("main")
        first = moves(nest)
        nest["/"].switch("empty")
        nest["/"].step(3)
        nest["/"].switch("main")
        assert (first, moves(nest)) == expected
    with opened(worlds, store=tmp_path / "run.bn") as nest:
        nest["/"].run("ann", "await bot.waitForTicks(7)")
    with bn.Nest.resume(tmp_path / "run.bn", worlds=worlds) as nest:
        first = moves(nest)
    with bn.Nest.resume(tmp_path / "run.bn", worlds=worlds) as nest:
        assert (first, moves(nest)) == expected
