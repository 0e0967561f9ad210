"""Benchmark of imagined histories: drawing a thousand, and reading their states."""

import statistics
import time
from collections.abc import Callable, Sequence

from beliefnest.minds.imagining.histories import Imagined
from beliefnest.minds.mind_model import MindModel
from beliefnest.nest.face.nest import Nest
from beliefnest.worlds.scripted.world import ScriptedWorld
from beliefnest_benchmarks.figures import Metric

_HISTORIES, _TICKS, _RUNS = 1000, 60, 3
_PLACES = {"K": (1, 1, 1), "L": (13, 1, 7), "M": (13, 1, 1)}


def measure() -> Sequence[Metric]:
    """Return times of drawing histories of a walk in a room, and of reading them against it."""
    world = ScriptedWorld(
        box=((0, 0, 0), (14, 3, 8)),
        blocks={(x, 0, z): "stone" for x in range(15) for z in range(9)},
        agents={"anne": (1.5, 1, 4.5), "bob": (9.5, 1, 4.5)},
        containers={(9, 1, 2): {"diamond": 1}},
    )
    model = MindModel(
        "bob",
        {name: {"at": place} for name, place in _PLACES.items()},
        {name: [5, 30] for name in _PLACES},
        rationality=0.3,
    )
    runs: list[tuple[float, ...]] = []
    with Nest(world) as nest:
        world.step(_TICKS)
        anything = [{"agent": "anne", "at": (1, 1, 4)}]
        for seed in range(_RUNS):
            began = time.perf_counter()
            imagined = nest["/"].imagine(
                0, actors={"bob": {"walk": model}}, n=_HISTORIES, seed=seed, evidence=anything
            )
            drawn = time.perf_counter() - began
            runs.append((drawn, *(_spent(read, imagined) / drawn for read in _READINGS.values())))
    drawing, *ratios = (statistics.median(run) for run in zip(*runs, strict=True))
    return [
        Metric(f"drawing {_HISTORIES} histories of {_TICKS} ticks", drawing, "s"),
        *(
            Metric(name, ratio, "of drawing", 1.0)
            for name, ratio in zip(_READINGS, ratios, strict=True)
        ),
    ]


def _spent(read: Callable[[Imagined], object], imagined: Imagined) -> float:
    began = time.perf_counter()
    read(imagined)
    return time.perf_counter() - began


def _agents(imagined: Imagined) -> None:
    for history in imagined:
        for tick in range(_TICKS + 1):
            history.at(tick).state.agents  # noqa: B018 - timed


def _all(imagined: Imagined) -> None:
    for history in imagined:
        for tick in range(_TICKS + 1):
            state = history.at(tick).state
            state.agents, state.containers, state.blocks.terrain  # noqa: B018 - timed


_READINGS: dict[str, Callable[[Imagined], object]] = {
    "feet of their agents": lambda imagined: [each.feet("bob") for each in imagined],
    "agents at every tick": _agents,
    "agents, contents and blocks at every tick": _all,
}
