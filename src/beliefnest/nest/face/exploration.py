"""Exploration of several programs from one tick, each on a branch of its own."""

import os
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass

from beliefnest.belief.view import State
from beliefnest.errors import BranchError, InputError
from beliefnest.nest.acting.engine import Engine
from beliefnest.nest.acting.speculation import Speculation
from beliefnest.nest.face.simulator import Simulator, check_senses
from beliefnest.timeline.journal import ForkPoint, TimelineKey
from beliefnest.timeline.run_records import Senses
from beliefnest.world.paths import BeliefPath
from beliefnest.worlds.protocol import ProgramResult

__all__ = ["Attempt", "Exploration", "ScoreFunction"]

ScoreFunction = Callable[[Simulator, ProgramResult], float]
"""Function that rates an outcome: of the simulator as the program left it, and the result."""

_WORTH_SECONDS = 4.0
"""Least expected duration of the remaining programs, in seconds, to start further processes."""


@dataclass(frozen=True, slots=True)
class Attempt:
    """Program that was tried.

    Attributes:
        program: Text of the program.
        branch: Branch on which it ran. The branch is kept.
        result: Result of the program.
        score: Score from the caller's function.
        state: State of the simulator at the end.
    """

    program: str
    branch: str
    result: ProgramResult
    score: float
    state: State

    def __repr__(self) -> str:
        return f"<attempt on branch {self.branch!r}, score {self.score:g}: {self.result!r}>"


@dataclass(frozen=True, slots=True)
class Exploration:
    """Programs to try from a simulator's present; see `Nest.explore`."""

    engine: Engine
    path: BeliefPath
    agent: str
    programs: Sequence[str]
    score: ScoreFunction
    timeout_ticks: int
    name: str
    processes: int | None
    senses: Senses

    def attempts(self) -> tuple[Attempt, ...]:
        """Try all programs in order; raise as `Nest.explore` does."""
        check_senses(self.senses)
        simulator = Simulator(self.engine, self.path)
        branches = self._branches(simulator)
        if self.processes is not None and self.processes < 1:
            raise InputError(f"processes is {self.processes}; give at least 1")
        before, base = simulator.branch, self._present()
        decided_at = 1 if self.processes is None else 0
        attempts: list[Attempt] = []
        ahead: Mapping[int, Speculation] = {}
        seconds = 0.0
        with ExitStack() as stack:
            stack.callback(simulator.switch, before)
            for number, branch in enumerate(branches):
                if number == decided_at:
                    ahead = self._ahead(stack, base, number, seconds)
                started = time.perf_counter()
                simulator.switch(before)
                # The score function may have let time pass in the world that this one follows.
                speculation = ahead.get(number) if self._present() == base else None
                simulator.switch(branch)
                result = self._run(simulator, number, speculation)
                seconds = time.perf_counter() - started
                score = float(self.score(simulator, result))
                attempts.append(
                    Attempt(self.programs[number], branch, result, score, simulator.state)
                )
        return tuple(attempts)

    def _present(self) -> ForkPoint:
        return self.engine.recording.moment(self.path)

    def _branches(self, simulator: Simulator) -> Sequence[str]:
        branches = [f"{self.name} {number}" for number in range(1, len(self.programs) + 1)]
        taken = {info.key for info in self.engine.recording.journal.timelines()}
        for branch in branches:
            if TimelineKey(self.path, branch) in taken:
                raise BranchError(
                    f"{simulator.path} already has a branch {branch!r}; give explore() another name"
                )
        return branches

    def _run(
        self, simulator: Simulator, number: int, speculation: Speculation | None
    ) -> ProgramResult:
        code = self.programs[number]
        if speculation is None:
            return simulator.run(self.agent, code, self.timeout_ticks, self.senses)
        with self.engine.recording.turn:
            results = self.engine.run_speculated(
                self.path, {self.agent: code}, self.timeout_ticks, speculation
            )
        return results[self.agent]

    def _ahead(
        self, stack: ExitStack, base: ForkPoint, first: int, seconds: float
    ) -> Mapping[int, Speculation]:
        """Run the programs from number `first` on ahead of their turn, if that is worth it.

        Args:
            stack: Stack that keeps the simulator without a body while speculations are used.
            base: Point of the timeline at which all begin.
            first: Number of the first program.
            seconds: Duration of the program that ran before.

        Returns:
            Speculations by number of the program; empty if they are to run one by one.
        """
        left = range(first, len(self.programs))
        processes = self.processes
        if processes is None:
            processes = _processors() if seconds * len(left) > _WORTH_SECONDS else 1
        processes = min(processes, len(left))
        # With percepts a program reads beliefs, which are computed from what is recorded. So it
        # must run when its turn comes.
        if processes < 2 or self.senses == "percepts":
            return {}
        with self.engine.recording.turn:
            stack.enter_context(self.engine.bodies.without(self.path))
            jobs = {number: {self.agent: self.programs[number]} for number in left}
            return self.engine.speculate(self.path, base, jobs, self.timeout_ticks, processes)


def _processors() -> int:
    """Return the number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
