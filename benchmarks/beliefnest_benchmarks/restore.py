"""Benchmark of recovery after Node is killed."""

import os
import signal
from collections.abc import Sequence

from beliefnest.errors import BodyError
from beliefnest.nest.acting.engine import Engine
from beliefnest.nest.face.opening import begun
from beliefnest.scenarios.scenario import Scenario
from beliefnest.worlds.minecraft.embedded import EmbeddedWorld
from beliefnest_benchmarks.figures import Metric, median_seconds

__all__ = ["measure"]

_RUNS = 7
_PATHS: Sequence[tuple[str, ...]] = ((), ("ann",), ("ann", "bob"))
_AGENTS = ("ann", "bob", "cleo")


def measure() -> Sequence[Metric]:
    """Return the time from the kill until all bodies have advanced by a tick."""
    world = EmbeddedWorld(0).start()
    engine = begun(_room(), world, "embedded", 0)
    try:
        _go_apart(engine)

        def restore() -> None:
            os.kill(world.pid, signal.SIGKILL)
            for path in _PATHS:
                engine.step(path, 1)

        spent = median_seconds(restore, _RUNS)
    finally:
        engine.close()
    return [Metric("restore after a kill of Node, 3 bodies with 3 agents each", spent, "s", 3.0)]


def _go_apart(engine: Engine) -> None:
    """Put three simulators into control mode and let all agents walk in each."""
    for path in _PATHS[1:]:
        engine.fork(path, "own", None)
    for path in _PATHS:
        walks = {
            agent: f"await goToPosition(bot, new Vec3({2 * number + 1}, 1, 18), 0)"
            for number, agent in enumerate(_AGENTS)
        }
        results = engine.run(path, walks, 1200)
        if not all(result.ok for result in results.values()):
            raise BodyError("an agent did not get to the other side of the room")


def _room() -> Scenario:
    return Scenario.from_mapping(
        {
            "name": "room",
            "box": [[0, 0, 0], [20, 4, 20]],
            "blocks": [{"block": "stone", "fill": [[0, 0, 0], [20, 0, 20]]}],
            "static_blocks": ["stone"],
            "agents": {
                agent: {"position": [2 * number + 1.5, 1, 1.5]}
                for number, agent in enumerate(_AGENTS)
            },
        }
    )
