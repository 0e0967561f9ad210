"""Claims, clause by clause (semantics, section 8), in the nest and in the reference.

Max is in the hall with two chests and knows where the diamond is; who is more than 6 blocks
away is out of sight. In most tests he goes away before he is told anything.
"""

from typing import Any

import pytest
from tests.semantics.reference import Reference
from tests.semantics.test_against_reference import split

import beliefnest as bn
from beliefnest.belief.grounds import Basis, ContainerBelief, Source
from beliefnest.world.values import EventKind, Position

LEFT, MIDDLE, RIGHT = (3, 0, 3), (10, 0, 3), (17, 0, 3)
HALL, BESIDE, OUTSIDE, FAR = (3.5, 0, 5.5), (5.5, 0, 5.5), (9.5, 0, 14.5), (1.5, 0, 19.5)
BY_RIGHT, NEAR_OUTSIDE = (17.5, 0, 5.5), (8.5, 0, 14.5)
GRACE = 10
SAYS_RIGHT = (bn.Claim.located("diamond", RIGHT),)


class Hall:
    """The nest and the reference, told the same things."""

    def __init__(self, depth: int = 2, **options: Any) -> None:
        options = {"max_visible_distance": 6, "grace": GRACE, "testimony": "informed"} | options
        self.world = bn.ScriptedWorld(
            ((0, 0, 0), (20, 1, 20)),
            agents={"max": HALL, "nora": BESIDE, "bob": FAR},
            containers={LEFT: {}, MIDDLE: {}, RIGHT: {}},
            inventories={"max": {"diamond": 2}, "nora": {"diamond": 1}},
        )
        perception = bn.Perception(**options)
        self.nest = bn.Nest(self.world, perception)
        self.reference = Reference(self.world.snapshot(), perception, depth=depth)
        self.world.listen(lambda frame: self.reference.frame((), frame))

    def go(self, **places: tuple[float, float, float]) -> None:
        with self.world.tick():
            for name, place in places.items():
                self.world.place_agent(name, place)

    def contents(self, path: str) -> dict[Position, ContainerBelief]:
        """Return a node's beliefs about containers; check that the reference has the same."""
        found = dict(self.nest[path].state.containers)
        assert found == self.reference.everything(split(path))["containers"]
        return found

    def where(self, path: str, item: str = "diamond") -> list[Position]:
        """Containers in which a node believes an item to be."""
        return sorted(place for place, held in self.contents(path).items() if item in held.items)


def hidden(**options: Any) -> Hall:
    """Max has put the diamond into the left chest, Nora looking on."""
    hall = Hall(**options)
    hall.world.deposit("max", LEFT, {"diamond": 1})
    return hall


def away(ticks: int = 0, **options: Any) -> Hall:
    """And has gone outside with Nora, who then was out of his sight for some ticks."""
    hall = hidden(**options)
    hall.go(max=OUTSIDE, nora=NEAR_OUTSIDE)
    if ticks:
        hall.go(nora=BY_RIGHT)
        hall.world.step(ticks - 1)
        hall.go(nora=NEAR_OUTSIDE)
    return hall


@pytest.mark.parametrize(
    ("testimony", "expected"), [("none", LEFT), ("accept", RIGHT), ("informed", LEFT)]
)
def test_under_accept_all_is_taken_up_that_is_said(testimony: str, expected: Position) -> None:
    hall = hidden(testimony=testimony)
    hall.world.say("nora", "It is on the right.", claims=SAYS_RIGHT)
    assert hall.where("/max") == [expected]


def test_1a_who_sees_the_known_place_needs_no_telling() -> None:
    hall = hidden()
    hall.go(nora=BY_RIGHT)
    hall.world.step(2 * GRACE)
    hall.world.say("nora", "It is on the right.", claims=SAYS_RIGHT)
    assert hall.where("/max") == [LEFT]


