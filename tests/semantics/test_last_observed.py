"""Ticks at which beliefs were last current (semantics, section 2): nothing unseen moves them."""

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.nest.comparing import everything
from tests.nest.places import CORNER, EAST, GAP, MEETING, WEST, nest_of

import beliefnest as bn

CHEST = (2, 0, 3)
BLOCK = (2, 0, 2)
AWAY = (60.5, 0, 1.5)
BOX = ((0, 0, 0), (63, 1, 9))


def hall(store: Path | None = None, **options: Any) -> tuple[bn.ScriptedWorld, bn.Nest]:
    """Ann and Bob beside a chest; Cat far away, whom nobody else sees or hears."""
    world = bn.ScriptedWorld(
        BOX,
        {BLOCK: "stone"},
        agents={"ann": (1.5, 0, 1.5), "bob": (4.5, 0, 3.5), "cat": AWAY},
        containers={CHEST: {"emerald": 1}, (60, 0, 5): {}},
        inventories={"ann": {"apple": 2}, "bob": {"apple": 2}, "cat": {"apple": 99}},
    )
    perception = {"max_visible_distance": 12, "hearing": "sight", "testimony": "accept"} | options
    return world, bn.Nest(world, bn.Perception(**perception), store=store)


def observed(nest: bn.Nest, path: str = "/ann") -> tuple[int, int, int]:
    """Return the ticks at which Bob, the block and the chest's content were last current."""
    state = nest[path].state
    bob, block = state.agents["bob"].basis, state.blocks.basis(BLOCK)
    assert bob is not None
    assert block is not None
    return bob.observed_at, block.observed_at, state.containers[CHEST].basis.observed_at


@pytest.mark.parametrize("busy", [False, True])
def test_what_is_current_is_observed_now_and_what_is_lost_was_observed_a_tick_ago(
    busy: bool, tmp_path: Path
) -> None:
    store = tmp_path / "run.bn"
    world, nest = hall(store, containers="transparent")

    def pass_ticks(count: int) -> None:
        for _ in range(count):
            if busy:
                world.place_agent("cat", (world.now % 3 + 58.5, 0, 1.5))
            else:
                world.step(1)

    pass_ticks(7)
    for path in ("/", "/ann", "/bob/ann", "/ann/bob/ann"):
        assert observed(nest, path) == (7, 7, 7)
    pass_ticks(3)
    world.place_agent("ann", (40.5, 0, 1.5))
    pass_ticks(5)
    for path in ("/ann", "/ann/bob", "/ann/bob/ann"):
        assert observed(nest, path) == (10, 10, 10)
    assert observed(nest, "/bob") == (16, 16, 16)
    past = nest.at(4)["/ann"].state
    assert past.agents["bob"].basis.observed_at == 4
    assert past.containers[CHEST].basis.observed_at == 4
    nest["/ann"].switch("try")
    assert observed(nest) == (16, 16, 16)
    assert observed(nest, "/ann/bob") == (10, 10, 10)
    nest["/ann"].switch("follow")
    nest.close()
    with bn.Nest.read(store) as recorded:
        state = recorded["/ann"].state
        assert state.agents["bob"].basis.observed_at == 10
        assert state.blocks.basis(BLOCK).observed_at == 10


@pytest.mark.parametrize("busy", [False, True])
def test_an_act_shows_a_content_in_its_tick_alone(busy: bool) -> None:
    world, nest = hall()
    world.open("ann", CHEST)
    assert nest["/ann"].state.containers[CHEST].current
    if busy:
        world.place_agent("cat", (59.5, 0, 1.5))
    else:
        world.step(1)
    held = nest["/ann"].state.containers[CHEST]
    assert (held.current, held.basis.observed_at, held.complete) == (False, 1, True)


