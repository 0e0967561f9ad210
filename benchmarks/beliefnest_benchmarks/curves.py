"""Curves of growth: time and memory over the box, agents, depth, ticks and branches."""

import json
import statistics
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import NamedTuple

import msgspec

from beliefnest_benchmarks.children import printed
from beliefnest_benchmarks.memory import megabytes, peak_megabytes
from beliefnest_benchmarks.walkers import EVERY, Walk, Walkers

__all__ = [
    "CURVES",
    "Aim",
    "Curve",
    "Point",
    "Series",
    "branched",
    "measured_points",
    "of_long_walk",
    "of_walk",
]

_LONG, _READINGS = 20_000, 20
"""Ticks of a long walk, and points along it."""
_BRANCHES, _BLOCK = 1_000, 50
"""Branches that are made, and branches between two points."""


class Point(NamedTuple):
    """Point of a curve: name of its series, place along the axis, milliseconds, megabytes."""

    series: str
    x: float
    ms: float
    mb: float


class Series(msgspec.Struct, frozen=True):
    """One line of a curve.

    Attributes:
        name: Text at its end.
        calls: Calls of functions of this module, Python expressions. Each is made in a process of
            its own and returns a JSON list of `[x, ms, mb]`.
    """

    name: str
    calls: Sequence[str]


class Aim(msgspec.Struct, frozen=True):
    """Figure that a curve is not to exceed, drawn as a line.

    Attributes:
        column: Column of `Point` that it limits, `ms` or `mb`.
        text: Text beside the line.
        value: The figure; a multiple of the first point if `of_first` is set.
        of_first: Name of the series whose first point is meant.
        at: The only place along the axis at which the aim holds; None: everywhere.
    """

    column: str
    text: str
    value: float
    of_first: str | None = None
    at: float | None = None


class Curve(msgspec.Struct, frozen=True):
    """Curve of growth, drawn as two plots: time and memory over the same axis.

    Attributes:
        name: Name of its files.
        title: What is measured.
        x: Label of the common axis, with its unit.
        ms: Label of the axis of time.
        mb: Label of the axis of memory.
        series: The lines.
        aims: Figures not to exceed.
        log: Letters of the axes that are logarithmic, `x` and `y`.
    """

    name: str
    title: str
    x: str
    ms: str
    mb: str
    series: Sequence[Series]
    aims: Sequence[Aim] = ()
    log: str = "xy"


def _walks(name: str, walks: Sequence[tuple[int, Walk]]) -> Series:
    """Return a series of walks, each with its place along the axis."""
    return Series(name, [f"of_walk({x}, {json.dumps(asdict(walk))!r})" for x, walk in walks])


def _crowd(agents: int, depth: int) -> Walk:
    return Walk((40, 20, 40), agents, depth, is_known=True)


_TICK, _PEAK = "tick, ms of processor time", "peak memory of the process, MB"
_BOX = "3 agents, depth 2"
_STORES = (("in memory", False), ("in a run file", True))

CURVES: Sequence[Curve] = (
    Curve(
        "box",
        "Box: nobody knows a block at first",
        "edge of the box, blocks (height 64)",
        _TICK,
        _PEAK,
        [_walks(_BOX, [(n, Walk((n, 64, n), 3, 2)) for n in (40, 80, 160, 320, 640)])],
        [
            Aim("ms", "at most 1.5 times the first", 1.5, of_first=_BOX),
            Aim("mb", "at most 3 times the first", 3.0, of_first=_BOX),
        ],
    ),
    Curve(
        "agents",
        "Agents: box of 40 x 20 x 40, stone and air known",
        "agents",
        _TICK,
        _PEAK,
        [
            _walks("depth 1", [(n, _crowd(n, 1)) for n in (4, 8, 16, 32, 64, 128)]),
            _walks("depth 2", [(n, _crowd(n, 2)) for n in (4, 8, 16, 32, 48)]),
        ],
        [Aim("ms", "depth 2: 25 ms", 25.0, at=32), Aim("ms", "depth 1: 10 ms", 10.0, at=64)],
    ),
    Curve(
        "depth",
        "Depth: box of 40 x 20 x 40, stone and air known; or 160 x 64 x 160, nothing known",
        "depth of beliefs",
        _TICK,
        _PEAK,
        [
            _walks("3 agents", [(n, _crowd(3, n)) for n in range(1, 7)]),
            _walks("8 agents", [(n, _crowd(8, n)) for n in range(1, 5)]),
            _walks("8 agents, large box", [(n, Walk((160, 64, 160), 8, n)) for n in range(1, 4)]),
        ],
        [Aim("mb", "large box: 400 MB", 400.0, at=3)],
        log="y",
    ),
    Curve(
        "ticks",
        "Ticks: 16 agents, depth 2, box of 80 x 20 x 80, stone and air known",
        f"ticks walked (all beliefs read each {EVERY})",
        _TICK,
        "memory of the process, MB",
        [Series(name, [f"of_long_walk(in_file={file})"]) for name, file in _STORES],
        log="",
    ),
    Curve(
        "branches",
        "Branches: 3 agents, box of 40 x 20 x 40, branches of one belief",
        "branches",
        "next branch, ms of processor time",
        "memory added by all branches, MB",
        [
            Series(f"{what}, {name}", [f"branched(in_file={file}, {how})"])
            for what, how in (
                ("empty", "acts=False, chained=False"),
                ("one tick", "acts=True, chained=False"),
                ("each from the last", "acts=True, chained=True"),
            )
            for name, file in _STORES
        ],
        log="",
    ),
)


