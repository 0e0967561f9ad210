"""Transitions of the filter: weights of an agent's states after an action, a percept or a claim.

Each function adds to `Sums` what becomes of weights by state, for one actual alternative.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from beliefnest.minds.evidence import EvidenceMoment
from beliefnest.minds.hypotheses import Hypotheses, Sums, WalkState, conditioned, told
from beliefnest.minds.planner import Knowledge
from beliefnest.minds.stage import Stage
from beliefnest.minds.surroundings import Surroundings
from beliefnest.perception.percept import gaze_from
from beliefnest.world.array_types import Floats
from beliefnest.world.values import Position, feet_in

Weights = Mapping[WalkState, Floats]


def stage_of(scene: Surroundings, *cells: Position) -> Stage:
    """Return the stage of some cells, of those that lie inside the box."""
    return scene.stage(*(cell for cell in cells if cell in scene.worlds.box))


def by_stage(scene: Surroundings, weights: Weights) -> list[tuple[Stage, dict[WalkState, Floats]]]:
    """Return the parts of weights whose cells are on one stage."""
    parts: dict[int, tuple[Stage, dict[WalkState, Floats]]] = {}
    for state, weight in weights.items():
        stage = stage_of(scene, state[0])
        parts.setdefault(id(stage), (stage, {}))[1][state] = weight
    return list(parts.values())


def arrive(
    hypotheses: Hypotheses, stage: Stage, actual: int, weights: Weights, cell: Position, sums: Sums
) -> None:
    """Add one action without an event; then the agent is seen in a cell."""
    for state, weight in weights.items():
        place, possible, believed, has_ended = state
        if has_ended or place not in stage.index:
            if place == cell:
                sums.add(state, weight, state)
            continue
        goal = stage.index.get(cell, -1)
        moves = stage.moves[actual, stage.index[place]].tolist()
        leading = [step + 1 for step, to in enumerate(moves) if to == goal]
        if place == cell:
            leading.insert(0, 0)
        if not leading:
            continue
        knowledge = (possible, believed)
        policy = hypotheses.log_policy(stage, place, knowledge)
        by = (stage, place, knowledge, tuple(leading))
        sums.add((cell, *knowledge, False), weight, state, policy, by)
        acts = _unmarked(stage, policy) if place == cell else ()
        if acts:
            by = (stage, place, knowledge, tuple(acts))
            sums.add((cell, *knowledge, True), weight, state, policy, by)


def _unmarked(stage: Stage, policy: Floats) -> list[int]:
    """Return the available acts on goals that leave no event."""
    return [
        action
        for goal, action in enumerate(goal_acts(stage))
        if not stage.marked[goal] and np.isfinite(policy[action]).any()
    ]


def goal_acts(stage: Stage) -> tuple[int, ...]:
    """Return the numbers of the acts on goals."""
    first = 1 + stage.moves.shape[2] + len(stage.boxes)
    return tuple(range(first, first + stage.acts.shape[1]))


def act(
    hypotheses: Hypotheses,
    stage: Stage,
    weights: Weights,
    actions: tuple[int, ...],
    sums: Sums,
    *,
    ends: bool,
) -> None:
    """Add one of some actions that do not move the agent, where one of them is available."""
    for state, weight in weights.items():
        place, possible, believed, has_ended = state
        if has_ended or place not in stage.index:
            continue
        knowledge = (possible, believed)
        policy = hypotheses.log_policy(stage, place, knowledge)
        if np.isfinite(policy[list(actions)]).any():
            by = (stage, place, knowledge, actions)
            sums.add((place, *knowledge, ends), weight, state, policy, by)


def spread(hypotheses: Hypotheses, stage: Stage, actual: int, weights: Weights, sums: Sums) -> None:
    """Add one action of an agent out of sight."""
    steps = stage.moves.shape[2]
    for state, weight in weights.items():
        place, possible, believed, has_ended = state
        if has_ended or place not in stage.index:
            sums.add(state, weight, state)
            continue
        number = stage.index[place]
        knowledge = (possible, believed)
        policy = hypotheses.log_policy(stage, place, knowledge)
        leading: dict[int, list[int]] = {number: [0]}
        for step, to in enumerate(stage.moves[actual, number].tolist()):
            leading.setdefault(to, []).append(step + 1)
        for to, actions in leading.items():
            by = (stage, place, knowledge, tuple(actions))
            sums.add((stage.cells[to], *knowledge, False), weight, state, policy, by)
        there = np.isfinite(policy[1 + steps :]).any(axis=(1, 2, 3))
        for action in (np.flatnonzero(there) + 1 + steps).tolist():
            by = (stage, place, knowledge, (action,))
            box = action - 1 - steps
            is_opening = box < len(stage.boxes)
            after = knowledge
            if is_opening:
                after = conditioned(knowledge, int(stage.content[box, actual]))
            sums.add((place, *after, not is_opening), weight, state, policy, by)


def look_round(stage: Stage, actual: int, weights: Weights, sums: Sums) -> None:
    """Add the percepts that the agent has from the middle of its cell."""
    for state, weight in weights.items():
        place, possible, believed, has_ended = state
        if has_ended or place not in stage.index:
            sums.add(state, weight, state)
            continue
        same = int(stage.same[actual, stage.index[place]])
        sums.add((place, *conditioned((possible, believed), same), False), weight, state)


def learn(
    weights: Weights, rule: Callable[[Knowledge, int], Knowledge], masks: Sequence[int], sums: Sums
) -> None:
    """Add what the agent learns, by the rule of percepts or of claims, each with its set."""
    for state, weight in weights.items():
        place, possible, believed, has_ended = state
        knowledge = (possible, believed)
        for mask in () if has_ended else masks:
            knowledge = rule(knowledge, mask)
        sums.add((place, *knowledge, has_ended), weight, state)


def unseen(moment: EvidenceMoment, actual: int, weights: Weights) -> Weights:
    """Return the states in which the observer, if it is present, does not see the agent."""
    if moment.watch is None or not weights:
        return weights
    cells = sorted({state[0] for state in weights})
    geometry = moment.scene.worlds.geometry(actual)
    seen = geometry.sees_agents(*gaze_from(*moment.watch), [feet_in(cell) for cell in cells])
    visible = {cell for cell, is_seen in zip(cells, seen.tolist(), strict=True) if is_seen}
    return {state: weight for state, weight in weights.items() if state[0] not in visible}


def known_after(moments: Sequence[EvidenceMoment], alternatives: int) -> list[Knowledge]:
    """Return an agent's knowledge by actual alternative, from its percepts at some moments.

    While the agent is out of the observer's sight, it is credited with no percepts (semantics,
    section 5).
    """
    everyone = (1 << alternatives) - 1
    knowledges = []
    for actual in range(alternatives):
        knowledge = (everyone, everyone)
        for moment in moments:
            for learnt in moment.learnt:
                knowledge = conditioned(knowledge, learnt[actual])
            if moment.alike:
                knowledge = conditioned(knowledge, moment.alike[actual])
            for mask in moment.claims:
                knowledge = told(knowledge, mask)
        knowledges.append(knowledge)
    return knowledges
