"""Rules of planning and of gaps, each by hand or by counting all courses."""

import itertools
import math

import numpy as np
import pytest
from tests.minds.lanes import lane, walk

import beliefnest as bn

SIDES = ((1, 0), (0, 1), (-1, 0), (0, -1))


def planned(cells, goals, utilities, beta, discount=0.99, act=1.0, step=1.0):
    """Values and policy on a known map, by plain value iteration over a dictionary."""

    def to(cell, side):
        there = (cell[0] + side[0], cell[1] + side[1])
        return there if there in cells else cell

    values = dict.fromkeys(cells, 0.0)
    for _ in range(500):
        for cell in cells:
            options = [values[cell], discount * values[cell]]
            options += [discount * values[to(cell, side)] - step for side in SIDES]
            options += [utilities[g] - act for g, at in goals.items() if at == cell]
            values[cell] = max(options)

    def chances(cell):
        """Pairs of what an action leads to (None: the end) and its probability."""
        q = [(cell, discount * values[cell])]
        q += [(to(cell, side), discount * values[to(cell, side)] - step) for side in SIDES]
        q += [(None, utilities[g] - act) for g, at in goals.items() if at == cell]
        total = sum(math.exp(beta * value) for _, value in q)
        return [(where, math.exp(beta * value) / total) for where, value in q]

    return chances


def test_a_gap_is_the_sum_over_all_courses():
    # Ann stands at one end of a lane behind whose wall Bob disappears.
    walls = [(x, 1) for x in range(5) if x != 2]
    seen = [(2, 0), (2, 1), (2, 2), (3, 2), (2, 2), (2, 1), (2, 0)]
    world = lane(5, 3, walls, agents={"bob": seen[0], "ann": (0, 0)})
    floor = [(x, 0, z) for x in range(5) for z in range(3)]
    nest = bn.Nest(world, static_blocks=floor)
    walk(world, *seen[1:])
    current = [nest.at(t)["/ann"].state.agents["bob"].current for t in range(7)]
    assert current[0] and current[6] and not all(current)
    model = bn.MindModel(
        "bob",
        {"L": {"at": (0, 1, 2)}, "R": {"at": (4, 1, 2)}},
        {"L": [0, 6], "R": [0, 6]},
        rationality=0.8,
    )
    inference = nest["/ann"].infer(model)
    cells = {(x, z) for x in range(5) for z in range(3)} - set(walls)
    likelihoods = []
    for left, right in itertools.product((0, 6), (0, 6)):
        chances = planned(cells, {"L": (0, 2), "R": (4, 2)}, {"L": left, "R": right}, 0.8)
        weights = {(seen[0], False): 1.0}
        for tick in range(1, 7):
            spread = {}
            for (cell, ended), weight in weights.items():
                options = [(None, 1.0)] if ended else chances(cell)
                for where, share in options:
                    state = (cell, True) if where is None else (where, False)
                    spread[state] = spread.get(state, 0.0) + weight * share
            if current[tick]:
                weights = {s: w for s, w in spread.items() if s[0] == seen[tick]}
            else:
                # Ann does not see behind the wall, nor the gap in it.
                hidden = {cell for cell in cells if not sees(nest, cell)}
                weights = {s: w for s, w in spread.items() if s[0] in hidden}
        likelihoods.append(sum(weights.values()))
    total = sum(likelihoods)
    np.testing.assert_allclose(
        inference.posterior().reshape(-1), np.array(likelihoods) / total, atol=1e-11
    )
    assert inference.log_evidence == pytest.approx(math.log(total / 4), abs=1e-11)


def sees(nest, cell):
    """Return whether Ann would see Bob in the middle of a cell."""
    view = nest._recording.state(("ann",))
    ann = view.agents["ann"].position
    eye = (ann[0], ann[1] + 1.62, ann[2])
    feet = [(cell[0] + 0.5, 1.0, cell[1] + 0.5)]
    return bool(view.geometry.sees_agents(eye, 0, 0, feet)[0])


def plain(goal, **further):
    return bn.MindModel("bob", {"G": goal}, {"G": [0, 20]}, **further)


def test_a_jump_is_a_gap_of_as_many_actions():
    one, two = bn.Nest(slow := lane(5)), bn.Nest(quick := lane(5))
    walk(slow, (1, 0), (2, 0))
    walk(quick, (2, 0))
    model = plain({"at": (4, 1, 0)})
    # In a lane there is one shortest way, so that nothing but it can have happened.
    assert one["/"].infer(model).log_evidence == pytest.approx(
        two["/"].infer(model).log_evidence, abs=1e-12
    )


