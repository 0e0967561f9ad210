"""What is told of a run's episode: rounds, who did what, when goals were reached."""

from collections.abc import Iterator, Mapping
from typing import Any

from beliefnest.episodes.record import Branch, Keeps, Start, holds_episode, kept_in
from beliefnest.episodes.rounds import Part, slots_of
from beliefnest.episodes.task import Task

__all__ = ["goal_rows", "round_rows", "told_episode"]


def told_episode(run: Keeps) -> dict[str, Any] | None:
    """The episode in a run as plain values; None: there is none.

    Raises:
        StoreError: It cannot be read.
    """
    if not holds_episode(run):
        return None
    start, branches = kept_in(run)
    task = Task.from_mapping(start.task, start.task_seed)
    return {
        "task": task.name,
        "instance": task.seed,
        "start": start.start,
        "rounds": task.form.rounds,
        "branches": {name: _branch(task, start, branch) for name, branch in branches.items()},
    }


def round_rows(told: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """One row for each agent in each round on each branch.

    Args:
        told: As `told_episode` gives it.
    """
    for name, branch in told["branches"].items():
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
                }


def goal_rows(told: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """One row for each condition of the goal on each branch; arguments as for `round_rows`."""
    for name, branch in told["branches"].items():
        for condition, tick in branch["goal"]:
            yield {"branch": name, "condition": condition, "tick": tick}


def _branch(task: Task, start: Start, branch: Branch) -> dict[str, Any]:
    slots = len(slots_of(task.agents, turns=task.form.play == "turns"))
    ticks = task.form.round_ticks
    return {
        "policies": branch.policies,
        "goal": [list(each) for each in branch.goal],
        "reached": branch.reached,
        "violated": branch.violated,
        "parts": [
            {
                "round": number // slots,
                "t": start.start + number * ticks,
                "end": start.start + (number + 1) * ticks,
                "agents": [_done(part, agent) for agent in part.decisions],
            }
            for number, part in enumerate(branch.parts)
        ],
    }


def _done(part: Part, agent: str) -> dict[str, Any]:
    decision, ended = part.decisions[agent], part.ended.get(agent)
    return {
        "agent": agent,
        "program": decision.program,
        "goes_on": decision.goes_on,
        "fault": decision.fault,
        "ended": "" if ended is None else ended.how,
        "message": "" if ended is None else ended.message,
    }
