"""Runner of agents' programs in a scripted world, together, tick by tick.

A program's code before its first wait belongs to the first tick. A skill that is called in one tick
acts in the next ones. Agents act in the order of their programs.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from beliefnest.errors import BeliefNestError
from beliefnest.skills.calls import callables
from beliefnest.world.frames import Frame
from beliefnest.world.values import AgentState, Box, Event, EventKind, Point
from beliefnest.worlds.protocol import (
    Aim,
    Fault,
    ProgramResult,
    RunRules,
    Sense,
    Sensed,
    Unfinished,
)
from beliefnest.worlds.scripted.engines import Engines
from beliefnest.worlds.scripted.footpaths import Ground
from beliefnest.worlds.scripted.ground_cache import Grounds
from beliefnest.worlds.scripted.hand import Doing, Hand, SkillError
from beliefnest.worlds.scripted.javascript_program import JavaScriptProgram
from beliefnest.worlds.scripted.program_memory import Memory
from beliefnest.worlds.scripted.skills import CALLS, SKILLS, UTTERANCES
from beliefnest.worlds.scripted.world import ScriptedWorld

__all__ = ["RunningPrograms", "run_programs"]

_MOST_AIMS = 100
_EPOCH_MS = 1_704_067_200_000
"""Start of the worlds' time, as in Minecraft's: 2024-01-01, in UTC."""
_TICK_MS = 50
_DOINGS = {**SKILLS, **CALLS}
_ENDS_WITH_PROGRAM = SKILLS.keys() - UTTERANCES


@dataclass
class _Run:
    """Running program."""

    hand: Hand
    program: JavaScriptProgram
    sense: Sense
    doing: dict[int, tuple[str, Doing]] = field(default_factory=dict)
    memory: Memory = field(default_factory=Memory)
    read: Sensed | None = None
    missed: tuple[tuple[str, str, str | None], ...] = ()
    aims: list[Aim] = field(default_factory=list)
    end_tick: int | None = None
    end: Fault | None = None


def run_programs(
    world: ScriptedWorld,
    programs: Mapping[str, str],
    timeout_ticks: int,
    senses: Mapping[str, Sense],
    rules: RunRules,
    seed: str,
    grounds: Grounds,
    engines: Engines,
) -> Mapping[str, ProgramResult]:
    """Run programs by agent until the last has ended.

    Args:
        world: World in which they act.
        programs: JavaScript by agent.
        timeout_ticks: Number of ticks after which they are ended.
        senses: Knowledge, by agent, for programs that may read nothing else; others read the true
            state.
        rules: Rules of the run.
        seed: Seed of random numbers.
        grounds: Cache of the data of grids.
        engines: Pool of engines to share.
    """
    under_way = RunningPrograms(world, programs, senses, rules, seed, grounds, engines)
    last = world.now + timeout_ticks
    try:
        while True:
            with world.tick():
                under_way.act()
            under_way.settle()
            if under_way.are_over:
                break
            if world.now >= last:
                under_way.time_out(timeout_ticks)
                break
    finally:
        under_way.leave()
    return under_way.results()


class RunningPrograms:
    """Programs under way together, advanced tick by tick by whoever makes the ticks.

    For each tick: `act` inside the tick, then `settle`. Arguments as for `run_programs`.
    """

    def __init__(
        self,
        world: ScriptedWorld,
        programs: Mapping[str, str],
        senses: Mapping[str, Sense],
        rules: RunRules,
        seed: str,
        grounds: Grounds,
        engines: Engines,
    ) -> None:
        self._world, self._rules, self._grounds = world, rules, grounds
        self._first = world.now
        self._happened: list[tuple[int, Event]] = []
        self._latest: list[Event] = []
        self._done: list[tuple[_Run, list[tuple[int, bool, object]]]] = []
        world.listen(self._hear)
        try:
            begun = {
                agent: JavaScriptProgram(
                    agent,
                    SKILLS,
                    code,
                    f"{seed} {_begin_of(rules, agent, world.now)} {agent}",
                    engines,
                )
                for agent, code in programs.items()
            }
            self._runs = [
                _begun(world, agent, program, senses, rules, grounds, self._latest)
                for agent, program in begun.items()
            ]
        except BaseException:
            self.leave()
            raise

    @property
    def are_over(self) -> bool:
        """True if all of them have ended."""
        return all(run.end_tick is not None for run in self._runs)

    @property
    def draws(self) -> int:
        """Number of random numbers that they have drawn."""
        return sum(run.program.draws for run in self._runs)

    def reseed(self, seed: str) -> None:
        """Let a seed decide about the random numbers of all of them from now on."""
        for run in self._runs:
            run.program.reseed(f"{seed} {run.hand.name}")

    def act(self) -> None:
        """Let all agents act in the tick that is being made."""
        self._done = [(run, _act(run)) for run in self._runs]

    def settle(self) -> None:
        """Tell the programs the effects of the tick, after it has ended."""
        for run in self._runs:
            _hear(run, self._grounds)
        for run, answers in self._done:
            for number, ok, value in answers:
                _settle(run, self._grounds, number, ok=ok, value=value)
        for run in self._runs:
            if run.end_tick is None and run.program.ended and not _goes_on(run):
                run.end_tick = self._world.now

    def time_out(self, timeout_ticks: int) -> None:
        """End those that go on, because their ticks are over."""
        _time_out(self._runs, self._world.now, timeout_ticks)

    def leave(self) -> None:
        """Listen to the world no longer."""
        self._world.unlisten(self._hear)

    def results(self) -> Mapping[str, ProgramResult]:
        """Give the engines back, and return what became of the programs."""
        for run in self._runs:
            run.program.end()
        happened, remembers = tuple(self._happened), self._rules.remembers
        return {
            run.hand.name: _result(run, self._first, happened, remembers=remembers)
            for run in self._runs
        }

    def _hear(self, frame: Frame) -> None:
        self._happened.extend((frame.tick, event) for event in frame.events)
        self._latest[:] = frame.events


def _begin_of(rules: RunRules, agent: str, now: int) -> int:
    """Return the tick at which a program first began."""
    past = rules.past.get(agent)
    return now if past is None else past.tick


def _begun(
    world: ScriptedWorld,
    agent: str,
    program: JavaScriptProgram,
    senses: Mapping[str, Sense],
    rules: RunRules,
    grounds: Grounds,
    latest: Sequence[Event],
) -> _Run:
    def all_of_it() -> Sensed:
        others, heard = _others(world.agents, agent), _heard_by(agent, latest)
        return Sensed(world.terrain, others, heard=heard, signs=world.signs)

    def ground() -> Ground:
        return grounds.of(world.box, world.terrain).ground

    sense = senses.get(agent, all_of_it)
    hand = Hand(
        agent,
        world,
        # For full knowledge use the true ground, which needs no map of all agents at each step.
        known=_known(world.box, sense, grounds) if agent in senses else ground,
        others=lambda: sense().agents,
        signs=lambda: sense().signs,
        ground=ground,
        speech_ticks=rules.speech_ticks,
    )
    past = rules.past.get(agent)
    missed = () if past is None else sense().heard
    run = _Run(
        hand, program, sense, missed=missed, memory=Memory(() if past is None else past.calls)
    )
    _show(run, grounds)
    program.start()
    _take_calls(run)
    return run


def _known(box: Box, sense: Sense, grounds: Grounds) -> Callable[[], Ground]:
    return lambda: grounds.of(box, sense().blocks).ground


def _heard_by(agent: str, events: Sequence[Event]) -> tuple[tuple[str, str, str | None], ...]:
    """Return the speech of a tick that an agent heard: all of it but whispers to others."""
    said = (event for event in events if event.kind is EventKind.CHAT)
    words = [(e.actor or "", str(e.detail["text"]), e.detail.get("to")) for e in said]
    return tuple(each for each in words if each[2] is None or agent in (each[0], each[2]))


def _listens(run: _Run) -> bool:
    """Return True if a program listens for speech, or its agent waits for it."""
    return run.program.listens or any(name == "waitForChat" for name, _ in run.doing.values())


def _hear(run: _Run, grounds: Grounds) -> None:
    """Report the speech of the tick that has ended to an agent and its program."""
    run.hand.heard.clear()
    if not _listens(run) or run.end_tick is not None:
        return
    sensed = run.sense()
    heard = run.missed if sensed is run.read else (*run.missed, *sensed.heard)
    run.read, run.missed = sensed, ()
    if not heard:
        return
    run.hand.heard.extend(heard)
    if run.program.listens and not run.program.ended:
        _show(run, grounds)
        run.program.hear(heard)
        _take_calls(run)


def _act(run: _Run) -> list[tuple[int, bool, object]]:
    """Advance an agent's acts by a tick; return the calls that ended, with their outcome."""
    ended: list[tuple[int, bool, object]] = []
    for number, (name, doing) in run.doing.items():
        # Utterances without `await` are made even if the program has ended by then.
        if run.program.ended and name in _ENDS_WITH_PROGRAM:
            continue
        try:
            next(doing)
        except StopIteration as end:
            ended.append((number, True, end.value))
        except BeliefNestError as error:
            ended.append((number, False, _told(error)))
    return ended


