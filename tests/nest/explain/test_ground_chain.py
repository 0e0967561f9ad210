"""Explanations of beliefs under claims, signs, priors, edits and unique items, checked by hand."""

from collections.abc import Callable
from typing import Any

import pytest

import beliefnest as bn
from beliefnest.belief.grounds import InitialBelief
from beliefnest.world.values import Position

A, B, SIGN = (3, 0, 3), (17, 0, 3), (10, 0, 12)
BY_A, ALSO_A, BY_B = (3.5, 0, 5.5), (5.5, 0, 5.5), (17.5, 0, 5.5)
AT_SIGN, ALSO_SIGN, FAR = (9.5, 0, 14.5), (11.5, 0, 14.5), (1.5, 0, 19.5)
IN_A, IN_B = bn.Claim.located("diamond", A), bn.Claim.located("diamond", B)
NOT_IN_A = bn.Claim.absent("diamond", A)
EVERYBODY = (InitialBelief(("**",), {A: ({"diamond": 1}, True)}),)
SIGNED: dict[str, Any] = {"signs": {SIGN: "x"}, "sign_claims": {SIGN: [IN_B]}}
UNIQUE: dict[str, Any] = {"unique": ("diamond",)}
LOOKED = "ann, at (3.5, 0, 5.5), perceived it at tick 1: ann looked in (then 1 diamond); since then"

Story = Callable[[bn.ScriptedWorld, bn.Nest], None]


def hall(
    story: Story,
    agents: dict[str, tuple[float, float, float]] | None = None,
    initial: tuple[InitialBelief, ...] = (),
    unique: tuple[str, ...] = (),
    options: dict[str, Any] | None = None,
    **world: Any,
) -> bn.Nest:
    """Ann and Bob beside chest A, which holds the diamond; Cid is far. Sight ends at 6 blocks."""
    scripted = bn.ScriptedWorld(
        ((0, 0, 0), (20, 3, 20)),
        {SIGN: "oak_sign"},
        agents={"ann": BY_A, "bob": ALSO_A, "cid": FAR} | (agents or {}),
        containers={A: {"diamond": 1}, B: {}},
        inventories={"bob": {"bread": 3}},
        **world,
    )
    perception = {"max_visible_distance": 6, "testimony": "accept"} | (options or {})
    nest = bn.Nest(
        scripted,
        bn.Perception(**perception),  # type: ignore[arg-type]  # options of any type
        initial_beliefs=initial,
        unique=unique,
    )
    story(scripted, nest)
    return nest


def told(world: bn.ScriptedWorld, nest: bn.Nest, claim: bn.Claim = IN_B) -> None:
    """Ann looks in at tick 1; Bob goes at tick 2, and says something at tick 23."""
    world.open("ann", A)
    world.place_agent("bob", FAR)
    world.step(20)
    world.say("bob", "x", claims=[claim])


def told_otherwise(world: bn.ScriptedWorld, nest: bn.Nest) -> None:
    """Bob says at tick 23 that it is not in A."""
    told(world, nest, NOT_IN_A)


def refuted(world: bn.ScriptedWorld, nest: bn.Nest) -> None:
    """Ann opens B at tick 25, and finds nothing."""
    told(world, nest)
    world.place_agent("ann", BY_B)
    world.open("ann", B)


def read_and_refuted(world: bn.ScriptedWorld, nest: bn.Nest) -> None:
    """Ann reads what Bob wrote, and finds B empty."""
    world.open("ann", A)
    world.place_agent("bob", AT_SIGN)
    world.write_sign("bob", SIGN, "x", claims=[IN_B])
    world.place_agent("ann", ALSO_SIGN)
    world.place_agent("ann", BY_B)
    world.open("ann", B)


def seen_written(world: bn.ScriptedWorld, nest: bn.Nest) -> None:
    """Ann sees Bob write."""
    world.place_agent("bob", AT_SIGN)
    world.place_agent("ann", ALSO_SIGN)
    world.write_sign("bob", SIGN, "x", claims=[IN_B])


def deed_and_told(world: bn.ScriptedWorld, nest: bn.Nest) -> None:
    """Ann sees Bob take it out and put it in; he says at tick 3 that it is in B."""
    world.withdraw("bob", A, {"diamond": 1})
    world.deposit("bob", A, {"diamond": 1})
    world.say("bob", "x", claims=[IN_B])


def told_and_deed(world: bn.ScriptedWorld, nest: bn.Nest) -> None:
    """Bob says that it is in A, then puts bread in."""
    world.say("bob", "x", claims=[IN_A])
    world.deposit("bob", A, {"bread": 1})


def two_deposits(world: bn.ScriptedWorld, nest: bn.Nest) -> None:
    """Bob puts bread in twice."""
    world.deposit("bob", A, {"bread": 1})
    world.deposit("bob", A, {"bread": 1})


