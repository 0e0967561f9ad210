"""Reasons for the beliefs of a node, level by level, in facts and in words."""

import pytest
from tests.nest.places import CHEST, CLOSED, CORNER, EAST, GAP, MEETING, OPEN, WEST, nest_of
from tests.semantics.test_sally_anne import BEFORE_LEFT, LEFT, RIGHT, walls

import beliefnest as bn
from beliefnest.belief.grounds import Basis, Source
from beliefnest.errors import InputError, PathError, PositionError, TickError
from beliefnest.nest.explain.parts import View
from beliefnest.world.values import EventKind

THREE = {"observer": WEST, "sally": MEETING, "anne": GAP}
EAST_2 = (8.5, 0.0, 3.5)
WEST_CHEST = (2, 0, 5)
EAST_BLOCK = (8, 0, 5)


def corner(**kwargs):
    return nest_of(THREE, CORNER, chests={CHEST: {"emerald": 1}}, **kwargs)


def lines(explanation):
    return str(explanation).splitlines()


def sally_anne(sallys_place):
    """Play the paper's story up to Anne's taking the diamond, at tick 5."""
    world = bn.ScriptedWorld(
        ((-11, -52, -11), (11, -49, 11)),
        walls(),
        {"sally": (-0.5, -51, 3.5), "anne": (2.5, -51, -0.5), "observer": (-3.5, -51, 9.5)},
        inventories={"sally": {"diamond": 1}},
        containers={LEFT: {}, RIGHT: {}},
    )
    nest = bn.Nest(world, static_blocks=["stone_bricks", "smooth_stone"])
    world.place_agent("sally", BEFORE_LEFT)
    world.deposit("sally", LEFT, {"diamond": 1})
    world.place_agent("sally", sallys_place)
    world.place_agent("anne", BEFORE_LEFT)
    world.withdraw("anne", LEFT, {"diamond": 1})
    return nest


def test_which_wall_hides_the_move_from_sally():
    nest = sally_anne((9.5, -51, 3.5))
    told = nest["/observer/sally"].explain(container=LEFT)
    assert lines(told) == [
        "In reality, the chest at (-2, -51, -4) holds nothing since tick 5: "
        "anne took 1 diamond out.",
        "observer does not know what the chest at (-2, -51, -4) holds: "
        "observer, at (-3.5, -51, 9.5), saw what happened at tick 5: anne took 1 diamond out. "
        "That is current.",
        "observer believes that sally believes that the chest at (-2, -51, -4) holds "
        "1 diamond, and perhaps more: as far as observer knows, sally, at (-1.5, -51, -2.5), "
        "last perceived it at tick 2: sally put 1 diamond in.",
        "At tick 5 observer saw that sally, at (9.5, -51, 3.5), could not see anne, "
        "at (-1.5, -51, -2.5): the stone_bricks at (6, -50, 1) blocks it; and could not see "
        "the chest at (-2, -51, -4): the stone_bricks at (7, -50, 1) blocks it. "
        "So sally missed this: anne took 1 diamond out.",
    ]
    (_, level) = told.levels
    assert (level.path, level.holder) == (("observer", "sally"), "sally")
    assert level.value == bn.Contents({"diamond": 1}, complete=False)
    assert level.basis == Basis(2, Source.WITNESSED, EventKind.DEPOSIT_ITEM_INTO_CHEST)
    assert (level.current, level.since, level.stood) == (False, 2, BEFORE_LEFT)
    missed = level.missed
    assert (missed.tick, missed.stood, missed.absence) == (5, (9.5, -51, 3.5), None)
    assert [(act.kind, act.actor) for act in missed.acts] == [
        (EventKind.GET_ITEM_FROM_CHEST, "anne")
    ]
    assert [(s.target, s.view, s.blocker) for s in missed.sightings] == [
        ("anne", View.BLOCKED, (6, -50, 1)),
        ("chest", View.BLOCKED, (7, -50, 1)),
    ]


