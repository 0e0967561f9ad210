"""Presence: agents that are credited with seeing, and its limits (semantics, 5.1 to 5.4)."""

from tests.nest.places import CHEST, CLOSED, CORNER, EAST, GAP, MEETING, WEST, nest_of, wall

THREE = {"observer": WEST, "sally": MEETING, "anne": GAP}


def corner(**options):
    return nest_of(
        THREE, CORNER, chests={CHEST: {}}, inventories={"anne": {"diamond": 1}}, **options
    )


def items(nest, path, position=CHEST):
    held = nest[path].state.containers.get(position)
    return None if held is None else held.items


def test_5_1_everyone_is_present_in_the_real_world():
    world, nest = nest_of({"a": WEST, "b": EAST}, CLOSED)
    world.step(3)
    assert all(agent.current for agent in nest["/"].state.agents.values())


def test_5_1_the_holder_is_present_in_its_own_belief_while_seen():
    _, nest = corner()
    assert nest["/observer"].state.agents["observer"].current
    assert nest["/observer/sally"].state.agents["sally"].current
    assert nest["/observer/sally/anne"].state.agents["anne"].current


def test_5_1_the_holder_of_a_deeper_belief_is_not_present_there_when_out_of_sight():
    world, nest = corner()
    world.place_agent("sally", EAST)
    assert not nest["/observer"].state.agents["sally"].current
    sally = nest["/observer/sally"].state.agents["sally"]
    assert (sally.position, sally.current) == (MEETING, False)


def test_5_2_who_is_not_present_is_credited_with_nothing_new():
    world, nest = corner()
    world.place_agent("sally", EAST)
    world.deposit("anne", CHEST, {"diamond": 1})
    assert items(nest, "/sally") == {"diamond": 1}
    assert items(nest, "/observer") == {"diamond": 1}
    assert items(nest, "/observer/sally") == {}
    assert nest["/observer/sally"].state.events == ()


def test_5_2_nothing_is_current_for_who_is_not_present():
    world, nest = corner(containers="transparent")
    before = nest["/observer/sally"].state
    assert before.blocks.current(CHEST)
    assert before.containers[CHEST].current
    assert before.agents["anne"].current
    world.place_agent("sally", EAST)
    after = nest["/observer/sally"].state
    assert not any(after.blocks.current(position) for position in after.blocks)
    assert not after.containers[CHEST].current
    assert not any(agent.current for agent in after.agents.values())


def test_5_2_what_was_believed_stays_as_it_was():
    world, nest = corner()
    before = nest["/observer/sally"].state
    world.place_agent("sally", EAST)
    world.place_agent("anne", EAST)
    world.set_block(CHEST, "air")
    after = nest["/observer/sally"].state
    assert after.blocks == before.blocks
    assert after.agents["anne"].position == before.agents["anne"].position == GAP
    assert after.agents["anne"].basis == before.agents["anne"].basis


def test_5_2_below_who_is_not_present_nobody_is():
    world, nest = corner()
    world.place_agent("sally", EAST)
    world.deposit("anne", CHEST, {"diamond": 1})
    assert items(nest, "/observer/sally/anne") == {}
    assert not nest["/observer/sally"].state.agents["anne"].current


def test_5_2_who_comes_back_into_sight_is_credited_again():
    world, nest = corner()
    world.place_agent("sally", EAST)
    world.place_agent("sally", MEETING)
    world.deposit("anne", CHEST, {"diamond": 1})
    assert items(nest, "/observer/sally") == {"diamond": 1}


def test_5_2_a_stale_pose_that_is_seen_makes_nobody_present():
    world, nest = corner()
    world.place_agent("sally", EAST)
    believed = nest["/observer/anne"].state.agents["sally"]
    assert (believed.position, believed.current) == (MEETING, False)
    world.deposit("anne", CHEST, {"diamond": 1})
    assert items(nest, "/observer/anne") == {"diamond": 1}
    assert items(nest, "/observer/anne/sally") == {}


SCREEN = {(x, y, 5): "stone" for x in (4, 5, 6) for y in range(3)}
PILLAR = wall([10])
BEHIND_THE_SCREEN = (5.5, 0.0, 0.5)
FAR_CHEST = (10, 0, 10)
ALONG_THE_ROW = {"observer": BEHIND_THE_SCREEN, "sally": (0.5, 0, 10.5), "anne": (9.5, 0, 10.5)}


def row(agents, blocks):
    """Sally and Anne in one row, a screen before its middle, where a pillar may stand."""
    return nest_of(agents, blocks, chests={FAR_CHEST: {}}, inventories={"anne": {"diamond": 1}})


