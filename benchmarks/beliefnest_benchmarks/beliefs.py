"""Benchmarks of beliefs: visible sets, ticks of many nodes, late queries, memory."""

import math
import random
import statistics
import time
from collections.abc import Sequence
from itertools import product

import numpy as np

from beliefnest.nest.face.nest import Nest
from beliefnest.perception.options import Perception
from beliefnest.perception.sight import Geometry, Sight
from beliefnest.world.claims import Claim
from beliefnest.world.registry import Registry
from beliefnest.world.values import Items, Point, Position
from beliefnest.worlds.scripted.world import ScriptedWorld
from beliefnest_benchmarks.children import printed
from beliefnest_benchmarks.figures import Metric, median_seconds
from beliefnest_benchmarks.memory import peak_megabytes
from beliefnest_benchmarks.walkers import paths_below_root

__all__ = ["keep_up", "measure"]

_BOX = ((0, 0, 0), (40, 19, 40))
_STEP = 0.2158
"""Blocks a player walks in one tick."""

_WARM = 300
_TICKS = 200
_DOOR = (20, 1, 20)
_CHESTS = ((1, 1, 20), (39, 1, 20))
_CLAIMS = 40
_LATE = 100_000


def measure() -> Sequence[Metric]:
    """Return all figures of beliefs, measured one after the other."""
    return [*_visible_sets(), *_crowd(8, 3), *_crowd(16, 2), _claims(), *_late(), _memory()]


def _visible_sets() -> list[Metric]:
    figures = []
    for percent, goal in ((2, 2.0), (15, 4.0), (40, 4.0)):
        milliseconds = _look(_random_geometry((41, 20, 41), percent), (20.3, 10.62, 20.7))
        name = f"visible set, 41x20x41, {percent} % solid"
        figures.append(Metric(name, milliseconds, "ms", goal))
    room = _look(_random_geometry((23, 4, 23), 2), (11.3, 2.62, 11.7))
    return [*figures, Metric("visible set, 23x4x23, 2 % solid", room, "ms", 0.2)]