@pytest.mark.parametrize(("containers", "expected"), [("opaque", RIGHT), ("transparent", LEFT)])
def test_1a_a_closed_container_that_is_seen_from_outside_settles_nothing(
    containers: str, expected: Position
) -> None:
    hall = away(GRACE + 1, containers=containers)
    hall.go(max=BY_RIGHT)
    hall.world.say("nora", "It is on the right.", claims=SAYS_RIGHT)
    assert hall.where("/max") == [expected]


def test_1a_who_opens_the_claimed_container_needs_no_telling() -> None:
    hall = away(GRACE + 1)
    hall.go(max=BY_RIGHT)
    with hall.world.tick():
        hall.world.open("max", RIGHT)
        hall.world.say("nora", "It is on the right.", claims=SAYS_RIGHT)
    assert hall.where("/max") == [LEFT]


BOTH = pytest.mark.parametrize("testimony", ["accept", "informed"])


def beaten(hall: Hall, path: str = "/max") -> bool:
    """Return True if the last claim was heard at a path, and beaten by a percept."""
    told = hall.nest.claims()[-1]
    return told.is_heard(path) and not told.taken_up(path) and told.condition(path) in ("0", "1a")


@BOTH
@pytest.mark.parametrize("path", ["/max", "/bob/max", "/max/nora", "/bob/nora"])
def test_0_who_sees_an_agent_or_its_claimed_place_knows_better(testimony: str, path: str) -> None:
    hall = Hall(testimony=testimony, max_visible_distance=30)
    hall.world.say("nora", "There!", claims=[bn.Claim.position("bob", (9.5, 0, 9.5))])
    bob = hall.nest[path].state.agents["bob"]
    assert (bob.position, bob.current) == (FAR, True)
    near = Hall(testimony=testimony)
    near.world.say("nora", "Here!", claims=[bn.Claim.position("bob", (3.5, 0, 7.5))])
    assert near.nest["/max"].state.agents["bob"].position is None
    assert beaten(near)


@BOTH
@pytest.mark.parametrize("path", ["/max", "/max/nora", "/bob/max/nora"])
def test_0_who_sees_a_block_knows_better(testimony: str, path: str) -> None:
    hall = Hall(testimony=testimony, max_visible_distance=30)
    hall.world.say("nora", "A stone!", claims=[bn.Claim.block((4, 0, 3), "stone")])
    blocks = hall.nest[path].state.blocks
    assert (blocks[(4, 0, 3)], blocks.current((4, 0, 3))) == ("air", True)
    assert beaten(hall, path)


@BOTH
@pytest.mark.parametrize(
    "claim",
    [
        bn.Claim.located("diamond", RIGHT),
        bn.Claim.located("diamond", LEFT),
        bn.Claim.located("gold_ingot", LEFT),
        bn.Claim.absent("diamond", LEFT),
    ],
)
def test_0_who_sees_into_containers_knows_better(testimony: str, claim: bn.Claim) -> None:
    paths = ("/max", "/bob/max", "/max/nora")
    hall = Hall(testimony=testimony, max_visible_distance=30, containers="transparent")
    hall.world.deposit("max", LEFT, {"diamond": 1})
    assert all(hall.contents(path)[LEFT].current for path in paths)
    hall.world.say("nora", "So it is.", claims=[claim])
    for path in paths:
        assert hall.where(path) == [LEFT]
        after = hall.contents(path)[LEFT]
        assert (after.items, after.current) == ({"diamond": 1}, True)
        assert beaten(hall, path)


@BOTH
def test_0_who_looks_in_in_this_tick_knows_better(testimony: str) -> None:
    hall = away(GRACE + 1, testimony=testimony)
    hall.go(max=BY_RIGHT, nora=(18.5, 0, 5.5))
    with hall.world.tick():
        hall.world.open("max", RIGHT)
        hall.world.say("nora", "It is on the right.", claims=SAYS_RIGHT)
    assert hall.where("/max") == [LEFT]
    # Max sees that it is closed; what it knew of the content a tick ago is no percept now.
    hall.world.say("nora", "It is on the right.", claims=SAYS_RIGHT)
    assert hall.where("/max") == [RIGHT]


