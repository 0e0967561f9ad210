"""Inference: hand-computed cases for the rules, and the laws (design/inference.md)."""

import math

import numpy as np
import pytest
from tests.minds.lanes import lane, walk

import beliefnest as bn


def policy(q, beta):
    weights = {name: math.exp(beta * value) for name, value in q.items()}
    return {name: weight / sum(weights.values()) for name, weight in weights.items()}


def test_a_step_and_a_stay_by_hand():
    world = lane(3)
    nest = bn.Nest(world)
    walk(world, (1, 0))
    world.step(1)
    model = bn.MindModel(
        "bob", {"end": {"at": (2, 1, 0)}}, {"end": [0, 10]}, rationality=0.7, discount=0.9
    )
    inference = nest["/"].infer(model)
    likelihoods = []
    for utility in (0, 10):
        v2 = max(0, utility - 1)
        v1 = max(0, 0.9 * v2 - 1)
        v0 = max(0, 0.9 * v1 - 1)
        at0 = policy(
            {
                "stay": 0.9 * v0,
                "on": 0.9 * v1 - 1,
                1: 0.9 * v0 - 1,
                2: 0.9 * v0 - 1,
                3: 0.9 * v0 - 1,
            },
            0.7,
        )
        at1 = policy(
            {
                "stay": 0.9 * v1,
                "on": 0.9 * v2 - 1,
                "back": 0.9 * v0 - 1,
                1: 0.9 * v1 - 1,
                2: 0.9 * v1 - 1,
            },
            0.7,
        )
        likelihoods.append(at0["on"] * (at1["stay"] + at1[1] + at1[2]))
    expected = 10 * likelihoods[1] / sum(likelihoods)
    assert inference.mean("utility.end") == pytest.approx(expected, abs=1e-12)
    assert inference.log_evidence == pytest.approx(math.log(sum(likelihoods) / 2), abs=1e-12)
    assert inference.marginal("utility.end", tick=0) == pytest.approx({0: 0.5, 10: 0.5})


def test_an_act_after_the_last_tick_by_hand():
    world = lane(2)
    nest = bn.Nest(world)
    walk(world, (1, 0))
    model = bn.MindModel("bob", {"end": {"at": (1, 1, 0)}}, {"end": [2, 5]}, rationality=1.0)
    likelihoods = []
    for utility in (2, 5):
        v1 = utility - 1
        v0 = max(0, 0.99 * v1 - 1)
        at0 = policy(
            {
                0: 0.99 * v0,
                "on": 0.99 * v1 - 1,
                1: 0.99 * v0 - 1,
                2: 0.99 * v0 - 1,
                3: 0.99 * v0 - 1,
            },
            1,
        )
        at1 = policy(
            {
                0: 0.99 * v1,
                "act": v1,
                1: 0.99 * v1 - 1,
                2: 0.99 * v1 - 1,
                3: 0.99 * v1 - 1,
                "back": 0.99 * v0 - 1,
            },
            1,
        )
        likelihoods.append(at0["on"] * at1["act"])
    inference = nest["/"].infer(model, ended=True)
    expected = likelihoods[1] / sum(likelihoods)
    assert inference.marginal("utility.end")[5] == pytest.approx(expected, abs=1e-12)


BLOCKS = {"L": "emerald_block", "M": "diamond_block", "none": "gravel"}


def trucks(true="emerald_block", mirrored=False, names=("L", "M", "none"), turned=False):
    """Return a small world of trucks: one is in sight, the other place lies behind a wall."""

    def cell(x, z):
        x = 5 - x if mirrored else x
        return (z, x) if turned else (x, z)

    size = (3, 6) if turned else (6, 3)
    walls = [cell(x, 1) for x in range(1, 6)]
    marks = {cell(5, 0): "gold_block", cell(5, 2): true}
    world = lane(*size, walls, marks, {"bob": cell(2, 0)})
    nest = bn.Nest(world)
    walk(world, cell(1, 0), cell(0, 0), cell(0, 1), cell(0, 2), cell(0, 2), cell(0, 1))
    x, z = cell(5, 2)
    doubt = {
        name: {"blocks": {(x, 0, z): block}}
        for name, block in zip(names, BLOCKS.values(), strict=True)
    }
    model = bn.MindModel(
        "bob",
        {
            "K": {"block": "gold_block"},
            "L": {"block": "emerald_block"},
            "M": {"block": "diamond_block"},
        },
        {goal: [0, 10, 20] for goal in "KLM"},
        doubt,
        bn.simplex_grid(3, 2, 0.1),
    )
    return nest, model


