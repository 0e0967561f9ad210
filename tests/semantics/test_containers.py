"""Beliefs about the contents of containers (semantics, section 4)."""

import pytest
from tests.nest.places import CHEST, CLOSED, CORNER, EAST, GAP, MEETING, WEST, nest_of

import beliefnest as bn
from beliefnest.world.values import EventKind

NEAR = (4, 0, 5)
AGENTS = {"a": (2.5, 0, 5.5), "b": (4.5, 0, 7.5)}


def room(content=None, **options):
    """Two agents who see each other and a chest; b has 9 diamonds."""
    return nest_of(
        AGENTS,
        chests={NEAR: content or {}},
        inventories={"b": {"diamond": 9}},
        **options,
    )


def content(nest, path, position=NEAR):
    """Known items and completeness; None if no container is known there."""
    belief = nest[path].state.containers.get(position)
    return None if belief is None else (dict(belief.items), belief.complete)


def knows(path, items, *, complete):
    return bn.InitialBelief(path, containers={NEAR: (items, complete)})


def test_of_a_container_seen_for_the_first_time_nothing_is_known():
    _, nest = room({"emerald": 1})
    assert content(nest, "/") == ({"emerald": 1}, True)
    assert content(nest, "/a") == content(nest, "/a/b") == ({}, False)


def test_of_a_container_never_seen_there_is_no_entry():
    _, nest = nest_of({"a": WEST, "b": EAST}, CLOSED, chests={(9, 0, 1): {}})
    assert content(nest, "/a", (9, 0, 1)) is None
    assert content(nest, "/b", (9, 0, 1)) == ({}, False)


@pytest.mark.parametrize("block", ["chest", "trapped_chest", "barrel", "furnace"])
def test_every_kind_of_container_has_contents(block):
    world, nest = nest_of(AGENTS, {NEAR: block}, chests={NEAR: {"emerald": 1}})
    world.open("a", NEAR)
    assert content(nest, "/a") == ({"emerald": 1}, True)


def test_opening_makes_contents_complete():
    world, nest = room({"emerald": 1})
    world.open("a", NEAR)
    entry = nest["/a"].state.containers[NEAR]
    assert (entry.items, entry.complete, entry.current) == ({"emerald": 1}, True, True)
    assert (entry.basis.observed_at, entry.basis.event) == (1, EventKind.OPEN_CONTAINER)


def test_an_empty_container_that_was_opened_is_known_to_be_empty():
    world, nest = room()
    world.open("a", NEAR)
    assert content(nest, "/a") == ({}, True)


def test_seeing_another_open_shows_that_it_did_and_not_what_is_inside():
    world, nest = room({"emerald": 1})
    world.open("b", NEAR)
    assert content(nest, "/a") == ({}, False)
    assert [(e.kind, e.actor) for e in nest["/a"].state.events] == [(EventKind.OPEN_CONTAINER, "b")]


def test_opening_inside_a_belief_learns_no_more_than_that_belief():
    world, nest = room({"emerald": 1})
    world.open("b", NEAR)
    assert content(nest, "/b") == ({"emerald": 1}, True)
    assert content(nest, "/a/b") == ({}, False)


def test_opening_inside_a_belief_learns_all_that_belief_holds():
    world, nest = room({"emerald": 1})
    world.open("a", NEAR)
    assert content(nest, "/a/b") == ({}, False)
    world.open("b", NEAR)
    assert content(nest, "/a/b") == ({"emerald": 1}, True)
    assert content(nest, "/a/b/a") == ({}, False)


def test_what_is_learned_from_a_stale_content_is_stale_itself():
    """A last looked in at tick 1; that b looks in at 2 is no perception of the content by a."""
    world, nest = room({"emerald": 1})
    world.open("a", NEAR)
    world.open("b", NEAR)
    learned = nest["/a/b"].state.containers[NEAR]
    assert (learned.current, learned.basis.observed_at) == (False, 1)


@pytest.mark.parametrize("complete", [True, False])
def test_a_witnessed_deposit_adds_and_leaves_completeness(complete):
    world, nest = room(
        {"emerald": 1}, initial_beliefs=[knows(("a",), {"emerald": 1}, complete=complete)]
    )
    world.deposit("b", NEAR, {"diamond": 2})
    assert content(nest, "/a") == ({"emerald": 1, "diamond": 2}, complete)


@pytest.mark.parametrize("complete", [True, False])
def test_a_witnessed_withdrawal_subtracts_and_leaves_completeness(complete):
    prior = knows(("a",), {"emerald": 3}, complete=complete)
    world, nest = room({"emerald": 3}, initial_beliefs=[prior])
    world.withdraw("b", NEAR, {"emerald": 1})
    assert content(nest, "/a") == ({"emerald": 2}, complete)


@pytest.mark.parametrize(("believed", "left"), [({}, {}), ({"emerald": 1}, {})])
def test_a_witnessed_withdrawal_takes_nothing_below_0(believed, left):
    prior = knows(("a",), believed, complete=False)
    world, nest = room({"emerald": 3}, initial_beliefs=[prior])
    world.withdraw("b", NEAR, {"emerald": 2})
    assert content(nest, "/a") == (left, False)
    world.deposit("b", NEAR, {"emerald": 1})
    assert content(nest, "/a") == ({"emerald": 1}, False)


