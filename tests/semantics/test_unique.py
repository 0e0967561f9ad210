"""Unique items (semantics, section 3): perceived in one place, believed nowhere else."""

from pathlib import Path
from typing import Any

import pytest

import beliefnest as bn
from beliefnest.belief.grounds import Basis, Source
from beliefnest.errors import InputError, UnknownNameError
from beliefnest.world.values import EventKind, Position

LEFT, RIGHT = (3, 0, 3), (17, 0, 3)
BY_LEFT, ALSO_LEFT, BY_RIGHT, FAR = (3.5, 0, 5.5), (5.5, 0, 5.5), (17.5, 0, 5.5), (10.5, 0, 19.5)
THERE = bn.Claim.located("diamond", RIGHT)


def hall(
    agents: dict[str, tuple[float, float, float]] | None = None,
    unique: tuple[str, ...] = ("diamond",),
    store: Path | None = None,
    initial: tuple[bn.InitialBelief, ...] = (),
    equipment: dict[str, dict[str, str]] | None = None,
    **options: Any,
) -> tuple[bn.ScriptedWorld, bn.Nest]:
    """Max beside the left chest; Nora, who has the diamond, looks on. Sight ends at 6 blocks."""
    places = {"max": BY_LEFT, "nora": ALSO_LEFT, "bob": FAR} | (agents or {})
    world = bn.ScriptedWorld(
        ((0, 0, 0), (20, 3, 20)),
        agents=places,
        containers={LEFT: {}, RIGHT: {}},
        inventories={"nora": {"diamond": 1, "apple": 1}},
        equipment=equipment,
    )
    perception = bn.Perception(**{"max_visible_distance": 6} | options)
    nest = bn.Nest(world, perception, initial_beliefs=initial, unique=unique, store=store)
    return world, nest


def where(nest: bn.Nest, path: str) -> list[Position | str]:
    """Return the place at which a node believes the diamond to be."""
    state = nest[path].state
    held = [place for place, c in state.containers.items() if "diamond" in c.items]
    with_whom = [
        name
        for name, agent in state.agents.items()
        if "diamond" in agent.inventory or "diamond" in (agent.equipment or {}).values()
    ]
    return [*held, *with_whom]


def hidden(**options: Any) -> tuple[bn.ScriptedWorld, bn.Nest]:
    """Nora has put the diamond into the left chest before Max; then he went to the other one."""
    world, nest = hall(**options)
    world.deposit("nora", LEFT, {"diamond": 1})
    world.place_agent("max", BY_RIGHT)
    assert where(nest, "/max") == [LEFT]
    return world, nest


def brought(**options: Any) -> tuple[bn.ScriptedWorld, bn.Nest]:
    """Nora took it out again unseen, and came to Max."""
    world, nest = hidden(**options)
    world.withdraw("nora", LEFT, {"diamond": 1})
    world.place_agent("nora", (15.5, 0, 5.5))
    assert where(nest, "/max") == [LEFT]
    return world, nest


@pytest.mark.parametrize("path", ["/max", "/max/nora", "/nora/max", "/max/nora/max"])
def test_who_sees_it_put_somewhere_believes_it_nowhere_else(path: str) -> None:
    world, nest = brought()
    world.deposit("nora", RIGHT, {"diamond": 1})
    assert where(nest, path) == [RIGHT]
    left = nest["/max"].state.containers[LEFT]
    assert (left.items, left.current) == ({}, False)
    assert left.basis == Basis(world.now, Source.WITNESSED, EventKind.DEPOSIT_ITEM_INTO_CHEST)


def test_without_it_both_chests_are_believed_to_hold_one() -> None:
    world, nest = brought(unique=())
    world.deposit("nora", RIGHT, {"diamond": 1})
    assert where(nest, "/max") == [LEFT, RIGHT]


