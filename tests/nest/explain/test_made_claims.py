"""Claims made in a nest, and the explanation of hearsay."""

from pathlib import Path

import pytest

import beliefnest as bn
from beliefnest.prompts import built_in_template
from beliefnest.world.values import Point

LEFT, RIGHT = (3, 0, 3), (17, 0, 3)
HALL, BESIDE, OUTSIDE, NEAR, FAR = (
    (3.5, 0.0, 5.5),
    (5.5, 0.0, 5.5),
    (9.5, 0.0, 14.5),
    (8.5, 0.0, 14.5),
    (17.5, 0.0, 5.5),
)
TRUTH, LIE = bn.Claim.located("diamond", LEFT), bn.Claim.located("diamond", RIGHT)


def played(store: Path | None = None, **options: object) -> bn.Nest:
    """Nora lies to Max, who has not seen her for a while; Bob hears nothing of it."""
    world = bn.ScriptedWorld(
        ((0, 0, 0), (20, 3, 20)),
        agents={"max": HALL, "nora": BESIDE, "bob": FAR},
        containers={LEFT: {}, RIGHT: {}},
        inventories={"max": {"diamond": 1}},
    )
    perception = {"max_visible_distance": 6, "grace": 5, "testimony": "informed"} | options
    nest = bn.Nest(world, bn.Perception(**perception), store=store)  # type: ignore[arg-type]  # of any type

    def go(name: str, place: Point) -> None:
        world.place_agent(name, place)

    world.deposit("max", LEFT, {"diamond": 1})
    go("max", OUTSIDE)
    world.step(10)
    world.say("nora", "It is there.", claims=[TRUTH])
    go("nora", NEAR)
    world.whisper("nora", "max", "It is on the right.", claims=[LIE])
    return nest


def test_every_claim_is_told_with_who_heard_it_and_what_it_was() -> None:
    truth, lie = played().claims()
    assert (truth.tick, truth.speaker, truth.addressee, truth.text) == (
        13,
        "nora",
        None,
        "It is there.",
    )
    assert (truth.claim, truth.false, truth.lie, truth.hearers) == (
        TRUTH,
        False,
        False,
        ("bob", "max"),
    )
    assert (lie.claim, lie.false, lie.lie, lie.hearers) == (LIE, True, True, ("max",))
    assert (lie.addressee, lie.text) == ("max", "It is on the right.")


def test_of_any_belief_it_is_told_whether_it_was_taken_up_and_by_which_condition() -> None:
    truth, lie = played().claims()
    told = {
        path: (lie.taken_up(path), lie.why(path)) for path in ("/max", "/bob", "/nora", "/max/nora")
    }
    assert [taken for taken, _ in told.values()] == [True, False, False, True]
    assert "bob did not hear it" in told["/bob"][1]
    assert told["/nora"][1].endswith("changes nothing of what nora believes (4)")
    assert told["/max/nora"][1] == "as far as max knows, nora believes what nora says (3)"
    assert truth.taken_up("/bob")
    never = played(grace=1000).claims()[1]
    assert (never.taken_up("/max"), never.why("/max")[-5:]) == (False, " (1b)")
    assert "1000 ticks" in never.why("/max/nora")
    assert "testimony is 'none'" in played(testimony="none").claims()[1].why("/max")
    with pytest.raises(bn.InputError, match="'/' is not a belief in /"):
        lie.why("/")
    with pytest.raises(bn.PathError, match="zed"):
        lie.taken_up("/zed")


def test_what_is_left_where_something_was_said_to_have_gone_is_explained_by_both() -> None:
    world = bn.ScriptedWorld(
        ((0, 0, 0), (20, 3, 20)),
        agents={"max": HALL, "nora": BESIDE},
        containers={LEFT: {}, RIGHT: {}},
        inventories={"nora": {"diamond": 2}},
    )
    nest = bn.Nest(world, bn.Perception(testimony="accept"))
    world.deposit("nora", LEFT, {"diamond": 2})
    world.say("nora", "One is on the right.", claims=[LIE])
    told = str(nest["/max"].explain(container=LEFT))
    assert "nora put 2 diamond in; since then nora told max at tick 2 that diamond is in" in told
    world.say("nora", "Nothing on the right.", claims=[bn.Claim.absent("diamond", RIGHT)])
    told = str(nest["/max"].explain(container=RIGHT))
    assert "nora told max at tick 3 that diamond is not in (17, 0, 3)" in told


