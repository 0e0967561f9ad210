"""Inference in large boxes: as in a small box with the same scene, at the cost of what is there."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from tests.profiles import few_by_day

import beliefnest as bn
import beliefnest_benchmarks
from beliefnest.minds import node_inference, surroundings
from beliefnest.world import terrain
from beliefnest.world.memory import MemoryLimit

SMALL = ((-7, -2, -7), (15, 9, 13))
# The edges of chunks are 8 blocks apart, from one block before the box; the floor has several.
LARGE = [((-161, -30, -90), (140, 40, 150)), ((-7, -3, -150), (700, 30, 18))]
SHIFT = (1003, 7, -64)
GOALS = {"G": {"block": "gold_block"}, "D": {"item": "diamond"}, "C": {"at": (8, 1, 0)}}
WALK = [(0, 2), (1, 2), (2, 2), (3, 2), (3, 1), (3, 0), (4, 0), (5, 0), (5, 1)]
HIDDEN = (5, 1, 3)
WALL = {(4, y, z): "stone" for y in (1, 2) for z in (2, 3, 4, 5, 6)}
DOOR = {
    (4, 1, 1): "oak_door[half=lower,facing=east]",
    (4, 2, 1): "oak_door[half=upper,facing=east]",
}
DOUBTS = {
    "goal": {
        "there": {"blocks": {(6, 0, 3): "gold_block"}},
        "here": {"blocks": {(6, 0, 3): "stone"}},
    },
    "wall": {
        name: {"blocks": {HIDDEN: block, (5, 2, 3): block}}
        for name, block in {"wall": "stone", "free": "air", "bars": "iron_bars"}.items()
    },
    "fence": {
        name: {"blocks": {(2, 1, 0): block}}
        for name, block in {"on": "oak_fence", "off": "air"}.items()
    },
    "contents": {
        "full": {"containers": {(6, 1, 1): {"diamond": 1}}},
        "empty": {"containers": {(6, 1, 1): {}}},
    },
    "place": {
        name: {"agents": {"carl": (x + 0.5, 1, z + 0.5)}}
        for name, (x, z) in {"a": (6, 4), "b": (8, 3)}.items()
    },
}


def moved(place, shift):
    return tuple(part + by for part, by in zip(place, shift, strict=True))


def moved_keys(held, shift):
    return {moved(place, shift): value for place, value in held.items()}


def doubt(kind, shift):
    """Return a doubt about a scene that is moved."""
    found = {}
    for name, edits in DOUBTS[kind].items():
        found[name] = {
            key: {who: moved(at, shift) for who, at in held.items()}
            if key == "agents"
            else moved_keys(held, shift)
            for key, held in edits.items()
        }
    return found


def played(box, shift=(0, 0, 0)):
    """Return a nest in which bob walks about a wall with a door, while anne looks on."""
    floor = {(x, 0, z): "stone" for x in range(9) for z in range(7)}
    steps = {(7, 1, 5): "stone", (8, 1, 5): "stone", (8, 2, 6): "stone", (8, 1, 6): "stone"}
    blocks = {**floor, **WALL, **DOOR, **steps, (2, 0, 5): "gold_block"}
    feet = {"bob": (0, 2), "anne": (1, 5), "carl": (8, 3)}
    world = bn.ScriptedWorld(
        tuple(moved(corner, shift) for corner in box),
        moved_keys(blocks, shift),
        {name: moved((x + 0.5, 1, z + 0.5), shift) for name, (x, z) in feet.items()},
        containers=moved_keys({(6, 1, 1): {"diamond": 1}, (0, 1, 6): {"diamond": 2}}, shift),
    )
    perception = bn.Perception(max_visible_distance=5, containers="transparent")
    known = ["stone", "air", "gold_block", "chest", "oak_door"]
    nest = bn.Nest(world, static_blocks=known, perception=perception)
    for x, z in WALK:
        world.place_agent("bob", moved((x + 0.5, 1, z + 0.5), shift), yaw=0.3 * x)
        if (x, z) == (5, 0):
            world.set_block(moved((1, 1, 0), shift), "glass")
    return nest


def model(kind, shift, **further):
    goals = {
        name: {key: moved(at, shift) if key == "at" else at for key, at in goal.items()}
        for name, goal in GOALS.items()
    }
    return bn.MindModel(
        agent="bob",
        goals=goals,
        utilities={"G": [0, 8], "D": [0, 5], "C": [0, 6]},
        doubt=doubt(kind, shift),
        credences=bn.simplex_grid(len(DOUBTS[kind]), 2, smoothing=0.1),
        rationality=1.0,
        **further,
    )


def told(box, shift, kind, path, **further):
    """Return all that is inferred in a scene, with places as if it had not been moved."""
    nest = played(box, shift)
    simulator = nest[path]
    back = tuple(-part for part in shift)
    inference = simulator.infer(model(kind, shift, actual="unknown", **further), smooth=True)
    paths = inference.sample_paths(3, seed=4)
    imagined = simulator.imagine(
        since=0,
        actors={"bob": {"model": model(kind, shift, **further), "idle": ""}},
        n=12,
        seed=1,
        evidence=[{"agent": "bob", "at": moved((5, 1, 1), shift), "mistaken": 0.2}],
    )
    return {
        "impossible": inference.impossible is None,
        "posteriors": [inference.posterior(tick).tobytes() for tick in inference.ticks],
        "foreseen": [moved_keys(each, back) for each in inference.predict(4)],
        "paths": [{tick: moved(at, back) for tick, at in each.cells.items()} for each in paths],
        "credences": [simulator.credence("bob", doubt(kind, shift), tick=t) for t in range(9)],
        "imagined": (imagined.by_candidate("bob"), imagined.effective_size),
        "drawn": [moved(each["/"].state.agents["bob"].position, back) for each in imagined],
    }


@pytest.fixture(scope="module")
def in_small_box():
    kept = {}

    def found(kind, path, **further):
        key = (kind, path, repr(further))
        if key not in kept:
            kept[key] = told(SMALL, (0, 0, 0), kind, path, **further)
        return kept[key]

    return found


@pytest.mark.parametrize("kind", few_by_day(DOUBTS, 2))
@pytest.mark.parametrize("path", ["/", "/anne"])
def test_a_large_box_changes_nothing(in_small_box, kind, path):
    expected = in_small_box(kind, path)
    assert expected["impossible"] or path == "/anne"
    for low, high in LARGE:
        assert told((low, high), (0, 0, 0), kind, path) == expected


@pytest.mark.parametrize("kind", ["wall", "contents"])
def test_a_moved_scene_changes_nothing(in_small_box, kind):
    assert told(LARGE[0], SHIFT, kind, "/") == in_small_box(kind, "/")


def test_diagonal_steps_are_the_same(in_small_box):
    expected = in_small_box("wall", "/", diagonal=True)
    assert told(LARGE[0], (0, 0, 0), "wall", "/", diagonal=True) == expected
    assert expected["posteriors"] != in_small_box("wall", "/")["posteriors"]


@pytest.mark.parametrize("kind", ["wall", "fence"])
def test_chunks_change_nothing(in_small_box, monkeypatch, kind):
    expected = in_small_box(kind, "/")
    monkeypatch.setattr(terrain, "DENSE", 0)
    assert told(SMALL, (0, 0, 0), kind, "/") == expected


def test_a_vast_box_takes_no_memory_of_its_size():
    # In a process of its own, which knows its greatest memory.
    code = """