def test_who_sees_the_move_has_missed_nothing():
    nest = sally_anne((6.5, -51, -5.5))
    told = nest["/observer/sally"].explain(container=LEFT)
    assert [level.missed for level in told.levels] == [None, None]
    assert lines(told)[-1] == (
        "observer believes that sally does not know what the chest at (-2, -51, -4) holds: "
        "as far as observer knows, sally, at (6.5, -51, -5.5), saw what happened at tick 5: "
        "anne took 1 diamond out. That is current."
    )


def test_who_is_out_of_sight_is_credited_with_nothing():
    nest = sally_anne((-8.5, -51, -4.5))
    told = nest["/observer/sally"].explain(container=LEFT)
    missed = told.levels[-1].missed
    assert (missed.tick, missed.sightings) == (5, ())
    assert missed.absence.last_seen == 2
    assert missed.absence.sighting.target == "sally"
    assert missed.absence.sighting.blocker_name == "stone_bricks"
    assert lines(told)[-1] == (
        "At tick 5 observer could not tell what sally saw: observer last saw sally at tick 2, "
        "at (-1.5, -51, -2.5), and could not see sally, at (-8.5, -51, -4.5): "
        "the stone_bricks at (-7, -50, -1) blocks it. "
        "So sally missed this: anne took 1 diamond out."
    )
    assert nest["/sally"].explain(container=LEFT).levels[0].missed is None


def test_the_past_is_explained_as_it_was():
    nest = sally_anne((9.5, -51, 3.5))
    told = nest.at(4)["/observer/sally"].explain(container=LEFT)
    assert (told.tick, told.fact.since) == (4, 2)
    assert [level.missed for level in told.levels] == [None, None]
    assert told.levels[1] == nest.at(4)["/observer/sally"].explain(container=LEFT).levels[1]
    (_, then, anne) = lines(nest.at(5)["/sally"].explain(agent="anne"))
    assert then == (
        "sally believes that anne is at (2.5, -51, -0.5): "
        "sally, at (-1.5, -51, -2.5), last saw anne at tick 2."
    )
    assert anne.endswith(
        "So sally missed this: anne moved from (2.5, -51, -0.5) to (-1.5, -51, -2.5)."
    )


def test_a_current_belief_about_an_agent():
    _, nest = corner()
    told = nest["/observer/sally"].explain(agent="anne")
    assert lines(told) == [
        "In reality, anne is at (5.5, 0, 10.5); that has not changed since the start.",
        "observer believes that anne is at (5.5, 0, 10.5): observer, at (2.5, 0, 1.5), last saw "
        "anne at tick 0. That is current.",
        "observer believes that sally believes that anne is at (5.5, 0, 10.5): as far as "
        "observer knows, sally, at (4.5, 0, 9.5), last saw anne at tick 0. "
        "That is current.",
    ]


def test_what_was_never_seen_and_which_block_hides_it():
    world, nest = nest_of({"a": WEST, "b": EAST}, CLOSED)
    world.step(3)
    told = nest["/a"].explain(agent="b")
    (level,) = told.levels
    assert (level.value, level.basis, level.since) == (None, None, None)
    assert lines(told)[1:] == [
        "a knows nothing of b.",
        "At tick 3 a, at (2.5, 0, 1.5), could not see b, at (8.5, 0, 1.5): "
        "the stone at (5, 1, 1) blocks it.",
    ]


def test_too_far():
    _, nest = nest_of({"a": (0.5, 0, 0.5), "b": (8.5, 0, 0.5)}, OPEN, max_visible_distance=5)
    told = nest["/a"].explain(agent="b")
    (look,) = told.levels[0].missed.sightings
    assert (look.view, look.blocker) == (View.TOO_FAR, None)
    assert look.distance == pytest.approx((8**2 + 0.72**2) ** 0.5)
    assert lines(told)[-1] == (
        "At tick 0 a, at (0.5, 0, 0.5), could not see b, at (8.5, 0, 0.5): "
        "it is 8.0 blocks away, which is too far."
    )