@BOTH
@pytest.mark.parametrize("claim", [SAYS_RIGHT[0], bn.Claim.absent("diamond", LEFT)])
def test_0_who_sees_an_item_put_somewhere_in_this_tick_knows_better(
    testimony: str, claim: bn.Claim
) -> None:
    hall = Hall(testimony=testimony)
    with hall.world.tick():
        hall.world.deposit("nora", LEFT, {"diamond": 1})
        hall.world.say("nora", "No!", claims=[claim])
    assert (hall.where("/max"), hall.where("/max/nora")) == ([LEFT], [LEFT])


def test_0_the_condition_is_told() -> None:
    hall = Hall(testimony="accept", max_visible_distance=30)
    hall.world.say("nora", "A stone!", claims=[bn.Claim.block((4, 0, 3), "stone")])
    (told,) = hall.nest.claims()
    assert told.condition("/max") == told.condition("/max/nora") == "0"
    assert told.why("/max") == "max perceives how it is, and seeing beats hearing (0)"


@pytest.mark.parametrize(("ticks", "expected"), [(GRACE, LEFT), (GRACE + 1, RIGHT)])
def test_1b_the_speaker_needs_a_chance_to_learn_what_the_hearer_could_not_notice(
    ticks: int, expected: Position
) -> None:
    hall = away(ticks)
    hall.world.say("nora", "It is on the right.", claims=SAYS_RIGHT)
    assert hall.where("/max") == [expected]


def test_1b_counts_from_when_the_known_place_was_last_watched() -> None:
    hall = hidden()
    hall.go(nora=BY_RIGHT)
    hall.world.step(2 * GRACE)
    hall.go(max=OUTSIDE, nora=NEAR_OUTSIDE)
    hall.world.say("nora", "It is on the right.", claims=SAYS_RIGHT)
    assert hall.where("/max") == [LEFT]


def test_1b_ticks_in_which_the_two_see_each_other_do_not_count() -> None:
    hall = away()
    hall.world.step(5 * GRACE)
    hall.world.say("nora", "It is on the right.", claims=SAYS_RIGHT)
    assert hall.where("/max") == [LEFT]


def test_1b_holds_where_there_is_no_known_place() -> None:
    hall = Hall()
    hall.go(max=OUTSIDE, nora=NEAR_OUTSIDE)
    hall.world.say("nora", "It is on the right.", claims=SAYS_RIGHT)
    assert hall.where("/max") == [RIGHT]


def test_an_item_seen_taken_out_has_no_known_place() -> None:
    hall = hidden()
    hall.world.withdraw("nora", LEFT, {"diamond": 1})
    hall.go(max=OUTSIDE, nora=NEAR_OUTSIDE)
    hall.world.say("nora", "It is on the right.", claims=SAYS_RIGHT)
    assert hall.where("/max") == [RIGHT]


def test_an_item_that_was_looked_for_in_vain_has_no_known_place() -> None:
    hall = away()
    hall.world.withdraw("bob", LEFT, {"diamond": 1})
    hall.go(max=HALL, nora=BESIDE)
    hall.world.open("max", LEFT)
    hall.go(max=OUTSIDE, nora=NEAR_OUTSIDE)
    hall.world.say("nora", "It is on the right.", claims=SAYS_RIGHT)
    assert hall.where("/max") == [RIGHT]


def test_hearsay_gives_no_known_place() -> None:
    hall = Hall()
    hall.go(max=OUTSIDE, nora=NEAR_OUTSIDE)
    hall.world.say("nora", "Right.", claims=SAYS_RIGHT)
    hall.world.say("nora", "Left.", claims=[bn.Claim.located("diamond", LEFT)])
    assert hall.where("/max") == [LEFT]


def test_2_what_is_taken_up_rests_on_the_utterance_and_is_neither_complete_nor_current() -> None:
    hall = away(GRACE + 1)
    hall.world.say("nora", "It is on the right.", claims=SAYS_RIGHT)
    left, right = (hall.contents("/max")[place] for place in (LEFT, RIGHT))
    basis = Basis(hall.world.now, Source.HEARD, EventKind.CHAT, "nora")
    assert (left.items, left.complete, left.basis) == ({}, True, basis)
    assert (right.items, right.complete, right.current) == ({"diamond": 1}, False, False)
    assert right.basis == basis


