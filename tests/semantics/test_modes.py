"""Follow and control mode, forks, and what goes where (semantics, section 6)."""

import numpy as np
import pytest
from tests.nest.comparing import everything, values
from tests.nest.places import CHEST, CLOSED, CORNER, EAST, GAP, MEETING, WEST, nest_of

from beliefnest.errors import BranchError, InputError, TickError, WorldError

THREE = {"observer": WEST, "sally": MEETING, "anne": GAP}
ALL = ["/", "/observer", "/observer/sally", "/sally", "/sally/anne", "/anne"]


def corner(agents=THREE, **options):
    return nest_of(
        agents,
        CORNER,
        chests={CHEST: {"emerald": 1}},
        inventories={"anne": {"diamond": 1}},
        **options,
    )


def test_the_real_world_is_in_control_mode_and_beliefs_follow():
    _, nest = corner()
    assert (nest["/"].mode, nest["/observer"].mode) == ("control", "follow")
    assert nest["/observer"].branch == "follow"
    with pytest.raises(BranchError):
        nest["/"].switch("follow")


def test_an_unknown_name_forks_and_puts_in_control_mode():
    world, nest = corner()
    world.step(3)
    belief = nest["/observer"]
    belief.switch("try")
    assert (belief.mode, belief.branch, belief.tick) == ("control", "try", 3)


def test_a_fork_holds_what_was_believed():
    world, nest = corner()
    world.place_agent("sally", EAST)
    belief = nest["/observer"]
    before = values(belief.state)
    belief.switch("try")
    assert values(belief.state) == before


def test_in_control_mode_everything_known_is_current():
    world, nest = corner()
    world.open("observer", CHEST)
    world.place_agent("sally", EAST)
    belief = nest["/observer"]
    belief.switch("try")
    for ticks in (0, 1):
        belief.step(ticks)
        state = belief.state
        assert all(state.blocks.current(p) == (state.blocks[p] is not None) for p in state.blocks)
        assert all(agent.current for agent in state.agents.values())
        assert all(content.current for content in state.containers.values())


def test_in_control_mode_an_agent_stands_at_its_last_seen_pose():
    world, nest = corner()
    world.place_agent("sally", EAST)
    belief = nest["/observer"]
    belief.switch("try")
    sally = belief.state.agents["sally"]
    assert (sally.position, sally.current) == (MEETING, True)


def test_in_control_mode_an_agent_of_unknown_pose_is_not_there():
    _, nest = corner(THREE | {"sally": EAST})
    belief = nest["/observer"]
    belief.switch("try")
    assert belief.state.agents["sally"].position is None
    with pytest.raises(WorldError, match="sally"):
        belief.scripted.say("sally", "here")


def test_agents_of_a_controlled_simulator_keep_what_they_believed_at_the_fork():
    world, nest = corner()
    world.place_agent("sally", EAST)
    world.open("observer", CHEST)
    before = everything(nest["/observer/sally"].state)
    nest["/observer"].switch("try")
    assert everything(nest["/observer/sally"].state) == before
    assert nest["/observer/sally"].tick == 2


def test_children_of_a_controlled_simulator_follow_it():
    world, nest = corner()
    world.place_agent("sally", EAST)
    belief = nest["/observer"]
    belief.switch("try")
    belief.scripted.place_agent("anne", (4.5, 0, 4.5))
    assert nest["/observer/sally"].mode == "follow"
    anne = nest["/observer/sally"].state.agents["anne"]
    assert (anne.position, anne.current) == ((4.5, 0, 4.5), True)
    assert nest["/observer/sally/anne"].tick == 2


def test_the_first_frame_makes_stale_elements_current_for_the_children_too():
    """At its last seen pose Sally stands in the controlled belief, and sees there."""
    world, nest = corner()
    world.place_agent("sally", EAST)
    belief = nest["/observer"]
    belief.switch("try")
    belief.scripted.say("observer", "hello")
    sally = nest["/observer/sally"].state
    assert sally.agents["sally"].current
    assert sally.agents["anne"].current
    assert sally.blocks.current(CHEST)


def test_nothing_done_in_control_mode_reaches_the_parents_or_the_siblings():
    _, nest = corner()
    outside = [path for path in ALL if not path.startswith("/observer")]
    before = [everything(nest[path].state) for path in outside]
    belief = nest["/observer"]
    belief.switch("try")
    belief.scripted.set_block((2, 0, 4), "stone")
    belief.scripted.place_agent("anne", WEST)
    belief.scripted.say("sally", "hello")
    assert [everything(nest[path].state) for path in outside] == before


def test_in_control_mode_the_parent_does_not_write():
    world, nest = corner()
    nest["/observer"].switch("try")
    before = [everything(nest[path].state) for path in ("/observer", "/observer/sally")]
    world.deposit("anne", CHEST, {"diamond": 1})
    world.say("sally", "hello")
    assert [everything(nest[path].state) for path in ("/observer", "/observer/sally")] == before
    assert nest["/observer"].tick == 0


def test_follow_catches_up_with_the_parent():
    world, nest = corner()
    other_world, other = corner()
    belief = nest["/observer"]
    belief.switch("try")
    belief.scripted.set_block((2, 0, 4), "stone")
    for scene in (world, other_world):
        scene.place_agent("sally", EAST)
        scene.deposit("anne", CHEST, {"diamond": 1})
    belief.switch("follow")
    assert (belief.mode, belief.tick) == ("follow", 2)
    for path in ALL:
        assert everything(nest[path].state) == everything(other[path].state)


