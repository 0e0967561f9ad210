"""Changes by hand, and what the nodes below make of them (semantics, section 6)."""

import pytest
from tests.nest.comparing import everything
from tests.nest.places import CHEST, CORNER, EAST, GAP, MEETING, WEST, nest_of
from tests.semantics.stories import REGISTRY

import beliefnest as bn
from beliefnest.belief.grounds import Source
from beliefnest.errors import InputError, PositionError, UnknownNameError

THREE = {"observer": WEST, "sally": MEETING, "anne": GAP}
PLACE = (8, 0, 1)
"""Out of the observer's sight."""


def corner():
    return nest_of(THREE, CORNER, chests={CHEST: {"emerald": 1}})


def test_an_edit_changes_blocks_and_contents_of_one_belief_and_of_those_below():
    _, nest = corner()
    outside = ["/", "/sally", "/sally/observer", "/anne"]
    before = [everything(nest[path].state) for path in outside]
    nest["/observer"].edit(blocks={PLACE: "stone"}, containers={CHEST: {"apple": 2}})
    state = nest["/observer"].state
    assert state.blocks[PLACE] == "stone"
    assert (state.containers[CHEST].items, state.containers[CHEST].complete) == ({"apple": 2}, True)
    assert [everything(nest[path].state) for path in outside] == before


def test_an_edit_in_follow_mode_is_stale_and_says_that_it_was_an_edit():
    world, nest = corner()
    world.step(4)
    nest["/observer"].edit(blocks={PLACE: "stone"}, containers={CHEST: {"apple": 2}})
    state = nest["/observer"].state
    for basis in (state.blocks.basis(PLACE), state.containers[CHEST].basis):
        assert (basis.source, basis.observed_at) == (Source.EDITED, 4)
    assert not state.blocks.current(PLACE)
    assert not state.containers[CHEST].current


def test_an_edit_in_follow_mode_lasts_until_the_place_is_perceived():
    world, nest = corner()
    nest["/observer"].edit(blocks={PLACE: "stone", (2, 0, 3): "stone"})
    world.say("anne", "hello")
    assert nest["/observer"].state.blocks[PLACE] == "stone"
    assert nest["/observer"].state.blocks[2, 0, 3] == "air"


def test_children_see_an_edited_block_where_they_are_credited_with_sight():
    """Sally sees the place in the belief; Anne does not."""
    _, nest = nest_of(THREE | {"anne": (2.5, 0, 2.5), "sally": GAP}, CORNER)
    place = (6, 0, 5)
    assert nest["/observer"].state.blocks[place] is None
    nest["/observer"].edit(blocks={place: "bricks"})
    handed = nest["/observer/sally"].state.blocks
    assert (handed[place], handed.current(place)) == ("bricks", False)
    assert handed.basis(place).source is Source.EDITED
    assert nest["/observer/anne"].state.blocks[place] is None
    assert nest["/sally"].state.blocks[place] == "air"


def test_children_do_not_learn_edited_contents_before_they_look_in():
    world, nest = corner()
    nest["/observer"].edit(containers={CHEST: {"apple": 2}})
    assert nest["/observer/sally"].state.containers[CHEST].items == {}
    world.open("sally", CHEST)
    held = nest["/observer/sally"].state.containers[CHEST]
    assert (held.items, held.complete) == ({"apple": 2}, True)


def test_an_edit_of_a_deeper_belief_leaves_the_shallower_one_alone():
    _, nest = corner()
    before = everything(nest["/observer"].state)
    nest["/observer/sally"].edit(containers={CHEST: {"apple": 2}})
    assert nest["/observer/sally"].state.containers[CHEST].items == {"apple": 2}
    assert everything(nest["/observer"].state) == before


def test_an_edit_takes_no_tick_and_is_in_the_past_of_later_ticks_only():
    world, nest = corner()
    world.step(2)
    nest["/observer"].edit(blocks={PLACE: "stone"})
    assert nest.tick == nest["/observer"].tick == 2
    assert nest.at(1)["/observer"].state.blocks[PLACE] is None
    assert nest.at(2)["/observer"].state.blocks[PLACE] == "stone"


