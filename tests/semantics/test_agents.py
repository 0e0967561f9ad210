"""Beliefs about agents: poses and possessions (semantics, section 4)."""

import math

import pytest
from tests.nest.places import CHEST, CLOSED, CORNER, EAST, GAP, MEETING, WEST, nest_of

AGENTS = {"a": (2.5, 0, 5.5), "b": (4.5, 0, 7.5), "c": (6.5, 0, 5.5)}
NEAR = (4, 0, 5)


def held(nest, path, name):
    return dict(nest[path].state.agents[name].inventory)


def test_a_seen_pose_is_taken_over_with_its_angles():
    world, nest = nest_of({"a": WEST, "b": MEETING})
    world.place_agent("b", GAP, yaw=1.0, pitch=0.5)
    seen = nest["/a"].state.agents["b"]
    assert (seen.position, seen.yaw, seen.pitch, seen.current) == (GAP, 1.0, 0.5, True)
    assert seen.basis.observed_at == 1


def test_a_last_seen_pose_is_kept():
    world, nest = nest_of({"a": WEST, "b": MEETING}, CORNER)
    world.place_agent("b", MEETING, yaw=1.0)
    world.place_agent("b", EAST, yaw=2.0)
    kept = nest["/a"].state.agents["b"]
    assert (kept.position, kept.yaw, kept.current) == (MEETING, 1.0, False)
    assert kept.basis.observed_at == 1


def test_equipment_is_seen_and_kept():
    from beliefnest import Nest, ScriptedWorld

    world = ScriptedWorld(
        ((0, 0, 0), (10, 2, 10)),
        CORNER,
        {"a": WEST, "b": MEETING, "c": EAST},
        equipment={"b": {"main_hand": "iron_axe"}},
    )
    nest = Nest(world)
    world.place_agent("b", EAST)
    assert nest["/a"].state.agents["b"].equipment == {"main_hand": "iron_axe"}
    assert nest["/a"].state.agents["c"].equipment is None


def test_an_agent_knows_its_own_possessions_and_nobody_else_does():
    _, nest = nest_of(AGENTS, inventories={"a": {"diamond": 2}})
    own = nest["/a"].state.agents["a"]
    assert (own.inventory, own.inventory_complete, own.health) == ({"diamond": 2}, True, 20)
    other = nest["/b"].state.agents["a"]
    assert (other.inventory, other.inventory_complete, other.health) == ({}, False, None)
    assert held(nest, "/b/a", "a") == {}


def test_a_witnessed_withdrawal_is_in_the_believed_hands():
    world, nest = nest_of(AGENTS, chests={NEAR: {"diamond": 3}})
    world.withdraw("b", NEAR, {"diamond": 2})
    for path in ("/b", "/a", "/a/b", "/b/a", "/a/b/c"):
        assert held(nest, path, "b") == {"diamond": 2}
    assert not nest["/a"].state.agents["b"].inventory_complete


def test_a_witnessed_deposit_leaves_the_believed_hands_and_not_below_0():
    world, nest = nest_of(AGENTS, chests={NEAR: {"diamond": 1}}, inventories={"b": {"diamond": 5}})
    world.withdraw("b", NEAR, {"diamond": 1})
    world.deposit("b", NEAR, {"diamond": 3})
    assert held(nest, "/b", "b") == {"diamond": 3}
    assert held(nest, "/a", "b") == held(nest, "/a/b", "b") == {}


def test_a_witnessed_gift_changes_both_believed_inventories():
    world, nest = nest_of(AGENTS, chests={NEAR: {"diamond": 2}})
    world.withdraw("b", NEAR, {"diamond": 2})
    world.give("b", "c", {"diamond": 1})
    for path in ("/a", "/a/b", "/c/b"):
        assert (held(nest, path, "b"), held(nest, path, "c")) == ({"diamond": 1}, {"diamond": 1})


def test_an_act_that_is_not_seen_changes_no_believed_inventory():
    world, nest = nest_of({"a": WEST, "b": EAST}, CORNER, chests={CHEST: {"diamond": 1}})
    world.withdraw("b", CHEST, {"diamond": 1})
    assert held(nest, "/b", "b") == {"diamond": 1}
    assert held(nest, "/a", "b") == {}