def test_who_turns_back_wanted_and_expected_what_is_not_there():
    nest, model = trucks()
    inference = nest["/"].infer(model)
    assert inference.mean("utility.M") > inference.mean("utility.K") > inference.mean("utility.L")
    assert inference.mean("credence.M") > inference.mean("credence.L")
    assert inference.marginal("credence_now.L") == pytest.approx({1.0: 1.0})
    before = inference.mean("credence_now.L", tick=3)
    assert before == pytest.approx(inference.mean("credence.L", tick=3))


def test_mirroring_rotation_and_names_change_nothing():
    nest, model = trucks()
    plain = nest["/"].infer(model).posterior()
    for other in (
        trucks(mirrored=True),
        trucks(turned=True),
        trucks(names=("zebra", "apple", "none")),
    ):
        turned = other[0]["/"].infer(other[1]).posterior()
        np.testing.assert_allclose(turned, plain, rtol=0, atol=1e-12)


def test_without_rationality_nothing_is_learnt_of_desires():
    nest, model = trucks()
    model = bn.MindModel(
        "bob", model.goals, model.utilities, model.doubt, model.credences, rationality=0
    )
    inference = nest["/"].infer(model)
    assert inference.mean("utility.K") == pytest.approx(10)
    assert inference.mean("credence.L") == pytest.approx(1 / 3)


def test_live_late_and_recorded_are_the_same_bytes(tmp_path):
    def played(store):
        world = lane(5, 2, marks={(4, 0): "gold_block"})
        nest = bn.Nest(world, store=store)
        model = bn.MindModel("bob", {"K": {"block": "gold_block"}}, {"K": [0, 5, 9]})
        live = []
        for cell in ((1, 0), (2, 0), (2, 1), (3, 1)):
            walk(world, cell)
            world.step(2)
            live.append(nest["/"].infer(model))
        return nest, model, live

    nest, model, live = played(tmp_path / "run.bn")
    for inference in live:
        tick = inference.until
        late = nest["/"].infer(model, until=tick)
        past = nest.at(tick)["/"].infer(model)
        whole = live[-1].at(tick)
        for other in (late, past, whole):
            assert other.posterior().tobytes() == inference.posterior().tobytes()
            assert other.log_evidence == inference.log_evidence
        assert live[-1].posterior(tick).tobytes() == inference.posterior().tobytes()
    nest.close()
    with bn.Nest.read(tmp_path / "run.bn") as recorded:
        again = recorded["/"].infer(model)
        assert again.posterior().tobytes() == live[-1].posterior().tobytes()


def hidden_room(cells, hidden="stone"):
    """Ann at one end of a lane; behind a wall with a gap is a corridor that she cannot see."""
    walls = [(x, 1) for x in range(7) if x != 3] + ([(6, 2)] if hidden != "stone" else [])
    world = lane(
        7, 3, walls, {(6, 2): "gold_block", (6, 0): "emerald_block"}, {"bob": (3, 0), "ann": (0, 0)}
    )
    # Ann knows the floor, not what stands on it.
    known = [(x, 0, z) for x in range(7) for z in range(3)]
    nest = bn.Nest(world, static_blocks=known)
    for cell in cells:
        walk(world, cell)
    return nest


GAP = ((3, 1), (3, 2), (4, 2), (3, 2), (3, 1), (3, 0))


def test_a_gap_is_summed_over_and_smoothed():
    nest = hidden_room(GAP)
    assert not nest.at(2)["/ann"].state.agents["bob"].current
    model = bn.MindModel(
        "bob",
        {"K": {"block": "gold_block"}, "L": {"block": "emerald_block"}},
        {"K": [0, 8], "L": [0, 8]},
        rationality=1.5,
    )
    filtered = nest["/ann"].infer(model)
    smoothed = nest["/ann"].infer(model, smooth=True)
    np.testing.assert_array_equal(filtered.posterior(), smoothed.posterior())
    for tick in range(7):
        shares = smoothed.marginal("cell", tick)
        assert sum(shares.values()) == pytest.approx(1)
    # One tick before it is seen again it cannot have been far away, whatever was thought then.
    assert smoothed.marginal("cell", 5) == pytest.approx({(3, 1, 1): 1.0})
    assert (4, 1, 2) in filtered.marginal("cell", 4)
    paths = smoothed.sample_paths(2000, seed=1)
    assert [path.cells for path in paths] == [
        path.cells for path in smoothed.sample_paths(2000, seed=1)
    ]
    for tick in (3, 4):
        exact = smoothed.marginal("cell", tick)
        drawn = [path.cells[tick] for path in paths]
        for cell, share in exact.items():
            assert drawn.count(cell) / 2000 == pytest.approx(share, abs=0.05)