def test_too_far_and_outside_the_field_of_view_is_too_far():
    _, nest = nest_of(
        {"a": (0.5, 0, 0.5), "b": (0.5, 0, 9.5)}, OPEN, max_visible_distance=5, field_of_view=90
    )
    (look,) = nest["/a"].explain(agent="b").levels[0].missed.sightings
    assert look.view is View.TOO_FAR


def test_too_far_and_behind_a_wall_is_too_far():
    _, nest = nest_of({"a": WEST, "b": EAST}, CLOSED, max_visible_distance=5)
    (look,) = nest["/a"].explain(agent="b").levels[0].missed.sightings
    assert (look.view, look.blocker) == (View.TOO_FAR, None)


def test_outside_the_field_of_view():
    _, nest = nest_of({"a": (2.5, 0, 5.5), "b": (2.5, 0, 9.5)}, OPEN, field_of_view=90)
    told = nest["/a"].explain(agent="b")
    assert lines(told)[-1] == (
        "At tick 0 a, at (2.5, 0, 5.5), could not see b, at (2.5, 0, 9.5): "
        "that is outside the field of view."
    )
    assert nest["/b"].explain(agent="a").levels[0].current


def test_a_wall_behind_which_nobody_was_ever_seen():
    agents = {"observer": WEST, "sally": EAST}
    _, nest = nest_of(agents, CLOSED, chests={WEST_CHEST: {}})
    told = nest["/observer/sally"].explain(container=WEST_CHEST)
    assert lines(told)[-2:] == [
        "observer believes that sally knows nothing of a container at (2, 0, 5).",
        "At tick 0 observer could not tell what sally saw: observer has never known where "
        "sally is, and could not see sally, at (8.5, 0, 1.5): the stone at (5, 1, 1) blocks it.",
    ]


def test_absence_further_down_tells_of_no_look():
    """Of Anne, whom the observer does not see, it cannot tell why she does not see Sally."""
    agents = {"observer": WEST, "sally": EAST_2, "anne": EAST}
    _, nest = nest_of(agents, CLOSED, chests={WEST_CHEST: {}})
    nest["/observer/anne"].edit(containers={WEST_CHEST: {"apple": 1}})
    told = nest["/observer/anne/sally"].explain(container=WEST_CHEST)
    assert told.levels[-1].missed.absence.sighting is None
    assert lines(told)[-1] == (
        "At tick 0, as far as observer knows, anne could not tell what sally saw: "
        "anne has never known where sally is."
    )


def test_a_prior_and_what_happened_since():
    prior = bn.InitialBelief(("observer",), containers={CHEST: ({"apple": 1}, True)})
    world, nest = corner(initial_beliefs=[prior])
    (level,) = nest["/observer"].explain(container=CHEST).levels
    assert level.basis.source is Source.PRIOR
    assert lines(nest["/observer"].explain(container=CHEST))[1] == (
        "observer believes that the chest at (5, 0, 9) holds 1 apple: "
        "a prior belief, held since tick 0."
    )
    world.place_agent("anne", EAST)
    world.withdraw("anne", CHEST, {"emerald": 1})
    assert lines(nest["/observer"].explain(container=CHEST))[2] == (
        "At tick 2 observer, at (2.5, 0, 1.5), could not see anne, at (8.5, 0, 1.5): "
        "the stone at (5, 1, 1) blocks it; and saw the chest at (5, 0, 9), which does not "
        "show this. So observer missed this: anne took 1 emerald out."
    )


def test_an_edit_and_who_is_not_told_of_it():
    world, nest = corner()
    world.step(4)
    nest["/observer"].edit(containers={CHEST: {"apple": 2}})
    told = nest["/observer/sally"].explain(container=CHEST)
    assert told.levels[1].missed.edited
    assert lines(told) == [
        "In reality, the chest at (5, 0, 9) holds 1 emerald; that has not changed since the start.",
        "observer believes that the chest at (5, 0, 9) holds 2 apple: edited by hand at tick 4.",
        "observer believes that sally does not know what the chest at (5, 0, 9) holds: as far as "
        "observer knows, sally, at (4.5, 0, 9.5), first saw the chest at (5, 0, 9) at tick 0, but "
        "not what it holds.",
        "At tick 4 observer saw that sally, at (4.5, 0, 9.5), saw the chest at (5, 0, 9), which "
        "does not show this. So sally missed this: it was edited by hand.",
    ]
    nest["/"].edit(containers={CHEST: {"apple": 3}})
    fact = nest["/"].explain(container=CHEST)
    assert lines(fact) == [
        "In reality, the chest at (5, 0, 9) holds 3 apple since tick 4: it was edited by hand."
    ]
    assert (fact.levels, fact.fact.edited) == ((), True)


