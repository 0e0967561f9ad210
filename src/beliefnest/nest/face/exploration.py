"""Exploration: several programs tried from one tick, each on a branch of its own."""

import os
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass

from beliefnest.belief.view import State
from beliefnest.bodies.protocol import ProgramResult
from beliefnest.errors import BranchError, InputError
from beliefnest.nest.acting.engine import Engine
from beliefnest.nest.acting.speculation import Speculation
from beliefnest.nest.face.simulator import Simulator, check_senses
from beliefnest.timeline.journal import ForkPoint, TimelineKey
from beliefnest.timeline.records import Senses
from beliefnest.world.paths import BeliefPath

__all__ = ["Attempt", "Exploration", "ScoreFunction"]

ScoreFunction = Callable[[Simulator, ProgramResult], float]
"""Says how good it is what a program led to; takes the simulator as the program left it."""

_WORTH_SECONDS = 4.0
"""What is to be done yet must take at least that long for other processes to be started."""


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

    def __repr__(self) -> str:
        return f"<attempt on branch {self.branch!r}, score {self.score:g}: {self.result!r}>"


@dataclass(frozen=True, slots=True)
class Exploration:
    """What is to be tried: each program from the simulator's present; see `Nest.explore`."""

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
        """Try all programs, in order; errors as those of `Nest.explore`."""
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
                # A score may have let the world go on that this simulator follows.
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
                    f"{simulator.path} already has a branch {branch!r}; explore under another name"
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
        """Speculations of the programs from one on, if it is to be done at the same time.

        Args:
            stack: Keeps the simulator without a body as long as speculations are used.
            base: Where they begin.
            first: Number of the first of them.
            seconds: What one took that ran before.
        """
        left = range(first, len(self.programs))
        processes = self.processes
        if processes is None:
            processes = _processors() if seconds * len(left) > _WORTH_SECONDS else 1
        processes = min(processes, len(left))
        # What an agent perceives is worked out as it is recorded, one program after the other.
        if processes < 2 or self.senses == "percepts":
            return {}
        with self.engine.recording.turn:
            stack.enter_context(self.engine.bodies.without(self.path))
            jobs = {number: {self.agent: self.programs[number]} for number in left}
            return self.engine.speculate(self.path, base, jobs, self.timeout_ticks, processes)


def _processors() -> int:
    """How many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
