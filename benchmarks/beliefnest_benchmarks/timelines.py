"""Benchmarks of timelines in a run file: recording, forking, reading the past, reopening."""

import itertools
import math
import random
import sqlite3
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path

import msgspec
from msgspec.structs import replace

from beliefnest.belief.view import State
from beliefnest.errors import StoreError
from beliefnest.nest.face.nest import Nest
from beliefnest.nest.past.history import StateHistory
from beliefnest.scenarios.scenario import Scenario
from beliefnest.timeline.journal import ForkPoint, TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.world.frames import Frame
from beliefnest.world.paths import parse_path
from beliefnest.world.values import AgentState
from beliefnest.worlds.scripted.world import ScriptedWorld
from beliefnest_benchmarks.figures import Metric, median_seconds
from beliefnest_benchmarks.memory import peak_megabytes

__all__ = ["measure"]

_TICKS = 1_000_000
_BATCH = 1000
_SINGLE = 5000
_AGENTS = 8
_STEP = 0.2158
"""Blocks a player walks in one tick."""

_WALK = 20_000
"""Ticks of the walk that is recorded repeatedly; longer than the pieces that are compressed."""

_TRIES = 101
_LOOKS = 31
_SWITCHES = 21
_STROLL = {
    "stone": "await goToPosition(bot, new Vec3(0, -51, 5))",
    "glass": "await goToPosition(bot, new Vec3(4, -51, -8))",
}
"""Programs by block; each branch is named after a block and built of it."""

_FIELD = ((-100, 0, -100), (100, 2, 100))
_MAIN = TimelineKey((), "main")
_DEEP = "/agent0/agent1"
_SINGLES = TimelineKey((), "single")


def measure() -> Sequence[Metric]:
    """Return figures of recording and reading a million ticks of eight walking agents.

    The agents walk in an open field that all of them know. The journal receives a thousand
    ticks at a time, and the nest's history follows, as in a long call of a nest. Two beliefs are
    queried at the beginning.
    """
    walk = list(_walk())
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.bn"
        recorded = _recorded(path, walk)
        size = path.stat().st_size / 1e6
        with Journal.open(path) as journal:
            figures = [
                Metric(
                    "ticks recorded, in batches", recorded.alone, "1/s", 20_000.0, at_least=True
                ),
                Metric("the same, following two beliefs", recorded.followed, "1/s"),
                Metric("memory that the last 9/10 of them take", recorded.memory, "MB"),
                Metric("ticks recorded, one at a time", _one_by_one(journal, walk), "1/s"),
                Metric("file of 10^6 ticks", size, "MB", 400.0),
                Metric("fork after 10^6 ticks", _fork(journal) * 1e3, "ms", 1.0),
                Metric("entries of a past tick of 10^6", _read(journal, walk) * 1e3, "ms", 20.0),
                Metric("opening a file of 10^6 ticks", _open(path) * 1e3, "ms"),
            ]
        figures += [
            Metric("reality at a past tick of 10^6", _look_back(path, "/") * 1e3, "ms", 20.0),
            Metric("a belief then, two deep", _look_back(path, _DEEP) * 1e3, "ms"),
            Metric("resume of 10^6 ticks, to reality's state", _resume(path, "/"), "s", 2.0),
            Metric("resume of 10^6 ticks, to a belief two deep", _resume(path, _DEEP), "s", 2.0),
        ]
        _drop_checkpoints(path)
        figures += [
            Metric(
                "reality at a past tick, no checkpoint", _look_back(path, "/") * 1e3, "ms", 20.0
            ),
            Metric("resume to reality's state, no checkpoint", _resume(path, "/"), "s", 2.0),
        ]
        switched = _switch(Path(folder) / "switched.bn")
        return [
            *figures,
            Metric("switch of a body, 20 blocks, 3 agents", switched * 1e3, "ms", 150.0),
        ]


def _walk() -> Iterator[Frame]:
    chance = random.Random(0)
    held = {"diamond": 1, "bread": 12, "iron_pickaxe": 1}
    worn = {"main_hand": "iron_pickaxe"}
    edge = _FIELD[1][0]
    poses = [[chance.uniform(-edge, edge) for _ in range(2)] + [0.0] for _ in range(_AGENTS)]
    for tick in range(1, _WALK + 1):
        agents = {}
        for number, pose in enumerate(poses):
            pose[2] += chance.gauss(0, 0.1)
            pose[0] = min(max(pose[0] - math.sin(pose[2]) * _STEP, -edge), edge)
            pose[1] = min(max(pose[1] - math.cos(pose[2]) * _STEP, -edge), edge)
            x, z, yaw = (round(value, 6) for value in pose)
            agents[f"agent{number}"] = AgentState(
                (x, 1.0, z), yaw, 0.0, equipment=worn, inventory=held
            )
        yield Frame(tick, agents)