def test_5_3_an_unknown_wall_hides_nothing_in_a_belief():
    world, nest = row(ALONG_THE_ROW, SCREEN | PILLAR)
    world.deposit("anne", FAR_CHEST, {"diamond": 1})
    assert nest["/observer"].state.blocks[5, 0, 10] is None
    assert items(nest, "/sally", FAR_CHEST) is None
    assert items(nest, "/observer", FAR_CHEST) == {"diamond": 1}
    assert items(nest, "/observer/sally", FAR_CHEST) == {"diamond": 1}


def test_5_3_a_remembered_wall_hides_in_a_belief_what_it_no_longer_hides():
    world, nest = row(ALONG_THE_ROW | {"observer": (1.5, 0, 7.5)}, SCREEN | PILLAR)
    world.place_agent("observer", BEHIND_THE_SCREEN)
    with world.tick():
        for position in PILLAR:
            world.set_block(position, "air")
    world.deposit("anne", FAR_CHEST, {"diamond": 1})
    assert nest["/observer"].state.blocks[5, 0, 10] == "stone"
    assert items(nest, "/sally", FAR_CHEST) == {"diamond": 1}
    assert items(nest, "/observer", FAR_CHEST) == {"diamond": 1}
    assert items(nest, "/observer/sally", FAR_CHEST) is None


def test_5_3_an_agent_sees_the_believed_pose_of_another():
    world, nest = corner()
    world.place_agent("sally", EAST)
    assert nest["/anne"].state.agents["sally"].position == EAST
    assert nest["/observer/anne"].state.agents["sally"].position == MEETING


def test_5_3_what_the_holder_did_not_perceive_the_other_is_not_credited_with():
    agents = {"observer": WEST, "sally": GAP, "anne": EAST}
    world, nest = nest_of(agents, CORNER, chests={CHEST: {}}, inventories={"anne": {"diamond": 1}})
    world.deposit("anne", CHEST, {"diamond": 1})
    assert items(nest, "/sally") == {"diamond": 1}
    assert items(nest, "/observer/sally") == {}
    assert nest["/observer/sally"].state.agents["anne"].position is None


SEEN_ONCE = (8, 0, 5)
"""A block that the observer, with a sight of 6 blocks, sees before it steps back."""


def stepped_back():
    """Let the observer see a block and Anne, step back, and only then meet Sally."""
    agents = {"observer": (4.5, 0, 5.5), "sally": (10.5, 0, 10.5), "anne": (8.5, 0, 6.5)}
    world, nest = nest_of(agents, {SEEN_ONCE: "oak_planks"}, max_visible_distance=6)
    world.place_agent("observer", (0.5, 0, 5.5))
    world.place_agent("sally", (5.5, 0, 5.5))
    return world, nest


def test_5_4_a_stale_block_is_handed_on_with_its_old_tick():
    _, nest = stepped_back()
    believed = nest["/observer/sally"].state.blocks
    assert believed[SEEN_ONCE] == "oak_planks"
    assert believed.basis(SEEN_ONCE).observed_at == 0
    assert not believed.current(SEEN_ONCE)
    assert nest["/sally"].state.blocks.basis(SEEN_ONCE).observed_at == 2
    assert nest["/sally"].state.blocks.current(SEEN_ONCE)


def test_5_4_a_stale_pose_is_handed_on_with_its_old_tick():
    _, nest = stepped_back()
    anne = nest["/observer/sally"].state.agents["anne"]
    assert (anne.position, anne.current, anne.basis.observed_at) == ((8.5, 0, 6.5), False, 0)


def test_5_4_a_current_element_is_handed_on_as_current():
    _, nest = stepped_back()
    blocks = nest["/observer/sally"].state.blocks
    assert blocks.current((3, 0, 5))
    assert blocks.basis((3, 0, 5)).observed_at == 2
    assert nest["/observer/sally"].state.agents["observer"].current


def test_5_4_an_unknown_block_is_not_handed_on():
    _, nest = stepped_back()
    assert nest["/observer"].state.blocks[9, 0, 9] is None
    assert nest["/sally"].state.blocks[9, 0, 9] == "air"
    assert nest["/observer/sally"].state.blocks[9, 0, 9] is None
    assert nest["/observer/sally"].state.blocks.basis((9, 0, 9)) is None


def test_2_introspection_an_agent_knows_its_own_beliefs():
    _, nest = corner()
    assert nest["/sally/sally/anne/anne/"].path == "/sally/anne"
    assert nest["/sally/sally"].state == nest["/sally"].state


def test_2_unknown_is_not_air():
    _, nest = nest_of({"a": WEST, "b": EAST}, CLOSED)
    state = nest["/a"].state
    assert state.blocks[8, 0, 1] is None
    assert state.blocks[2, 0, 1] == "air"
    assert (state.agents["b"].position, state.agents["b"].basis) == (None, None)