def _random_geometry(shape: tuple[int, int, int], percent: int) -> Geometry:
    """Return a geometry of random blocks, a fifth of them slabs and fences."""
    registry = Registry.load()
    chance = np.random.default_rng(percent)
    kinds = [registry.state_id(name) for name in ("stone", "oak_slab", "oak_fence")]
    blocks = chance.choice(kinds, size=shape, p=[0.8, 0.1, 0.1]).astype(np.int32)
    blocks[chance.random(shape) >= percent / 100] = registry.air
    middle = tuple(slice(size // 2 - 1, size // 2 + 2) for size in shape)
    blocks[middle] = registry.air
    return Sight(registry, None).geometry(blocks, (0, 0, 0))


def _look(geometry: Geometry, eye: Point) -> float:
    """Return the median time of a complete visible set, in milliseconds."""
    geometry.visible_blocks(eye, 0.0, 0.0)
    return median_seconds(lambda: geometry.visible_blocks(eye, 0.0, 0.0), 31) * 1e3


class _Crowd:
    """Agents that walk about in a hall with pillars, while a door opens and shuts.

    All agents know stone and air from the start, as the paper assumes for floor and walls.
    """

    def __init__(self, agents: int, perception: Perception | None = None) -> None:
        self._chance = random.Random(agents)
        self._yaws = {f"agent{n}": self._chance.uniform(-math.pi, math.pi) for n in range(agents)}
        self._feet: dict[str, Point] = {
            name: (3.5 + 2 * n, 1.0, 3.5 + 2 * n) for n, name in enumerate(self._yaws)
        }
        self.pillars = {(x, z) for x in range(5, 40, 7) for z in range(2, 40, 7)}
        blocks: dict[Position, str] = {(x, 0, z): "stone" for x, z in product(range(41), repeat=2)}
        blocks |= {(x, y, z): "stone" for x, z in self.pillars for y in range(1, 20)}
        chests: dict[Position, Items] = {} if perception is None else {at: {} for at in _CHESTS}
        self.world = ScriptedWorld(_BOX, blocks, self._feet, containers=chests)
        options = perception or Perception()
        self.nest = Nest(self.world, options, static_blocks=["stone", "air"])
        self._open = False

    def nodes(self, depth: int) -> list[str]:
        """Return all paths down to a depth."""
        return paths_below_root(list(self._yaws), depth)

    def tick(self, walkers: int) -> None:
        """Move some agents and the door in one tick."""
        with self.world.tick():
            for name in self._chance.sample(sorted(self._yaws), walkers):
                self._walk(name)
            self._open = not self._open
            self.world.set_block(_DOOR, "air" if self._open else "oak_planks")

    def walk_one(self) -> None:
        """Move one agent in one tick."""
        with self.world.tick():
            self._walk(self._chance.choice(sorted(self._yaws)))

    def _walk(self, name: str) -> None:
        x, _, z = self._feet[name]
        for _ in range(8):
            yaw = self._yaws[name]
            x1, z1 = x - math.sin(yaw) * _STEP, z - math.cos(yaw) * _STEP
            free = (int(x1), int(z1)) not in self.pillars and (int(x1), 1, int(z1)) != _DOOR
            if 0.5 < x1 < 40.5 and 0.5 < z1 < 40.5 and free:
                self._feet[name] = (x1, 1.0, z1)
                break
            self._yaws[name] = self._chance.uniform(-math.pi, math.pi)
        self.world.place_agent(name, self._feet[name], self._yaws[name])


def _crowd(agents: int, depth: int) -> list[Metric]:
    crowd = _Crowd(agents)
    paths = crowd.nodes(depth)
    for path in paths:
        crowd.nest[path].state  # noqa: B018 - from now on the node is kept up to date
    spent = []
    for number in range(_WARM + _TICKS):
        crowd.tick(agents)
        started = time.perf_counter()
        for path in paths:
            crowd.nest[path].state  # noqa: B018 - what is measured
        if number >= _WARM:
            spent.append((time.perf_counter() - started) * 1e3)
    quiet = median_seconds(lambda: crowd.nest[paths[-1]].state, 101)
    title = f"{len(paths)} nodes, {agents} agents walking, a door moving"
    spent.sort()
    return [
        Metric(f"tick of {title}", statistics.median(spent), "ms", 10.0),
        Metric(f"95th percentile of {title}", spent[int(0.95 * len(spent))], "ms", 25.0),
        Metric(f"node of {len(paths)} asked for with nothing changed", quiet * 1e6, "us", 50.0),
    ]


def _claims() -> Metric:
    """Return the time of a tick in which all agents hear and judge a claim."""
    crowd = _Crowd(8, Perception(testimony="informed", grace=0))
    paths = crowd.nodes(3)
    spent = []
    for number in range(_CLAIMS):
        crowd.tick(8)
        for path in paths:
            crowd.nest[path].state  # noqa: B018 - up to date before the claim
        claim = Claim.located("diamond", _CHESTS[number % 2])
        crowd.world.say(f"agent{number % 8}", "It is there.", claims=[claim])
        started = time.perf_counter()
        for path in paths:
            crowd.nest[path].state  # noqa: B018 - what is measured
        spent.append((time.perf_counter() - started) * 1e3)
    title = f"tick with a claim heard by 8 agents, {len(paths)} nodes"
    return Metric(title, statistics.median(spent[_CLAIMS // 4 :]), "ms", 10.0)


def _late() -> list[Metric]:
    crowd = _Crowd(8)
    for _ in range(_LATE):
        crowd.walk_one()
    path = "/agent0/agent1/agent2"
    # Loading compiled code happens once in a process, so it must not count here.
    _Crowd(8).nest[path].state.agents["agent3"]
    started = time.perf_counter()
    crowd.nest[path].state.agents["agent3"]
    first = time.perf_counter() - started
    again = median_seconds(lambda: crowd.nest[path].state.agents["agent3"], 31)
    return [
        Metric(f"depth-3 node asked for after {_LATE} ticks", first, "s", 1.0),
        Metric("the same node again", again * 1e3, "ms", 1.0),
    ]


def _memory() -> Metric:
    """Return the peak memory of a child process that runs `keep_up`."""
    peak = float(printed(__name__, "keep_up()"))
    return Metric(f"peak memory, 456 nodes over {_LATE} ticks", peak, "MB", 300.0)


def keep_up() -> float:
    """Keep all nodes down to depth 3 up to date over a long walk; return the peak MB."""
    crowd = _Crowd(8)
    paths = crowd.nodes(3)
    for path in paths:
        crowd.nest[path].state  # noqa: B018 - from now on the node is kept up to date
    for tick in range(_LATE):
        crowd.walk_one()
        if tick % 100 == 0:
            crowd.nest[paths[-1]].state  # noqa: B018 - brings all nodes up to date
    return peak_megabytes()
