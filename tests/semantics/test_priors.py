"""Knowledge at the start (semantics, section 4): static blocks and initial beliefs."""

import pytest
from tests.nest.places import CLOSED, EAST, WEST, nest_of

import beliefnest as bn
from beliefnest.belief.grounds import Source
from beliefnest.world.registry import Registry

AGENTS = {"a": WEST, "b": EAST, "c": (2.5, 0, 8.5)}
PLACE = (9, 0, 1)
"""A position that b alone sees, a wall being between."""

STONE = Registry.load().state_id("stone")


def test_static_blocks_are_known_to_everybody_at_every_depth():
    _, nest = nest_of(AGENTS, CLOSED | {PLACE: "bricks"}, static_blocks=["bricks"])
    for path in ("/a", "/b", "/a/c", "/c/a/b", "/b/a"):
        assert nest[path].state.blocks[PLACE] == "bricks"


def test_a_static_block_rests_on_a_prior_and_is_current_only_where_seen():
    _, nest = nest_of(AGENTS, CLOSED | {PLACE: "bricks"}, static_blocks=["bricks"])
    known = nest["/a"].state.blocks
    assert known.basis(PLACE).source is Source.PRIOR
    assert not known.current(PLACE)
    assert nest["/b"].state.blocks.current(PLACE)
    assert nest["/b"].state.blocks.basis(PLACE).source is Source.SEEN


def test_blocks_of_other_names_are_not_static():
    _, nest = nest_of(AGENTS, CLOSED | {PLACE: "stone_bricks"}, static_blocks=["bricks"])
    assert nest["/a"].state.blocks[PLACE] is None


def test_a_static_container_is_known_to_be_there_and_nothing_of_its_content():
    _, nest = nest_of(AGENTS, CLOSED, chests={PLACE: {"diamond": 1}}, static_blocks=["chest"])
    held = nest["/a"].state.containers[PLACE]
    assert (held.items, held.complete, held.current) == ({}, False, False)


def test_a_static_block_seen_replaced_is_updated():
    world, nest = nest_of(AGENTS, CLOSED | {PLACE: "bricks"}, static_blocks=["bricks"])
    world.set_block(PLACE, "air")
    assert nest["/b"].state.blocks[PLACE] == "air"
    assert nest["/a"].state.blocks[PLACE] == nest["/b/a"].state.blocks[PLACE] == "bricks"


def initially(path, **beliefs):
    return nest_of(AGENTS, CLOSED, initial_beliefs=[bn.InitialBelief(path, **beliefs)])


def test_initial_contents_blocks_and_poses_are_believed():
    _, nest = initially(
        ("a",),
        containers={PLACE: ({"diamond": 1}, True)},
        blocks={(8, 0, 8): STONE},
        agents={"b": (7.5, 0, 7.5)},
    )
    state = nest["/a"].state
    assert (state.containers[PLACE].items, state.containers[PLACE].complete) == (
        {"diamond": 1},
        True,
    )
    assert state.blocks[8, 0, 8] == "stone"
    assert state.agents["b"].position == (7.5, 0, 7.5)
    bases = [state.containers[PLACE].basis, state.blocks.basis((8, 0, 8)), state.agents["b"].basis]
    assert {(basis.source, basis.observed_at) for basis in bases} == {(Source.PRIOR, 0)}
    assert not state.containers[PLACE].current
    assert not state.blocks.current((8, 0, 8))


def test_who_stands_at_an_initial_pose_is_not_present():
    world, nest = initially(("a",), agents={"b": (3.5, 0, 3.5)})
    assert not nest["/a"].state.agents["b"].current
    world.set_block((2, 0, 2), "bricks")
    assert nest["/a"].state.blocks[2, 0, 2] == "bricks"
    assert nest["/a/b"].state.blocks[2, 0, 2] is None


def test_initial_beliefs_may_be_at_any_depth_and_stay_there():
    world, nest = initially(("c", "a", "b"), containers={PLACE: ({"diamond": 1}, False)})
    world.say("a", "hello")
    held = nest["/c/a/b"].state.containers[PLACE]
    assert (held.items, held.complete) == ({"diamond": 1}, False)
    for path in ("/c", "/c/a", "/b", "/a/b", "/c/b"):
        assert PLACE not in nest[path].state.containers or path == "/b"
    assert nest["/b"].state.containers == {}


def test_an_initial_belief_is_replaced_by_what_is_seen():
    _, nest = initially(("a",), blocks={(2, 0, 5): STONE}, agents={"c": (0.5, 0, 0.5)})
    state = nest["/a"].state
    assert state.blocks[2, 0, 5] == "air"
    assert state.agents["c"].position == AGENTS["c"]


def test_an_initial_belief_that_is_seen_in_the_belief_is_handed_on_as_stale():
    _, nest = nest_of(
        {"a": (0.5, 0, 5.5), "c": (5.5, 0, 5.5)},
        max_visible_distance=6,
        initial_beliefs=[bn.InitialBelief(("a",), blocks={(9, 0, 5): STONE})],
    )
    handed = nest["/a/c"].state.blocks
    assert handed[9, 0, 5] == "stone"
    assert not handed.current((9, 0, 5))
    assert handed.basis((9, 0, 5)).source is Source.PRIOR
    assert nest["/c"].state.blocks[9, 0, 5] == "air"