def _goes_on(run: _Run) -> bool:
    """Return True if an act is in progress that continues without its program."""
    return any(name not in _ENDS_WITH_PROGRAM for name, _ in run.doing.values())


def _settle(run: _Run, grounds: Grounds, number: int, *, ok: bool, value: object) -> None:
    del run.doing[number]
    _show(run, grounds)
    _answer(run, number, ok=ok, value=value)
    _take_calls(run)


def _answer(run: _Run, number: int, *, ok: bool, value: object) -> None:
    run.memory.answered(number, ok=ok, value=value)
    run.program.settle(number, ok=ok, value=value)


def _take_calls(run: _Run) -> None:
    """Begin the calls of a program; a call that cannot begin fails at once."""
    calls = run.program.calls()
    while calls:
        for number, name, args in calls:
            known = run.memory.called(number, name, args, run.hand.world.now)
            if known is not None:
                run.program.settle(number, ok=known[0], value=known[1])
                continue
            _note_aim(run, name, args)
            try:
                doing = _DOINGS[name](run.hand, *run.memory.left(number, args))
                next(doing)
                run.doing[number] = (name, doing)
            except StopIteration as ended:
                _answer(run, number, ok=True, value=ended.value)
            except (BeliefNestError, TypeError) as error:
                _answer(run, number, ok=False, value=_told(error))
        calls = run.program.calls()
    if _listens(run) and run.read is None:
        # A new listener gets no earlier speech.
        run.read = run.sense()


