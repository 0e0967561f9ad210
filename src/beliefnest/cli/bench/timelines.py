"""Timelines in a run file: recording, forking, reading the past, opening again."""

import itertools
import math
import random
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from beliefnest.cli.bench.figures import Figure, median_seconds
from beliefnest.errors import StoreError
from beliefnest.nest.nest import Nest
from beliefnest.scenarios.scenario import Scenario
from beliefnest.timeline.journal import ForkPoint, TimelineKey
from beliefnest.timeline.store import SqliteJournal
from beliefnest.world.frames import Frame
from beliefnest.world.scripted import ScriptedWorld
from beliefnest.world.values import AgentState

__all__ = ["measure"]

_TICKS = 1_000_000
_BATCH = 1000
_SINGLE = 5000
_AGENTS = 8
_STEP = 0.2158
"""Blocks a player walks in one tick."""

_WALK = 20_000
"""Ticks of the walk that is recorded over and over; longer than any piece that is packed."""

_TRIES = 101
_SWITCHES = 21
_STROLL = {
    "stone": "await goToPosition(bot, new Vec3(0, -51, 5))",
    "glass": "await goToPosition(bot, new Vec3(4, -51, -8))",
}
"""Blocks that branches are built of and named after, and what everybody does there."""

_FIELD = ((-100, 0, -100), (100, 2, 100))
_MAIN = TimelineKey((), "main")
_SINGLES = TimelineKey((), "single")


def measure() -> Sequence[Figure]:
    """A million ticks of eight agents that walk, recorded and then used."""
    walk = list(_walk())
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.bn"
        agents = dict.fromkeys(walk[0].agents, (0.5, 1.0, 0.5))
        Nest(ScriptedWorld(_FIELD, agents=agents), store=path).close()
        with SqliteJournal.open(path) as journal:
            batched = _recorded(journal, walk)
        size = path.stat().st_size / 1e6
        with SqliteJournal.open(path) as journal:
            figures = [
                Figure("ticks recorded, in batches", batched, "1/s", 20_000.0, at_least=True),
                Figure("ticks recorded, one at a time", _one_by_one(journal, walk), "1/s"),
                Figure("file of 10^6 ticks", size, "MB", 400.0),
                Figure("fork after 10^6 ticks", _fork(journal) * 1e3, "ms", 1.0),
                Figure("entries of a past tick of 10^6", _read(journal, walk) * 1e3, "ms", 20.0),
                Figure("opening a file of 10^6 ticks", _open(path) * 1e3, "ms"),
            ]
        switched = _switch(Path(folder) / "switched.bn")
        return [
            *figures,
            Figure("switch of a body, 20 blocks, 3 agents", switched * 1e3, "ms", 150.0),
            Figure("resume of 10^6 ticks, to reality's state", _resume(path), "s", 2.0),
        ]


def _walk() -> Iterator[Frame]:
    chance = random.Random(0)
    held = {"diamond": 1, "bread": 12, "iron_pickaxe": 1}
    worn = {"main_hand": "iron_pickaxe"}
    poses = [[chance.uniform(-99, 99), chance.uniform(-99, 99), 0.0] for _ in range(_AGENTS)]
    for tick in range(1, _WALK + 1):
        agents = {}
        for number, pose in enumerate(poses):
            pose[2] += chance.gauss(0, 0.1)
            pose[0] -= math.sin(pose[2]) * _STEP
            pose[1] -= math.cos(pose[2]) * _STEP
            x, z, yaw = (round(value, 6) for value in pose)
            agents[f"agent{number}"] = AgentState(
                (x, -51.0, z), yaw, 0.0, equipment=worn, inventory=held
            )
        yield Frame(tick, agents)


def _later(walk: Sequence[Frame], tick: int) -> Frame:
    return replace(walk[tick % len(walk)], tick=tick)


def _recorded(journal: SqliteJournal, walk: Sequence[Frame]) -> float:
    """Ticks a second."""
    spent = 0.0
    for start in range(1, _TICKS + 1, _BATCH):
        frames = [_later(walk, tick) for tick in range(start, start + _BATCH)]
        started = time.perf_counter()
        journal.append(_MAIN, frames, frames[-1].tick)
        spent += time.perf_counter() - started
    return _TICKS / spent


def _one_by_one(journal: SqliteJournal, walk: Sequence[Frame]) -> float:
    """Ticks a second."""
    journal.create(_SINGLES, None, 0)
    started = time.perf_counter()
    for frame in walk[:_SINGLE]:
        journal.append(_SINGLES, [frame], frame.tick)
    return _SINGLE / (time.perf_counter() - started)


def _fork(journal: SqliteJournal) -> float:
    names = iter(range(_TRIES))

    def fork() -> None:
        base = ForkPoint(_MAIN, _TICKS, _TICKS)
        journal.create(TimelineKey((), f"plan {next(names)}"), base, _TICKS)

    return median_seconds(fork, _TRIES)


def _read(journal: SqliteJournal, walk: Sequence[Frame]) -> float:
    chance = random.Random(1)

    def read() -> None:
        tick = chance.randrange(1, _TICKS)
        last = journal.entries_until(_MAIN, tick)
        if list(journal.entries(_MAIN, last - 1, last)) != [_later(walk, tick)]:
            raise StoreError(f"tick {tick} was not read as it was recorded")

    return median_seconds(read, _TRIES)


def _open(path: Path) -> float:
    return median_seconds(lambda: SqliteJournal.read(path).close(), _TRIES)


def _switch(store: Path) -> float:
    """Seconds to go from one branch of the real world to another, in Minecraft."""
    with Nest.open(Scenario.load("sally-anne", 3), store=store) as nest:
        world = nest["/"]
        for name, program in _STROLL.items():
            world.switch(name, at=0)
            world.edit(blocks={(x, -51, 9): name for x in range(-10, 10)})
            world.run_all(dict.fromkeys(nest.agents, program))
        names = itertools.cycle(_STROLL)
        return median_seconds(lambda: world.switch(next(names)), _SWITCHES)


def _resume(store: Path) -> float:
    """Seconds from the file of a long run to the state of its real world."""
    started = time.perf_counter()
    with Nest.resume(store) as nest:
        if nest["/"].state.agents["agent0"].position is None:
            raise StoreError("an agent of the real world has no position")
        return time.perf_counter() - started
