"""Benchmarks of real time: beliefs that keep up, and the load of a Minecraft server."""

import itertools
import os
import time
from collections.abc import Sequence
from pathlib import Path

from msgspec.structs import replace

from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.scenario import Scenario
from beliefnest.world.frames import Snapshot
from beliefnest.world.values import TICKS_PER_SECOND
from beliefnest.worlds.servers.address import ServerAddress
from beliefnest.worlds.servers.server_world import MinecraftWorld
from beliefnest_benchmarks.figures import Metric, median_seconds

__all__ = ["measure"]

_SERVER = "BELIEFNEST_BENCH_SERVER"
_RUNS = 3
_BOTS = 32
_WATCHED_S = 600
_DEPTH = 3
_EMBODIED = 3
_WALKED_S = 10
_WALK = """
while (true) {{
  await goToPosition(bot, new Vec3(-8, -51, {z}), 0)
  await goToPosition(bot, new Vec3(2, -51, {z}), 0)
}}
"""


def measure() -> Sequence[Metric]:
    """Return figures of beliefs in real time, and, if a server is named, of bodies and bots."""
    named = os.environ.get(_SERVER)
    return [*_beliefs(), *([] if named is None else _server(named))]


def _beliefs() -> Sequence[Metric]:
    """Measure a run of three walking agents, all beliefs to depth 3, and three bodies."""
    scenario = Scenario.load("sally-anne", 1)
    agents = sorted(scenario.setting.snapshot.agents)
    nodes = [
        names
        for depth in range(1, _DEPTH + 1)
        for names in itertools.product(agents, repeat=depth)
        if all(one != other for one, other in itertools.pairwise(names))
    ]
    paths = ["/" + "/".join(names) for names in nodes]
    walks = {name: _WALK.format(z=2 * number + 3) for number, name in enumerate(agents)}
    with Nest.open(scenario, realtime=True, listen=0) as nest:
        # From its first query on, the nest keeps a belief up to date; first queries take longer.
        nest.states(paths)
        nest["/"].run_all(walks, 2 * TICKS_PER_SECOND)
        nest.states(paths)
        for path in paths[-_EMBODIED:]:
            nest[path].embody()
        nest.wait(timeout_s=1)
        began, used = time.perf_counter(), time.process_time()
        start = nest.tick
        nest["/"].run_all(walks, _WALKED_S * TICKS_PER_SECOND)
        nest.states(paths)
        ticks, seconds = nest.tick - start, time.perf_counter() - began
        per_tick = 1000 * (time.process_time() - used) / ticks
        lag = max(each.lag for each in nest.layout())
    return [
        Metric(
            f"a tick of {len(paths)} beliefs, {_EMBODIED} of them embodied", per_tick, "ms", 5.0
        ),
        Metric(
            "ticks that a run of 10 s is late, its call included", _late(seconds, ticks), "", 2.0
        ),
        Metric(f"a change is seen in {_EMBODIED} embodied beliefs after", lag, "ticks", 4.0),
    ]


def _late(seconds: float, ticks: int) -> float:
    return max(0.0, seconds * TICKS_PER_SECOND - ticks)


def _server(named: str) -> Sequence[Metric]:
    """Return figures of a verified body of Sally-Anne's box, and of many bots."""
    world = MinecraftWorld(ServerAddress.parse(named), 0).start()
    snapshot = Scenario.load("sally-anne", 1).setting.snapshot
    try:
        seconds = median_seconds(lambda: _body(world, snapshot), _RUNS)
        share, missing = _crowd(world, snapshot)
    finally:
        world.close()
    return [
        Metric("a verified body of Sally-Anne's box, made and put back", seconds, "s", 3.0),
        Metric(f"processors that {_BOTS} bots take", share, "", 1.0),
        Metric(f"of {_BOTS} bots lost in {_WATCHED_S} s", missing, "", 0.0),
    ]


def _body(world: MinecraftWorld, snapshot: Snapshot) -> None:
    world.open_body("/", "bench", snapshot, lambda frame: None).close()


def _crowd(world: MinecraftWorld, snapshot: Snapshot) -> tuple[float, int]:
    """Return Node's processor seconds per second, and the number of bots that lost connection."""
    one = next(iter(snapshot.agents.values()))
    x, y, z = snapshot.box.low
    places = [(x + 1.5 + 2 * (i % 8), y + 1.0, z + 1.5 + 2 * (i // 8)) for i in range(_BOTS)]
    crowd = {
        f"bot{i}": replace(one, position=place, inventory={}, equipment={})
        for i, place in enumerate(places)
    }
    body = world.open_body("/", "bench", replace(snapshot, agents=crowd), lambda frame: None)
    before, started = _processor_seconds(world.pid), time.perf_counter()
    ticks = _WATCHED_S * TICKS_PER_SECOND
    # The program of a bot ends when the bot loses its connection.
    waiting = f"await waitTicks(bot, {ticks})"
    results = body.run(dict.fromkeys(crowd, waiting), ticks + 10 * TICKS_PER_SECOND)
    passed = time.perf_counter() - started
    share = (_processor_seconds(world.pid) - before) / passed
    body.close()
    return share, sum(not result.ok for result in results.values())


def _processor_seconds(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