def test_a_witnessed_move_is_current_in_its_tick_only():
    world, nest = room()
    world.deposit("b", NEAR, {"diamond": 1})
    entry = nest["/a"].state.containers[NEAR]
    assert entry.current
    assert (entry.basis.observed_at, entry.basis.event) == (1, EventKind.DEPOSIT_ITEM_INTO_CHEST)
    world.place_agent("b", (4.5, 0, 8.5))
    entry = nest["/a"].state.containers[NEAR]
    assert (entry.current, entry.basis.observed_at) == (False, 1)


def test_who_moves_items_learns_the_whole_content():
    world, nest = room({"emerald": 1})
    world.deposit("b", NEAR, {"diamond": 2})
    assert content(nest, "/b") == ({"emerald": 1, "diamond": 2}, True)
    assert content(nest, "/a") == ({"diamond": 2}, False)


def test_who_moves_items_in_a_belief_learns_what_that_belief_holds():
    world, nest = room(
        {"emerald": 1}, initial_beliefs=[knows(("a",), {"emerald": 1}, complete=True)]
    )
    world.deposit("b", NEAR, {"diamond": 2})
    assert content(nest, "/a/b") == ({"emerald": 1, "diamond": 2}, True)
    assert content(nest, "/b/a") == ({"diamond": 2}, False)


def test_the_order_of_moves_in_one_tick_counts():
    world, nest = room()
    with world.tick():
        world.deposit("b", NEAR, {"diamond": 2})
        world.withdraw("b", NEAR, {"diamond": 1})
    assert content(nest, "/a") == ({"diamond": 1}, False)


def test_items_are_seen_to_move_without_the_container_being_seen():
    """Behind the wall's gap b is seen, and the chest beside the wall is not."""
    hidden = (6, 0, 4)
    world, nest = nest_of(
        {"a": WEST, "b": GAP}, CORNER, chests={hidden: {}}, inventories={"b": {"diamond": 1}}
    )
    world.deposit("b", hidden, {"diamond": 1})
    assert nest["/a"].state.blocks[hidden] is None
    assert content(nest, "/a", hidden) == ({"diamond": 1}, False)


def test_a_move_by_an_unseen_agent_is_not_noticed_though_the_container_is_seen():
    world, nest = nest_of(
        {"a": WEST, "b": EAST}, CORNER, chests={CHEST: {}}, inventories={"b": {"diamond": 1}}
    )
    world.deposit("b", CHEST, {"diamond": 1})
    assert nest["/a"].state.blocks.current(CHEST)
    assert content(nest, "/a", CHEST) == ({}, False)
    assert content(nest, "/b", CHEST) == ({"diamond": 1}, True)


@pytest.mark.parametrize("block", ["air", "stone"])
def test_a_container_is_forgotten_when_its_block_is_seen_replaced(block):
    world, nest = room({"emerald": 1})
    world.open("a", NEAR)
    world.set_block(NEAR, block)
    assert content(nest, "/a") is None
    world.set_block(NEAR, "chest")
    assert content(nest, "/a") == ({}, False)


def test_a_container_seen_replaced_by_one_of_another_kind_is_forgotten():
    world, nest = room({"emerald": 1})
    world.open("a", NEAR)
    world.set_block(NEAR, "barrel")
    assert content(nest, "/a") == ({}, False)


def test_a_move_into_a_container_seen_gone_in_the_same_tick_leaves_no_entry():
    world, nest = room()
    with world.tick():
        world.deposit("b", NEAR, {"diamond": 1})
        world.set_block(NEAR, "air")
    assert content(nest, "/a") is None


def test_a_container_replaced_unseen_is_remembered_until_its_place_is_seen():
    world, nest = nest_of({"a": MEETING}, chests={CHEST: {"emerald": 1}}, max_visible_distance=6)
    world.open("a", CHEST)
    world.place_agent("a", (0.5, 0, 0.5))
    world.set_block(CHEST, "air")
    assert content(nest, "/a", CHEST) == ({"emerald": 1}, True)
    world.place_agent("a", MEETING)
    assert content(nest, "/a", CHEST) is None


def test_transparent_contents_are_perceived_while_the_block_is_seen():
    world, nest = room({"emerald": 1}, containers="transparent")
    assert content(nest, "/a") == content(nest, "/a/b") == ({"emerald": 1}, True)
    assert nest["/a/b"].state.containers[NEAR].current
    world.deposit("b", NEAR, {"diamond": 2})
    assert content(nest, "/a/b/a") == ({"emerald": 1, "diamond": 2}, True)


def test_transparent_contents_are_not_perceived_while_the_block_is_not_seen():
    world, nest = nest_of(
        {"a": MEETING, "b": EAST},
        chests={CHEST: {}},
        inventories={"b": {"diamond": 1}},
        containers="transparent",
        max_visible_distance=6,
    )
    world.place_agent("a", (0.5, 0, 0.5))
    world.deposit("b", CHEST, {"diamond": 1})
    assert content(nest, "/a", CHEST) == ({}, True)
    assert not nest["/a"].state.containers[CHEST].current
    world.place_agent("a", MEETING)
    assert content(nest, "/a", CHEST) == ({"diamond": 1}, True)


def test_transparent_stale_contents_are_handed_on_as_stale():
    agents = {"a": (4.5, 0, 5.5), "b": (10.5, 0, 10.5)}
    far = (8, 0, 5)
    world, nest = nest_of(
        agents, chests={far: {"emerald": 1}}, containers="transparent", max_visible_distance=6
    )
    world.place_agent("a", (0.5, 0, 5.5))
    world.place_agent("b", (5.5, 0, 5.5))
    entry = nest["/a/b"].state.containers[far]
    assert (entry.items, entry.complete) == ({"emerald": 1}, True)
    assert (entry.current, entry.basis.observed_at) == (False, 0)