def test_an_edit_in_the_tick_of_the_last_perception_is_missed():
    world, nest = corner(inventories={"anne": {"diamond": 1}})
    world.deposit("anne", CHEST, {"diamond": 1})
    nest["/observer"].edit(containers={CHEST: {"apple": 2}})
    level = nest["/observer/sally"].explain(container=CHEST).levels[1]
    assert level.value == bn.Contents({"diamond": 1}, complete=False)
    assert (level.since, level.missed.tick, level.missed.edited) == (1, 1, True)


def test_what_somebody_sees_of_an_edit_further_up_is_no_edit_of_its_own():
    """Sally sees what the observer's belief was edited to; of Anne she has lost sight."""
    place = (2, 0, 3)
    world, nest = nest_of(THREE | {"sally": (2.5, 0.0, 5.5)}, CORNER)
    world.place_agent("anne", EAST_2)
    nest["/observer"].edit(blocks={place: "bricks"})
    told = nest["/observer/sally/anne"].explain(block=place)
    assert [level.value for level in told.levels] == ["bricks", "bricks", "air"]
    assert not told.levels[2].missed.edited
    assert told.levels[2].missed.absence.last_seen == 0
    assert lines(told)[-1].endswith("So anne missed this: the block at (2, 0, 3) became bricks.")


def test_opening_tells_the_contents_to_who_opens_only():
    world, nest = corner()
    world.open("anne", CHEST)
    told = nest["/anne/observer"].explain(container=CHEST)
    assert told.levels[1].missed.saw_acts
    assert lines(told)[1:] == [
        "anne believes that the chest at (5, 0, 9) holds 1 emerald: anne, at (5.5, 0, 10.5), "
        "last perceived it at tick 1: anne looked in. That is current.",
        "anne believes that observer does not know what the chest at (5, 0, 9) holds: as far as "
        "anne knows, observer, at (2.5, 0, 1.5), first saw the chest at (5, 0, 9) at tick 0, but "
        "not what it holds.",
        "At tick 1 anne saw that observer, at (2.5, 0, 1.5), saw this, which does not show "
        "what the chest at (5, 0, 9) holds: anne looked in.",
    ]


def test_a_stale_belief_that_was_handed_on_later():
    """Sally meets the observer's outdated belief about Anne when she comes into its sight."""
    agents = {"observer": WEST, "sally": EAST, "anne": GAP}
    world, nest = nest_of(agents, CORNER)
    world.place_agent("anne", EAST_2)
    world.step(1)
    world.place_agent("sally", MEETING)
    told = nest["/observer/sally"].explain(agent="anne")
    level = told.levels[1]
    assert (level.basis.observed_at, level.since, level.stood) == (0, 3, MEETING)
    assert lines(told)[-1] == (
        "observer believes that sally believes that anne is at (5.5, 0, 10.5): as far as "
        "observer knows, sally, at (4.5, 0, 9.5), perceived at tick 3 what had last been seen at "
        "tick 0."
    )
    assert told.levels[0].missed.tick == 1


def test_a_place_that_was_seen_empty():
    world, nest = nest_of({"a": WEST, "b": GAP}, CORNER, negative_evidence=True)
    world.step(2)
    world.place_agent("b", EAST_2)
    world.step(1)
    told = nest["/a"].explain(agent="b")
    assert told.levels[0].since == 3
    assert lines(told)[1] == (
        "a knows nothing of b. At tick 3 a, at (2.5, 0, 1.5), saw b not to be where it was "
        "believed to be."
    )
    world.place_agent("b", GAP)
    world.place_agent("b", EAST_2)
    assert nest["/a"].explain(agent="b").levels[0].since == 6
    assert lines(told)[2].startswith("At tick 4 a, at (2.5, 0, 1.5), could not see b, at (8.5")


