"""Benchmark of joint steps of three agents, with beliefs of depth 1 as arrays."""

import random
import time
from collections.abc import Callable, Sequence
from typing import Any

from beliefnest.adapters.pettingzoo import parallel_env
from beliefnest_benchmarks.figures import Metric

__all__ = ["measure"]

_STEPS = 600
_FIRST = 20

Act = Callable[[Any, str, bool], Any]
"""Function of the environment, an agent, and True if it is busy; returns the agent's action."""


def measure() -> Sequence[Metric]:
    """Return rates for agents that walk between places, and for random actions at each tick."""
    chance = random.Random(0)

    def walk(env: Any, agent: str, busy: bool) -> Any:
        if busy:
            return env.action("doNothing")
        place = (chance.randint(-9, 9), -51, chance.randint(-9, 9))
        return env.action("goToPosition", position=place)

    def anything(env: Any, agent: str, busy: bool) -> Any:
        return env.action_space(agent).sample()

    return [
        Metric("joint steps, 3 agents that walk", _rate(walk), "1/s", 500.0, at_least=True),
        Metric("joint steps, 3 agents that act at random", _rate(anything), "1/s"),
    ]


def _rate(act: Act) -> float:
    """Return joint steps of one tick per second, after all code is compiled."""
    env = parallel_env("sally-anne", step_ticks=1, max_steps=_FIRST + _STEPS)
    _, infos = env.reset(seed=0)
    for number, agent in enumerate(env.agents):
        env.action_space(agent).seed(number)
    started = 0.0
    for step in range(_FIRST + _STEPS):
        if step == _FIRST:
            started = time.perf_counter()
        actions = {agent: act(env, agent, infos[agent]["busy"]) for agent in env.agents}
        *_, infos = env.step(actions)
    seconds = time.perf_counter() - started
    env.close()
    return _STEPS / seconds
