"""Agent programs: one that does nothing, the price of the sandbox, many walkers, a dead Node."""

import json
import statistics
import subprocess
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from beliefnest.bodies.node_files import node_command
from beliefnest.cli.bench import restore
from beliefnest.cli.bench.figures import Metric, median_seconds
from beliefnest.errors import BodyError
from beliefnest.nest.face.nest import Nest
from beliefnest.nest.past.setting import Senses
from beliefnest.scenarios.scenario import Scenario
from beliefnest.world.values import TICKS_PER_SECOND

__all__ = ["measure"]

_RUNS = 50
_WALKS = 5
_PAIRS = 61
_WARM = 20
"""Pairs of walks before which Node has not yet compiled what it runs most."""

_SIZE = 21
_FLOOR = -52
_PILLARS = range(-18, 19, 9)
_CORNERS = ((15, 15), (-15, 10), (-10, -17), (17, -12))


def measure() -> Sequence[Metric]:
    """All figures of programs, as users run them: `Nest.open`, `Simulator.run` and `run_all`."""
    walks = [_walk(4, 100.0), _walk(16, 20.0), _walk(4, None, "percepts")]
    return [_empty(), *_containment(), *walks, *restore.measure()]


def _empty() -> Metric:
    """From the call to the result, recorded in a run file."""
    with (
        tempfile.TemporaryDirectory() as folder,
        Nest.open(_hall(1), store=Path(folder) / "run.bn") as nest,
    ):
        spent = median_seconds(lambda: nest["/"].run("agent0", ""), _RUNS)
    return Metric("empty program, from call to result", spent * 1e3, "ms", 15.0)


def _containment() -> Sequence[Metric]:
    """What the sandbox adds to a walk of four legs, beside the same calls of skills without one.

    Inside Node, walks by turns, the median over pairs; then as a part of what a user waits for,
    who gets the walk recorded in a run file.
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
    """Return seconds from the call to the result of the walk."""
    with (
        tempfile.TemporaryDirectory() as folder,
        Nest.open(_hall(1), store=Path(folder) / "run.bn") as nest,
    ):
        programs = {"agent0": _round(0)}
        for _ in range(_WARM):
            _speed(nest, programs)
        return median_seconds(lambda: _speed(nest, programs), _PAIRS)


def _walk(agents: int, target: float | None, senses: Senses = "world") -> Metric:
    """Everybody walks around the hall, recorded in a run file; the median of some rounds."""
    programs = {f"agent{number}": _round(number) for number in range(agents)}
    with (
        tempfile.TemporaryDirectory() as folder,
        Nest.open(_hall(agents), store=Path(folder) / "run.bn") as nest,
    ):
        # Node compiles what it runs most.
        ratios = [_speed(nest, programs, senses) for _ in range(1 + _WALKS)][1:]
    what = "" if senses == "world" else f" by their {senses}"
    name = f"{agents} agents walking{what}, Minecraft seconds per second"
    return Metric(name, statistics.median(ratios), "x", target, at_least=True)


def _speed(nest: Nest, programs: dict[str, str], senses: Senses = "world") -> float:
    """Minecraft seconds per second."""
    before = nest.tick
    started = time.perf_counter()
    results = nest["/"].run_all(programs, senses=senses)
    seconds = time.perf_counter() - started
    if not all(result.ok for result in results.values()):
        raise BodyError("an agent did not get around the hall")
    return (nest.tick - before) / TICKS_PER_SECOND / seconds


def _round(number: int) -> str:
    """Return a walk of four legs; neighbours begin at different corners and keep apart."""
    places = (_CORNERS[(number + leg) % len(_CORNERS)] for leg in range(len(_CORNERS)))
    row = number // len(_CORNERS)
    return "\n".join(
        f"await goToPosition(bot, new Vec3({x + row}, {_FLOOR + 1}, {z - row}), 1)"
        for x, z in places
    )


def _hall(agents: int) -> Scenario:
    """Return a hall of 43 by 43 blocks with pillars."""
    feet = _FLOOR + 1
    pillars = ((x, z) for x in _PILLARS for z in _PILLARS)
    document = {
        "name": "hall",
        "box": [[-_SIZE, _FLOOR, -_SIZE], [_SIZE, _FLOOR + 3, _SIZE]],
        "blocks": [
            {"block": "stone", "fill": [[-_SIZE, _FLOOR, -_SIZE], [_SIZE, _FLOOR, _SIZE]]},
            *({"block": "stone", "fill": [[x, feet, z], [x, feet + 1, z]]} for x, z in pillars),
        ],
        "agents": {
            f"agent{number}": {"position": [2 * number - 15.5, feet, number * 5 % 7 - 3.5]}
            for number in range(agents)
        },
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "hall.yaml"
        path.write_text(json.dumps(document))
        return Scenario.load(str(path))