def test_a_known_name_restores_the_latest_state_of_the_branch_in_the_world_too():
    _, nest = corner()
    belief = nest["/observer"]
    belief.switch("one")
    belief.scripted.place_agent("anne", WEST)
    kept = [everything(nest[path].state) for path in ("/observer", "/observer/anne")]
    belief.switch("follow")
    belief.switch("two")
    belief.scripted.place_agent("anne", EAST)
    belief.switch("one")
    assert belief.tick == 1
    assert [everything(nest[path].state) for path in ("/observer", "/observer/anne")] == kept
    assert belief.scripted.snapshot().agents["anne"].position == WEST
    belief.scripted.say("anne", "on")
    assert belief.state.chat == [(2, "anne", "on")]


def test_a_branch_of_a_branch_goes_on_from_it():
    _, nest = corner()
    belief = nest["/observer"]
    belief.switch("one")
    belief.scripted.place_agent("anne", WEST)
    belief.switch("two")
    assert belief.state.agents["anne"].position == WEST
    belief.scripted.place_agent("anne", EAST)
    belief.switch("one")
    assert belief.state.agents["anne"].position == WEST
    assert [info.key.branch for info in belief.branches()] == ["one", "two"]


def test_a_fork_at_a_past_tick_begins_there():
    world, nest = corner()
    world.place_agent("anne", WEST)
    world.place_agent("anne", MEETING)
    belief = nest["/observer"]
    belief.switch("past", at=1)
    assert belief.tick == 1
    assert belief.state.agents["anne"].position == WEST


def test_the_real_world_can_fork_and_go_back():
    world, nest = corner()
    world.place_agent("anne", WEST)
    nest["/"].switch("what-if")
    world.place_agent("anne", EAST)
    assert nest["/observer"].state.agents["anne"].position == WEST
    nest["/"].switch("main")
    assert nest["/"].state.agents["anne"].position == WEST
    assert world.snapshot().agents["anne"].position == WEST


def test_a_deeper_simulator_may_be_in_control_alone():
    world, nest = corner()
    deeper = nest["/observer/sally"]
    deeper.switch("try")
    world.place_agent("anne", WEST)
    assert nest["/observer"].state.agents["anne"].position == WEST
    assert deeper.state.agents["anne"].position == GAP
    deeper.scripted.place_agent("anne", MEETING)
    assert nest["/observer/sally/anne"].state.agents["anne"].position == MEETING
    assert nest["/observer"].state.agents["anne"].position == WEST


def test_incomplete_contents_stay_incomplete_in_control_mode():
    _, nest = corner()
    belief = nest["/observer"]
    belief.switch("try")
    belief.scripted.open("sally", CHEST)
    assert not belief.state.containers[CHEST].complete
    held = nest["/observer/sally"].state.containers[CHEST]
    assert (held.items, held.complete) == ({}, False)


@pytest.mark.parametrize("asked_early", [True, False])
def test_it_does_not_matter_when_a_node_below_a_fork_is_asked_for(asked_early):
    world, nest = corner()
    reference_world, reference = corner()
    paths = ["/observer/sally", "/observer/sally/anne", "/observer/anne"]
    if asked_early:
        _ = [reference[path].state for path in paths]
    for scene, tree in ((world, nest), (reference_world, reference)):
        scene.place_agent("sally", EAST)
        tree["/observer"].switch("try")
        tree["/observer"].scripted.place_agent("anne", WEST)
        tree["/observer"].scripted.step(2)
        tree["/observer"].scripted.set_block((2, 0, 4), "stone")
    for path in paths:
        assert everything(nest[path].state) == everything(reference[path].state)


def test_unknown_blocks_stay_unknown_in_control_mode_and_are_air_in_its_world():
    _, nest = nest_of({"a": WEST, "b": EAST}, CLOSED | {(9, 0, 1): "bricks"})
    belief = nest["/a"]
    belief.switch("try")
    belief.scripted.say("a", "hello")
    assert belief.state.blocks[9, 0, 1] is None
    assert belief.scripted.snapshot().blocks[9, 0, 1] == 0


@pytest.mark.parametrize("tick", [1.0, 1.5, "1", True, -1, 9])
def test_what_is_no_past_tick_is_refused(tick):
    world, nest = corner()
    world.step(3)
    with pytest.raises(TickError):
        nest["/observer"].switch("past", at=tick)
    with pytest.raises(TickError):
        nest.at(tick)
    assert nest["/observer"].branches() == ()
    nest["/observer"].switch("past", at=np.int64(2))
    assert nest.at(np.int64(2))["/"].tick == nest["/observer"].tick == 2


@pytest.mark.parametrize("ticks", [-1, 1.5, "2", None, True, 10**9])
def test_what_is_no_number_of_ticks_is_refused(ticks):
    _, nest = corner()
    with pytest.raises(InputError, match="cannot pass"):
        nest["/"].step(ticks)
    assert nest.tick == 0


def test_follow_goes_on_with_the_present_alone():
    world, nest = corner()
    world.step(3)
    nest["/observer"].switch("try")
    with pytest.raises(BranchError, match="present"):
        nest["/observer"].switch("follow", at=1)
    assert nest["/observer"].branch == "try"


def test_a_description_is_a_text():
    _, nest = corner()
    with pytest.raises(InputError, match="text"):
        nest["/"].describe("main", None)