def test_worlds_that_differ_in_what_is_not_perceived_have_the_same_posterior():
    model = bn.MindModel(
        "bob",
        {"K": {"block": "gold_block"}, "L": {"block": "emerald_block"}},
        {"K": [0, 8], "L": [0, 8]},
    )
    # Bob walks elsewhere behind the wall, and it looks different there.
    other = ((3, 1), (3, 2), (2, 2), (3, 2), (3, 1), (3, 0))
    one = hidden_room(GAP)["/ann"].infer(model)
    two = hidden_room(other, hidden="gravel")["/ann"].infer(model)
    assert one.posterior().tobytes() == two.posterior().tobytes()
    assert one.log_evidence == two.log_evidence


def chests(*, open_first=True, actual=None, contents=None):
    world = lane(
        5,
        2,
        agents={"bob": (2, 0)},
        containers=contents or {(0, 1, 1): {"diamond": 1}, (4, 1, 1): {}},
    )
    nest = bn.Nest(world)
    doubt = {
        "left": {"containers": {(0, 1, 1): {"diamond": 1}, (4, 1, 1): {}}},
        "right": {"containers": {(0, 1, 1): {}, (4, 1, 1): {"diamond": 1}}},
    }
    model = bn.MindModel(
        "bob", {"D": {"item": "diamond"}}, {"D": [0, 20]}, doubt, [[0.9, 0.1], [0.1, 0.9]], actual
    )
    return world, nest, model


def test_opening_and_taking_are_actions():
    world, nest, model = chests()
    walk(world, (1, 0), (0, 0))
    world.open("bob", (0, 1, 1))
    world.withdraw("bob", (0, 1, 1), {"diamond": 1})
    walk(world, (1, 0))
    inference = nest["/"].infer(model)
    assert inference.impossible is None
    assert inference.mean("credence.left") > 0.8
    assert inference.mean("utility.D") > 15
    assert inference.marginal("credence_now.left", tick=2) == pytest.approx(
        inference.marginal("credence.left", tick=2)
    )
    assert inference.marginal("credence_now.left", tick=3) == {1.0: pytest.approx(1)}
    # Behaviour after the act does not count.
    assert inference.posterior().tobytes() == inference.posterior(tick=4).tobytes()


def test_an_act_that_is_unavailable_is_impossible_and_nothing_is_lost():
    world, nest, model = chests()
    walk(world, (1, 0), (0, 0))
    world.withdraw("bob", (0, 1, 1), {"diamond": 1})
    inference = nest["/"].infer(model)
    assert inference.impossible is not None
    assert inference.impossible.tick == 3
    assert "acts on goal" in str(inference.impossible)
    assert inference.log_evidence == -math.inf
    before = nest["/"].infer(model, until=2)
    assert inference.mean("credence.left") == before.mean("credence.left")
    assert "impossible" in repr(inference)


@pytest.mark.parametrize("actual", ["wall", {"wall": 1.0, "free": 0.0}])
def test_a_walk_through_the_wall_of_the_stated_alternative_is_impossible(actual):
    world = lane(6)
    nest = bn.Nest(world)
    walk(world, *((x, 0) for x in range(1, 5)))
    doubt = {
        "wall": {"blocks": {(3, 1, 0): "bricks"}},
        "free": {"blocks": {(3, 1, 0): "air"}},
    }
    goals = {"end": {"at": (5, 1, 0)}}
    model = bn.MindModel("bob", goals, {"end": [0, 20]}, doubt, actual=actual)
    inference = nest["/"].infer(model)
    assert inference.impossible.tick == 3
    assert inference.log_evidence == -math.inf
    assert inference.marginal("cell") == {(2, 1, 0): 1.0}
    assert inference.mean("actual.wall") == 1
    assert 10 < inference.mean("utility.end") <= 20