def test_2_one_such_item_is_moved_and_the_others_stay() -> None:
    hall = Hall(testimony="accept")
    hall.world.deposit("max", LEFT, {"diamond": 2})
    hall.world.say("nora", "One is on the right.", claims=SAYS_RIGHT)
    contents = hall.contents("/max")
    assert (contents[LEFT].items, contents[RIGHT].items) == ({"diamond": 1}, {"diamond": 1})


def test_2_what_is_left_in_a_container_rests_on_what_was_perceived_there() -> None:
    hall = Hall(testimony="accept", max_visible_distance=20)
    hall.world.deposit("max", LEFT, {"diamond": 2})
    before = hall.contents("/max")[LEFT].basis
    hall.world.say("nora", "One is on the right.", claims=SAYS_RIGHT)
    left = hall.contents("/max")[LEFT]
    assert (left.items, left.basis, left.current) == ({"diamond": 1}, before, False)
    # Hearsay is younger than that: the next one comes out of the right chest.
    there = bn.Claim.located("diamond", MIDDLE)
    hall.world.say("nora", "Now it is in the middle.", claims=[there])
    assert hall.where("/max") == [LEFT, MIDDLE]


def test_2_absent_removes_what_was_believed_to_be_there() -> None:
    hall = away(GRACE + 1)
    hall.world.say("nora", "It is gone.", claims=[bn.Claim.absent("diamond", LEFT)])
    assert hall.where("/max") == []


def test_2_later_perception_replaces_what_was_heard() -> None:
    hall = away(GRACE + 1)
    hall.world.say("nora", "It is on the right.", claims=SAYS_RIGHT)
    hall.go(max=HALL)
    hall.world.open("max", LEFT)
    assert hall.contents("/max")[LEFT].items == {"diamond": 1}


def test_2_position_and_block_set_the_value() -> None:
    hall = away(GRACE + 1)
    claims = [bn.Claim.position("bob", (3.5, 0, 1.5)), bn.Claim.block((3, 1, 3), "stone")]
    hall.world.say("nora", "Bob is there, and a stone.", claims=claims)
    basis = Basis(hall.world.now, Source.HEARD, EventKind.CHAT, "nora")
    for path in ("/max", "/nora/max", "/max/nora"):
        state, node = hall.nest[path].state, hall.reference.tree(split(path)).node
        bob = state.agents["bob"]
        assert (bob.position, bob.current, bob.basis) == ((3.5, 0, 1.5), False, basis)
        assert node.agents["bob"] == bob
        assert (state.blocks[(3, 1, 3)], state.blocks.basis((3, 1, 3))) == ("stone", basis)


def test_properties_that_a_claim_does_not_name_stay_as_they_are_believed() -> None:
    hall = Hall(testimony="accept")
    hall.world.set_block((5, 0, 3), "oak_door[facing=west,open=false]")
    hall.go(max=OUTSIDE, nora=NEAR_OUTSIDE)
    hall.world.say("nora", "Open!", claims=[bn.Claim.block((5, 0, 3), "oak_door[open=true]")])
    believed = hall.nest["/max"].state.blocks[(5, 0, 3)]
    assert believed is not None
    assert "facing=west" in believed
    assert "open=true" in believed


@pytest.mark.parametrize("testimony", ["accept", "informed"])
def test_3_who_speaks_is_taken_to_believe_what_it_says(testimony: str) -> None:
    hall = away(GRACE + 1, testimony=testimony)
    hall.world.say("nora", "It is on the right.", claims=SAYS_RIGHT)
    assert hall.where("/max/nora") == [RIGHT]


def test_3_unless_it_is_known_to_have_learnt_nothing_new() -> None:
    honest, known = away(GRACE + 1), away(GRACE)
    for hall in (honest, known):
        hall.world.say("nora", "It is on the right.", claims=SAYS_RIGHT)
    assert (honest.where("/max/nora"), known.where("/max/nora")) == ([RIGHT], [LEFT])


