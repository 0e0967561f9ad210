"""Inference against the slow reference, on random small worlds."""

import contextlib
import random
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from tests.minds.reference import CORNERS, STRAIGHT, Cell, Question, Reference, centre, moment
from tests.profiles import at_night

import beliefnest as bn
from beliefnest.world import terrain

FLOORS = ("gold_block", "emerald_block", "diamond_block")


@dataclass
class Scene:
    """A small world in which bob walks about, who looks on, and what is asked."""

    nest: bn.Nest
    perception: bn.Perception
    path: str
    question: Question

    @property
    def owner(self) -> str | None:
        return self.path.rsplit("/", 1)[-1] or None


def scene(seed: int) -> Scene:
    """Make a world, let bob walk at random, and ask something that fits it."""
    chance = random.Random(seed)
    width, depth = chance.randint(3, 5), chance.randint(2, 4)
    columns = [(x, z) for x in range(width) for z in range(depth)]
    chance.shuffle(columns)
    blocks: dict[Cell, str] = {(x, 0, z): "stone" for x, z in columns}
    standing = {name: columns.pop() for name in ("bob", "anne")}
    # At depth 2 both onlookers stand in one place, so that they see the same.
    path = chance.choice(["/", "/anne", "/carl/anne"])
    standing["carl"] = standing["anne"] if path == "/carl/anne" else columns.pop()
    kind = chance.choice(["block", "contents", "pose"])
    if kind == "pose":
        standing["dora"] = columns.pop()
    diagonal = chance.random() < 0.3
    # A wall in doubt beside a diagonal step would make it a jump in some alternatives only.
    walls = kind == "block" and not diagonal and chance.random() < 0.3
    doubt, containers, goals = _doubt(
        kind, columns, blocks, chance, standing.get("dora"), walls=walls
    )
    for x, z in columns[: chance.randint(0, len(columns) // 2)]:
        _pile(blocks, x, z, 1)
    perception = bn.Perception(
        max_visible_distance=chance.choice([2.5, 64]),
        containers=chance.choice(["opaque", "transparent"]),
    )
    world = bn.ScriptedWorld(
        box=((0, 0, 0), (width - 1, 3, depth - 1)),
        blocks=blocks,
        agents={name: centre((x, 1, z)) for name, (x, z) in standing.items()},
        containers=containers,
    )
    static = ["stone", *FLOORS] if chance.random() < 0.7 else ["stone"]
    nest = bn.Nest(world, perception=perception, static_blocks=[*static, "air", "chest"])
    _walk(world, standing["bob"], containers, diagonal, chance)
    names = list(doubt)
    rows = [[1 / len(names)] * len(names), _row(chance, len(names))]
    if chance.random() < 0.3:
        rows.append([1.0] + [0.0] * (len(names) - 1))
    actual = chance.choice([None, "unknown", names[0], {names[0]: 0.75, names[-1]: 0.25}])
    question = Question(
        agent="bob",
        goals=goals,
        utilities=[
            {name: chance.choice([-2.0, 0.0, 3.0, 8.0]) for name in goals} for _ in range(3)
        ],
        doubt=doubt,
        credences=rows,
        actual=actual,
        rationality=chance.choice([0.0, 0.7, 2.0]),
        discount=chance.choice([0.8, 0.95]),
        stay_cost=chance.choice([0.0, 0.5]),
        act_cost=chance.choice([0.0, 1.0]),
        diagonal=diagonal,
        ended=chance.random() < 0.2,
    )
    return Scene(nest, perception, path, question)


def _doubt(
    kind: str,
    columns: list[tuple[int, int]],
    blocks: dict[Cell, str],
    chance: random.Random,
    doubted: tuple[int, int] | None,
    *,
    walls: bool,
) -> tuple[dict[str, dict[str, dict[Any, Any]]], dict[Cell, dict[str, int]], dict[str, Any]]:
    """Choose alternatives, containers and goals; the first alternative is true."""
    (gx, gz), (ex, ez) = columns.pop(), columns.pop()
    goals: dict[str, Any] = {"K": {"block": "gold_block"}, "C": {"at": (gx, 1, gz)}}
    if kind == "contents":
        places: list[Cell] = [(gx, 1, gz), (ex, 1, ez)]
        for x, _, z in places:
            _pile(blocks, x, z, 2)
        first, second = ({places[n]: {"diamond": 1}, places[1 - n]: {}} for n in (0, 1))
        free = columns[-1] if columns else None
        goals = {"D": {"item": "diamond"}}
        if free is not None:
            goals["C"] = {"at": (free[0], 1, free[1])}
        doubt = {"left": {"containers": first}, "right": {"containers": second}}
        return doubt, dict(first), goals
    blocks[gx, 0, gz] = "gold_block"
    if doubted is not None:
        spots = [doubted, (ex, ez), *([columns.pop()] if columns else [])]
        doubt = {
            f"at{number}": {"agents": {"dora": centre((x, 1, z))}}
            for number, (x, z) in enumerate(spots)
        }
        return doubt, {}, goals
    floors = chance.sample([*FLOORS[1:], "stone"], chance.randint(2, 3))
    blocks[ex, 0, ez] = floors[0]
    goals |= {"L": {"block": "emerald_block"}}
    doubt = {floor: {"blocks": {(ex, 0, ez): floor}} for floor in floors}
    if walls:
        for edits in doubt.values():
            edits["blocks"] |= {(ex, y, ez): chance.choice(["air", "stone"]) for y in (1,)}
            edits["blocks"] |= {(ex, y, ez): edits["blocks"][ex, 1, ez] for y in (2, 3)}
        for place, block in doubt[floors[0]]["blocks"].items():
            if block == "air":
                blocks.pop(place, None)
            else:
                blocks[place] = block
    return doubt, {}, goals


def _pile(blocks: dict[Cell, str], x: int, z: int, low: int) -> None:
    """Put stone from a height up to the top of the box, so that nobody stands there."""
    for y in range(low, 4):
        blocks[x, y, z] = "stone"


def _row(chance: random.Random, count: int) -> list[float]:
    weights = [chance.randint(1, 5) for _ in range(count)]
    return [weight / sum(weights) for weight in weights]


def _walk(
    world: bn.ScriptedWorld,
    start: tuple[int, int],
    containers: dict[Cell, Any],
    diagonal: bool,
    chance: random.Random,
) -> None:
    x, z = start
    snapshot = world.snapshot()
    air = {p for p in snapshot.box.positions() if snapshot.block(p) == 0}

    def free(x: int, z: int) -> bool:
        return (x, 1, z) in air and (x, 2, z) in air

    opened: set[Cell] = set()
    for _ in range(chance.randint(2, 7)):
        near = [p for p in containers if abs(p[0] - x) + abs(p[2] - z) <= 1 and p not in opened]
        if near and chance.random() < 0.5:
            opened |= set(containers)
            world.open("bob", near[0])
            continue
        ways = list(STRAIGHT)
        if diagonal:
            ways += [w for w in CORNERS if free(x + w[0], z) and free(x, z + w[1])]
        ways = [way for way in ways if free(x + way[0], z + way[1])]
        if not ways or chance.random() < 0.25:
            world.step(1)
            continue
        way = chance.choice(ways)
        x, z = x + way[0], z + way[1]
        world.place_agent("bob", centre((x, 1, z)))


def model(question: Question) -> Any:
    return bn.MindModel(
        agent=question.agent,
        goals=question.goals,
        utilities=list(question.utilities),
        doubt=question.doubt,
        credences=np.array(question.credences),
        actual=question.actual,
        rationality=question.rationality,
        discount=question.discount,
        step_cost=question.step_cost,
        stay_cost=question.stay_cost,
        act_cost=question.act_cost,
        diagonal=question.diagonal,
    )


@pytest.mark.parametrize("seed", range(at_night(100, 8)))
def test_inference_in_chunks_agrees_with_the_reference(seed, monkeypatch):
    monkeypatch.setattr(terrain, "DENSE", 0)
    test_inference_agrees_with_the_reference(seed)


@pytest.mark.parametrize("seed", range(at_night(500, 16)))
def test_inference_agrees_with_the_reference(seed):
    made = scene(seed)
    nest, question = made.nest, made.question
    last = nest["/"].tick
    moments = [moment(nest.at(tick=tick)[made.path].state) for tick in range(last + 1)]
    reference = Reference(moments, made.owner, question, made.perception)
    if not reference.course:
        with pytest.raises(bn.BeliefNestError):
            nest[made.path].infer(model(question), ended=question.ended)
        return
    if not any(reference.weights(last).values()):
        with pytest.raises(bn.BeliefNestError):
            nest[made.path].infer(model(question), ended=question.ended)
        return
    if not reference.has_reachable_goal():
        # The agent's walk may show more than the reference's map; an error is right here too.
        with contextlib.suppress(bn.InputError):
            nest[made.path].infer(model(question), ended=question.ended)
        return
    inference = nest[made.path].infer(model(question), ended=question.ended)
    evidence = reference.evidence(last)
    if not evidence:
        assert inference.log_evidence == -np.inf
        return
    assert inference.log_evidence == pytest.approx(np.log(evidence), abs=1e-9)
    for tick in sorted({reference.course[0], last // 2, last}):
        if tick < reference.course[0] or not reference.evidence(tick):
            continue
        for factor, mean in reference.means(tick).items():
            assert inference.mean(factor, tick=tick) == pytest.approx(mean, abs=1e-9), factor
    predicted = inference.predict(steps=3)
    for found, expected in zip(predicted, reference.prediction(last, 3), strict=True):
        for cell in {*found, *expected}:
            assert found.get(cell, 0.0) == pytest.approx(expected.get(cell, 0.0), abs=1e-9)
