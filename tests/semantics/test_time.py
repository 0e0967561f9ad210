"""Past ticks, late questions: a node follows from the log alone (semantics, sections 5 and 6)."""

import itertools

import pytest
from tests.nest.comparing import everything
from tests.nest.places import CHEST, CORNER, EAST, GAP, MEETING, WEST, nest_of

import beliefnest as bn
from beliefnest.errors import BranchError, PathError, PositionError, TickError

THREE = {"observer": WEST, "sally": MEETING, "anne": GAP}
PATHS = ["/", "/observer", "/observer/sally", "/observer/sally/anne", "/anne/observer"]


def corner():
    return nest_of(
        THREE, CORNER, chests={CHEST: {"emerald": 1}}, inventories={"anne": {"diamond": 1}}
    )


def acts(world):
    """Play the story, one act after the other."""
    yield world.deposit("anne", CHEST, {"diamond": 1})
    yield world.place_agent("sally", EAST)
    yield world.step(2)
    yield world.withdraw("anne", CHEST, {"emerald": 1})
    with world.tick():
        world.place_agent("sally", GAP)
        world.say("sally", "hello")
    yield None
    yield world.set_block(CHEST, "air")


def told():
    world, nest = corner()
    for _ in acts(world):
        pass
    return nest


def test_a_node_asked_late_is_what_it_would_have_been_live():
    world, live = corner()
    seen_live = {}
    for path in PATHS:
        seen_live[0, path] = everything(live[path].state)
    for _ in acts(world):
        for path in PATHS:
            seen_live[live.tick, path] = everything(live[path].state)
    late = told()
    for (tick, path), state in seen_live.items():
        assert everything(late.at(tick)[path].state) == state, (tick, path)


@pytest.mark.parametrize("order", list(itertools.permutations(PATHS[2:])))
def test_nodes_may_be_asked_for_in_any_order_and_twice(order):
    expected = told()
    nest = told()
    for path in (*order, *order):
        assert everything(nest[path].state) == everything(expected[path].state)


def test_the_state_that_was_given_out_does_not_change():
    world, nest = corner()
    state = nest["/observer/sally"].state
    before = everything(state)
    for _ in acts(world):
        _ = nest["/observer/sally"].state
    assert everything(state) == before


def test_the_past_may_be_asked_for_in_any_order():
    nest = told()
    forwards = [everything(nest.at(t)["/observer/sally"].state) for t in range(nest.tick + 1)]
    backwards = [everything(nest.at(t)["/observer/sally"].state) for t in range(nest.tick, -1, -1)]
    assert forwards == backwards[::-1]


def test_the_present_is_the_latest_past():
    nest = told()
    for path in PATHS:
        assert everything(nest.at(nest.tick)[path].state) == everything(nest[path].state)


def test_the_past_of_a_controlled_simulator_is_its_own_before_it_its_parent_s():
    world, nest = corner()
    world.place_agent("anne", WEST)
    belief = nest["/observer"]
    belief.switch("try")
    belief.scripted.place_agent("anne", MEETING)
    world.place_agent("anne", EAST)
    assert nest.at(2)["/observer"].state.agents["anne"].position == MEETING
    assert nest.at(1)["/observer"].state.agents["anne"].position == WEST
    assert nest.at(0)["/observer"].state.agents["anne"].position == GAP
    assert nest.at(2)["/"].state.agents["anne"].position == EAST


@pytest.mark.parametrize("tick", [-1, 8, 100])
def test_a_tick_in_the_future_or_before_the_start_is_an_error(tick):
    nest = told()
    assert nest.tick == 7
    with pytest.raises(TickError, match=str(tick)):
        nest.at(tick)


@pytest.mark.parametrize("tick", ["1", 1.5, True, None])
def test_what_is_no_tick_is_an_error_live_and_recorded(tick, tmp_path):
    world = bn.ScriptedWorld(((0, 0, 0), (3, 3, 3)), agents={"sally": (1.5, 0, 1.5)})
    store = tmp_path / "run.bn"
    with bn.Nest(world, store=store) as nest, pytest.raises(TickError, match="is not a tick"):
        nest.at(tick)
    with bn.Nest.read(store) as nest, pytest.raises(TickError, match="is not a tick"):
        nest.at(tick)


def test_a_world_may_begin_at_a_later_tick():
    from beliefnest import Nest, ScriptedWorld

    world = ScriptedWorld(((0, 0, 0), (3, 2, 3)), agents={"a": (0.5, 0, 0.5)}, tick=40)
    nest = Nest(world)
    world.say("a", "hello")
    assert nest["/a"].state.chat == [(41, "a", "hello")]
    assert nest.at(40)["/a"].state.chat == []
    with pytest.raises(TickError, match="39"):
        nest.at(39)


@pytest.mark.parametrize(
    "path", ["", "observer", "///", "/observer//sally", "/nobody", "/observer/Sally", "/observer/ "]
)
def test_a_malformed_path_or_an_unknown_agent_is_an_error(path):
    _, nest = corner()
    with pytest.raises(PathError):
        nest[path]
    with pytest.raises(PathError):
        nest.at(0)[path]


def test_the_error_of_an_unknown_agent_says_who_there_is():
    _, nest = corner()
    with pytest.raises(PathError, match=r"nobody.*anne, observer, sally"):
        nest["/observer/nobody"]


@pytest.mark.parametrize("position", [(11, 0, 0), (0, -1, 0), (0, 3, 0), (-1, 0, 0)])
def test_a_position_outside_the_box_is_an_error(position):
    _, nest = corner()
    blocks = nest["/observer"].state.blocks
    with pytest.raises(PositionError):
        blocks[position]
    with pytest.raises(PositionError):
        blocks.current(position)
    with pytest.raises(PositionError):
        blocks.basis(position)


@pytest.mark.parametrize("name", ["", "a/b", "a[b", "a]b", "line\nbreak", 3])
def test_a_wrong_branch_name_is_an_error(name):
    _, nest = corner()
    with pytest.raises(BranchError):
        nest["/observer"].switch(name)
    assert nest["/observer"].mode == "follow"


def test_a_fork_in_the_future_or_of_a_known_branch_is_an_error():
    _, nest = corner()
    belief = nest["/observer"]
    with pytest.raises(TickError):
        belief.switch("try", at=1)
    assert (belief.mode, belief.branches()) == ("follow", ())
    belief.switch("try")
    with pytest.raises(BranchError, match="try"):
        belief.switch("try", at=0)


def test_a_belief_in_follow_mode_cannot_be_acted_in():
    _, nest = corner()
    with pytest.raises(BranchError, match="switch"):
        nest["/observer"].step(1)
    with pytest.raises(BranchError, match="switch"):
        _ = nest["/observer"].scripted
