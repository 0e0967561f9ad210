"""Differences between simulators, and false beliefs."""

import pytest
from tests.nest.places import CHEST, CLOSED, CORNER, EAST, GAP, MEETING, WEST, nest_of

import beliefnest as bn
from beliefnest.errors import PathError, TickError

EAST_2 = (8.5, 0.0, 3.5)
EAST_BLOCK = (8, 0, 5)
TOLD = bn.Contents
STONE = "stone"


def corner(**kwargs):
    agents = {"a": WEST, "b": GAP}
    return nest_of(agents, CORNER, chests={CHEST: {"emerald": 1}}, **kwargs)


def found(differences):
    return {(d.kind, d.where): (d.a, d.b) for d in differences}


def test_a_simulator_does_not_differ_from_itself():
    _, nest = corner()
    assert nest.compare("/a", "/a") == nest.compare("/a/b", "/a/a/b") == []


def test_every_kind_of_difference():
    world, nest = nest_of(
        {"a": WEST, "b": GAP},
        CORNER,
        chests={CHEST: {"emerald": 1}},
        inventories={"b": {"apple": 1}},
    )
    world.place_agent("b", EAST_2, yaw=1.0)
    world.withdraw("b", CHEST, {"emerald": 1})
    world.set_block((5, 0, 8), STONE)
    nest["/a"].edit(blocks={(2, 0, 3): "bricks"})
    both = found(nest.compare("/", "/a", unknown=False))
    assert both == {
        ("block", (2, 0, 3)): ("air", "bricks"),
        ("container", CHEST): (TOLD({}, True), TOLD({}, False)),
        ("agent", "b"): (bn.Pose(EAST_2, 1.0, 0.0), bn.Pose(GAP, 0.0, 0.0)),
        ("inventory", "b"): (TOLD({"apple": 1, "emerald": 1}, True), TOLD({}, False)),
    }
    mirrored = found(nest.compare("/a", "/", unknown=False))
    assert mirrored == {key: (b, a) for key, (a, b) in both.items()}


def test_what_is_unknown_in_one_is_a_difference_unless_it_is_left_out():
    _, nest = nest_of({"a": WEST, "b": EAST}, CLOSED, chests={(8, 0, 8): {}})
    every = found(nest.compare("/", "/a"))
    assert every["block", EAST_BLOCK] == ("air", None)
    assert every["container", (8, 0, 8)] == (TOLD({}, True), None)
    assert every["agent", "b"] == (bn.Pose(EAST, 0.0, 0.0), None)
    assert ("block", (2, 0, 3)) not in every
    assert [d.kind for d in nest.compare("/", "/a", unknown=False)] == ["inventory"]
    kinds = [d.kind for d in nest.compare("/", "/a")]
    assert kinds == sorted(kinds, key=["block", "container", "agent", "inventory"].index)


def test_the_past_is_compared_as_it_was():
    world, nest = corner()
    world.place_agent("b", EAST_2)
    assert ("agent", "b") in found(nest.compare("/", "/a"))
    assert ("agent", "b") not in found(nest.at(0).compare("/", "/a"))
    assert [d.kind for d in nest.false_beliefs("/a")] == ["agent"]
    assert nest.at(0).false_beliefs("/a") == []


def test_reality_holds_no_false_beliefs():
    world, nest = corner()
    world.place_agent("b", EAST_2)
    assert nest.false_beliefs("/") == []


def test_the_unknown_is_not_false():
    _, nest = nest_of({"a": WEST, "b": EAST}, CLOSED, chests={(8, 0, 8): {"apple": 1}})
    assert nest.compare("/", "/a") != []
    assert nest.false_beliefs("/a") == []


@pytest.mark.parametrize(
    ("believed", "complete", "false"),
    [
        ({}, False, False),
        ({"emerald": 1}, False, False),
        ({"emerald": 2}, False, False),
        ({"emerald": 3}, False, True),
        ({"apple": 1}, False, True),
        ({"emerald": 2}, True, False),
        ({"emerald": 1}, True, True),
        ({}, True, True),
    ],
)
def test_when_contents_are_false(believed, complete, false):
    prior = bn.InitialBelief(("a",), containers={CHEST: (believed, complete)})
    agents = {"a": WEST, "b": GAP}
    _, nest = nest_of(agents, CORNER, chests={CHEST: {"emerald": 2}}, initial_beliefs=[prior])
    expected = [
        bn.Difference("container", CHEST, TOLD({"emerald": 2}, True), TOLD(believed, complete))
    ]
    assert nest.false_beliefs("/a") == (expected if false else [])


