"""Benchmarks of prompts: the paper's template late in a long run, and the ice cream van."""

import gc
import math
import time
from collections.abc import Sequence

from beliefnest.nest.face.nest import Nest
from beliefnest.perception.options import Perception
from beliefnest.prompts import built_in_template
from beliefnest.world.values import Position
from beliefnest.worlds.scripted.world import ScriptedWorld
from beliefnest_benchmarks.children import play_scenario
from beliefnest_benchmarks.figures import Metric, median_seconds

__all__ = ["measure"]

_TICKS = 10_000
_RENDERS = 20
_RUNS = 3
_SIZE = 20
_AGENTS = ("anne", "bob", "sally", "tom")


def measure() -> Sequence[Metric]:
    """Return the time to render a prompt after a long run, and of one whole experiment."""
    nest = _walked(_TICKS)
    template = built_in_template("paper")
    asked = nest["/anne/sally"]
    asked.render(template, task="Go.")
    known = median_seconds(lambda: asked.render(template, task="Go."), _RENDERS)
    # A search of all objects for garbage takes 0.1 s; the next one is not to begin in what follows.
    gc.collect()
    started = time.perf_counter()
    nest["/bob/tom/anne"].render(template, task="Go.")
    new = time.perf_counter() - started
    play_scenario("ice-cream-van")
    whole = median_seconds(lambda: play_scenario("ice-cream-van"), _RUNS)
    return [
        Metric(f"depth 2 after {_TICKS:,} ticks", known * 1000, "ms", 20.0),
        Metric("depth 3, a path nobody asked for before", new * 1000, "ms", 300.0),
        Metric("ice cream van, process start included", whole, "s", 8.0),
    ]


def _walked(ticks: int) -> Nest:
    """Return a nest in which four agents have walked around a wall and spoken at times."""
    wall: dict[Position, str] = {(10, y, z): "stone" for y in range(3) for z in range(4, 16)}
    chests: dict[Position, dict[str, int]] = {(3, 0, 10): {"diamond": 1}, (17, 0, 10): {}}
    world = ScriptedWorld(
        ((0, 0, 0), (_SIZE, 4, _SIZE)),
        wall,
        {name: _place(number, 0) for number, name in enumerate(_AGENTS)},
        containers=chests,
    )
    nest = Nest(world, Perception(max_visible_distance=64, hearing="sight"), ["stone"])
    for tick in range(1, ticks):
        with world.tick():
            for number, name in enumerate(_AGENTS):
                world.place_agent(name, _place(number, tick))
            if tick % 500 == 0:
                world.say(_AGENTS[tick // 500 % len(_AGENTS)], f"It is {tick}.")
    return nest


def _place(number: int, tick: int) -> tuple[float, float, float]:
    """Return an agent's position on a circle around the wall; agents keep apart."""
    angle = tick / 100 + number * math.tau / len(_AGENTS)
    middle = _SIZE / 2
    return (middle + 0.5 + 8 * math.sin(angle), 0.0, middle + 0.5 + 8 * math.cos(angle))
