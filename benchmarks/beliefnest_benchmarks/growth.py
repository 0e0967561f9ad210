"""Benchmarks of growth: ticks and memory in large boxes, and with many agents."""

import json
import math
import random
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise, product
from pathlib import Path

import numpy as np

from beliefnest.errors import BodyError
from beliefnest.nest.face.nest import Nest
from beliefnest.world.frames import Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, Box, Point
from beliefnest.worlds.scripted.world import ScriptedWorld
from beliefnest_benchmarks.figures import Metric
from beliefnest_benchmarks.memory import megabytes, peak_megabytes

__all__ = ["followed", "measure", "walked"]

_STEP = 0.2158
"""Blocks a player walks in one tick."""
_GROUND = 4
"""Height of the top layer of stone."""
_FIELD = 40
"""Edge in blocks of the part of the box in which agents walk, from the box's lower corner."""
_WARM, _TICKS = 40, 120
_SPAWN, _SEED = 3, 1
_FULL, _LONG, _EVERY = 9000, 12_000, 100
"""Ticks after which all caches are full, ticks of a long walk, and ticks between two readings."""


@dataclass(frozen=True, slots=True)
class _Walk:
    """Walk of all agents: shape of the box, number of agents, depth of beliefs, known floor."""

    shape: tuple[int, int, int]
    agents: int
    depth: int
    is_known: bool = False


def measure() -> Sequence[Metric]:
    """Return the figures; each walk is a process of its own."""
    span = f"ticks {_FULL} to {_LONG} of 32 agents"
    small = _child(_Walk((40, 64, 40), 3, 2))
    large = _child(_Walk((640, 64, 640), 3, 2))
    deep = _child(_Walk((160, 64, 160), 8, 3))
    crowd = _child(_Walk((40, 20, 40), 32, 2, is_known=True))
    wide = _child(_Walk((40, 20, 40), 64, 1, is_known=True))
    hall = _child(_Walk((40, 20, 40), 8, 3, is_known=True))
    ticks, memory = large["tick"] / small["tick"], large["memory"] / small["memory"]
    return [
        Metric("tick of 10 nodes, 3 agents, 40 x 64 x 40", small["tick"], "ms"),
        Metric("tick of 10 nodes, 3 agents, 640 x 64 x 640", large["tick"], "ms"),
        Metric("ratio of these ticks", ticks, "", 1.5),
        Metric("peak memory, 40 x 64 x 40", small["memory"], "MB"),
        Metric("peak memory, 640 x 64 x 640", large["memory"], "MB"),
        Metric("ratio of these memories", memory, "", 3.0),
        Metric("first beliefs, 640 x 64 x 640", large["first"], "s"),
        Metric("tick of 456 nodes, 8 agents, 160 x 64 x 160", deep["tick"], "ms"),
        Metric("peak memory, 456 nodes, 160 x 64 x 160", deep["memory"], "MB", 400.0),
        Metric("tick of 1,024 nodes, 32 agents, depth 2", crowd["tick"], "ms", 25.0),
        Metric("tick of 64 nodes, 64 agents, depth 1", wide["tick"], "ms", 10.0),
        Metric("tick of 456 nodes, 8 agents, depth 3", hall["tick"], "ms"),
        Metric(f"memory grown, {span}, in memory", _grown(in_file=False), "MB", 5.0),
        Metric(f"memory grown, {span}, in a run file", _grown(in_file=True), "MB", 5.0),
    ]


def _child(walk: _Walk) -> Mapping[str, float]:
    """Return the figures of a walk in a process of its own."""
    figures: Mapping[str, float] = json.loads(_printed(f"walked({json.dumps(asdict(walk))!r})"))
    return figures


def _grown(*, in_file: bool) -> float:
    """Return the MB that a long walk adds once caches are full, recorded in memory or in a file."""
    with tempfile.TemporaryDirectory() as folder:
        store = str(Path(folder) / "run.bn") if in_file else None
        return float(_printed(f"followed({store!r})"))


def _printed(call: str) -> str:
    """Return the result of a function of this module in a process of its own."""
    code = f"from {__name__} import *; print({call})"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise BodyError(f"a process in which agents walk failed: {done.stderr.strip()}")
    return done.stdout


