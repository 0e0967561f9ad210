"""Benchmarks of agent programs: an empty one, the cost of the sandbox, many walkers."""

import json
import math
import statistics
import subprocess
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from beliefnest.errors import BodyError
from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.scenario import Scenario
from beliefnest.timeline.run_records import Senses
from beliefnest.world.values import TICKS_PER_SECOND
from beliefnest.worlds.minecraft.node_files import node_command
from beliefnest_benchmarks import restore
from beliefnest_benchmarks.figures import Metric, median_seconds

__all__ = ["measure"]

_RUNS = 50
_WALKS = 5
_PAIRS = 61
_WARM = 20
"""Pairs of walks that are not counted, during which Node compiles its hot code."""

_REACH = 17
_FLOOR = -52
_PILLARS = range(-18, 19, 9)
_WALKERS = ((4, 100.0), (16, 60.0), (32, None), (64, 6.0))
"""Numbers of agents that walk, each with the speed to reach."""

_CORNERS = ((15, 15), (-15, 10), (-10, -17), (17, -12))


def measure() -> Sequence[Metric]:
    """Return all figures of programs, run with `Nest.open`, `Simulator.run` and `run_all`."""
    walks = [_walk(agents, target) for agents, target in _WALKERS]
    walks.append(_walk(4, None, "percepts"))
    return [_empty(), *_containment(), *walks, *restore.measure()]


def _empty() -> Metric:
    """Return the time from the call to the result of an empty program in a recorded run."""
    with (
        tempfile.TemporaryDirectory() as folder,
        Nest.open(_hall(1), store=Path(folder) / "run.bn") as nest,
    ):
        spent = median_seconds(lambda: nest["/"].run("agent0", ""), _RUNS)
    return Metric("empty program, from call to result", spent * 1e3, "ms", 15.0)


def _containment() -> Sequence[Metric]:
    """Return the time that the sandbox adds to a walk of four legs.

    The first figure compares the walk with the same calls of skills outside the sandbox, both in
    Node: the median over alternating pairs. The second figure is the share of the sandbox in the
    time that a user waits for the recorded walk.
    """
    command = [*node_command(), "containment", str(_WARM + _PAIRS)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise BodyError(f"measuring the sandbox failed: {done.stderr.strip()}")
    pairs = json.loads(done.stdout)[_WARM:]
    inside = statistics.median(pair["contained"] / pair["direct"] - 1 for pair in pairs)
    added = statistics.median(pair["contained"] - pair["direct"] for pair in pairs)
    whole = _call() * 1e3
    walk = "added by the sandbox to a walk of four legs"
    return [
        Metric(f"{walk}, from call to result", added / (whole - added) * 100, "%", 10.0),
        Metric(f"{walk}, bots and server alone", inside * 100, "%"),
    ]


def _call() -> float:
    """Return the time from the call to the result of the walk, in seconds."""
    with (
        tempfile.TemporaryDirectory() as folder,
        Nest.open(_hall(1), store=Path(folder) / "run.bn") as nest,
    ):
        programs = {"agent0": _round(0)}
        for _ in range(_WARM):
            _speed(nest, programs)
        return median_seconds(lambda: _speed(nest, programs), _PAIRS)


def _walk(agents: int, target: float | None, senses: Senses = "world") -> Metric:
    """Return the speed of agents that walk around the hall in a recorded run: a median."""
    programs = {f"agent{number}": _round(number) for number in range(agents)}
    with (
        tempfile.TemporaryDirectory() as folder,
        Nest.open(_hall(agents), store=Path(folder) / "run.bn") as nest,
    ):
        # The first walk does not count: Node compiles its hot code.
        ratios = [_speed(nest, programs, senses) for _ in range(1 + _WALKS)][1:]
    what = "" if senses == "world" else f" by their {senses}"
    name = f"{agents} agents walking{what}, Minecraft seconds per second"
    return Metric(name, statistics.median(ratios), "x", target, at_least=True)


def _speed(nest: Nest, programs: dict[str, str], senses: Senses = "world") -> float:
    """Return Minecraft seconds per second."""
    before = nest.tick
    started = time.perf_counter()
    results = nest["/"].run_all(programs, senses=senses)
    seconds = time.perf_counter() - started
    if not all(result.ok for result in results.values()):
        raise BodyError("an agent did not get around the hall")
    return (nest.tick - before) / TICKS_PER_SECOND / seconds


def _round(number: int) -> str:
    """Return a program of four legs; neighbours begin at different corners and keep apart."""
    places = (_CORNERS[(number + leg) % len(_CORNERS)] for leg in range(len(_CORNERS)))
    row = number // len(_CORNERS)
    return "\n".join(
        f"await goToPosition(bot, new Vec3({x + row}, {_FLOOR + 1}, {z - row}), 1)"
        for x, z in places
    )


def _start(number: int) -> tuple[float, float, float]:
    """Return the position of an agent at the beginning: 16 in a band of 7 blocks."""
    band, place = divmod(number, 16)
    return 2 * place - 15.5, _FLOOR + 1, number * 5 % 7 - 3.5 + 7 * band


def _hall(agents: int) -> Scenario:
    """Return a hall with pillars, of 43 by 43 blocks for up to 16 agents and larger for more."""
    feet = _FLOOR + 1
    size = _REACH + max(4, math.ceil(agents / len(_CORNERS)))
    pillars = ((x, z) for x in _PILLARS for z in _PILLARS)
    document = {
        "name": "hall",
        "box": [[-size, _FLOOR, -size], [size, _FLOOR + 3, size]],
        "blocks": [
            {"block": "stone", "fill": [[-size, _FLOOR, -size], [size, _FLOOR, size]]},
            *({"block": "stone", "fill": [[x, feet, z], [x, feet + 1, z]]} for x, z in pillars),
        ],
        "agents": {f"agent{number}": {"position": _start(number)} for number in range(agents)},
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "hall.yaml"
        path.write_text(json.dumps(document))
        return Scenario.load(str(path))
