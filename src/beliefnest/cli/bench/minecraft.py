"""The real world on a server of this machine: how soon it stands, and what bots there take."""

import os
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from beliefnest.bodies.address import ServerAddress
from beliefnest.bodies.minecraft import MinecraftWorld
from beliefnest.cli.bench.figures import Figure, median_seconds
from beliefnest.errors import InputError
from beliefnest.scenarios.scenario import Scenario
from beliefnest.world.frames import Snapshot
from beliefnest.world.values import TICKS_PER_SECOND

__all__ = ["measure"]

_SERVER = "BELIEFNEST_BENCH_SERVER"
_RUNS = 3
_BOTS = 32
_WATCHED_S = 60


def measure() -> Sequence[Figure]:
    """A verified body of Sally-Anne's box, and the processor time of many bots.

    Raises:
        InputError: No server is named in the environment.
    """
    named = os.environ.get(_SERVER)
    if named is None:
        raise InputError(
            f"name a server on which BeliefNest is an operator: {_SERVER}=minecraft://HOST:PORT"
        )
    world = MinecraftWorld.start(ServerAddress.parse(named), 0)
    snapshot = Scenario.load("sally-anne", 1).setting.snapshot
    try:
        seconds = median_seconds(lambda: _body(world, snapshot), _RUNS)
        share, missing = _crowd(world, snapshot)
    finally:
        world.close()
    return [
        Figure("a verified body of Sally-Anne's box, made and put back", seconds, "s", 3.0),
        Figure(f"processors that {_BOTS} bots take", share, "", 1.0),
        Figure(f"of {_BOTS} bots lost in {_WATCHED_S} s", missing, "", 0.0),
    ]


def _body(world: MinecraftWorld, snapshot: Snapshot) -> None:
    world.open_body("/", "bench", snapshot, lambda frame: None).close()


def _crowd(world: MinecraftWorld, snapshot: Snapshot) -> tuple[float, int]:
    """Processor seconds of Node per second, and how many bots lost their connection meanwhile."""
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
    # A program ends with the connection of its bot.
    waiting = f"await waitTicks(bot, {ticks})"
    results = body.run(dict.fromkeys(crowd, waiting), ticks + 10 * TICKS_PER_SECOND)
    passed = time.perf_counter() - started
    share = (_processor_seconds(world.pid) - before) / passed
    body.close()
    return share, sum(not result.ok for result in results.values())


def _processor_seconds(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