def test_a_block_that_changed_behind_the_back():
    agents = {"sally": GAP, "anne": EAST, "observer": MEETING}
    world, nest = nest_of(agents, CORNER)
    world.place_agent("sally", WEST)
    world.set_block(EAST_BLOCK, "stone", actor="anne")
    told = nest["/sally"].explain(block=EAST_BLOCK)
    (level,) = told.levels
    assert (level.value, level.basis, level.current) == ("air", Basis(0, Source.SEEN), False)
    assert (level.missed.tick, level.missed.before, level.missed.after) == (2, "air", "stone")
    place = level.missed.sightings[0].blocker
    assert place in CORNER
    assert lines(told) == [
        "In reality, the block at (8, 0, 5) is stone since tick 2: anne made it stone.",
        "sally believes that the block at (8, 0, 5) is air: sally, at (5.5, 0, 10.5), last saw "
        "the block at (8, 0, 5) at tick 0.",
        "At tick 2 sally, at (2.5, 0, 1.5), could not see the stone at (8, 0, 5): the stone at "
        f"{place} blocks it. So sally missed this: anne made it stone.",
    ]


def test_changes_that_the_observer_found_later():
    """The observer finds the block and the contents changed; Sally is out of its sight."""
    agents = {"observer": WEST, "sally": (4.5, 0.0, 6.5), "anne": (0.5, 0.0, 1.5)}
    world, nest = nest_of(
        agents,
        CLOSED,
        chests={WEST_CHEST: {}},
        inventories={"anne": {"diamond": 1}},
        containers="transparent",
    )
    world.place_agent("observer", EAST)
    world.place_agent("sally", EAST_2)
    world.deposit("anne", WEST_CHEST, {"diamond": 1})
    world.set_block((1, 0, 8), "stone")
    world.place_agent("sally", (4.5, 0.0, 6.5))
    world.step(1)
    world.place_agent("sally", EAST_2)
    world.place_agent("observer", WEST)
    contents = nest["/observer/sally"].explain(container=WEST_CHEST)
    assert contents.levels[1].missed.acts == ()
    assert lines(contents)[-1].endswith(
        "So sally missed this: observer came to believe that the chest at (2, 0, 5) holds "
        "1 diamond."
    )
    block = nest["/observer/sally"].explain(block=(1, 0, 8))
    assert lines(block)[-1].endswith("So sally missed this: the block at (1, 0, 8) became stone.")
    assert contents.levels[1].missed.tick == block.levels[1].missed.tick == 8


def test_what_the_simulator_around_lost_sight_of():
    agents = {"a": WEST, "b": MEETING, "c": GAP}
    world, nest = nest_of(agents, CORNER, negative_evidence=True)
    world.place_agent("b", EAST)
    world.place_agent("c", EAST_2)
    told = nest["/a/b"].explain(agent="c")
    missed = told.levels[1].missed
    assert (missed.tick, missed.before, missed.after) == (2, GAP, None)
    assert lines(told)[-1].endswith("So b missed this: c became unknown.")


def test_a_container_that_is_seen_to_be_gone():
    world, nest = corner()
    world.set_block(CHEST, "air")
    told = nest["/observer"].explain(container=CHEST)
    assert lines(told) == [
        "In reality, there is no container at (5, 0, 9) (air is there) since tick 1: "
        "something made it air.",
        "observer believes that there is no container at (5, 0, 9) (air is there). "
        "At tick 1 observer, at (2.5, 0, 1.5), gave up what it had believed.",
    ]


def test_a_block_that_was_made_unknown_by_hand():
    world, nest = corner()
    world.step(2)
    place = (2, 0, 3)
    nest["/observer"].edit(blocks={place: None})
    told = nest["/observer"].explain(block=place)
    assert (told.levels[0].value, told.levels[0].basis, told.levels[0].since) == (None, None, 2)
    assert lines(told)[1] == (
        "observer knows nothing of the block at (2, 0, 3). "
        "At tick 2 observer, at (2.5, 0, 1.5), gave up what it had believed."
    )


