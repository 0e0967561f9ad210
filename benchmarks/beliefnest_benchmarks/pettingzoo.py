"""Benchmark of environments: joint steps, rounds of a task, and copies."""

import random
import time
from collections.abc import Callable, Sequence
from typing import Any

from beliefnest.env import parallel_env, vector_env
from beliefnest_benchmarks.figures import Metric

__all__ = ["measure"]

_STEPS = 600
_FIRST = 20
_FIRST_EPISODES, _EPISODES = 1, 5
_COPIES = 4

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
        Metric("rounds of joint-lift, 2 agents that learn", _rounds(["anne", "bob"]), "1/s"),
        Metric("rounds of joint-lift, Bob plans by himself", _rounds(None), "1/s"),
        Metric("steps of agents in 4 copies, sally-anne", _copied(), "1/s"),
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


def _rounds(agents: Sequence[str] | None) -> float:
    """Return rounds per second in which agents go to levers, with resets."""
    env = parallel_env("joint-lift", agents=agents)
    started, rounds = 0.0, 0
    for seed in range(_FIRST_EPISODES + _EPISODES):
        if seed == _FIRST_EPISODES:
            started, rounds = time.perf_counter(), 0
        env.reset(seed=seed)
        levers = dict(zip(env.agents, env.layout.levers[:2], strict=False))
        while env.agents:
            env.step({a: env.action("turnOnLever", lever=at) for a, at in levers.items()})
            rounds += 1
    seconds = time.perf_counter() - started
    env.close()
    return rounds / seconds


def _copied() -> float:
    """Return steps of single agents per second, in copies, with resets."""
    env = vector_env("sally-anne", _COPIES, step_ticks=1, max_steps=_STEPS)
    env.reset(seed=0)
    env.action_space.seed(0)
    started = 0.0
    for step in range(_FIRST + _STEPS):
        if step == _FIRST:
            started = time.perf_counter()
        env.step(env.action_space.sample())
    seconds = time.perf_counter() - started
    env.close()
    return _STEPS * env.num_envs / seconds
