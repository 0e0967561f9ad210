"""Episodes: rounds against real time, branches a planner tries, tasks solved."""

import time

from beliefnest.bodies.worlds import Worlds
from beliefnest.cli.bench.figures import Figure
from beliefnest.episodes.episode import Episode
from beliefnest.episodes.policies.search import Bounds, Planner
from beliefnest.episodes.task import Task
from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.scenario import Scenario
from beliefnest.world.values import TICKS_PER_SECOND

__all__ = ["measure"]

_TICKS = 100
_WALK = """
for (let n = 0; n < 4; n++) {
  await goToPosition(bot, new Vec3(%d, 1, 1), 0)
  await goToPosition(bot, new Vec3(%d, 1, 14), 0)
}
await waitTicks(bot, 200)
"""


def measure() -> list[Figure]:
    """A round of four agents, branches of an order-1 search, each task at its order."""
    return [_round(), _branches(), *(_solved(name) for name in Task.names())]


def _round() -> Figure:
    """Programs of 100 ticks of four agents that read percepts, and everybody's belief after it."""
    hall = {
        "name": "round",
        "box": [[0, 0, 0], [15, 3, 15]],
        "blocks": [{"block": "stone", "fill": [[0, 0, 0], [15, 0, 15]]}],
        "static_blocks": ["stone"],
        "agents": {name: {"position": [x + 0.5, 1, 1.5]} for x, name in enumerate("abcd", 3)},
    }
    with (
        Worlds(0) as worlds,
        Nest.open(Scenario.from_mapping(hall), world="scripted", worlds=worlds) as nest,
    ):
        programs = {name: _WALK % (x, x) for x, name in enumerate("abcd", 3)}
        nest["/"].run_all(programs, 10, senses="percepts")
        started = time.perf_counter()
        nest["/"].run_all(programs, _TICKS, senses="percepts")
        beliefs = [nest[f"/{name}"].state.agents for name in "abcd"]
        seconds = time.perf_counter() - started
        assert len(beliefs) == 4
    faster = _TICKS / TICKS_PER_SECOND / seconds
    return Figure("round of 4 agents, 100 ticks, scripted", faster, "x", 100.0, at_least=True)


def _branches() -> Figure:
    task = Task.load("tell-what-is-needed", agents=3)
    with Episode(task) as episode:
        view = episode.view("nora")
        planner = Planner(view.brief)
        planner.plan(view.imagine(1), "nora", 1, view.ticks_left, Bounds())
        planner = Planner(view.brief)
        started = time.perf_counter()
        planner.plan(view.imagine(1), "nora", 1, view.ticks_left, Bounds())
        seconds = time.perf_counter() - started
    rate = planner.tried / seconds
    return Figure("branches, order 1, 3 agents", rate, "1/s", 200.0, at_least=True)


def _solved(name: str) -> Figure:
    task = Task.load(name)
    started = time.perf_counter()
    with Episode(task) as episode:
        solved = episode.play().success
    seconds = time.perf_counter() - started
    unit = "s" if solved else "s, not solved"
    return Figure(f"{name} at order {task.order}", seconds, unit, 60.0)