def test_an_observer_who_does_not_know_learns_from_behaviour():
    world, nest, model = chests(actual="unknown")
    walk(world, (1, 0), (0, 0))
    world.open("bob", (0, 1, 1))
    walk(world, (1, 0), (2, 0), (3, 0))
    inference = nest["/"].infer(model)
    assert inference.mean("actual.right") > 0.99


def test_credence_follows_the_percepts_that_are_credited():
    world, nest, model = chests()
    assert nest["/"].credence("bob", model.doubt, [0.3, 0.7]) == pytest.approx(
        {"left": 0.3, "right": 0.7}
    )
    walk(world, (1, 0), (0, 0))
    world.open("bob", (0, 1, 1))
    assert nest["/"].credence("bob", model.doubt, [0.3, 0.7]) == {"left": 1.0, "right": 0.0}
    assert nest["/"].credence("bob", model.doubt, [0, 1]) == {"left": 1.0, "right": 0.0}
    assert nest["/"].credence("bob", model.doubt, tick=2) == {"left": 0.5, "right": 0.5}
    lapsed = nest["/"].credence("bob", model.doubt, [0.5, 0.5], lapse=0.2)
    assert lapsed == pytest.approx({"left": 0.5 / 0.6, "right": 0.1 / 0.6})


def test_claims_condition_and_percepts_override_them():
    world = lane(
        5,
        2,
        agents={"bob": (2, 0), "eve": (3, 0)},
        containers={(0, 1, 1): {"diamond": 1}, (4, 1, 1): {}},
    )
    nest = bn.Nest(world, perception=bn.Perception(testimony="accept"))
    doubt = {
        "left": {"containers": {(0, 1, 1): {"diamond": 1}, (4, 1, 1): {}}},
        "right": {"containers": {(0, 1, 1): {}, (4, 1, 1): {"diamond": 1}}},
    }
    world.say("eve", "right", claims=[bn.Claim.located("diamond", (4, 1, 1))])
    assert nest["/"].credence("bob", doubt) == {"left": 0.0, "right": 1.0}
    world.say("eve", "left", claims=[bn.Claim.located("diamond", (0, 1, 1))])
    assert nest["/"].credence("bob", doubt) == {"left": 1.0, "right": 0.0}
    world.say("eve", "right", claims=[bn.Claim.located("diamond", (4, 1, 1))])
    walk(world, (1, 0), (0, 0))
    world.open("bob", (0, 1, 1))
    assert nest["/"].credence("bob", doubt) == {"left": 1.0, "right": 0.0}


def test_one_alternative_is_as_good_as_certainty():
    nest, model = trucks()
    common = {"agent": "bob", "goals": model.goals, "utilities": model.utilities}
    one = bn.MindModel(**common, doubt={"L": model.doubt["L"]})
    sure = bn.MindModel(**common, doubt=model.doubt, credences=[[1, 0, 0]])
    plain = bn.MindModel(**common)
    expected = nest["/"].infer(plain).posterior()[0]
    for other in (one, sure):
        found = nest["/"].infer(other).posterior()[0]
        np.testing.assert_allclose(found, expected, atol=1e-12)


def test_predictions_explanations_and_tables():
    nest, model = trucks()
    inference = nest["/"].infer(model)
    ahead = inference.predict(3)
    assert len(ahead) == 3
    assert all(sum(shares.values()) == pytest.approx(1) for shares in ahead)
    early = inference.predict(1, tick=2)[0]
    assert early == nest["/"].infer(model, until=2).predict(1)[0]
    changes = inference.explain()
    assert max(changes, key=lambda change: change.bits["utility.M"]).tick >= 3
    assert "moves from" in str(changes[1])
    frame = inference.frame()
    assert list(frame.columns) == ["tick", "factor", "value", "probability"]
    sums = frame.groupby(["tick", "factor"]).probability.sum()
    assert np.allclose(sums, 1)
    joint = inference.joint("utility.K", "credence.L")
    assert sum(joint.values()) == pytest.approx(1)
    assert inference.map()["probability"] == pytest.approx(inference.posterior().max())
    assert len(inference.hypotheses()) == inference.posterior().size


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"credences": [[0.5, 0.6, 0]]}, "sums to"),
        ({"credences": [[0.5, 0.5]]}, "shape"),
        ({"prior": [[1]]}, "shape"),
        ({"actual": "other"}, "one of L, M, none"),
        ({"actual": {"L": 0.5}}, "sum to 0.5"),
        ({"actual": {"X": 1}}, "X"),
        ({"utilities": {"K": [1]}}, "lack values"),
        ({"goals": {"K": {"block": "no_such"}}}, "does not exist"),
        ({"doubt": {"a": {"blocks": {(0, 0, 0): "stone"}}, "b": {}}}, "same elements"),
        (
            {
                "doubt": {
                    "a": {"blocks": {(0, 0, 0): "stone"}},
                    "b": {"blocks": {(0, 0, 0): "stone"}},
                }
            },
            "equal",
        ),
        ({"discount": 1, "stay_cost": 1, "step_cost": 1}, "stay_cost"),
        ({"rationality": -1}, "rationality"),
        ({"step_cost": 0.5, "stay_cost": 1}, "step_cost"),
    ],
)
def test_models_that_do_not_fit_together_are_refused(change, message):
    _, model = trucks()
    given = {
        "agent": "bob",
        "goals": model.goals,
        "utilities": model.utilities,
        "doubt": model.doubt,
        **change,
    }
    with pytest.raises(bn.BeliefNestError, match=message):
        bn.MindModel(**given)


