"""Trying several programs, each on a branch of its own, from one tick."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from beliefnest.belief.view import State
from beliefnest.bodies.protocol import ProgramResult
from beliefnest.errors import BranchError
from beliefnest.nest.engine import Engine
from beliefnest.nest.simulator import Simulator
from beliefnest.timeline.journal import TimelineKey

__all__ = ["Attempt", "Score", "explore"]

Score = Callable[[Simulator, ProgramResult], float]
"""Says how good it is what a program led to; takes the simulator as the program left it."""


@dataclass(frozen=True, slots=True)
class Attempt:
    """A program that was tried.

    Attributes:
        program: Its text.
        branch: The branch it ran on, which stays.
        result: How it ended.
        score: What the caller's function gave it.
        state: What the simulator held in the end.
    """

    program: str
    branch: str
    result: ProgramResult
    score: float
    state: State


def explore(
    engine: Engine,
    path: tuple[str, ...],
    agent: str,
    programs: Sequence[str],
    score: Score,
    timeout_ticks: int,
    name: str,
) -> tuple[Attempt, ...]:
    """Run each program from the simulator's present; the simulator ends where it began."""
    simulator = Simulator(engine, path)
    branches = [f"{name} {number}" for number in range(1, len(programs) + 1)]
    taken = {info.key for info in engine.journal.timelines()}
    for branch in branches:
        if TimelineKey(path, branch) in taken:
            raise BranchError(
                f"{simulator.path} already has a branch {branch!r}; explore under another name"
            )
    before = simulator.branch
    attempts = []
    try:
        for program, branch in zip(programs, branches, strict=True):
            simulator.switch(before)
            simulator.switch(branch)
            result = simulator.run(agent, program, timeout_ticks)
            attempts.append(
                Attempt(program, branch, result, float(score(simulator, result)), simulator.state)
            )
    finally:
        simulator.switch(before)
    return tuple(attempts)