def repeated(world: bn.ScriptedWorld, nest: bn.Nest) -> None:
    """Bob, Cid and Bob again say that it is in B."""
    for name in ("bob", "cid", "bob"):
        world.say(name, "x", claims=[IN_B])


def edited(world: bn.ScriptedWorld, nest: bn.Nest) -> None:
    """Ann's belief is edited by hand: the only diamond is in B."""
    world.open("ann", A)
    nest["/ann"].edit(containers={B: {"diamond": 1}})


def edited_back(world: bn.ScriptedWorld, nest: bn.Nest) -> None:
    """Edit, and undo the edit in the same tick."""
    edited(world, nest)
    nest["/ann"].edit(containers={A: {"diamond": 1}})


def found_in_a(world: bn.ScriptedWorld, nest: bn.Nest) -> None:
    """Bob says that the only diamond is in B, then Ann finds it in A."""
    world.say("bob", "x", claims=[IN_B])
    world.open("ann", A)


def lost_and_told(world: bn.ScriptedWorld, nest: bn.Nest) -> None:
    """Ann goes away at tick 5; Cid says at tick 6 that it is in B."""
    world.step(4)
    world.place_agent("ann", FAR)
    world.say("cid", "x", claims=[IN_B])


def in_the_air(world: bn.ScriptedWorld, nest: bn.Nest) -> None:
    """Bob says that there is no chest, and then that the diamond is in it."""
    world.say("bob", "x", claims=[bn.Claim.block(B, "air")])
    world.say("bob", "x", claims=[IN_B])


def quiet(world: bn.ScriptedWorld, nest: bn.Nest) -> None:
    """Nothing happens."""


CASES: list[tuple[Story, str, Position, str, dict[str, Any]]] = [
    (told, "/ann", A, f"holds nothing: {LOOKED} bob told ann at tick 23 that diamond is in B.", {}),
    (told, "/ann", B, "holds 1 diamond, and perhaps more: bob told ann at tick 23 that {}.", {}),
    (told_otherwise, "/ann", A, f"{LOOKED} bob told ann at tick 23 that diamond is not in A.", {}),
    (
        told,
        "/ann/bob",
        B,
        "ann believes that bob believes that the container at B holds 1 diamond, and perhaps "
        "more: as far as ann knows, bob said at tick 23 that {}.",
        {},
    ),
    (
        told,
        "/bob/ann",
        A,
        "bob believes that ann does not know what the chest at A holds: as far as bob knows, ann, "
        "at (3.5, 0, 5.5), first saw the chest at A at tick 0, but not what it holds.",
        {},
    ),
    (
        told,
        "/ann/bob/ann",
        B,
        "perhaps more: ann believes that as far as bob knows, bob told ann at tick 23 that {}.",
        {},
    ),
    (
        seen_written,
        "/ann",
        B,
        "bob wrote, at tick 3 that {}; nothing that ann perceived contradicted it.",
        {"options": {"testimony": "informed"}},
    ),
    (
        told,
        "/ann",
        A,
        "holds 1 diamond: ann, at (3.5, 0, 5.5), last perceived it at tick 1: ann looked in.",
        {"options": {"testimony": "none"}},
    ),
    (
        refuted,
        "/ann",
        A,
        f"{LOOKED} bob told ann at tick 23 that {{}}, which ann perceived at tick 25 to be wrong.",
        {},
    ),
    (
        read_and_refuted,
        "/ann",
        A,
        f"{LOOKED} ann read on the sign at (10, 0, 12) at tick 4 that {{}}, which ann perceived "
        "at tick 6 to be wrong.",
        {},
    ),
    (
        read_and_refuted,
        "/ann",
        B,
        "holds nothing: ann, at (17.5, 0, 5.5), last perceived it at "
        "tick 6: ann looked in. That is current.",
        {},
    ),
    (
        seen_written,
        "/ann",
        B,
        "perhaps more: ann read on the sign at (10, 0, 12), which bob wrote, at tick 3 that {}.",
        {},
    ),
    (
        seen_written,
        "/ann/bob",
        B,
        "as far as ann knows, bob wrote on the sign at (10, 0, 12) at tick 3 that {}.",
        {},
    ),
    (
        quiet,
        "/ann",
        A,
        "the container at A holds nothing: a prior belief, held since tick 0 (then 1 diamond); "
        "since then ann read on the sign at (10, 0, 12) at tick 0 that {}.",
        {"agents": {"ann": AT_SIGN}, "initial": EVERYBODY, **SIGNED},
    ),
    (
        quiet,
        "/ann/bob",
        A,
        "(then 1 diamond); since then, as far as ann knows, bob read on the sign at (10, 0, 12) "
        "at tick 0 that {}.",
        {"agents": {"ann": AT_SIGN, "bob": ALSO_SIGN}, "initial": EVERYBODY, **SIGNED},
    ),
    (
        deed_and_told,
        "/ann",
        A,
        "ann does not know what the chest at A holds: ann, at (3.5, 0, 5.5), saw what happened at "
        "tick 2: bob put 1 diamond in; since then bob told ann at tick 3 that {}.",
        {},
    ),
    (
        told_and_deed,
        "/ann",
        A,
        "holds 1 bread and 1 diamond, and perhaps more: bob told ann at tick 1 that diamond is in "
        "A; since then ann, at (3.5, 0, 5.5), saw what happened at tick 2: bob put 1 bread in. "
        "That is current.",
        {},
    ),
    (
        two_deposits,
        "/ann",
        A,
        "holds 2 bread and 1 diamond: a prior belief, held since tick 0 (then 1 diamond); since "
        "then ann, at (3.5, 0, 5.5), saw what happened at tick 1: bob put 1 bread in; and ann, at "
        "(3.5, 0, 5.5), saw what happened at tick 2: bob put 1 bread in. That is current.",
        {"initial": EVERYBODY},
    ),
    (
        repeated,
        "/ann",
        B,
        "cid told ann at tick 2 that {}; since then bob told ann at tick 3 that {}.",
        {},
    ),
    (
        edited,
        "/ann",
        A,
        f"{LOOKED} the only diamond was put at (17, 0, 3) by hand at tick 1.",
        UNIQUE,
    ),
    (edited_back, "/ann", A, "holds 1 diamond: edited by hand at tick 1.", UNIQUE),
    (
        edited_back,
        "/ann",
        B,
        "holds nothing: edited by hand at tick 1 (then 1 diamond); since then the only diamond "
        "was put at (3, 0, 3) by hand at tick 1.",
        UNIQUE,
    ),
    (
        found_in_a,
        "/ann",
        B,
        "ann does not know what the container at B holds: bob told ann at tick 1 that {}; since "
        "then ann perceived at tick 2 the only diamond at A.",
        UNIQUE,
    ),
    (
        lost_and_told,
        "/ann",
        A,
        "holds nothing: ann, at (3.5, 0, 5.5), saw the chest at A at tick 4 (then 1 diamond); "
        "since then cid told ann at tick 6 that {}.",
        {"options": {"containers": "transparent"}},
    ),
    (
        in_the_air,
        "/ann",
        B,
        "the container at B holds 1 diamond, and perhaps more: bob told ann at tick 2 that {}.",
        {},
    ),
]


