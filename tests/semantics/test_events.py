"""Perceived events, and the ticks at which perception is evaluated (semantics, section 3)."""

import pytest
from tests.nest.comparing import values
from tests.nest.places import CHEST, CLOSED, CORNER, EAST, GAP, MEETING, WEST, nest_of

from beliefnest.world.values import EventKind

THREE = {"a": WEST, "b": MEETING, "c": EAST}


def seen(nest, path):
    return [(event.tick, event.kind, event.actor) for event in nest[path].state.events]


def test_an_action_is_seen_if_the_actor_is_seen():
    world, nest = nest_of(THREE, CORNER, chests={CHEST: {"diamond": 1}})
    world.withdraw("b", CHEST, {"diamond": 1})
    expected = [(1, EventKind.GET_ITEM_FROM_CHEST, "b")]
    for path in ("/", "/a", "/b", "/a/b", "/b/a"):
        assert seen(nest, path) == expected


def test_an_action_is_not_seen_if_the_actor_is_not_seen():
    world, nest = nest_of(THREE, CORNER, chests={CHEST: {"diamond": 1}})
    world.withdraw("c", CHEST, {"diamond": 1})
    assert seen(nest, "/c") == [(1, EventKind.GET_ITEM_FROM_CHEST, "c")]
    for path in ("/a", "/a/c", "/c/a", "/a/b"):
        assert seen(nest, path) == []


def test_the_visible_part_of_an_action_is_delivered():
    world, nest = nest_of(THREE, CORNER, chests={CHEST: {"diamond": 1, "emerald": 5}})
    world.withdraw("b", CHEST, {"diamond": 1})
    (event,) = nest["/a"].state.events
    assert dict(event.detail) == {"position": CHEST, "items": {"diamond": 1}}


def test_a_block_update_is_seen_if_its_position_is_seen():
    world, nest = nest_of(THREE, CORNER)
    world.set_block((2, 0, 4), "stone")
    world.set_block((8, 0, 4), "stone")
    assert seen(nest, "/a") == seen(nest, "/a/b") == [(1, EventKind.BLOCK_UPDATE, None)]
    assert seen(nest, "/c") == [(2, EventKind.BLOCK_UPDATE, None)]


def test_a_block_update_by_an_unseen_actor_is_seen():
    world, nest = nest_of({"a": WEST, "c": EAST}, CORNER)
    world.set_block(CHEST, "stone", actor="c")
    assert seen(nest, "/a") == [(1, EventKind.BLOCK_UPDATE, "c")]
    assert nest["/a"].state.agents["c"].position is None


def test_a_gift_is_two_actions_each_seen_with_its_actor():
    world, nest = nest_of(THREE, CORNER, inventories={"b": {"diamond": 1}})
    world.give("b", "c", {"diamond": 1})
    assert seen(nest, "/a") == [(1, EventKind.GIVE_ITEM_TO_OTHER, "b")]
    assert seen(nest, "/c") == [(1, EventKind.RECEIVE_ITEM_FROM_OTHER, "c")]


@pytest.mark.parametrize(("first", "then"), [(EAST, MEETING), (MEETING, EAST)])
def test_perception_is_of_the_state_after_everything_in_the_tick(first, then):
    """B moves and acts in one tick: it is seen to act iff it is seen afterwards."""
    agents = {"a": WEST, "b": first}
    world, nest = nest_of(agents, CORNER, chests={CHEST: {"diamond": 1}})
    with world.tick():
        world.withdraw("b", CHEST, {"diamond": 1})
        world.place_agent("b", then)
    assert (len(seen(nest, "/a")) == 1) == (then == MEETING)


def test_quiet_ticks_change_nothing():
    world, nest = nest_of(THREE, CORNER)
    world.place_agent("b", GAP)
    before = {path: nest[path].state for path in ("/", "/a", "/a/b")}
    world.step(5)
    for path, state in before.items():
        after = nest[path].state
        assert (after.tick, state.tick) == (6, 1)
        assert values(after) == values(state)
        for name, agent in after.agents.items():
            assert agent.current == state.agents[name].current
            assert agent.basis is None or not agent.current or agent.basis.observed_at == 6


def test_blocks_the_user_lists_are_transparent():
    _, hidden = nest_of({"a": WEST, "b": EAST}, CLOSED)
    _, shown = nest_of({"a": WEST, "b": EAST}, CLOSED, transparent_blocks=["stone"])
    assert hidden["/a"].state.agents["b"].position is None
    assert shown["/a"].state.agents["b"].position == EAST


@pytest.mark.parametrize(("distance", "sees"), [(6.1, True), (5.9, False)])
def test_sight_ends_at_the_greatest_visible_distance(distance, sees):
    agents = {"a": (2.5, 0, 1.5), "b": (8.5, 0, 1.5)}
    _, nest = nest_of(agents, max_visible_distance=distance)
    assert nest["/a"].state.agents["b"].current == sees


def test_agents_do_not_block_sight():
    agents = {"a": (0.5, 0, 1.5), "b": (4.5, 0, 1.5), "c": (8.5, 0, 1.5)}
    _, nest = nest_of(agents)
    assert nest["/a"].state.agents["c"].current