def test_3_holds_of_a_speaker_of_whom_no_known_place_is_known() -> None:
    hall = Hall()
    hall.go(nora=OUTSIDE)
    hall.world.deposit("max", LEFT, {"diamond": 1})
    hall.go(nora=BESIDE)
    hall.world.say("nora", "It is on the right.", claims=SAYS_RIGHT)
    assert (hall.where("/max"), hall.where("/max/nora")) == ([LEFT], [RIGHT])


@pytest.mark.parametrize(("sincere", "expected"), [(True, RIGHT), (False, LEFT)])
def test_sincere_alone_decides_what_is_thought_of_one_who_is_not_believed(
    sincere: bool, expected: Position
) -> None:
    hall = away(GRACE + 1, sincere=sincere, containers="transparent")
    hall.go(max=BY_RIGHT)
    hall.world.say("nora", "It is on the right.", claims=SAYS_RIGHT)
    assert hall.where("/max") == [LEFT]
    assert hall.where("/max/nora") == [expected]


def test_not_sincere_is_nothing_to_who_is_believed() -> None:
    hall = away(GRACE + 1, sincere=False)
    hall.world.say("nora", "It is on the right.", claims=SAYS_RIGHT)
    assert (hall.where("/max"), hall.where("/max/nora")) == ([RIGHT], [RIGHT])


@pytest.mark.parametrize("testimony", ["none", "accept", "informed"])
def test_4_a_lie_changes_nothing_of_what_the_liar_believes(testimony: str) -> None:
    hall = away(GRACE + 1, testimony=testimony)
    hall.world.say("nora", "It is on the right.", claims=SAYS_RIGHT)
    assert hall.where("/nora") == [LEFT]


def test_5_whether_it_is_thought_to_be_taken_up_is_the_same_rule_one_node_deeper() -> None:
    hall = away(GRACE + 1, depth=3)
    hall.world.say("nora", "It is on the right.", claims=SAYS_RIGHT)
    assert (hall.where("/nora/max"), hall.where("/max/nora/max")) == ([RIGHT], [RIGHT])
    assert hall.where("/nora/max/nora") == [RIGHT]


def test_what_was_not_heard_changes_nobody() -> None:
    hall = away(GRACE + 1)
    hall.world.whisper("nora", "max", "It is on the right.", claims=SAYS_RIGHT)
    assert hall.where("/max") == [RIGHT]
    assert (hall.where("/max/bob"), hall.where("/bob")) == ([], [])


def test_claims_of_one_utterance_are_taken_in_order_each_for_itself() -> None:
    hall = Hall(testimony="accept")
    claims = [
        bn.Claim.located("diamond", LEFT),
        bn.Claim.located("emerald", RIGHT),
        bn.Claim.absent("diamond", LEFT),
    ]
    hall.world.say("nora", "So.", claims=claims)
    assert (hall.where("/max"), hall.where("/max", "emerald")) == ([], [RIGHT])


def test_nobody_can_be_told_where_they_are_themselves() -> None:
    hall = Hall(testimony="accept")
    hall.world.say("nora", "You are there.", claims=[bn.Claim.position("max", FAR)])
    assert hall.nest["/max"].state.agents["max"].position == HALL
    assert hall.nest["/nora/bob"].state.agents["max"].position == FAR


@pytest.mark.parametrize("testimony", ["accept", "informed"])
@pytest.mark.parametrize("block", ["bricks", "air"])
def test_who_sees_no_container_at_a_place_believes_nothing_to_be_in_it(
    testimony: str, block: str
) -> None:
    hall = Hall(testimony=testimony)
    place = (4, 0, 4)
    hall.world.set_block(place, block)
    hall.world.step(3 * GRACE)
    hall.world.say("nora", "Right here.", claims=[bn.Claim.located("diamond", place)])
    # Max and Nora see the place; Bob is far away.
    for path in ("/max", "/nora", "/max/nora", "/nora/max"):
        assert hall.where(path) == []
    assert hall.where("/bob") == [place]