def test_who_sees_it_taken_out_knows_who_has_it() -> None:
    world, nest = brought(initial=(bn.InitialBelief(("bob",), {LEFT: ({"diamond": 1}, True)}),))
    world.deposit("nora", RIGHT, {"diamond": 1})
    world.place_agent("bob", (15.5, 0, 3.5))
    assert where(nest, "/bob") == [LEFT]
    world.withdraw("max", RIGHT, {"diamond": 1})
    assert where(nest, "/bob") == where(nest, "/bob/max") == where(nest, "/nora") == ["max"]
    assert nest["/bob"].state.containers[LEFT].complete


@pytest.mark.parametrize("path", ["/max", "/nora/max", "/max/nora/max"])
def test_who_sees_it_in_somebodys_hand_believes_it_nowhere_else(path: str) -> None:
    prior = bn.InitialBelief(("max", "**"), {LEFT: ({"diamond": 1, "bread": 2}, True)})
    also = bn.InitialBelief(("nora", "max", "**"), {LEFT: ({"diamond": 1}, True)})
    world, nest = hall(
        agents={"max": BY_RIGHT},
        initial=(prior, also),
        equipment={"nora": {"main_hand": "diamond"}},
    )
    assert where(nest, "/max") == [LEFT]
    world.place_agent("nora", (15.5, 0, 5.5))
    assert where(nest, path) == ["nora"]
    world.give("nora", "max", {"diamond": 1})
    assert where(nest, path) == ["max"]
    left = nest["/max"].state.containers[LEFT]
    # The rest keeps its evidence.
    assert (dict(left.items), left.complete, left.basis.source) == ({"bread": 2}, True, "prior")


def test_who_has_it_or_opens_a_chest_with_it_knows_where_it_is() -> None:
    prior = bn.InitialBelief(("**",), {LEFT: ({"diamond": 1}, True)})
    world, nest = hall(agents={"nora": (15.5, 0, 5.5)}, initial=(prior,))
    assert (where(nest, "/nora"), where(nest, "/bob")) == (["nora"], [LEFT])
    world.deposit("nora", RIGHT, {"diamond": 1})
    world.place_agent("nora", FAR)
    world.place_agent("bob", BY_RIGHT)
    world.open("bob", RIGHT)
    assert (where(nest, "/bob"), where(nest, "/max")) == ([RIGHT], [LEFT])


def test_who_sees_into_a_transparent_chest_believes_it_nowhere_else() -> None:
    prior = bn.InitialBelief(("**",), {RIGHT: ({"diamond": 1}, True)})
    world, nest = hall(initial=(prior,), containers="transparent")
    world.deposit("nora", LEFT, {"diamond": 1})
    for path in ("/max", "/max/nora", "/nora/max", "/nora/max/nora"):
        assert where(nest, path) == [LEFT]
    assert where(nest, "/bob") == [RIGHT]


def test_who_takes_up_a_claim_believes_it_nowhere_else() -> None:
    world, nest = brought(testimony="accept")
    world.place_agent("nora", FAR)
    world.say("bob", "right", claims=[THERE])
    assert where(nest, "/max") == where(nest, "/max/bob") == [RIGHT]
    assert nest["/max"].state.containers[LEFT].basis.speaker == "bob"


@pytest.mark.parametrize("path", ["/nora", "/max/nora", "/nora/max"])
def test_nobody_is_told_otherwise_of_what_they_perceive(path: str) -> None:
    world, nest = hall(testimony="accept", equipment={"nora": {"main_hand": "diamond"}})
    world.say("bob", "right", claims=[THERE])
    assert where(nest, path) == ["nora"]
    (made,) = nest.claims()
    assert not made.taken_up(path)
    assert made.taken_up("/bob/max") is False or where(nest, "/bob/max") == [RIGHT]


def test_a_perception_elsewhere_leaves_no_known_place() -> None:
    world, nest = brought(testimony="informed", grace=10)
    world.place_agent("nora", (15.5, 0, 5.5))
    world.give("nora", "max", {"diamond": 1})
    world.place_agent("bob", (15.5, 0, 3.5))
    world.give("max", "bob", {"diamond": 1})
    world.place_agent("bob", FAR)
    # No place is known, so that it can be said at once.
    world.say("bob", "left", claims=[bn.Claim.located("diamond", LEFT)])
    assert where(nest, "/max") == [LEFT]