def test_models_that_do_not_fit_the_node_are_refused():
    nest, model = trucks()
    common = {"goals": model.goals, "utilities": model.utilities}
    with pytest.raises(bn.PathError, match="no agent 'eve'"):
        nest["/"].infer(bn.MindModel("eve", **common))
    far = bn.MindModel("bob", {"K": {"at": (5, 1, 1)}}, {"K": 1})
    with pytest.raises(bn.InputError, match="none of the goals"):
        nest["/"].infer(far)
    never = bn.MindModel(
        "bob",
        **common,
        doubt={
            "a": {"blocks": {(5, 0, 2): "gravel"}},
            "b": {"blocks": {(5, 0, 2): "diamond_block"}},
        },
    )
    with pytest.raises(bn.InputError, match="no alternative agrees"):
        nest["/"].infer(never)
    with pytest.raises(bn.TickError):
        nest["/"].infer(model, until=99)
    blind = lane(3, 1, [(1, 0)], agents={"bob": (0, 0), "ann": (2, 0)})
    other = bn.Nest(blind)
    with pytest.raises(bn.InputError, match=r"has not seen bob .* up to a later tick"):
        other["/ann"].infer(bn.MindModel("bob", {"K": {"at": (0, 1, 0)}}, {"K": 1}))
    walk(blind, (2, 0))
    late = other["/ann"].infer(bn.MindModel("bob", {"K": {"at": (2, 1, 0)}}, {"K": 1}))
    with pytest.raises(bn.TickError, match="bob had not been seen until then; ask from tick 1 on"):
        late.marginal("cell", tick=0)


def test_simplex_grid():
    grid = bn.simplex_grid(3, 6, smoothing=0.075)
    assert grid.shape == (28, 3)
    assert np.allclose(grid.sum(axis=1), 1)
    assert grid.min() == pytest.approx(0.025)
    assert bn.simplex_grid(2, 1).tolist() == [[0, 1], [1, 0]]


def test_only_a_change_of_cell_is_a_movement():
    world = lane(5)
    nest = bn.Nest(world)
    walk(world, (1, 0))
    world.step(1)
    model = bn.MindModel("bob", {"end": {"at": (4, 1, 0)}}, {"end": [0, 10]})
    changes = nest["/"].infer(model).explain()
    assert [
        (change.text.split()[0], change.is_action, change.is_movement) for change in changes
    ] == [
        ("is", False, False),
        ("moves", True, True),
        ("stays", True, False),
    ]


def test_what_is_impossible_is_told_with_its_cells():
    world, nest, model = chests()
    walk(world, (1, 0), (0, 0))
    world.withdraw("bob", (0, 1, 1), {"diamond": 1})
    told = str(nest["/"].infer(model).impossible)
    assert told.startswith("tick 3: the agent acts on goal D at (0, 1, 0), which no hypothesis")
    assert "the goal is not in reach there" in told
    split = lane(5, 1, [(2, 0)])
    jumping = bn.Nest(split)
    walk(split, (3, 0))
    ends = {"a": {"at": (1, 1, 0)}, "b": {"at": (4, 1, 0)}}
    failed = jumping["/"].infer(bn.MindModel("bob", ends, {"a": 1, "b": [1, 2]})).impossible
    assert failed is not None
    assert failed.text == "moves from (0, 1, 0) to (3, 1, 0)"
    assert failed.why.startswith("no steps lead")