def test_a_container_that_is_not_there_is_false_as_a_block_and_by_its_items():
    world, nest = nest_of({"a": WEST, "b": MEETING}, CORNER, chests={(2, 0, 5): {"apple": 1}})
    world.open("a", (2, 0, 5))
    world.place_agent("a", EAST)
    world.set_block((2, 0, 5), "air")
    assert found(nest.false_beliefs("/a")) == {
        ("block", (2, 0, 5)): ("air", nest["/a"].state.blocks[2, 0, 5]),
        ("container", (2, 0, 5)): (None, TOLD({"apple": 1}, True)),
    }


def test_a_false_block_and_a_false_inventory():
    world, nest = nest_of(
        {"a": MEETING, "b": GAP}, CORNER, chests={CHEST: {"emerald": 1}}, inventories={"b": {}}
    )
    world.withdraw("b", CHEST, {"emerald": 1})
    assert nest.false_beliefs("/a") == []
    world.place_agent("a", WEST)
    world.place_agent("b", EAST)
    world.deposit("b", CHEST, {"emerald": 1})
    world.set_block(EAST_BLOCK, STONE)
    false = found(nest.false_beliefs("/a"))
    assert false["inventory", "b"] == (TOLD({}, True), TOLD({"emerald": 1}, False))
    assert false["block", EAST_BLOCK] == (STONE, "air")


def test_a_prior_place_is_no_belief_about_where_someone_looks():
    prior = bn.InitialBelief(("a",), agents={"b": EAST})
    world, nest = nest_of({"a": WEST, "b": EAST}, CLOSED, initial_beliefs=[prior])
    world.place_agent("b", EAST, yaw=2.0)
    assert nest.false_beliefs("/a") == []
    world.place_agent("b", EAST_2)
    assert nest.false_beliefs("/a") == [
        bn.Difference("agent", "b", bn.Pose(EAST_2, 2.0, 0.0), bn.Pose(EAST, None, None))
    ]


@pytest.mark.parametrize(("there", "false"), [(0.4, False), (0.5, True), (3.0, True)])
def test_a_place_is_false_from_half_a_block_on_wherever_the_head_has_turned(there, false):
    world, nest = nest_of({"a": WEST, "b": GAP}, CORNER, max_visible_distance=10)
    world.place_agent("a", (2.5, 0.0, 0.5))
    world.place_agent("b", (GAP[0] + there, 0.0, GAP[2]), yaw=2.0, pitch=0.5)
    held = nest["/a"].state.agents["b"]
    assert not held.current
    assert held.position == GAP
    assert [d.kind for d in nest.false_beliefs("/a")] == ["agent"] * false
    assert "agent" in [d.kind for d in nest.compare("/", "/a", unknown=False)]


def test_unknown_paths_and_ticks_are_errors():
    _, nest = corner()
    with pytest.raises(PathError):
        nest.compare("/", "/nobody")
    with pytest.raises(PathError):
        nest.false_beliefs("a")
    with pytest.raises(TickError):
        nest.at(7).false_beliefs("/a")


def test_a_recorded_nest_is_compared_as_the_live_one(tmp_path):
    world = bn.ScriptedWorld(((0, 0, 0), (10, 2, 10)), CORNER, {"a": WEST, "b": GAP})
    nest = bn.Nest(world, store=tmp_path / "run.bn")
    world.place_agent("b", EAST_2)
    false, every = nest.false_beliefs("/a"), nest.compare("/", "/a")
    assert [d.kind for d in false] == ["agent"]
    nest.close()
    with bn.Nest.read(tmp_path / "run.bn") as recorded:
        assert recorded.false_beliefs("/a") == false
        assert recorded.compare("/", "/a") == every