@pytest.mark.parametrize("negative_evidence", [True, False])
def test_a_place_seen_empty_makes_a_pose_unknown_only_with_negative_evidence(negative_evidence):
    agents = {"a": WEST, "b": GAP}
    world, nest = nest_of(agents, CORNER, negative_evidence=negative_evidence)
    world.place_agent("b", EAST)
    believed = nest["/a"].state.agents["b"]
    assert believed.position == (None if negative_evidence else GAP)
    assert not believed.current


def test_negative_evidence_needs_the_place_to_be_seen():
    agents = {"a": MEETING, "b": GAP}
    world, nest = nest_of(agents, CORNER, negative_evidence=True)
    world.place_agent("a", (4.5, 0, 0.5))
    world.place_agent("b", EAST)
    assert nest["/a"].state.agents["b"].position == GAP
    world.place_agent("a", MEETING)
    assert nest["/a"].state.agents["b"].position != GAP


def test_negative_evidence_keeps_the_believed_possessions():
    world, nest = nest_of(
        {"a": WEST, "b": GAP}, CORNER, chests={CHEST: {"diamond": 1}}, negative_evidence=True
    )
    world.withdraw("b", CHEST, {"diamond": 1})
    world.place_agent("b", EAST)
    assert held(nest, "/a", "b") == {"diamond": 1}


def test_negative_evidence_works_inside_beliefs_on_believed_poses():
    """Carl is not present for the observer: he cannot be credited with seeing the empty place."""
    agents = {"observer": WEST, "carl": MEETING, "anne": GAP}
    world, nest = nest_of(agents, CORNER, negative_evidence=True)
    world.place_agent("carl", EAST)
    world.place_agent("anne", (6.5, 0, 5.5))
    assert nest["/observer"].state.agents["anne"].position is None
    assert nest["/observer/carl"].state.agents["anne"].position == GAP


def test_nobody_is_seen_through_a_wall():
    _, nest = nest_of({"a": WEST, "b": EAST}, CLOSED)
    assert nest["/a"].state.agents["b"].position is None


@pytest.mark.parametrize(
    ("yaw", "seen"), [(0.0, "north"), (math.pi, "south"), (math.pi / 2, "west")]
)
def test_3_the_field_of_view_is_a_cone_around_yaw(yaw, seen):
    places = {"north": (5.5, 0, 1.5), "south": (5.5, 0, 9.5), "west": (1.5, 0, 5.5)}
    agents = {"me": (5.5, 0, 5.5), **places}
    world, nest = nest_of(agents, field_of_view=60)
    world.place_agent("me", agents["me"], yaw=yaw)
    current = {n for n, agent in nest["/me"].state.agents.items() if agent.current}
    assert current == {"me", seen}


def test_3_the_field_of_view_is_a_cone_around_pitch():
    world, nest = nest_of({"me": (5.5, 0, 9.5), "b": (5.5, 0, 1.5)}, field_of_view=60)
    assert nest["/me"].state.agents["b"].current
    world.place_agent("me", (5.5, 0, 9.5), yaw=0.0, pitch=math.pi / 2)
    assert not nest["/me"].state.agents["b"].current


def test_5_3_the_cone_of_another_is_that_of_its_believed_angles():
    """Anne turns away behind the observer's back: for it she still looks at Carl."""
    agents = {"observer": (5.5, 0, 5.5), "anne": (5.5, 0, 1.5), "carl": (1.5, 0, 1.5)}
    world, nest = nest_of(agents, field_of_view=130)
    world.place_agent("anne", agents["anne"], yaw=math.pi / 2)
    world.place_agent("observer", agents["observer"], yaw=math.pi / 4)
    assert nest["/observer"].state.agents["anne"].yaw == math.pi / 2
    assert nest["/observer/anne"].state.agents["carl"].current
    world.place_agent("anne", agents["anne"], yaw=-math.pi / 2)
    assert not nest["/observer/anne"].state.agents["carl"].current