def test_it_is_common_knowledge_in_a_forked_belief_too() -> None:
    _, nest = brought()
    nest["/max"].switch("what if")
    inner = nest["/max"].scripted
    assert where(nest, "/max") == where(nest, "/max/nora") == [LEFT]
    inner.place_agent("max", ALSO_LEFT)
    inner.withdraw("max", LEFT, {"diamond": 1})
    assert where(nest, "/max") == ["max"]
    inner.deposit("max", LEFT, {"diamond": 1})
    inner.place_agent("nora", (5.5, 0, 3.5))
    inner.withdraw("max", LEFT, {"diamond": 1})
    assert where(nest, "/max/nora") == ["max"]
    nest["/max"].switch("follow")
    assert where(nest, "/max") == [LEFT]


def test_an_edit_of_a_belief_moves_it() -> None:
    _, nest = brought()
    nest["/max"].edit(containers={RIGHT: {"diamond": 1}})
    assert where(nest, "/max") == [RIGHT]


def test_an_explanation_says_where_else_it_was_perceived() -> None:
    world, nest = brought()
    world.deposit("nora", RIGHT, {"diamond": 1})
    assert "max perceived at tick 5 the only diamond at (17, 0, 3)" in str(
        nest["/max"].explain(container=LEFT)
    )
    world.withdraw("max", RIGHT, {"diamond": 1})
    world.give("max", "nora", {"diamond": 1})
    world.deposit("nora", RIGHT, {"diamond": 1})
    assert "nora put 1 diamond in" in str(nest["/max"].explain(container=RIGHT))


def test_it_is_kept_in_run_files(tmp_path: Path) -> None:
    world, nest = brought(store=tmp_path / "run.bn")
    world.deposit("nora", RIGHT, {"diamond": 1})
    nest.close()
    with bn.Nest.read(tmp_path / "run.bn") as read:
        assert where(read, "/max") == where(read, "/max/nora") == [RIGHT]
    with bn.Nest.resume(tmp_path / "run.bn") as resumed:
        resumed["/"].scripted.withdraw("nora", RIGHT, {"diamond": 1})
        assert where(resumed, "/max") == ["nora"]


@pytest.mark.parametrize(
    ("unique", "fault"),
    [("diamond", "give a list"), (["diamnd"], "diamond"), ([7], "give a list")],
)
def test_what_is_no_list_of_items_is_refused(unique: Any, fault: str) -> None:
    with pytest.raises((InputError, UnknownNameError), match=fault):
        hall(unique=unique)


def test_a_world_with_two_of_them_is_refused() -> None:
    world = bn.ScriptedWorld(
        ((0, 0, 0), (5, 3, 5)),
        agents={"max": (1.5, 0, 1.5)},
        containers={LEFT: {"diamond": 1}},
        inventories={"max": {"diamond": 1}},
    )
    with pytest.raises(InputError, match=r"'diamond' is unique, but at the start there are 1 in "):
        bn.Nest(world, unique=["diamond"])


@pytest.mark.parametrize(
    "initial",
    [
        (
            bn.InitialBelief(
                ("max",), {LEFT: ({"diamond": 1}, True), RIGHT: ({"diamond": 1}, True)}
            ),
        ),
        (bn.InitialBelief(("max", "**"), {LEFT: ({"diamond": 2}, True)}),),
        (
            bn.InitialBelief(("**",), {LEFT: ({"diamond": 1}, True)}),
            bn.InitialBelief(("max", "nora"), {RIGHT: ({"diamond": 1}, True)}),
        ),
    ],
)
def test_initial_beliefs_with_two_of_them_are_refused(
    initial: tuple[bn.InitialBelief, ...],
) -> None:
    with pytest.raises(InputError, match=r"'diamond' is unique, but initial_beliefs give '/.*max"):
        hall(initial=initial)
    # An agent that believes it elsewhere must believe the first place empty.
    prior = bn.InitialBelief(("**",), {LEFT: ({"diamond": 1}, True)})
    other = bn.InitialBelief(("max",), {LEFT: ({}, True), RIGHT: ({"diamond": 1}, True)})
    hall(initial=(prior, other))
