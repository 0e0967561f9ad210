"""Engine of a nest: it forks and selects timelines, runs programs, lets time pass, and edits.

A simulator is in control mode if and only if a timeline is selected for it. It then has a body in
the world, whose frames are recorded on that timeline (semantics, sections 6 and 7). A call that
raises leaves no trace: everything that it recorded is taken back. If the process behind the world
ends during a call, the call is repeated in a new process. Programs are the exception: they end as
`killed`, and only steps of the script are repeated.
"""

import dataclasses
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import wraps
from typing import Concatenate, ParamSpec, Self, TypeVar

import msgspec
from msgspec.structs import replace

from beliefnest.errors import BodyLostError, BranchError
from beliefnest.importing import part
from beliefnest.nest.acting.bodies import Bodies
from beliefnest.nest.acting.hearsay import ClaimReader
from beliefnest.nest.acting.speculation import Speculation, SpeculationStart, speculate
from beliefnest.nest.acting.visitable import Visitable
from beliefnest.nest.past.body_state import internal_state_at, note_internal_state, present
from beliefnest.nest.past.placing import placed_in
from beliefnest.nest.past.recording import Recording
from beliefnest.timeline.journal import FOLLOW, Edit, ForkPoint, TimelineInfo, TimelineKey
from beliefnest.timeline.run_records import ProgramRecord, Senses
from beliefnest.world.paths import BeliefPath, path_text
from beliefnest.world.values import Block, Items, Position
from beliefnest.worlds.protocol import (
    KILLED,
    Body,
    Fault,
    ProgramPast,
    ProgramResult,
    RunRules,
    World,
)

P = ParamSpec("P")
R = TypeVar("R")


def _surviving(
    method: Callable[Concatenate["Engine", P], R],
) -> Callable[Concatenate["Engine", P], R]:
    """Repeat a method if the process behind the world ends while it runs."""

    @wraps(method)
    def again(self: "Engine", /, *args: P.args, **kwargs: P.kwargs) -> R:
        return self.bodies.lives().call(lambda: method(self, *args, **kwargs))

    return again


def _shown(method: Callable[Concatenate["Engine", P], R]) -> Callable[Concatenate["Engine", P], R]:
    """Show the result of a method to people who visit beliefs."""

    @wraps(method)
    def visible(self: "Engine", /, *args: P.args, **kwargs: P.kwargs) -> R:
        result = method(self, *args, **kwargs)
        if self.visitable is not None:
            self.visitable.keep_up()
        return result

    return visible


class _Request(msgspec.Struct, frozen=True):
    """Request to run programs together. The fields are those of `Engine.run`."""

    programs: Mapping[str, str]
    timeout_ticks: int
    step: int | None
    senses: Senses
    rules: RunRules


