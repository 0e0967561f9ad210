"""Smoothing: the places of an agent while it was out of sight, given later evidence.

Works on the layers that a `Tracker` keeps (forward filtering, backward smoothing and sampling).
"""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from msgspec.structs import replace

from beliefnest.minds.hypotheses import Action, Hypotheses, Layer, WalkState
from beliefnest.minds.planner import log_sum
from beliefnest.minds.tracking import FilterStep, Tracker
from beliefnest.world.array_types import Floats
from beliefnest.world.values import Position


def smoothed_steps(tracker: Tracker) -> list[FilterStep]:
    """Return the steps of a filter, with their states conditioned on all evidence."""
    by_actual = [_smoothed(tracker, actual, layers) for actual, layers in enumerate(tracker.trail)]
    count = len(tracker.hypotheses.credences)
    steps = []
    for step in tracker.steps:
        masses = []
        for layers, moments in zip(tracker.trail, by_actual, strict=True):
            joint = moments[sum(layer.tick <= step.tick for layer in layers)]
            masses.append(
                {
                    state: log_sum((weight + tracker.log_prior).reshape(-1, count))
                    for state, weight in joint.items()
                }
            )
        steps.append(replace(step, states=tuple(masses)))
    return steps


def sampled_cells(
    tracker: Tracker, actual: int, hypothesis: tuple[int, int, int], random: np.random.Generator
) -> dict[int, Position]:
    """Draw the cell of the agent at each tick of its course, given all evidence.

    Random numbers are used only where several states are possible. A tick at which nothing of the
    course was perceived has one way back, so it changes no draw.

    Args:
        tracker: A filter with layers.
        actual: Number of the actual alternative.
        hypothesis: Numbers of rationality, utility and credence.
        random: Random generator.

    Returns:
        Cell by tick, from the first tick of the course to the last with evidence.
    """
    state = _drawn(
        {each: float(weight[hypothesis]) for each, weight in tracker.states[actual].items()}, random
    )
    cells: dict[int, Position] = {}
    left = tracker.steps[-1].tick
    for layer in reversed(tracker.trail[actual]):
        for tick in range(layer.tick, left + 1):
            cells[tick] = state[0]
        left = min(left, layer.tick - 1)
        parts: dict[WalkState, list[float]] = {}
        for source, action in layer.sources(state):
            chance = _chance(tracker.hypotheses, action)
            inside = 0.0 if chance is None else float(_at(chance, hypothesis))
            parts.setdefault(source, []).append(float(layer.before[source][hypothesis]) + inside)
        state = _drawn({source: _log_sum_of(logs) for source, logs in parts.items()}, random)
    for tick in range(tracker.steps[0].tick, left + 1):
        cells[tick] = state[0]
    return dict(sorted(cells.items()))


def _log_sum_of(logs: Sequence[float]) -> float:
    return logs[0] if len(logs) == 1 else float(log_sum(np.array(logs)))


def _smoothed(
    tracker: Tracker, actual: int, layers: Sequence[Layer]
) -> list[Mapping[WalkState, Floats]]:
    """Return joint weights of states and all evidence, before each layer and after the last."""
    last = tracker.states[actual]
    ahead: dict[WalkState, Floats] = {
        state: np.zeros_like(weight) for state, weight in last.items()
    }
    masses: list[Mapping[WalkState, Floats]] = [last]
    for layer in reversed(layers):
        parts: dict[WalkState, list[Floats]] = {}
        for source, target, action in layer.edges:
            if target in ahead:
                chance = _chance(tracker.hypotheses, action)
                rest = ahead[target]
                parts.setdefault(source, []).append(rest if chance is None else rest + chance)
        ahead = {
            state: each[0] if len(each) == 1 else log_sum(np.stack(each))
            for state, each in parts.items()
        }
        masses.append({state: layer.before[state] + weight for state, weight in ahead.items()})
    return masses[::-1]


def _chance(hypotheses: Hypotheses, action: Action | None) -> Floats | None:
    if action is None:
        return None
    stage, cell, knowledge, numbers = action
    policy = hypotheses.log_policy(stage, cell, knowledge)[list(numbers)]
    return log_sum(policy)


def _at(chance: Floats, hypothesis: tuple[int, int, int]) -> float:
    b, u, w = hypothesis
    # A certain knowledge has one value for all credences.
    return float(chance[b, u, min(w, chance.shape[2] - 1)])


def _drawn(logs: Mapping[WalkState, float], random: np.random.Generator) -> WalkState:
    possible = [state for state, log in logs.items() if log > -math.inf]
    if len(possible) == 1:
        return possible[0]
    states = sorted(possible)
    weights = np.array([logs[state] for state in states])
    shares = np.exp(weights - log_sum(weights))
    return states[int(random.choice(len(states), p=shares / shares.sum()))]