def test_prompts_tell_hearsay_from_what_was_seen_and_from_ones_own_words() -> None:
    world = bn.ScriptedWorld(
        ((0, 0, 0), (20, 3, 20)), agents={"max": HALL, "nora": BESIDE, "sal": FAR}
    )
    nest = bn.Nest(world, bn.Perception(max_visible_distance=6, testimony="accept"))
    world.say("nora", "Sal is there.", claims=[bn.Claim.position("sal", (9.5, 0, 9.5))])
    template = built_in_template("default")
    max_, nora = (nest[path].render(template, task="-") for path in ("/max", "/max/nora"))
    for prompt in (max_, nora):
        assert "1;heardOf;sal;position:[9.5, 0, 9.5];" in prompt
    assert "sal: at [9.5, 0, 9.5]; heard from nora 0 s ago" in max_
    assert "sal: at [9.5, 0, 9.5]; said 0 s ago" in nora


def test_the_same_is_told_of_the_past_and_of_what_was_recorded(tmp_path: Path) -> None:
    store = tmp_path / "run.bn"
    with played(store) as nest:
        assert [told.claim for told in nest.at(13).claims()] == [TRUTH]
    with bn.Nest.read(store) as recorded:
        lie = recorded.claims()[-1]
        assert (lie.claim, lie.false, lie.lie, lie.taken_up("/max")) == (LIE, True, True, True)


def test_claims_on_a_branch_are_told_there() -> None:
    nest = played()
    belief = nest["/max"]
    belief.switch("try")
    belief.scripted.say("nora", "Left!", claims=[TRUTH])
    (told,) = nest.claims("/max")
    assert (told.claim, told.false, told.taken_up("/max/nora")) == (TRUTH, True, True)
    assert len(nest.claims()) == 2


def test_who_speaks_in_a_world_of_their_own_belief_lies_against_it() -> None:
    nest = played()
    belief = nest["/nora"]
    belief.switch("try")
    belief.scripted.place_agent("max", HALL)
    belief.scripted.withdraw("max", LEFT, {"diamond": 1})
    belief.scripted.say("nora", "It is there.", claims=[TRUTH])
    (lie,) = nest.claims("/nora")
    assert (lie.false, lie.lie) == (True, True)


def test_hearsay_is_explained_as_such() -> None:
    nest = played()
    told = str(nest["/max"].explain(container=RIGHT))
    assert "nora told max at tick 15 that diamond is in (17, 0, 3); nothing that max" in told
    assert "nora said at tick 15 that diamond" in str(nest["/max/nora"].explain(container=RIGHT))
    accepting = played(testimony="accept")
    taken = str(nest["/max"].explain(container=LEFT))
    assert (
        "max, at (3.5, 0, 5.5), perceived it at tick 1: max put 1 diamond in (then 1 diam" in taken
    )
    assert "nora told max at tick 15 that diamond is in (17, 0, 3); nothing" in taken
    assert "nora told max at tick 15 that diamond is in (17, 0, 3)." in str(
        accepting["/max"].explain(container=RIGHT)
    )


def test_each_sentence_is_the_view_of_the_believer_it_names() -> None:
    lie = played().claims()[1]
    assert lie.why("/bob") == "bob did not hear it"
    assert lie.why("/bob/nora") == "bob does not know of it"
    assert lie.why("/bob/nora/max") == "bob does not know of it"
    assert lie.why("/nora/bob") == "as far as nora knows, bob did not hear it"
    assert lie.why("/max/bob/nora") == "as far as max knows, bob does not know of it"
    assert lie.why("/max/nora/bob") == (
        "max believes that as far as nora knows, bob did not hear it"
    )
