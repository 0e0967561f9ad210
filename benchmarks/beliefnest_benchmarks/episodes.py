"""Benchmarks of episodes: rounds against real time, branches of planners, solved tasks."""

import time
from typing import Any

from beliefnest.episodes.episode import Episode
from beliefnest.episodes.policies.candidates import calls_of, claims_of_mind, said
from beliefnest.episodes.policies.course_planner import Planner, SearchBounds
from beliefnest.episodes.task import Task
from beliefnest.facts.states import StateFacts
from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.scenario import Scenario
from beliefnest.world.values import TICKS_PER_SECOND
from beliefnest.worlds.by_name import Worlds
from beliefnest_benchmarks.figures import Metric

__all__ = ["measure"]

_TICKS = 100
_TRIED = 40
_PROCESSES = 2
_WANTED = ("apple", "bread", "carrot")
_WALK = """
for (let n = 0; n < 4; n++) {
  await goToPosition(bot, new Vec3(%d, 1, 1), 0)
  await goToPosition(bot, new Vec3(%d, 1, 14), 0)
}
await waitTicks(bot, 200)
"""


def measure() -> list[Metric]:
    """Return figures of rounds, of an order-1 search, and of each task."""
    return [
        _round(),
        _branches(),
        *(_crowd(order) for order in (0, 1)),
        _branches_in_minecraft(),
        *(_solved(name) for name in Task.names()),
    ]


def _round() -> Metric:
    """Time a round: four agents run programs of 100 ticks on percepts; then read all beliefs."""
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
    return Metric("round of 4 agents, 100 ticks, scripted", faster, "x", 100.0, at_least=True)


def _branches() -> Metric:
    task = Task.load("tell-what-is-needed", agents=3)
    with Episode(task) as episode:
        view = episode.view("nora")
        # The first search compiles.
        for _ in range(2):
            planner = Planner(view.brief)
            started = time.perf_counter()
            planner.planning("nora", 1, view.ticks_left, SearchBounds()).best(view.imagine(1))
            seconds = time.perf_counter() - started
    rate = planner.tried / seconds
    return Metric("branches, order 1, 3 agents", rate, "1/s", 200.0, at_least=True)


def _crowd(order: int) -> Metric:
    """Time the slowest round of eight agents in a hall of 64 x 64 blocks."""
    task = Task.of(Scenario.from_mapping(_hall()))
    with Episode(task, dict.fromkeys(task.players, f"search:{order}")) as episode:
        seconds = []
        while not episode.is_over:
            started = time.process_time()
            episode.play(1)
            seconds.append(time.process_time() - started)
        assert episode.success
    title = f"slowest round of search:{order}, 8 agents, 64 x 64, processor time"
    return Metric(title, max(seconds), "s", 2.0)


def _hall() -> dict[str, Any]:
    """Return a scenario: agents who each know one of three items must bring all to one barrel."""
    spots = [(8, 8), (55, 8), (8, 55), (55, 55), (32, 6), (6, 32), (57, 32), (32, 57)]
    names = ["ann", "bob", "carl", "dora", "eve", "finn", "gus", "hal"]
    chests = [(12, 14), (51, 14), (12, 49), (51, 49), (32, 16), (16, 32)]
    held = [{"apple": 1}, {"bread": 1}, {"carrot": 1}, {"bone": 1}, {"stick": 2}, {}]
    contents = [
        {"at": [x, 1, z], "items": items} for (x, z), items in zip(chests, held, strict=True)
    ]
    barrel = [32, 1, 32]
    return {
        "name": "hall",
        "box": [[0, 0, 0], [63, 3, 63]],
        "blocks": [{"block": "stone", "fill": [[0, 0, 0], [63, 0, 63]]}],
        "static_blocks": ["stone", "chest", "barrel"],
        "containers": [
            *({"label": "chest", **each} for each in contents),
            {"label": "barrel", "at": barrel, "block": "barrel"},
        ],
        "agents": {
            name: {"position": [x + 0.5, 1, z + 0.5]}
            for name, (x, z) in zip(names, spots, strict=True)
        },
        "perception": {"max_visible_distance": 64, "testimony": "accept", "hearing": "global"},
        "initial_beliefs": [
            {"path": f"/{name}", "containers": [contents[number % 3]]}
            for number, name in enumerate(names)
        ],
        "episode": {
            "goal": {"reach": [{"container": barrel, "items": dict.fromkeys(_WANTED, 1)}]},
            "talk": names,
            "rounds": 8,
            "round_ticks": 20,
        },
    }


def _branches_in_minecraft() -> Metric:
    """Time the candidates of an order-1 planner, each on an embodied branch of its belief.

    Only programs of the agent itself run there. The planner itself uses scripted worlds.
    """
    task = Task.load("tell-what-is-needed", agents=3)
    with Episode(task, world="embedded") as episode:
        view = episode.view("nora")
        mind, goals = view.imagine(1), list(view.brief.goals.values())
        told = claims_of_mind(mind, goals, lies=False)
        calls = [*calls_of(mind, "nora", [view.goal]), *map(said, told)]
        wanted = view.goal.reach[0].fact
        programs = [calls[number % len(calls)].program for number in range(_TRIED)]

        def tried(name: str) -> float:
            started = time.perf_counter()
            attempts = episode.nest.explore(
                "/nora",
                "nora",
                programs,
                lambda simulator, _: float(wanted.holds(StateFacts(simulator.state))),
                timeout_ticks=view.brief.round_ticks,
                name=name,
                processes=_PROCESSES,
            )
            return len(attempts) / (time.perf_counter() - started)

        tried("first")
        rate = tried("again")
    return Metric("branches in Minecraft, order 1, 3 agents", rate, "1/s", 20.0, at_least=True)


def _solved(name: str) -> Metric:
    task = Task.load(name)
    started = time.perf_counter()
    with Episode(task) as episode:
        solved = episode.play().success
    seconds = time.perf_counter() - started
    unit = "s" if solved else "s, not solved"
    return Metric(f"{name} at order {task.order}", seconds, unit, 60.0)