def test_an_edit_in_control_mode_is_current_and_in_the_world():
    _, nest = corner()
    belief = nest["/observer"]
    belief.switch("try")
    belief.edit(blocks={(2, 0, 4): "stone"}, containers={CHEST: {"apple": 2}})
    assert belief.state.blocks.current((2, 0, 4))
    assert belief.state.containers[CHEST].current
    belief.scripted.withdraw("sally", CHEST, {"apple": 1})
    assert belief.state.containers[CHEST].items == {"apple": 1}
    assert nest["/observer/sally"].state.containers[CHEST].items == {"apple": 1}
    belief.switch("follow")
    assert belief.state.containers[CHEST].items == {}


def test_an_edit_of_the_real_world_is_real():
    world, nest = corner()
    nest["/"].edit(blocks={(2, 0, 4): "stone"}, containers={CHEST: {"apple": 2}})
    assert nest["/observer"].state.blocks[2, 0, 4] == "stone"
    assert nest["/observer"].state.blocks.current((2, 0, 4))
    world.withdraw("anne", CHEST, {"apple": 2})
    assert nest["/anne"].state.containers[CHEST].items == {}


def test_an_edit_can_make_a_block_unknown_and_forgets_its_content():
    world, nest = corner()
    world.open("observer", CHEST)
    nest["/observer"].edit(blocks={CHEST: None})
    state = nest["/observer"].state
    assert state.blocks[CHEST] is None
    assert state.blocks.basis(CHEST) is None
    assert CHEST not in state.containers


def test_an_edited_node_asked_for_late_is_the_same():
    world, nest = corner()
    late_world, late = corner()
    for scene, tree in ((world, nest), (late_world, late)):
        if tree is nest:
            _ = [tree[p].state for p in ("/observer/sally", "/observer/sally/anne")]
        scene.place_agent("sally", EAST)
        tree["/observer"].edit(blocks={PLACE: "stone"}, containers={CHEST: {"apple": 2}})
        scene.place_agent("sally", MEETING)
        scene.open("sally", CHEST)
    for path in ("/observer", "/observer/sally", "/observer/sally/anne", "/sally"):
        assert everything(nest[path].state) == everything(late[path].state)


def test_wrong_edits_are_refused_and_change_nothing():
    _, nest = corner()
    before = everything(nest["/observer"].state)
    with pytest.raises(PositionError, match=r"99"):
        nest["/observer"].edit(blocks={(99, 0, 0): "stone"})
    with pytest.raises(PositionError):
        nest["/observer"].edit(containers={(0, -1, 0): {"apple": 1}})
    with pytest.raises(UnknownNameError, match="stoone"):
        nest["/observer"].edit(blocks={PLACE: "stoone"})
    with pytest.raises(UnknownNameError, match="appel"):
        nest["/observer"].edit(containers={CHEST: {"appel": 1}})
    with pytest.raises(InputError):
        nest["/observer"].edit(containers={CHEST: {"apple": 0}})
    assert everything(nest["/observer"].state) == before


def test_after_a_fork_only_those_below_an_edit_perceive_anew():
    """Sally sees the place, the observer only believes in a block there, until it is a world."""
    place, elsewhere = (6, 0, 5), {(3, 0, 3): "glass"}
    believed = bn.InitialBelief(("**",), blocks={place: REGISTRY.state_id("stone")})
    _, nest = nest_of(
        THREE | {"anne": (2.5, 0, 2.5), "sally": GAP}, CORNER, initial_beliefs=[believed]
    )
    nest["/observer"].switch("what if")
    for path in ("/observer/anne", "/observer/sally"):
        nest[path].edit(blocks=elsewhere)
        assert not nest["/observer/sally"].state.blocks.current(place)
    nest["/observer"].edit(blocks=elsewhere)
    assert nest["/observer/sally"].state.blocks.current(place)
