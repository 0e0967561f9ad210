"""Histories of models of minds against exact inference, on small worlds."""

import math
import warnings

import pytest

import beliefnest as bn
from beliefnest.minds.imagining.imagining import ImaginationWarning

GOALS = {"K": {"block": "gold_block"}, "L": {"block": "emerald_block"}}


def floor(*, containers=None, blocks=None, perception=None, wall=True):
    """Return a floor of 7 by 4 with a wall behind which Anne does not see."""
    stones = {(x, 0, z): "stone" for x in range(7) for z in range(4)}
    stones |= {(0, 0, 3): "gold_block", (6, 0, 3): "emerald_block"}
    if wall:
        for x in (1, 2, 4, 5):
            stones |= {(x, 1, 1): "stone", (x, 2, 1): "stone"}
    world = bn.ScriptedWorld(
        box=((0, 0, 0), (6, 3, 3)),
        blocks={**stones, **(blocks or {})},
        agents={"anne": (0.5, 1, 0.5), "bob": (3.5, 1, 0.5)},
        containers=containers or {},
    )
    known = ["stone", "gold_block", "emerald_block", "air", "chest", "gravel"]
    return bn.Nest(world, perception=perception, static_blocks=known)


def walk(nest, cells):
    for x, z in cells:
        if (x, z) == (None, None):
            nest.scripted_world.step()
        else:
            nest.scripted_world.place_agent("bob", (x + 0.5, 1, z + 0.5))


def drawn_means(imagined, agent="bob"):
    """Weighted means of all factors of the hypotheses, and their standard errors."""
    total: dict[str, float] = {}
    square: dict[str, float] = {}
    for history in imagined:
        told = dict(history.hypotheses[agent])
        actual = told.pop("actual", None)
        values = {name: float(value) for name, value in told.items()}
        if actual is not None:
            values[f"actual.{actual}"] = 1.0
        for name, value in values.items():
            total[name] = total.get(name, 0.0) + history.weight * value
            square[name] = square.get(name, 0.0) + history.weight * value**2
    return {
        name: (mean, math.sqrt(max(0, square[name] - mean**2) / imagined.effective_size))
        for name, mean in total.items()
    }


def agree(nest, path, model, n=400, seed=0):
    exact = nest[path].infer(model)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ImaginationWarning)
        imagined = nest[path].imagine(0, actors={"bob": {"model": model}}, n=n, seed=seed)
    assert imagined.impossible is None
    assert imagined.effective_size > 20
    for name, (mean, error) in drawn_means(imagined).items():
        assert mean == pytest.approx(exact.mean(name), abs=4 * error + 0.02), name
    # The filter's estimate of the evidence; its error shrinks with the size.
    assert imagined.log_evidence == pytest.approx(exact.log_evidence, abs=0.5)
    cells = exact.marginal("cell")
    found: dict[tuple[int, int, int], float] = {}
    for history in imagined:
        x, y, z = history.state.agents["bob"].position
        cell = (math.floor(x), math.floor(y), math.floor(z))
        found[cell] = found.get(cell, 0.0) + history.weight
    for cell in {*cells, *found}:
        share = cells.get(cell, 0.0)
        error = math.sqrt(share * (1 - share) / imagined.effective_size)
        assert found.get(cell, 0.0) == pytest.approx(share, abs=4 * error + 0.02), cell
    return exact, imagined


def model(**further):
    given = {
        "utilities": {"K": [0, 6], "L": [0, 6]},
        "rationality": 0.8,
        "discount": 0.95,
        **further,
    }
    return bn.MindModel("bob", goals=GOALS, **given)


@pytest.mark.parametrize("path", ["/", "/anne", "/bob/anne"])
def test_a_walk_out_of_sight(path):
    with floor() as nest:
        walk(nest, [(3, 1), (3, 2), (4, 2)])
        agree(nest, path, model())


def test_not_being_seen_is_evidence():
    with floor() as nest:
        walk(nest, [(3, 1), (3, 2)])
        nest.scripted_world.step(6)
        agree(nest, "/anne", model())


def test_seen_again_after_a_gap():
    with floor() as nest:
        walk(nest, [(3, 1), (3, 2), (3, 2), (3, 1), (3, 0)])
        agree(nest, "/anne", model(), n=800)


def test_stays_in_sight():
    with floor() as nest:
        nest.scripted_world.step(2)
        walk(nest, [(2, 0)])
        nest.scripted_world.step(1)
        agree(nest, "/anne", model(), n=800)


@pytest.mark.parametrize("actual", [None, "unknown", {"gold": 0.3, "gone": 0.7}])
def test_a_doubt_about_a_block(actual):
    doubt = {
        "gold": {"blocks": {(0, 0, 3): "gold_block"}},
        "gone": {"blocks": {(0, 0, 3): "gravel"}},
    }
    doubted = model(doubt=doubt, credences=[[0.8, 0.2], [0.2, 0.8]], actual=actual)
    with floor() as nest:
        walk(nest, [(3, 1), (3, 2)])
        nest.scripted_world.step(2)
        agree(nest, "/anne", doubted)


def test_a_doubt_about_contents_with_a_look_into_the_chest():
    chest = (3, 1, 3)
    doubt = {"full": {"containers": {chest: {"diamond": 1}}}, "empty": {"containers": {chest: {}}}}
    doubted = bn.MindModel(
        "bob",
        goals={"D": {"item": "diamond"}, "L": {"block": "emerald_block"}},
        utilities={"D": [0, 6], "L": [0, 6]},
        doubt=doubt,
        credences=[[0.8, 0.2], [0.3, 0.7]],
        actual="unknown",
        rationality=0.8,
        discount=0.95,
    )
    with floor(containers={chest: {}}, wall=False) as nest:
        walk(nest, [(3, 1), (3, 2)])
        nest.scripted_world.open("bob", chest)
        walk(nest, [(4, 2)])
        agree(nest, "/anne", doubted, n=800)
