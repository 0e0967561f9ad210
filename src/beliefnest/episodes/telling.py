"""Summary of a run's episode as plain values: rounds, programs, and goals."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

import msgspec

from beliefnest.episodes.considered import told_trace
from beliefnest.episodes.decided import RoundPart
from beliefnest.episodes.record import Branch, EpisodeStart, Keeps, holds_episode, kept_in
from beliefnest.episodes.task_form import TaskForm
from beliefnest.errors import BeliefNestError, StoreError
from beliefnest.scenarios.goals import Goal
from beliefnest.scenarios.rules import goal_of


def told_episode(run: Keeps) -> dict[str, Any] | None:
    """Return the episode in a run as plain values; None: there is none.

    Raises:
        StoreError: The episode cannot be read.
    """
    if not holds_episode(run):
        return None
    start, branches = kept_in(run)
    try:
        form = msgspec.convert(start.task, TaskForm)
        goal = goal_of(form.goal, form.scenario["agents"])
    except (msgspec.ValidationError, BeliefNestError) as fault:
        raise StoreError(f"the task of the episode in this run cannot be read: {fault}") from None
    return {
        "task": form.name,
        "instance": start.task_seed,
        "start": start.start,
        "rounds": form.rounds,
        "branches": {name: _branch(form, goal, start, branch) for name, branch in branches.items()},
    }


def round_rows(episode: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield a row for each agent in each round on each branch.

    Args:
        episode: Episode, as `told_episode` returns it.
    """
    for name, branch in episode["branches"].items():
        for part in branch["parts"]:
            for done in part["agents"]:
                yield {
                    "branch": name,
                    "round": part["round"],
                    "tick": part["t"],
                    "end": part["end"],
                    "agent": done["agent"],
                    "policy": branch["policies"][done["agent"]],
                    "program": done["program"],
                    "goes_on": done["goes_on"],
                    "fault": done["fault"],
                    "ended": done["ended"],
                    "message": done["message"],
                    "reason": done["reason"],
                }


def goal_rows(episode: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield a row for each condition of the goal on each branch; argument as in `round_rows`."""
    for name, branch in episode["branches"].items():
        for condition, never, tick in branch["goal"]:
            yield {"branch": name, "condition": condition, "never": never, "tick": tick}


def _branch(form: TaskForm, goal: Goal, start: EpisodeStart, branch: Branch) -> dict[str, Any]:
    parts_of_round = len(branch.policies) if form.play == "turns" else 1
    return {
        "policies": branch.policies,
        "goal": [
            [text, number >= len(goal.reach), tick]
            for number, (text, tick) in enumerate(branch.goal)
        ],
        "reached": branch.reached,
        "violated": branch.violated,
        "parts": [
            {
                "round": number // parts_of_round,
                "t": began,
                "end": end,
                "agents": [_done(part, agent) for agent in part.decisions],
            }
            for number, (part, (began, end)) in enumerate(
                zip(branch.parts, _spans(branch.parts, start.start, form.round_ticks), strict=True)
            )
        ],
    }


def _spans(parts: Sequence[RoundPart], start: int, ticks: int) -> list[tuple[int, int]]:
    """Return the first and last tick of each part; with people, parts last until the next one."""
    began = [
        start + number * ticks if part.began is None else part.began
        for number, part in enumerate(parts)
    ]
    return [*pairwise(began), *((last, last + ticks) for last in began[-1:])]


def _done(part: RoundPart, agent: str) -> dict[str, Any]:
    decision, ended = part.decisions[agent], part.ended.get(agent)
    return {
        "agent": agent,
        "program": decision.program,
        "goes_on": decision.goes_on,
        "fault": decision.fault,
        "outcome": decision.outcome,
        "ended": "" if ended is None else ended.how,
        "message": "" if ended is None else ended.message,
        "reason": part.reason(agent),
        "considered": None if decision.considered is None else told_trace(decision.considered),
    }