def measured_points(
    curve: Curve, on_point: Callable[[str], object] = lambda text: None
) -> Sequence[Point]:
    """Measure a curve, each call of its series in a process of its own.

    Args:
        curve: The curve.
        on_point: Function called with the name of each series before its next process starts.

    Raises:
        BodyError: A process failed.
    """
    points = []
    for series in curve.series:
        for call in series.calls:
            on_point(f"{curve.name}: {series.name}")
            found = json.loads(printed(__name__, call))
            points += [Point(series.name, *each) for each in found]
    return points


def of_walk(x: float, text: str) -> str:
    """Walk as a JSON object says; return one point: the median tick and the peak memory."""
    given = json.loads(text)
    walkers = Walkers(Walk(tuple(given.pop("shape")), **given))
    walkers.first_beliefs()
    return json.dumps([[x, walkers.median_tick(), peak_megabytes()]])


def of_long_walk(*, in_file: bool, ticks: int = _LONG, agents: int = 16) -> str:
    """Let agents walk for many ticks; return points along the walk.

    Milliseconds are the median of the readings since the last point, for each tick.
    """
    points, spent = [], list[float]()
    with tempfile.TemporaryDirectory() as folder:
        walkers = Walkers(Walk((80, 20, 80), agents, 2, is_known=True), _store(folder, in_file))
        walkers.first_beliefs()
        for tick, ms in walkers.long_walk(ticks):
            spent.append(ms)
            if tick % (ticks // _READINGS) == 0:
                points.append([tick, statistics.median(spent), megabytes()])
                spent.clear()
        walkers.nest.close()
    return json.dumps(points)


def branched(
    *, in_file: bool, acts: bool, chained: bool, branches: int = _BRANCHES, block: int = _BLOCK
) -> str:
    """Make branches of the belief of one of three agents; return points along them.

    Milliseconds are the median of the branches since the last point.

    Args:
        in_file: True to record in a run file.
        acts: True if an agent moves on each branch, and a belief of the branch is read.
        chained: True if each branch begins on the last one, False if all begin in reality's belief.
        branches: Number of branches.
        block: Number of branches between two points.
    """
    points, spent = [], list[float]()
    with tempfile.TemporaryDirectory() as folder:
        walkers = Walkers(_crowd(3, 2), _store(folder, in_file))
        walkers.first_beliefs()
        for _ in range(20):
            walkers.tick()
        walkers.read()
        simulator = walkers.nest["/agent00"]
        before = megabytes()
        for number in range(1, branches + 1):
            started = time.process_time()
            if not chained:
                simulator.switch("follow")
            simulator.switch(f"branch {number}")
            if acts:
                with simulator.scripted.tick():
                    simulator.scripted.place_agent("agent01", walkers.feet["agent01"], number / 10)
                walkers.nest["/agent00/agent01"].state  # noqa: B018 - what is measured
            spent.append((time.process_time() - started) * 1e3)
            if number % block == 0:
                points.append([number, statistics.median(spent), megabytes() - before])
                spent.clear()
        walkers.nest.close()
    return json.dumps(points)


def _store(folder: str, in_file: bool) -> str | None:
    return str(Path(folder) / "run.bn") if in_file else None