class Engine:
    """Engine that acts in the world of one nest and records what happens.

    Attributes:
        recording: The nest's timelines and states.
        world: The world that has the bodies. A body is opened when it is first needed.
        visitable: The beliefs that stand in Minecraft for people to visit; None: nobody can join
            the world.
        bodies: The bodies of simulators in control mode.
    """

    def __init__(
        self, recording: Recording, world: World, reader: ClaimReader | None = None
    ) -> None:
        self.recording = recording
        self.world = world
        joined = world.realtime
        self.visitable: Visitable | None = None
        if joined is not None:
            self.visitable = part("visits")(recording, joined)
        self.bodies = Bodies(recording, world, self.visitable, reader)

    def begin(self) -> Self:
        """Start the real world's timeline and open its body."""
        journal, snapshot = self.recording.journal, self.recording.setting.snapshot
        key = self.recording.selected[()]
        with journal.together():
            journal.create(key, None, snapshot.tick)
            journal.records.select(key.path, key.branch)
        self.bodies.lives().call(lambda: self.bodies.open(key, snapshot))
        return self

    @_shown
    @_surviving
    def fork(self, path: BeliefPath, name: str, tick: int | None) -> None:
        """Begin a branch at the current tick, or at a past one, and select it."""
        recording, journal = self.recording, self.recording.journal
        self.bodies.catch_up(recording.controller(path).path)
        base = recording.moment(path, tick)
        key = TimelineKey(path, name)
        start = self.bodies.start(path, base)
        with self.bodies.selecting(key, start.snapshot), journal.together():
            journal.create(key, base, base.tick)
            if start.frame is not None:
                journal.append(key, [start.frame], base.tick)
            journal.records.select(path, name)

    @_shown
    @_surviving
    def select(self, key: TimelineKey) -> None:
        """Select one of a simulator's timelines, and bring its body to the state at its head."""
        if self.recording.selected.get(key.path) != key:
            self.bodies.catch_up(key.path)
            with self.bodies.selecting(key, self.bodies.recorded(key)):
                self.recording.records.select(key.path, key.branch)

    @_shown
    def follow(self, path: BeliefPath) -> None:
        """Put a simulator into follow mode and close its body."""
        if path == ():
            raise BranchError(
                f"the real world '/' has no parent that it could follow; switch a belief to "
                f"{FOLLOW!r} instead"
            )
        if path in self.recording.selected:
            self.recording.records.select(path, FOLLOW)
            del self.recording.selected[path]
        self.bodies.give_up(path)

    def rename(self, key: TimelineKey, name: str) -> None:
        """Rename a branch. A simulator that is on it stays on it."""
        self.recording.journal.rename(key, name)
        # Cached forests of timelines that were forked from it refer to the old name too.
        self.recording.history.forget_all()
        if self.recording.selected.get(key.path) == key:
            new = self.recording.selected[key.path] = TimelineKey(key.path, name)
            self.bodies.rename(new)

    def delete(self, keys: Sequence[TimelineKey]) -> None:
        """Delete timelines, all of them or none.

        Args:
            keys: The timelines; a fork comes before the timeline that it was forked from.

        Raises:
            BranchError: A simulator is on one of them, or another timeline was forked from it.
        """
        for key in keys:
            if self.recording.selected.get(key.path) == key:
                raise BranchError(
                    f"{path_text(key.path)} is on branch {key.branch!r}, so this branch cannot "
                    "be deleted; switch the simulator to another branch first"
                )
        with self.recording.journal.together():
            for key in keys:
                self.recording.journal.delete(key)
        for key in keys:
            self.recording.history.forget(key)

    @_surviving
    def body(self, path: BeliefPath) -> Body:
        """Return the body of a simulator in control mode; see `Bodies.of`."""
        return self.bodies.of(path)

    @_shown
    def run(
        self,
        path: BeliefPath,
        programs: Mapping[str, str],
        timeout_ticks: int,
        step: int | None = None,
        senses: Senses = "world",
        past: Mapping[str, ProgramPast] | None = None,
        mute: Collection[str] = (),
    ) -> Mapping[str, ProgramResult]:
        """Run programs in a body, record what happens, and note them with their results.

        If the process behind the world ends while they run, their results say so, and nothing that
        they did is kept. A step of the script is then repeated: from the same state and seed it
        does the same again.

        Args:
            path: Path of the simulator.
            programs: Texts of the programs by agent.
            timeout_ticks: Ticks after which programs are stopped.
            step: Number of the step of the script; None: the programs are not from the script.
            senses: `world` or `percepts`: what programs can read.
            past: Pasts of agents whose programs continue interrupted ones. None: no program
                continues another, and results contain no past for later programs.
            mute: Agents that cannot speak.
        """
        rules = replace(self._rules, mute=frozenset(mute))
        if past is not None:
            rules = replace(rules, remembers=True, past=past)
        request = _Request(programs, timeout_ticks, step, senses, rules)
        lives = self.bodies.lives()
        while True:
            results = lives.call(lambda: self._run_once(path, request))
            killed = any(result.killed for result in results.values())
            if not killed or step is None or not lives.spend():
                return results

    def _run_once(self, path: BeliefPath, request: _Request) -> Mapping[str, ProgramResult]:
        self.bodies.of(path)
        self.bodies.catch_up(path)
        programs, rules = request.programs, request.rules
        limited = {}
        if request.senses == "percepts":
            past = rules.past
            limited = {a: self.bodies.sense_of(path, a, past.get(a)) for a in programs}
        before = self.recording.info(path)
        try:
            with self.bodies.acting(path) as body:
                results = body.run(programs, request.timeout_ticks, limited, rules)
                self._note(before, request, results)
            if placed := placed_in(self.recording, path):
                results = {
                    name: dataclasses.replace(each, placed=placed) for name, each in results.items()
                }
        except BodyLostError as lost:
            message = (
                f"nothing that the program did is kept, {path_text(path)} is at tick "
                f"{before.head} as before, and the next call runs in a new process: {lost}"
            )
            fault = Fault(message, KILLED)
            results = {agent: ProgramResult(agent, False, fault, 0) for agent in programs}
            with self.recording.journal.together():
                self._note(before, request, results, kept=False)
        return results

    def speculate(
        self,
        path: BeliefPath,
        base: ForkPoint,
        jobs: Mapping[int, Mapping[str, str]],
        timeout_ticks: int,
        processes: int,
    ) -> Mapping[int, Speculation]:
        """Run jobs ahead of their turn, each in a copy of a simulator's body, without recording.

        All begin at `base`, in up to `processes` processes at the same time. See `speculation`.
        """
        start = SpeculationStart(
            f"{path_text(path)} ahead",
            self.bodies.seed_of(path),
            self.bodies.start(path, base).snapshot,
            self._rules,
        )
        worlds = [self.world, *self.bodies.further_worlds(processes - 1)]
        return speculate(worlds, start, jobs, timeout_ticks)

    def run_speculated(
        self,
        path: BeliefPath,
        programs: Mapping[str, str],
        timeout_ticks: int,
        speculation: Speculation,
    ) -> Mapping[str, ProgramResult]:
        """Record programs that have run already, in a body equal to this simulator's.

        See `speculation`.
        """
        with self.bodies.speculated(path, speculation):
            return self.run(path, programs, timeout_ticks)

    @_shown
    @_surviving
    def step(self, path: BeliefPath, ticks: int) -> None:
        """Let ticks pass in a body."""
        with self.bodies.acting(path) as body:
            body.step(ticks)

    @_shown
    @_surviving
    def edit(
        self,
        path: BeliefPath,
        blocks: Mapping[Position, Block],
        containers: Mapping[Position, Items],
    ) -> None:
        """Record a change by hand, and apply it to the body if there is one."""
        self.bodies.catch_up(path)
        journal, info = self.recording.journal, self.recording.info(path)
        with self.bodies.changing(path):
            # An edit does not change the internal state: copy it to the moment after the edit.
            state = internal_state_at(journal, present(journal, info.key))
            journal.append(info.key, [Edit(info.head, path, blocks, containers)], info.head)
            note_internal_state(journal, present(journal, info.key), state)
            if path in self.bodies and (blocks or containers or self.world.has_physics):
                self.bodies.of(path).set_state(self.bodies.recorded(info.key))

    @property
    def _rules(self) -> RunRules:
        return RunRules(self.recording.setting.perception.speech_ticks)

    def close(self) -> None:
        """Close all bodies, the world and the journal. Do nothing in a forked child."""
        if not self.recording.turn.is_own:
            return
        try:
            self.bodies.close()
        finally:
            self.recording.close()

    def _note(
        self,
        before: TimelineInfo,
        request: _Request,
        results: Mapping[str, ProgramResult],
        *,
        kept: bool = True,
    ) -> None:
        """Note programs that ran together. `before` is their timeline as it was at their begin."""
        records = self.recording.records
        group = records.next_group()
        for agent, result in results.items():
            past = request.rules.past.get(agent)
            records.add_program(
                ProgramRecord(
                    path=before.key.path,
                    branch=before.key.branch,
                    agent=agent,
                    code=request.programs[agent],
                    tick=before.head,
                    ok=result.ok,
                    error=None if result.error is None else str(result.error),
                    ticks=result.ticks,
                    group=group,
                    lines=result.lines,
                    log=result.log,
                    unfinished=tuple(map(str, result.unfinished)),
                    entries=before.entries,
                    timeout_ticks=request.timeout_ticks,
                    step=request.step,
                    kept=kept,
                    senses=request.senses,
                    past=msgspec.UNSET if past is None else msgspec.json.encode(past),
                    mute=agent in request.rules.mute or msgspec.UNSET,
                )
            )