def test_what_only_the_deeper_belief_knows_is_kept_where_the_shallower_one_sees_nothing():
    """B sees the place in a's belief, where it is unknown: that is no perception of it."""
    place = (9, 0, 8)
    _, nest = nest_of(
        {"a": (0.5, 0, 8.5), "b": (5.5, 0, 8.5)},
        max_visible_distance=6,
        initial_beliefs=[bn.InitialBelief(("a", "b"), blocks={place: STONE})],
    )
    assert nest["/a"].state.blocks[place] is None
    believed = nest["/a/b"].state.blocks
    assert believed[place] == "stone"
    assert believed.basis(place).source is Source.PRIOR
    assert not believed.current(place)


CANDY = {PLACE: ({"cookie": 1}, True)}


def test_what_everybody_takes_for_granted_everybody_takes_everybody_to():
    _, nest = initially(("**",), containers=CANDY)
    for path in ("/a", "/b/a", "/c/a/b", "/a/b/c/a"):
        assert nest[path].state.containers[PLACE].items == {"cookie": 1}
    assert PLACE not in nest["/"].state.containers


def test_a_prior_below_a_belief_is_that_belief_s_alone():
    _, nest = initially(("a", "**"), containers=CANDY)
    assert PLACE in nest["/a"].state.containers
    assert PLACE in nest["/a/b"].state.containers
    assert PLACE not in nest["/b"].state.containers
    assert PLACE not in nest["/b/a"].state.containers


def test_who_is_named_more_exactly_counts():
    beliefs = [
        bn.InitialBelief(("a",), containers={PLACE: ({"diamond": 1}, False)}),
        bn.InitialBelief(("a", "**"), containers={PLACE: ({"apple": 1}, True)}),
        bn.InitialBelief(("**",), containers=CANDY, blocks={(8, 0, 8): STONE}),
    ]
    _, nest = nest_of(AGENTS, CLOSED, chests={PLACE: {}}, initial_beliefs=beliefs)
    held = {path: nest[path].state.containers[PLACE].items for path in ("/a", "/a/b", "/b")}
    assert held == {"/a": {"diamond": 1}, "/a/b": {"apple": 1}, "/b": {"cookie": 1}}
    assert nest["/a/b"].state.blocks[8, 0, 8] == "stone"


def test_unexpected_contents_one_s_own_past_belief_and_another_s():
    """Smarties: who has looked in knows, others and one's own past self believe the look."""
    world, nest = nest_of(
        AGENTS,
        chests={PLACE: {"stick": 1}},
        initial_beliefs=[bn.InitialBelief(("**",), containers=CANDY)],
        containers="opaque",
    )
    world.place_agent("a", (8.5, 0, 1.5))
    world.open("a", PLACE)
    held = {
        "own": nest["/a"].state.containers[PLACE].items,
        "own, past": nest.at(0)["/a"].state.containers[PLACE].items,
        "another's": nest["/a/c"].state.containers[PLACE].items,
        "another's of another's": nest["/c/b"].state.containers[PLACE].items,
    }
    assert held == {
        "own": {"stick": 1},
        "own, past": {"cookie": 1},
        "another's": {"cookie": 1},
        "another's of another's": {"cookie": 1},
    }


def test_a_static_position_is_known_to_everybody_whatever_is_there():
    blocks = CLOSED | {PLACE: "bricks", (9, 0, 2): "bricks"}
    _, nest = nest_of(AGENTS, blocks, static_blocks=[PLACE])
    state = nest["/a/c"].state
    assert (state.blocks[PLACE], state.blocks[9, 0, 2]) == ("bricks", None)
    with pytest.raises(bn.InputError, match="outside the box"):
        nest_of(AGENTS, CLOSED, static_blocks=[(99, 0, 0)])


def test_possessions_can_be_known_from_the_start_at_any_depth():
    prior = bn.InitialBelief(("b", "**"), inventories={"a": {"diamond": 1}})
    world = bn.ScriptedWorld(
        ((0, 0, 0), (9, 3, 9)),
        agents={"a": (1.5, 0, 1.5), "b": (5.5, 0, 1.5), "c": (5.5, 0, 5.5)},
        inventories={"a": {"apple": 2}},
        containers={(2, 0, 3): {}},
    )
    with bn.Nest(world, initial_beliefs=[prior]) as nest:

        def known(path):
            agent = nest[path].state.agents["a"]
            return dict(agent.inventory), agent.inventory_complete

        assert known("/b") == known("/b/a") == known("/b/c") == ({"diamond": 1}, False)
        assert known("/c") == ({}, False)
        # What it has itself, an agent knows.
        assert known("/a") == ({"apple": 2}, True)
        world.deposit("a", (2, 0, 3), {"apple": 1})
        assert known("/b") == ({"diamond": 1}, False)