def _later(walk: Sequence[Frame], tick: int) -> Frame:
    return replace(walk[tick % len(walk)], tick=tick)


class _Recorded(msgspec.Struct, frozen=True):
    """Ticks recorded per second, by the journal alone and with the history; size in megabytes."""

    alone: float
    followed: float
    memory: float


def _recorded(path: Path, walk: Sequence[Frame]) -> _Recorded:
    """Record the long run."""
    agents = {name: agent.position for name, agent in walk[0].agents.items() if agent is not None}
    world = ScriptedWorld(_FIELD, agents=agents)
    with Nest(world, static_blocks=["air"], store=path) as nest:
        setting = nest.setting
    alone = followed = 0.0
    with Journal.open(path) as journal:
        history = StateHistory(journal, setting)
        history.state(_MAIN, parse_path(_DEEP, tuple(agents)))
        for start in range(1, _TICKS + 1, _BATCH):
            frames = [_later(walk, tick) for tick in range(start, start + _BATCH)]
            started = time.perf_counter()
            journal.append(_MAIN, frames, frames[-1].tick)
            alone += time.perf_counter() - started
            history.note(_MAIN)
            followed += time.perf_counter() - started
            if start <= _TICKS // 10:
                memory = peak_megabytes()
        history.close()
    return _Recorded(_TICKS / alone, _TICKS / followed, peak_megabytes() - memory)


def _drop_checkpoints(path: Path) -> None:
    with closing(sqlite3.connect(path)) as connection, connection:
        connection.execute("DELETE FROM keyframe")


def _one_by_one(journal: Journal, walk: Sequence[Frame]) -> float:
    """Return ticks recorded per second, one at a time."""
    journal.create(_SINGLES, None, 0)
    started = time.perf_counter()
    for frame in walk[:_SINGLE]:
        journal.append(_SINGLES, [frame], frame.tick)
    return _SINGLE / (time.perf_counter() - started)


def _fork(journal: Journal) -> float:
    names = iter(range(_TRIES))

    def fork() -> None:
        base = ForkPoint(_MAIN, _TICKS, _TICKS)
        journal.create(TimelineKey((), f"plan {next(names)}"), base, _TICKS)

    return median_seconds(fork, _TRIES)


def _read(journal: Journal, walk: Sequence[Frame]) -> float:
    chance = random.Random(1)

    def read() -> None:
        tick = chance.randrange(1, _TICKS)
        last = journal.entries_until(_MAIN, tick)
        if list(journal.entries(_MAIN, last - 1, last)) != [_later(walk, tick)]:
            raise StoreError(f"tick {tick} was not read as it was recorded")

    return median_seconds(read, _TRIES)


def _open(path: Path) -> float:
    return median_seconds(lambda: Journal.read(path).close(), _TRIES)


def _switch(store: Path) -> float:
    """Return the seconds to switch between branches of the real world, in Minecraft."""
    with Nest.open(Scenario.load("sally-anne", 3), store=store) as nest:
        world = nest["/"]
        for name, program in _STROLL.items():
            world.switch(name, at=0)
            world.edit(blocks={(x, -51, 9): name for x in range(-10, 10)})
            world.run_all(dict.fromkeys(nest.agents, program))
        names = itertools.cycle(_STROLL)
        return median_seconds(lambda: world.switch(next(names)), _SWITCHES)


def _resume(store: Path, path: str) -> float:
    """Return the seconds from opening the file of a long run to the state of a simulator."""
    started = time.perf_counter()
    with Nest.resume(store) as nest:
        _check(nest[path].state)
        return time.perf_counter() - started


def _look_back(store: Path, path: str) -> float:
    """Return the seconds to get the state of a simulator at a past tick of a long run."""
    chance = random.Random(2)
    with Nest.read(store) as nest:
        return median_seconds(
            lambda: _check(nest.at(chance.randrange(1, _TICKS))[path].state), _LOOKS
        )


def _check(state: State) -> None:
    if state.agents["agent0"].position is None and state.owner is None:
        raise StoreError("an agent of a long run has no position")
