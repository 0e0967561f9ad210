"""Replays: recorded programs run again, each timeline in a fresh body, and frames compared."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

import msgspec

from beliefnest.bodies.protocol import Body, ProgramPast, RunRules, Sense, World
from beliefnest.nest.acting.hearsay import recalled
from beliefnest.nest.acting.sensing import Sensing
from beliefnest.nest.acting.starting import start_of
from beliefnest.nest.past.body_state import internal_state_at
from beliefnest.nest.past.history import History
from beliefnest.nest.past.placing import placing_frame
from beliefnest.nest.past.setting import Setting
from beliefnest.timeline.compare import EntryDifference, first_difference
from beliefnest.timeline.journal import Edit, Entry, ForkPoint, Journal, TimelineInfo, TimelineKey
from beliefnest.timeline.records import ProgramRecord, Senses
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.paths import path_text

__all__ = ["ReplayedTimeline", "replay"]


@dataclass(frozen=True, slots=True)
class ReplayedTimeline:
    """What became of one timeline when it was run again.

    Attributes:
        key: The timeline.
        programs: How many programs were run.
        difference: The first difference; None if there is none.
    """

    key: TimelineKey
    programs: int
    difference: EntryDifference | None


@dataclass(frozen=True, slots=True)
class _RecordedCall:
    """Programs that ran together: at a tick, after some entries of the timeline, for some ticks."""

    tick: int
    entries: int
    programs: Mapping[str, str]
    timeout_ticks: int
    senses: Senses
    ticks: int
    past: Mapping[str, ProgramPast]

    def made(self, entry: Entry) -> bool:
        """Return True if an entry lies in its time."""
        return self.tick < entry.tick <= self.tick + self.ticks


@dataclass(frozen=True, slots=True)
class _RecordedTimeline:
    """One timeline as it was recorded."""

    journal: Journal
    history: History
    info: TimelineInfo

    def after(self, entries: int, tick: int, world: World) -> Snapshot:
        """What its body was like after some of its entries, in a world of that kind."""
        moment = ForkPoint(self.info.key, entries, tick)
        path, physics = self.info.key.path, world.has_physics
        return start_of(self.journal, self.history, path, moment, has_physics=physics).snapshot

    def senses(self, call: _RecordedCall, body: Body) -> Mapping[str, Sense]:
        """What its agents knew when, as recorded: a difference before that is reported anyway."""
        if call.senses == "world":
            return {}
        return {agent: self._sense(call, body, agent) for agent in call.programs}

    def _sense(self, call: _RecordedCall, body: Body, agent: str) -> Sense:
        key = self.info.key

        def entries() -> int:
            # Edits between two calls lie before the later one.
            return max(call.entries, self.journal.entries_until(key, body.tick))

        return Sensing(self.history, key, agent, entries)

    def wait_until(self, body: Body, tick: int) -> None:
        """Let time pass in a body, in the calls in which it passed.

        A call that only let time pass is not noted. Where one ends with nothing under way it makes
        no difference; where something is, that was kept.
        """
        for stop in range(body.tick + 1, tick + 1):
            if stop == tick or self._is_stop(stop):
                body.step(stop - body.tick)

    def _is_stop(self, tick: int) -> bool:
        entries = self.journal.entries_until(self.info.key, tick)
        return internal_state_at(self.journal, ForkPoint(self.info.key, entries, tick)) != b""


def replay(
    setting: Setting,
    journal: Journal,
    programs: Sequence[ProgramRecord],
    world: World,
    seed: int,
) -> Iterator[ReplayedTimeline]:
    """Run every timeline of a run again, in order of creation.

    Each begins in the state that was recorded for its first tick, so that one that differs does not
    make those based on it differ. What a user did in a scripted world is done again as recorded.
    `world` is a fresh one of the kind that the run was in.

    Raises:
        BodyError: The Minecraft side died.
    """
    history = History(journal, setting)
    rules = RunRules(setting.perception.speech_ticks)
    for info in journal.timelines():
        mine = [
            p for p in programs if (p.path, p.branch) == (info.key.path, info.key.branch) and p.kept
        ]
        entries = list(journal.entries(info.key, 0, info.entries))
        calls = [_call(list(group)) for _, group in groupby(mine, key=lambda p: p.group)]
        found = _run_again(
            world, _RecordedTimeline(journal, history, info), entries, calls, seed, rules
        )
        yield ReplayedTimeline(info.key, len(mine), first_difference(entries, found))


def _call(group: Sequence[ProgramRecord]) -> _RecordedCall:
    first = group[0]
    programs = {program.agent: program.code for program in group}
    ticks = max(program.ticks for program in group)
    past = {
        program.agent: msgspec.json.decode(program.past, type=ProgramPast)
        for program in group
        if program.past is not msgspec.UNSET
    }
    return _RecordedCall(
        first.tick, first.entries, programs, first.timeout_ticks, first.senses, ticks, past
    )


def _run_again(
    world: World,
    recorded: _RecordedTimeline,
    entries: Sequence[Entry],
    calls: Sequence[_RecordedCall],
    seed: int,
    rules: RunRules,
) -> list[Entry]:
    info = recorded.info
    # Where agents begin who could not be where they were believed to be is no body's doing.
    moved = placing_frame(recorded.journal, info)
    found: list[Entry] = [] if moved is None else [moved]

    once = {entry.tick: entry for entry in entries if isinstance(entry, Frame)}

    def take(frame: Frame) -> None:
        if not frame.is_empty:
            # What was read out of words was recorded, and nobody is asked again.
            found.append(recalled(frame, once.get(frame.tick)))

    name = path_text(info.key.path)
    begins = recorded.after(len(found), info.start, world)
    body = world.open_body(name, f"{seed} {name}", begins, take)
    try:
        given = [
            (number, entry)
            for number, entry in enumerate(entries)
            if isinstance(entry, Edit)
            or not (world.has_physics or any(call.made(entry) for call in calls))
        ]
        acts: list[tuple[int, int, Entry | _RecordedCall]] = [(e.tick, n, e) for n, e in given]
        acts += [(call.tick, call.entries, call) for call in calls]
        for tick, number, act in sorted(acts, key=lambda each: each[:2]):
            recorded.wait_until(body, tick)
            if isinstance(act, _RecordedCall):
                going_on = replace(rules, remembers=bool(act.past), past=act.past)
                body.run(act.programs, act.timeout_ticks, recorded.senses(act, body), going_on)
                continue
            if isinstance(act, Frame) or act.path == info.key.path:
                body.set_state(recorded.after(number + 1, act.tick, world))
            found.append(act)
        recorded.wait_until(body, info.head)
    finally:
        body.close()
    return found