from beliefnest_benchmarks.memory import peak_megabytes
from tests.minds.test_large_boxes import doubt, model, played
still = (0, 0, 0)
played(((-7, -2, -7), (15, 9, 60)))["/"].infer(model("wall", still, actual="unknown"))
nest, before = played(((-500, -50, -500), (499, 49, 499))), peak_megabytes()
nest["/"].infer(model("wall", still, actual="unknown"))
nest["/"].credence("bob", doubt("wall", still))
print(peak_megabytes() - before)
"""
    paths = [Path(__file__).parents[2], Path(beliefnest_benchmarks.__file__).parents[1], *sys.path]
    run = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(map(str, paths))},
        capture_output=True,
        text=True,
        check=True,
    )
    # One byte for each cell would be 100 MB.
    assert float(run.stdout) < 80


def test_too_many_cells_are_refused_before_planning(monkeypatch):
    nest = played(LARGE[0])
    asked = model("wall", (0, 0, 0), actual="unknown")
    monkeypatch.setattr(surroundings, "_MOST_CELLS", 20)
    with pytest.raises(
        bn.TooLargeError, match=r"bob can get to more than 20 cells from \(0, 1, 2\)"
    ):
        nest["/"].infer(asked)
    # No cell is visited for the credence by percepts.
    assert sum(nest["/"].credence("bob", doubt("wall", (0, 0, 0))).values()) == pytest.approx(1)
    monkeypatch.undo()
    monkeypatch.setattr(surroundings, "memory_limit", lambda: MemoryLimit(12_000, "its cage"))
    with pytest.raises(
        bn.TooLargeError, match=r"Each takes at least .* its cage: use a smaller box"
    ):
        played(LARGE[0])["/"].infer(asked)
    monkeypatch.undo()
    monkeypatch.setattr(node_inference, "memory_limit", lambda: MemoryLimit(1_000, "its cage"))
    with pytest.raises(bn.TooLargeError, match="coarser grid of credences"):
        played(LARGE[0])["/"].infer(asked)
