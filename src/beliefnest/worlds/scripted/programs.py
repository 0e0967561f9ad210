"""Runner of agents' programs in a scripted world, together, tick by tick.

A program's code before its first wait belongs to the first tick. A skill that is called in one tick
acts in the next ones. Agents act in the order of their programs.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from beliefnest.errors import BeliefNestError
from beliefnest.world.event_words import Announcement, announced
from beliefnest.world.frames import Frame
from beliefnest.world.values import Event
from beliefnest.worlds.protocol import Aim, Fault, ProgramResult, RunRules, Sensed, SenseSource
from beliefnest.worlds.scripted.bot_reads import BotReads
from beliefnest.worlds.scripted.desk import Desk
from beliefnest.worlds.scripted.footpaths import Ground
from beliefnest.worlds.scripted.ground_cache import Grounds
from beliefnest.worlds.scripted.hand import Doing, Hand, SkillError, point_in
from beliefnest.worlds.scripted.javascript_program import JavaScriptProgram
from beliefnest.worlds.scripted.literal_program import LiteralProgram, literal_calls
from beliefnest.worlds.scripted.program_memory import Memory
from beliefnest.worlds.scripted.requests import Request
from beliefnest.worlds.scripted.skills import CALLS, SKILLS, UTTERANCES
from beliefnest.worlds.scripted.world import ScriptedWorld

_MOST_AIMS = 100
_DOINGS = {**SKILLS, **CALLS}
_ENDS_WITH_PROGRAM = SKILLS.keys() - UTTERANCES


@dataclass
class _Run:
    """Running program; `late` has the ticks, by call, that passed before an interruption."""

    hand: Hand
    program: JavaScriptProgram | LiteralProgram
    sense: SenseSource
    doing: dict[int, tuple[str, Doing]] = field(default_factory=dict)
    late: dict[int, int] = field(default_factory=dict)
    memory: Memory = field(default_factory=Memory)
    read: Sensed | None = None
    missed: tuple[Announcement, ...] = ()
    aims: list[Aim] = field(default_factory=list)
    stopped: list[tuple[int, str]] = field(default_factory=list)
    end_tick: int | None = None
    end: Fault | None = None


def run_programs(
    world: ScriptedWorld,
    programs: Mapping[str, str],
    timeout_ticks: int,
    senses: Mapping[str, SenseSource],
    rules: RunRules,
    seed: str,
    grounds: Grounds,
    desk: Desk,
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
        desk: Desk of programs to share.
    """
    under_way = RunningPrograms(world, programs, senses, rules, seed, grounds, desk)
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
        senses: Mapping[str, SenseSource],
        rules: RunRules,
        seed: str,
        grounds: Grounds,
        desk: Desk,
    ) -> None:
        self._world, self._rules, self._grounds, self._desk = world, rules, grounds, desk
        self._first = world.now
        self._happened: list[tuple[int, Event]] = []
        self._latest: list[Event] = []
        self._done: list[tuple[_Run, list[tuple[int, bool, object]]]] = []
        world.listen(self._hear)
        try:
            self._runs = [
                self._begun(agent, code, senses, seed) for agent, code in programs.items()
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
            _hear(run)
        for run, answers in self._done:
            for number, ok, value in answers:
                del run.doing[number]
                _answer(run, number, ok=ok, value=value)
                _take_calls(run)
        for run in self._runs:
            # An act may be in progress that continues without its program.
            goes_on = any(name not in _ENDS_WITH_PROGRAM for name, _ in run.doing.values())
            if run.end_tick is None and run.program.ended and not goes_on:
                run.end_tick = self._world.now

    def time_out(self, timeout_ticks: int) -> None:
        """End those that go on, because their ticks are over."""
        for run in self._runs:
            if run.end_tick is None:
                run.end_tick = self._world.now
                run.end = Fault(f"the program did not end within {timeout_ticks} ticks", "timeout")

    def leave(self) -> None:
        """Listen to the world no longer."""
        self._world.unlisten(self._hear)

    def results(self) -> Mapping[str, ProgramResult]:
        """Free the programs, and return what became of them."""
        for run in self._runs:
            run.program.end()
        happened, remembers = tuple(self._happened), self._rules.remembers
        return {
            run.hand.name: _result(run, self._first, happened, remembers=remembers)
            for run in self._runs
        }

    def _begun(self, agent: str, code: str, senses: Mapping[str, SenseSource], seed: str) -> _Run:
        world, rules, grounds, latest = self._world, self._rules, self._grounds, self._latest

        def all_of_it() -> Sensed:
            news = announced(_said_to(agent, latest), agent)
            others = {name: each for name, each in world.agents.items() if name != agent}
            return Sensed(world.terrain, others, announced=news, signs=world.signs)

        def ground() -> Ground:
            return grounds.of(world.box, world.terrain)

        sense = senses.get(agent, all_of_it)
        hand = Hand(
            agent,
            world,
            # For full knowledge use the true ground, which needs no map of all agents at each step.
            known=(lambda: grounds.of(world.box, sense().blocks)) if agent in senses else ground,
            others=lambda: sense().agents,
            signs=lambda: sense().signs,
            ground=ground,
            speech_ticks=rules.speech_ticks,
            mute=agent in rules.mute,
        )
        past = rules.past.get(agent)
        begin = world.now if past is None else past.tick
        reads = BotReads(world, agent, sense)
        program = self._program(reads, code, f"{seed} {begin} {agent}")
        missed = () if past is None else sense().announced
        run = _Run(
            hand, program, sense, missed=missed, memory=Memory(() if past is None else past.calls)
        )
        program.start()
        _take_calls(run)
        return run

    def _program(self, reads: BotReads, code: str, seed: str) -> JavaScriptProgram | LiteralProgram:
        calls = literal_calls(code, SKILLS)
        if calls is not None:
            return LiteralProgram(reads, code, calls, self._desk)
        lasts, mute = self._rules.speech_ticks > 0, reads.name in self._rules.mute
        return JavaScriptProgram(
            reads, SKILLS, code, seed, self._desk, speech_lasts=lasts, mute=mute
        )

    def _hear(self, frame: Frame) -> None:
        self._happened.extend((frame.tick, event) for event in frame.events)
        self._latest[:] = frame.events


def _said_to(agent: str, events: Sequence[Event]) -> list[Event]:
    """Return the events of a tick but for whispers between others."""
    return [each for each in events if agent in (each.actor, each.detail.get("to", agent))]


def _listens(run: _Run) -> bool:
    """Return True if a program listens for speech, or its agent waits for it."""
    return run.program.listens or any(name == "waitForChat" for name, _ in run.doing.values())


def _hear(run: _Run) -> None:
    """Announce the events of the tick that has ended to an agent and its program."""
    run.hand.news.clear()
    if not _listens(run) or run.end_tick is not None:
        return
    sensed = run.sense()
    news = run.missed if sensed is run.read else (*run.missed, *sensed.announced)
    run.read, run.missed = sensed, ()
    if not news:
        return
    run.hand.news.extend(news)
    if run.program.listens and not run.program.ended:
        run.program.hear(news)
        _take_calls(run)


def _act(run: _Run) -> list[tuple[int, bool, object]]:
    """Advance an agent's acts by a tick; return the calls that ended, with their outcome."""
    ended: list[tuple[int, bool, object]] = []
    for number, (name, doing) in run.doing.items():
        # Utterances without `await` are made even if the program has ended by then.
        if run.program.ended and name in _ENDS_WITH_PROGRAM:
            continue
        try:
            for _ in range(1 + run.late.pop(number, 0)):
                next(doing)
        except StopIteration as end:
            ended.append((number, True, end.value))
        except BeliefNestError as error:
            ended.append((number, False, _told(error)))
    return ended


def _answer(run: _Run, number: int, *, ok: bool, value: Any) -> None:
    run.memory.answered(number, ok=ok, value=value)
    _tell(run, number, ok=ok, value=value)


def _tell(run: _Run, number: int, *, ok: bool, value: Any) -> None:
    if ok:
        run.program.settle(number, value)
    else:
        run.program.fail(number, value)


def _take_calls(run: _Run) -> None:
    """Begin the calls of a program; a call that cannot begin fails at once."""
    requests = run.program.requests()
    while requests:
        for request in requests:
            _begin(run, request)
        requests = run.program.requests()
    if _listens(run) and run.read is None:
        # A new listener gets no earlier speech.
        run.read = run.sense()


def _begin(run: _Run, request: Request) -> None:
    number, name, now = request.number, request.name, run.hand.world.now
    past = run.memory.called(number, name, request.args, now)
    if past is not None:
        _tell(run, number, ok=past[0], value=past[1])
        return
    if request.aim is not None and len(run.aims) < _MOST_AIMS:
        run.aims.append(_aim(now, request.aim))
    if request.error is not None:
        _stop(run, request)
        run.program.fail(number, request.error)
        return
    try:
        walks = len(run.hand.walks)
        doing = _DOINGS[name](run.hand, *request.checked)
        next(doing)
        run.doing[number] = (name, doing)
        if len(run.hand.walks) == walks:
            run.late[number] = run.memory.done(number)
    except StopIteration as ended:
        _answer(run, number, ok=True, value=ended.value)
    except BeliefNestError as error:
        _stop(run, request)
        _answer(run, number, ok=False, value=_told(error))


def _stop(run: _Run, request: Request) -> None:
    """Note that a call failed after the end of its program, which did not wait for it."""
    if run.program.ended:
        run.stopped.append((request.number, request.name))


def _told(error: Exception) -> dict[str, object]:
    reason = error.reason if isinstance(error, SkillError) else None
    return {"message": str(error), "reason": reason}


def _aim(tick: int, made: Mapping[str, Any]) -> Aim:
    place = None if made["place"] is None else point_in("position", made["place"])
    return Aim(tick, made["call"], place, made["agent"], made["uses"])


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
        log=tuple(run.program.log),
        unfinished=tuple(
            run.program.unfinished(number, name.removeprefix("bot."))
            for number, name in sorted(
                [*run.stopped, *((number, name) for number, (name, _) in run.doing.items())]
            )
        ),
        aims=tuple(run.aims),
        calls=run.memory.calls(first, run.end_tick or first, walked=bool(run.hand.walks))
        if remembers
        else (),
    )