def test_a_branch_is_the_world_of_what_follows_it():
    world, nest = corner(inventories={"anne": {"diamond": 1}})
    world.deposit("anne", CHEST, {"diamond": 1})
    world.step(1)
    belief = nest["/observer"]
    belief.switch("try")
    told = nest["/observer/sally"].explain(container=CHEST)
    assert (told.fact.path, told.fact.branch, told.fact.forked_at) == (("observer",), "try", 2)
    assert [level.holder for level in told.levels] == ["sally"]
    assert (told.levels[0].basis.observed_at, told.levels[0].since) == (1, 1)
    assert told.before.levels[-1].holder == "observer"
    assert lines(told) == [
        "In /observer, on branch 'try' since tick 2, the chest at (5, 0, 9) holds 1 diamond, and "
        "perhaps more; that has not changed since the fork.",
        "observer believes that sally believes that the chest at (5, 0, 9) holds 1 diamond, and "
        "perhaps more: as far as observer knows, sally, at (4.5, 0, 9.5), saw what happened at "
        "tick 1: anne put 1 diamond in.",
        "Before the fork at tick 2:",
        "  In reality, the chest at (5, 0, 9) holds 1 diamond and 1 emerald since tick 1: "
        "anne put 1 diamond in.",
        "  observer believes that the chest at (5, 0, 9) holds 1 diamond, and perhaps more: "
        "observer, at (2.5, 0, 1.5), saw what happened at tick 1: anne put 1 diamond in.",
    ]
    belief.scripted.withdraw("sally", CHEST, {"diamond": 1})
    after = nest["/observer/sally"].explain(container=CHEST)
    assert (after.before, after.fact.since) == (None, 3)
    assert lines(after)[0].endswith("since tick 3: sally took 1 diamond out.")
    assert nest.at(1)["/observer/sally"].explain(container=CHEST).fact.path == ()


def test_explanations_that_are_asked_together_equal_those_asked_one_by_one():
    world, nest = corner(inventories={"anne": {"diamond": 1}})
    world.deposit("anne", CHEST, {"diamond": 1})
    world.step(1)
    nest["/observer"].switch("try")
    nest["/observer"].scripted.withdraw("sally", CHEST, {"diamond": 1})
    reader, path = nest.reader, ("observer", "sally")
    (key,) = (info.key for info in reader.timelines() if info.key.branch == "try")
    things = [{"container": CHEST}, {"agent": "anne"}, {"block": EAST_BLOCK}]
    # At ticks before 2 the beliefs are in the timeline below the branch, and at 2 they rest on it.
    asked = [(tick, reader.element(**each)) for tick in (3, 0, 2, 1) for each in things]
    together = reader.explain(key, path, asked)
    alone = [reader.explain(key, path, [each])[0] for each in asked]
    assert together == alone
    assert list(map(lines, together)) == list(map(lines, alone))
    assert len({str(each) for each in alone}) > 6


@pytest.mark.parametrize(
    ("asked", "error", "message"),
    [
        ({}, InputError, "0 things"),
        ({"agent": "anne", "block": CHEST}, InputError, "2 things"),
        ({"agent": "nobody"}, PathError, "nobody"),
        ({"block": (11, 0, 0)}, PositionError, "outside the box"),
        ({"container": (0, 3, 0)}, PositionError, "outside the box"),
        ({"container": "chest"}, InputError, "three whole numbers"),
        ({"block": (1.5, 0, 0)}, InputError, "three whole numbers"),
    ],
)
def test_wrong_questions_are_errors(asked, error, message):
    _, nest = corner()
    for simulator in (nest["/observer"], nest.at(0)["/observer"]):
        with pytest.raises(error, match=message):
            simulator.explain(**asked)


def test_a_tick_that_a_past_simulator_does_not_have():
    _, nest = corner()
    with pytest.raises(TickError):
        nest.at(1)["/observer"].explain(agent="anne")
