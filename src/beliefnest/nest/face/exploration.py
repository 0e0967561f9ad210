"""Exploration of several programs from one tick, each on a branch of its own."""

import os
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from typing import SupportsFloat

import msgspec

from beliefnest.belief.view import State
from beliefnest.errors import BranchError, InputError
from beliefnest.nest.acting.engine import Engine
from beliefnest.nest.acting.speculation import Speculation
from beliefnest.nest.face.given import check_branch_name
from beliefnest.nest.face.simulator import Simulator, check_senses
from beliefnest.timeline.journal import ForkPoint, TimelineKey
from beliefnest.timeline.run_records import Senses
from beliefnest.world.paths import BeliefPath
from beliefnest.worlds.protocol import ProgramResult

ScoreFunction = Callable[[Simulator, ProgramResult], float | Mapping[str, float]]
"""Function that rates an outcome, of the simulator as the program left it and the result, by one
number or by several with names."""

_WORTH_SECONDS = 4.0
"""Least expected duration of the remaining programs, in seconds, to start further processes."""


@dataclass(frozen=True, slots=True)
class Attempt:
    """Program that was tried.

    Attributes:
        name: Name of the program in a mapping; else its number, from 1.
        program: Text of the program.
        branch: Branch on which it ran. The branch is kept.
        result: Result of the program.
        score: Score from the caller's function: a number, or numbers by name.
        state: State of the simulator at the end.
    """

    name: str
    program: str
    branch: str
    result: ProgramResult
    score: float | Mapping[str, float]
    state: State

    def __repr__(self) -> str:
        scores = {"score": self.score} if isinstance(self.score, float) else self.score
        score_words = ", ".join(f"{name} {value:g}" for name, value in scores.items())
        return f"<attempt on branch {self.branch!r}, {score_words}: {self.result!r}>"


class Exploration(msgspec.Struct, frozen=True):
    """Programs to try from a simulator's present, by name; see `Nest.explore`."""

    engine: Engine
    path: BeliefPath
    agent: str
    programs: Mapping[str, str]
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
        texts = tuple(self.programs.values())
        if self.processes is not None and self.processes < 1:
            raise InputError(f"processes is {self.processes}; give at least 1")
        before, base = simulator.branch, self._present()
        decided_at = 1 if self.processes is None else 0
        attempts: list[Attempt] = []
        ahead: Mapping[int, Speculation] = {}
        seconds = 0.0
        with ExitStack() as stack:
            begun: list[str] = []
            stack.push(self._without_branches(simulator, begun))
            stack.callback(simulator.switch, before)
            for number, (name, branch) in enumerate(branches.items()):
                if number == decided_at:
                    ahead = self._ahead(stack, base, number, seconds)
                started = time.perf_counter()
                simulator.switch(before)
                # The score function may have let time pass in the world that this one follows.
                speculation = ahead.get(number) if self._present() == base else None
                simulator.switch(branch)
                begun.append(branch)
                result = self._run(simulator, texts[number], speculation)
                seconds = time.perf_counter() - started
                score = _checked(self.score(simulator, result), name)
                attempts.append(
                    Attempt(name, texts[number], branch, result, score, simulator.state)
                )
        return tuple(attempts)

    def _present(self) -> ForkPoint:
        return self.engine.recording.moment(self.path)

    def _without_branches(
        self, simulator: Simulator, begun: Sequence[str]
    ) -> Callable[[type[BaseException] | None, object, object], None]:
        """Return a function that deletes the branches if the exploration fails.

        Another exploration can then use the same name.
        """

        def leave(kind: type[BaseException] | None, error: object, trace: object) -> None:
            if kind is not None:
                for branch in begun:
                    simulator.delete(branch, recursive=True)

        return leave

    def _branches(self, simulator: Simulator) -> Mapping[str, str]:
        """Return the branches by name of their program."""
        branches = {name: f"{self.name} {name}" for name in self.programs}
        taken = {info.key for info in self.engine.recording.journal.timelines()}
        for branch in branches.values():
            check_branch_name(branch)
            if TimelineKey(self.path, branch) in taken:
                raise BranchError(
                    f"{simulator.path} already has a branch {branch!r}; give explore() another name"
                )
        return branches

    def _run(
        self, simulator: Simulator, code: str, speculation: Speculation | None
    ) -> ProgramResult:
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
            texts = tuple(self.programs.values())
            jobs = {number: {self.agent: texts[number]} for number in left}
            return self.engine.speculate(self.path, base, jobs, self.timeout_ticks, processes)


def programs_by_name(programs: Mapping[str, str] | Sequence[str]) -> dict[str, str]:
    """Return programs by name; those of a list are numbered from 1.

    Raises:
        InputError: They are neither a mapping from names to texts nor a list of texts.
    """
    if isinstance(programs, Mapping):
        named = dict(programs)
    elif isinstance(programs, Sequence) and not isinstance(programs, str):
        named = {str(number): program for number, program in enumerate(programs, start=1)}
    else:
        raise InputError(
            f"programs is {type(programs).__name__}; give a list of programs, or a mapping from "
            "names to programs"
        )
    for name, program in named.items():
        if not isinstance(name, str) or not isinstance(program, str):
            raise InputError(
                f"the program {name!r} is {type(program).__name__}; give names and texts"
            )
    return named


def _checked(score: object, name: str) -> float | Mapping[str, float]:
    """Return a score as numbers; raise InputError if it is none."""
    if isinstance(score, Mapping):
        return {str(key): _number(value, name) for key, value in score.items()}
    return _number(score, name)


def _number(score: object, name: str) -> float:
    if isinstance(score, SupportsFloat):
        return float(score)
    raise InputError(
        f"the score function gave {score!r} for the program {name!r}; return a number, or a "
        "mapping from names to numbers"
    )


def _processors() -> int:
    """Return the number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