def test_an_edit_lies_after_the_tick_at_which_something_was_last_current() -> None:
    world, nest = nest_of({"a": WEST, "b": MEETING}, CORNER)
    world.step(4)
    nest["/"].edit(blocks={(x, y, 3): "stone" for x in range(11) for y in range(3)})
    believed = nest["/a"].state.agents["b"]
    assert (believed.position, believed.current, believed.basis.observed_at) == (MEETING, False, 4)


def test_what_is_handed_on_stale_keeps_its_tick() -> None:
    world, nest = nest_of({"a": WEST, "b": MEETING, "c": GAP}, CORNER, negative_evidence=False)
    world.step(4)
    world.place_agent("b", EAST)
    world.step(4)
    state = nest["/a/c"].state
    assert state.agents["b"].current == (nest["/a"].state.agents["b"].current)
    lost = nest["/a"].state.agents["b"].basis.observed_at
    world.place_agent("a", (WEST[0] + 0.25, 0, WEST[2]))
    assert nest["/a"].state.agents["b"].basis.observed_at == lost == 4


NEAR = st.sampled_from([(1.5, 0, 1.5), (4.5, 0, 3.5), (6.5, 0, 6.5), (40.5, 0, 1.5)])
CLAIMS = st.sampled_from(
    [
        bn.Claim.located("emerald", CHEST),
        bn.Claim.absent("emerald", CHEST),
        bn.Claim.block(BLOCK, "dirt"),
        bn.Claim.position("bob", (6.5, 0, 1.5)),
        bn.Claim.position("cat", (6.5, 0, 3.5)),
    ]
)
SEEN_ACTS = st.one_of(
    st.tuples(st.just("place_agent"), st.sampled_from(["ann", "bob"]), NEAR),
    st.tuples(st.just("open"), st.sampled_from(["ann", "bob"]), st.just(CHEST)),
    st.tuples(
        st.just("deposit"), st.sampled_from(["ann", "bob"]), st.just(CHEST), st.just({"apple": 1})
    ),
    st.tuples(st.just("set_block"), st.just(BLOCK), st.sampled_from(["stone", "air", "chest"])),
    st.tuples(st.just("say"), st.sampled_from(["ann", "bob"]), st.just("x"), st.tuples(CLAIMS)),
)
UNSEEN_ACTS = st.one_of(
    st.tuples(st.just("place_agent"), st.just("cat"), st.sampled_from([AWAY, (58.5, 0, 3.5)])),
    st.tuples(st.just("set_block"), st.just((61, 0, 7)), st.sampled_from(["stone", "air"])),
    st.tuples(st.just("deposit"), st.just("cat"), st.just((60, 0, 5)), st.just({"apple": 1})),
    st.tuples(st.just("think"), st.just("cat"), st.just("x")),
)
TICKS = st.lists(st.tuples(st.none() | SEEN_ACTS, st.none() | UNSEEN_ACTS), max_size=10)
PATHS = ("/ann", "/bob", "/ann/bob", "/bob/ann", "/ann/bob/ann", "/ann/cat")


@given(TICKS, st.sampled_from(["opaque", "transparent"]), st.sampled_from(["accept", "informed"]))
def test_what_the_holder_cannot_perceive_changes_nothing_of_its_state(
    ticks: list[Any], containers: str, testimony: str
) -> None:
    """Two worlds, in one of which Cat is busy far away, give the same beliefs at each tick."""
    worlds = [hall(containers=containers, testimony=testimony, grace=3) for _ in range(2)]
    for seen, unseen in ticks:
        for (world, _), acts in zip(worlds, ([seen], [seen, unseen]), strict=True):
            before = world.now
            with world.tick():
                for act in acts:
                    try:
                        if act is not None:
                            getattr(world, act[0])(*act[1:])
                    except (bn.WorldError, bn.InputError):
                        continue
            world.step(before + 1 - world.now)
        (_, quiet), (_, busy) = worlds
        for path in PATHS:
            one, other = (everything(nest[path].state) for nest in (quiet, busy))
            for part, value in one.items():
                assert other[part] == value, f"{part} of {path}"