def test_ticks_without_movement_are_stays_of_several_ticks():
    world = lane(4)
    nest = bn.Nest(world)
    world.step(7)
    walk(world, (1, 0))
    world.step(2)
    two = nest["/"].infer(plain({"at": (3, 1, 0)}, step_ticks=3))
    assert list(two.ticks) == [0, 3, 6, 8]
    none = nest["/"].infer(plain({"at": (3, 1, 0)}, stays=False))
    assert list(none.ticks) == [0, 8]


def test_speech_is_no_stay():
    world = lane(4)
    nest = bn.Nest(world)
    world.say("bob", "hm")
    world.step(1)
    assert nest["/"].infer(plain({"at": (3, 1, 0)})).ticks == (0, 2)


def reached(world, goal, **further):
    """Return whether a goal can be reached."""
    nest = bn.Nest(world)
    world.step(1)
    try:
        nest["/"].infer(plain(goal, **further))
    except bn.InputError as error:
        assert "can be reached" in str(error)
        return False
    return True


def test_a_step_leads_up_or_down_by_one_at_most():
    for height, expected in ((1, True), (2, False)):
        world = lane(3)
        for x in (1, 2):
            for y in range(1, height + 1):
                world.set_block((x, y, 0), "stone")
        assert reached(world, {"at": (2, 1 + height, 0)}) is expected


@pytest.mark.parametrize(
    ("block", "expected"),
    [
        ("oak_door[half=lower,facing=east]", True),
        ("iron_door[half=lower,facing=east]", False),
        ("stone", False),
        ("iron_door[half=lower,open=true,facing=east]", True),
        ("oak_fence_gate[facing=east]", True),
        ("oak_door[half=lower,facing=north]", False),
    ],
)
def test_doors_that_open_by_hand_are_walked_through(block, expected):
    world = lane(3)
    world.set_block((1, 1, 0), block)
    if "gate" not in block:
        world.set_block((1, 2, 0), block.replace("lower", "upper"))
    assert reached(world, {"at": (2, 1, 0)}) is expected


def test_diagonal_steps_need_both_corners_free():
    for walls, expected in (([], 1), ([(1, 0)], 3)):
        world = lane(2, 2, walls)
        nest = bn.Nest(world)
        walk(world, (1, 1))
        inference = nest["/"].infer(plain({"at": (1, 1, 1)}, diagonal=True))
        ways = len(inference.predict(1, tick=0)[0])
        assert ways == (4 if expected == 1 else 2)


def test_an_agents_place_can_be_in_doubt():
    world = lane(5, 3, [(x, 1) for x in range(5) if x != 2], agents={"bob": (0, 0), "eve": (0, 2)})
    nest = bn.Nest(world)
    doubt = {
        "left": {"agents": {"eve": (0.5, 1, 2.5)}},
        "right": {"agents": {"eve": (4.5, 1, 2.5)}},
    }
    assert nest["/"].credence("bob", doubt) == {"left": 0.5, "right": 0.5}
    walk(world, (1, 0), (2, 0), (2, 1), (2, 2))
    assert nest["/"].credence("bob", doubt) == {"left": 1.0, "right": 0.0}
    assert nest["/"].credence("bob", doubt, actual="right") == {"left": 0.0, "right": 1.0}
    assert nest["/"].credence("bob", doubt, actual="unknown") == {"left": 0.5, "right": 0.5}


def test_a_changed_block_ends_the_doubt_about_it():
    world = lane(4, agents={"bob": (0, 0)}, marks={(3, 0): "gold_block"})
    nest = bn.Nest(world)
    doubt = {
        "gold": {"blocks": {(3, 0, 0): "gold_block"}},
        "gravel": {"blocks": {(3, 0, 0): "gravel"}},
    }
    world.set_block((3, 0, 0), "emerald_block")
    # At tick 0 it was seen to be gold; from then on both worlds are the same.
    assert nest["/"].credence("bob", doubt) == {"gold": 1.0, "gravel": 0.0}
    model = bn.MindModel(
        "bob", {"E": {"block": "emerald_block"}}, {"E": [0, 9]}, doubt, actual="unknown"
    )
    walk(world, (1, 0))
    assert nest["/"].infer(model).mean("actual.gold") == pytest.approx(0.5)