@pytest.mark.parametrize(
    ("story", "path", "place", "expected", "setting"),
    CASES,
    ids=[f"{case[0].__name__} {case[1]} {'A' if case[2] == A else 'B'}" for case in CASES],
)
def test_an_explanation_tells_what_a_belief_rests_on(
    story: Story, path: str, place: Position, expected: str, setting: dict[str, Any]
) -> None:
    explanation = hall(story, **setting)[path].explain(container=place)
    line = next(one for one in reversed(str(explanation).splitlines()) if "At tick" not in one)
    named = expected.replace("{}", "diamond is in B")
    for place_, name in ((A, "A"), (B, "B")):
        line = line.replace(str(place_), name)
    for place_, name in ((A, "A"), (B, "B")):
        named = named.replace(str(place_), name)
    assert line.endswith(named)


def test_a_value_that_was_handed_on_names_its_source() -> None:
    """Bob tells Ann alone of a block out of sight; then she sees Cid come to see it."""

    def story(world: bn.ScriptedWorld, nest: bn.Nest) -> None:
        world.whisper("bob", "ann", "x", claims=[bn.Claim.block((3, 0, 18), "gold_block")])
        world.place_agent("bob", FAR)
        world.place_agent("cid", (3.5, 0, 11.5))

    nest = hall(story, agents={"cid": BY_B}, options={"max_visible_distance": 8})
    assert str(nest["/ann/cid"].explain(block=(3, 0, 18))).endswith(
        "as far as ann knows, cid, at (3.5, 0, 11.5), perceived at tick 3 what bob had said at "
        "tick 1."
    )


def test_a_belief_that_ended_without_an_act_is_no_change_of_contents():
    """The sign says that it is in B; Ann, who looks into A, then believes nothing about B."""
    far = {"max_visible_distance": 30}
    nest = hall(lambda world, _: world.open("ann", A), options=far, **UNIQUE, **SIGNED)
    assert str(nest["/ann/bob"].explain(container=B)).endswith(
        "saw the chest at (17, 0, 3), which does not show this. So bob missed this: ann no longer "
        "believed anything about what the chest at (17, 0, 3) holds."
    )