def _told(error: Exception) -> dict[str, object]:
    reason = error.reason if isinstance(error, SkillError) else None
    message = str(error)
    if isinstance(error, TypeError):
        message = "it is called with too few or too many arguments"
    return {"message": message, "reason": reason}


def _show(run: _Run, grounds: Grounds) -> None:
    if not run.program.reads:
        return
    sensed = run.sense()
    me = run.hand.world.agents[run.hand.name]
    there = {**sensed.agents, run.hand.name: me}
    told = {
        "agents": {name: _pose(agent) for name, agent in there.items()},
        "players": {name: name in there for name in sorted(run.hand.world.agents)},
        "inventory": dict(me.inventory),
        "health": me.health,
        "food": me.food,
        "ms": _EPOCH_MS + run.hand.world.now * _TICK_MS,
        "signs": {",".join(map(str, place)): text for place, text in sensed.signs.items()},
    }
    run.program.see(told, grounds.of(run.hand.world.box, sensed.blocks).text)


def _others(agents: Mapping[str, AgentState], me: str) -> Mapping[str, AgentState]:
    return {name: agent for name, agent in agents.items() if name != me}


def _pose(agent: AgentState) -> dict[str, object]:
    return {"position": agent.position, "yaw": agent.yaw, "pitch": agent.pitch}


def _note_aim(run: _Run, name: str, args: list[Any]) -> None:
    """Note the target of a call, as the manifest of the skill declares it."""
    known = callables().get(name)
    if known is None or len(run.aims) >= _MOST_AIMS:
        return
    for parameter, value in zip(known.arguments, args, strict=False):
        if not parameter.aim:
            continue
        is_agent = parameter.type == "string"
        place = None if is_agent else _point(value)
        agent = value if is_agent and isinstance(value, str) else None
        if place is not None or agent is not None:
            uses = parameter.aim == "uses"
            run.aims.append(Aim(run.hand.world.now, name, place, agent, uses))


def _point(value: Any) -> Point | None:
    if not isinstance(value, list) or len(value) != 3:
        return None
    if not all(isinstance(part, int | float) and math.isfinite(part) for part in value):
        return None
    return (float(value[0]), float(value[1]), float(value[2]))


def _time_out(runs: Sequence[_Run], tick: int, timeout_ticks: int) -> None:
    for run in runs:
        if run.end_tick is None:
            run.end_tick = tick
            run.end = Fault(f"the program did not end within {timeout_ticks} ticks", "timeout")


def _result(
    run: _Run, first: int, happened: tuple[tuple[int, Event], ...], *, remembers: bool
) -> ProgramResult:
    fault = run.end or run.program.fault
    return ProgramResult(
        agent=run.hand.name,
        ok=fault is None,
        error=fault,
        ticks=(run.end_tick or first) - first,
        happened=happened,
        log=run.program.log,
        unfinished=tuple(Unfinished(name) for name, _ in run.doing.values()),
        aims=tuple(run.aims),
        calls=run.memory.calls(run.end_tick or first) if remembers else (),
    )