def test_inference_nests():
    world = lane(
        6, agents={"bob": (0, 0), "ann": (5, 0), "eve": (5, 0)}, marks={(5, 0): "gold_block"}
    )
    nest = bn.Nest(world)
    walk(world, (1, 0), (2, 0))
    model = plain({"block": "gold_block"})
    expected = nest["/"].infer(model).posterior()
    for path in ("/ann", "/ann/eve", "/bob", "/ann/bob"):
        np.testing.assert_allclose(nest[path].infer(model).posterior(), expected, atol=1e-12)


def test_no_discount_is_exact():
    world = lane(4)
    nest = bn.Nest(world)
    walk(world, (1, 0))
    inference = nest["/"].infer(plain({"at": (3, 1, 0)}, discount=1))
    assert inference.mean("utility.G") > 10


def test_rationality_may_be_a_factor():
    world = lane(6)
    nest = bn.Nest(world)
    walk(world, (1, 0), (2, 0), (3, 0), (4, 0))
    inference = nest["/"].infer(plain({"at": (5, 1, 0)}, rationality=[0.1, 3.0]))
    assert inference.mean("rationality") > 1.55
    assert set(inference.marginal("rationality")) == {0.1, 3.0}


def test_a_gap_of_several_ticks_an_action_has_its_actions_rounded():
    walls = [(x, 1) for x in range(5) if x != 2]
    world = lane(5, 3, walls, agents={"bob": (2, 0), "ann": (0, 0)})
    nest = bn.Nest(world, static_blocks=[(x, 0, z) for x in range(5) for z in range(3)])
    walk(world, (2, 2))
    world.step(5)
    walk(world, (2, 0))
    model = plain({"at": (0, 1, 2)}, step_ticks=2)
    assert not nest.at(3)["/ann"].state.agents["bob"].current
    inference = nest["/ann"].infer(model)
    assert inference.impossible is None
    # Gone at tick 1, seen again at tick 7: from tick 0 that is 7 ticks, or 4 actions.
    filtered = nest["/ann"].infer(model, until=6)
    assert len([tick for tick in filtered.ticks if tick > 0]) == 3
    for tick in range(1, 7):
        early = nest["/ann"].infer(model, until=tick)
        assert sum(early.marginal("cell").values()) == pytest.approx(1)


def test_since_and_until_are_ticks_of_the_timeline():
    world = lane(5)
    nest = bn.Nest(world)
    walk(world, (1, 0), (2, 0), (3, 0))
    model = plain({"at": (4, 1, 0)})
    late = nest["/"].infer(model, since=2)
    assert late.ticks == (2, 3)
    assert nest["/"].infer(model, since=3).mean("utility.G") == pytest.approx(10)
    for since in (-1, 9):
        with pytest.raises(bn.TickError):
            nest["/"].infer(model, since=since)
    with pytest.raises(bn.TickError):
        late.mean("utility.G", tick=1)


def test_a_fork_and_what_happens_in_it_is_read_too():
    world = lane(5, agents={"bob": (0, 0), "ann": (4, 0)})
    nest = bn.Nest(world)
    walk(world, (1, 0), (2, 0))
    model = plain({"at": (4, 1, 0)})
    before = nest["/ann"].infer(model)
    nest["/ann"].switch("try")
    forked = nest["/ann"].infer(model)
    np.testing.assert_allclose(forked.posterior(), before.posterior(), atol=1e-12)
    nest["/ann"].scripted.place_agent("bob", (3.5, 1, 0.5))
    after = nest["/ann"].infer(model)
    assert after.mean("utility.G") > forked.mean("utility.G")
    assert nest["/"].infer(model).posterior().tobytes() == before.posterior().tobytes()


@pytest.mark.parametrize("cover", ["air", "glass"])
def test_nothing_is_reached_through_a_block(cover):
    blocks = {(x, 0, 0): "stone" for x in range(5)} | {(4, 0, 0): "chest", (4, 1, 0): cover}
    world = bn.ScriptedWorld(
        ((0, 0, 0), (4, 3, 0)),
        blocks,
        {"bob": (0.5, 1, 0.5)},
        containers={(4, 0, 0): {"diamond": 1}},
    )
    nest = bn.Nest(world)
    walk(world, (1, 0))
    model = bn.MindModel("bob", {"D": {"item": "diamond"}}, {"D": 10})
    if cover == "air":
        assert nest["/"].infer(model).impossible is None
    else:
        with pytest.raises(bn.BeliefNestError, match="reach"):
            nest["/"].infer(model)