def followed(store: str | None) -> float:
    """Let 32 agents walk, read 1,024 nodes now and then, and return the MB grown after `_FULL`."""
    walkers = _Walkers(_Walk((80, 20, 80), 32, 2, is_known=True), store)
    paths = _paths(list(walkers.feet), 2)
    walkers.nest.states(paths)
    full = 0.0
    for tick in range(1, _LONG + 1):
        walkers.tick()
        if tick % _EVERY == 0:
            for path in paths:
                walkers.nest[path].state  # noqa: B018 - brings all nodes up to date
        if tick == _FULL:
            full = megabytes()
    return megabytes() - full


def _paths(names: Sequence[str], depth: int) -> list[str]:
    """Return all paths down to a depth."""
    chains = (chain for length in range(1, depth + 1) for chain in product(names, repeat=length))
    return ["/" + "/".join(c) for c in chains if all(a != b for a, b in pairwise(c))]


def walked(text: str) -> str:
    """Walk as a JSON object says, and return figures as one.

    `tick` is the median processor time of a tick in ms, all nodes read. `first` is the processor
    time of the first beliefs in s, `memory` the greatest memory in MB.
    """
    given = json.loads(text)
    walkers = _Walkers(_Walk(tuple(given.pop("shape")), **given))
    paths = _paths(list(walkers.feet), given["depth"])
    started = time.process_time()
    walkers.nest.states(paths)
    first = time.process_time() - started
    spent = []
    for _ in range(_WARM + _TICKS):
        walkers.tick()
        started = time.process_time()
        for path in paths:
            walkers.nest[path].state  # noqa: B018 - what is measured
        spent.append((time.process_time() - started) * 1e3)
    memory = peak_megabytes()
    tick = statistics.median(spent[_WARM:])
    return json.dumps({"tick": tick, "first": first, "memory": memory})


class _Walkers:
    """Agents that walk on a floor of stone with pillars.

    Attributes:
        feet: Places of the agents by name.
        nest: Nest of their beliefs.
    """

    def __init__(self, walk: _Walk, store: str | None = None) -> None:
        self._chance = random.Random(_SEED)
        registry = Registry.load()
        stone, (x, y, z) = registry.state_id("stone"), walk.shape
        blocks = np.full(walk.shape, registry.air, dtype=np.int32)
        blocks[:, : _GROUND + 1] = stone
        blocks[4::7, _GROUND + 1 : _GROUND + 4, 5::7] = stone
        self._taken = blocks[:_FIELD, _GROUND + 1, :_FIELD] == stone
        self.feet: dict[str, Point] = {}
        for number in range(walk.agents):
            at = _SPAWN + 7 * (number % 5) + 0.5, _SPAWN + 4 * (number // 5 % 9) + 0.5
            self.feet[f"agent{number:02d}"] = (at[0], _GROUND + 1.0, at[1])
        self._yaws = {name: self._chance.uniform(-math.pi, math.pi) for name in self.feet}
        box = Box((0, 0, 0), (x - 1, y - 1, z - 1))
        agents = {name: AgentState(feet) for name, feet in self.feet.items()}
        self.world = ScriptedWorld.from_snapshot(Snapshot(0, box, Terrain.of(blocks), {}, agents))
        del blocks
        known = ["stone", "air"] if walk.is_known else []
        self.nest = Nest(self.world, static_blocks=known, store=store)

    def tick(self) -> None:
        """Let every agent walk on in one tick."""
        with self.world.tick():
            for name in self.feet:
                self._walk(name)

    def _walk(self, name: str) -> None:
        x, y, z = self.feet[name]
        for _ in range(8):
            yaw = self._yaws[name]
            i, k = x - math.sin(yaw) * _STEP, z - math.cos(yaw) * _STEP
            if min(i, k) > 0.5 and max(i, k) < _FIELD - 0.5 and not self._taken[int(i), int(k)]:
                self.feet[name] = (i, y, k)
                break
            self._yaws[name] = self._chance.uniform(-math.pi, math.pi)
        self.world.place_agent(name, self.feet[name], self._yaws[name])
