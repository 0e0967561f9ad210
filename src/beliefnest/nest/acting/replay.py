"""Replay of recorded programs, each timeline in a fresh body, with a comparison of frames."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby

import msgspec
from msgspec.structs import replace

from beliefnest.nest.acting.hearsay import recalled
from beliefnest.nest.acting.sensing import Sensing
from beliefnest.nest.acting.starting import start_of
from beliefnest.nest.past.body_state import internal_state_at
from beliefnest.nest.past.history import StateHistory
from beliefnest.nest.past.placing import placing_frame
from beliefnest.nest.past.setting import Setting
from beliefnest.timeline.compare import EntryDifference, first_difference
from beliefnest.timeline.journal import Edit, Entry, ForkPoint, TimelineInfo, TimelineKey
from beliefnest.timeline.run_records import ProgramRecord, Senses
from beliefnest.timeline.store import Journal
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.paths import path_text
from beliefnest.worlds.protocol import Body, ProgramPast, RunRules, SenseSource, World


class ReplayedTimeline(msgspec.Struct, frozen=True):
    """Result of the replay of one timeline.

    Attributes:
        key: The timeline.
        programs: Number of programs that were run.
        difference: The first difference; None if there is none.
    """

    key: TimelineKey
    programs: int
    difference: EntryDifference | None


class _RecordedCall(msgspec.Struct, frozen=True):
    """Programs that ran together in one call, with the tick, entries and ticks of the call."""

    tick: int
    entries: int
    programs: Mapping[str, str]
    timeout_ticks: int
    senses: Senses
    ticks: int
    past: Mapping[str, ProgramPast]
    mute: frozenset[str]

    def made(self, entry: Entry) -> bool:
        """Return True if an entry was recorded during the call."""
        return self.tick < entry.tick <= self.tick + self.ticks


class _RecordedTimeline(msgspec.Struct, frozen=True):
    """Timeline as it was recorded."""

    journal: Journal
    history: StateHistory
    info: TimelineInfo

    def after(self, entries: int, tick: int, world: World) -> Snapshot:
        """Return the snapshot of its body after some entries, in a world of the given kind."""
        moment = ForkPoint(self.info.key, entries, tick)
        path, physics = self.info.key.path, world.has_physics
        return start_of(self.journal, self.history, path, moment, has_physics=physics).snapshot

    def senses(self, call: _RecordedCall, body: Body) -> Mapping[str, SenseSource]:
        """Return the recorded percepts of the agents of a call.

        Recorded percepts serve as well as new ones: if an earlier frame differs, that is reported
        in any case.
        """
        if call.senses == "world":
            return {}
        return {agent: self._sense(call, body, agent) for agent in call.programs}

    def _sense(self, call: _RecordedCall, body: Body, agent: str) -> SenseSource:
        key = self.info.key

        def entries() -> int:
            # An edit between two calls belongs to the time before the later one.
            return max(call.entries, self.journal.entries_until(key, body.tick))

        return Sensing(self.history, key, agent, entries)

    def wait_until(self, body: Body, tick: int) -> None:
        """Let time pass in a body until a tick, divided into calls as it was recorded.

        Calls that only let time pass are not noted. Their ends matter only where the body had an
        internal state, which was stored then; these are the stops.
        """
        for stop in range(body.tick + 1, tick + 1):
            if stop == tick or self._is_stop(stop):
                body.step(stop - body.tick)

    def _is_stop(self, tick: int) -> bool:
        entries = self.journal.entries_until(self.info.key, tick)
        return internal_state_at(self.journal, ForkPoint(self.info.key, entries, tick)) != b""


def replay(
    setting: Setting, journal: Journal, programs: Sequence[ProgramRecord], world: World, seed: int
) -> Iterator[ReplayedTimeline]:
    """Run every timeline of a run again, in order of creation, and yield the results.

    Each timeline begins in the state recorded for its first tick, so that a difference in one does
    not cause differences in its forks. A user's acts in a scripted world are repeated as recorded.

    Args:
        setting: Setting of the run.
        journal: Journal of the run.
        programs: Notes of its programs.
        world: A fresh world of the kind that the run used.
        seed: Seed of the run.

    Raises:
        BodyError: The process behind the world ended.
    """
    history = StateHistory(journal, setting)
    rules = RunRules(setting.perception.speech_ticks)
    for info in journal.timelines():
        mine = [
            p for p in programs if (p.path, p.branch) == (info.key.path, info.key.branch) and p.kept
        ]
        entries = list(journal.entries(info.key, 0, info.entries))
        calls = [_call(list(group)) for _, group in groupby(mine, key=lambda p: p.group)]
        replayed = _run_again(
            world, _RecordedTimeline(journal, history, info), entries, calls, seed, rules
        )
        yield ReplayedTimeline(info.key, len(mine), first_difference(entries, replayed))


def _call(group: Sequence[ProgramRecord]) -> _RecordedCall:
    first = group[0]
    programs = {program.agent: program.code for program in group}
    ticks = max(program.ticks for program in group)
    past = {
        program.agent: msgspec.json.decode(program.past, type=ProgramPast)
        for program in group
        if program.past is not msgspec.UNSET
    }
    mute = frozenset(program.agent for program in group if program.mute is True)
    return _RecordedCall(
        first.tick, first.entries, programs, first.timeout_ticks, first.senses, ticks, past, mute
    )


def _run_again(
    world: World,
    recorded: _RecordedTimeline,
    entries: Sequence[Entry],
    calls: Sequence[_RecordedCall],
    seed: int,
    rules: RunRules,
) -> list[Entry]:
    """Return the entries of one timeline, made again in a fresh body.

    Edits and, in a scripted world, frames outside of calls are the user's acts: they are applied to
    the body as recorded. Programs run again, in the same order and at the same ticks.
    """
    info = recorded.info
    # No body makes the frame that moves agents at a fork: take it from the record.
    moved = placing_frame(recorded.journal, info)
    again: list[Entry] = [] if moved is None else [moved]

    once = {entry.tick: entry for entry in entries if isinstance(entry, Frame)}

    def take(frame: Frame) -> None:
        if not frame.is_empty:
            # Claims that a model read out of utterances are taken from the record.
            again.append(recalled(frame, once.get(frame.tick)))

    name = path_text(info.key.path)
    begins = recorded.after(len(again), info.start, world)
    body = world.open_body(name, f"{seed} {name}", begins, take)
    try:
        past = [
            (number, entry)
            for number, entry in enumerate(entries)
            if isinstance(entry, Edit)
            or not (world.has_physics or any(call.made(entry) for call in calls))
        ]
        acts: list[tuple[int, int, Entry | _RecordedCall]] = [(e.tick, n, e) for n, e in past]
        acts += [(call.tick, call.entries, call) for call in calls]
        for tick, number, act in sorted(acts, key=lambda each: each[:2]):
            recorded.wait_until(body, tick)
            if isinstance(act, _RecordedCall):
                its = replace(rules, remembers=bool(act.past), past=act.past, mute=act.mute)
                body.run(act.programs, act.timeout_ticks, recorded.senses(act, body), its)
                continue
            if isinstance(act, Frame) or act.path == info.key.path:
                body.set_state(recorded.after(number + 1, act.tick, world))
            again.append(act)
        recorded.wait_until(body, info.head)
    finally:
        body.close()
    return again
