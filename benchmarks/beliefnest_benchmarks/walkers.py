"""Agents that walk on a floor of stone: a world for benchmarks of growth."""

import math
import random
import statistics
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np

from beliefnest.nest.face.nest import Nest
from beliefnest.world.frames import Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, Box, Point
from beliefnest.worlds.scripted.world import ScriptedWorld

__all__ = ["EVERY", "Walk", "Walkers", "paths_below_root"]

EVERY = 100
"""Ticks between two readings of a long walk."""

_STEP = 0.2158
"""Blocks a player walks in one tick."""
_GROUND = 4
"""Height of the top layer of stone."""
_FIELD = 40
"""Edge in blocks of the part of the box in which agents walk, from the box's lower corner."""
_WARM, _TICKS = 40, 120
_SPAWN, _SEED = 3, 1


@dataclass(frozen=True, slots=True)
class Walk:
    """Walk of all agents: shape of the box, number of agents, depth of beliefs, known floor."""

    shape: tuple[int, int, int]
    agents: int
    depth: int
    is_known: bool = False


def paths_below_root(names: Sequence[str], depth: int) -> list[str]:
    """Return all paths of beliefs down to a depth."""
    chains = (chain for length in range(1, depth + 1) for chain in product(names, repeat=length))
    return ["/" + "/".join(c) for c in chains if all(a != b for a, b in pairwise(c))]


class Walkers:
    """Agents that walk on a floor of stone with pillars.

    Args:
        walk: The walk.
        store: Run file; None: the nest is recorded in memory.

    Attributes:
        feet: Places of the agents by name.
        nest: Nest of their beliefs.
        paths: Paths of these beliefs.
        began: Processor time of opening the nest, in s.
        world: World in which they walk.
    """

    def __init__(self, walk: Walk, store: str | None = None) -> None:
        self._chance = random.Random(_SEED)
        registry = Registry.load()
        stone, (x, y, z) = registry.state_id("stone"), walk.shape
        blocks = Terrain.full(walk.shape, registry.air).draft()
        blocks.fill((0, 0, 0), (x, _GROUND + 1, z), stone)
        self._taken = np.zeros((_FIELD, _FIELD), dtype=np.bool_)
        self._taken[4::7, 5::7] = True
        for i, k in product(range(4, x, 7), range(5, z, 7)):
            blocks.fill((i, _GROUND + 1, k), (i + 1, _GROUND + 4, k + 1), stone)
        self.feet: dict[str, Point] = {}
        for number in range(walk.agents):
            at = _SPAWN + 7 * (number % 5) + 0.5, _SPAWN + 4 * (number // 5 % 9) + 0.5
            self.feet[f"agent{number:02d}"] = (at[0], _GROUND + 1.0, at[1])
        self._yaws = {name: self._chance.uniform(-math.pi, math.pi) for name in self.feet}
        box = Box((0, 0, 0), (x - 1, y - 1, z - 1))
        agents = {name: AgentState(feet) for name, feet in self.feet.items()}
        snapshot = Snapshot(0, box, blocks.terrain().canonical(), {}, agents)
        del blocks
        self.world = ScriptedWorld.from_snapshot(snapshot)
        known = ["stone", "air"] if walk.is_known else []
        started = time.process_time()
        self.nest = Nest(self.world, static_blocks=known, store=store)
        self.began = time.process_time() - started
        self.paths = paths_below_root(list(self.feet), walk.depth)

    def first_beliefs(self) -> float:
        """Make all beliefs down to the walk's depth; return the processor time in s."""
        started = time.process_time()
        self.nest.states(self.paths)
        return time.process_time() - started

    def read(self) -> float:
        """Read every belief of the walk; return the processor time in ms."""
        started = time.process_time()
        for path in self.paths:
            self.nest[path].state  # noqa: B018 - what is measured
        return (time.process_time() - started) * 1e3

    def median_tick(self) -> float:
        """Walk; return the median processor time of reading every belief in a tick, in ms."""
        spent = []
        for _ in range(_WARM + _TICKS):
            self.tick()
            spent.append(self.read())
        return statistics.median(spent[_WARM:])

    def long_walk(self, ticks: int) -> Iterator[tuple[int, float]]:
        """Walk, and read every belief each `EVERY` ticks.

        Yields:
            The number of ticks so far, and the processor time of this reading for each tick, in ms.
        """
        for number in range(1, ticks + 1):
            self.tick()
            if number % EVERY == 0:
                yield number, self.read() / EVERY

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
