"""Playing of one part of a round, in virtual time or together with people."""

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import partial

from beliefnest.episodes.agent_view import Policy
from beliefnest.episodes.decided import Ended, RoundPart
from beliefnest.episodes.live_people import people_in
from beliefnest.episodes.policies.simple import Person
from beliefnest.episodes.record import cut_in, ended_as, reasons_in
from beliefnest.nest.face.nest import Nest
from beliefnest.world.values import TICKS_PER_SECOND
from beliefnest.worlds.protocol import ProgramPast

_LONGEST = 20
"""Number of part lengths after which the episode no longer waits for an idle person."""


def play_part(
    nest: Nest, parts: Sequence[RoundPart], ticks: int, end: int, mute: Collection[str]
) -> RoundPart:
    """Run the decided programs of the last part in virtual time.

    Args:
        nest: Nest of the episode.
        parts: All parts up to this one.
        ticks: Length of the part.
        end: Tick at which the part ends.
        mute: Agents that may not speak.

    Returns:
        The part with its results.
    """
    part, (programs, past) = parts[-1], _programs(parts)
    run = partial(nest["/"].run_all, senses="percepts", past=past, mute=mute)
    results = run(programs, ticks) if programs else {}
    if nest.tick < end:
        nest["/"].step(end - nest.tick)
    look_around(nest)
    ended = {agent: ended_as(each, results.get(agent)) for agent, each in part.decisions.items()}
    cut = cut_in(results, ended, past, end - ticks, end)
    return RoundPart(part.decisions, ended, cut, reasons=reasons_in(results))


def play_part_with_people(
    nest: Nest,
    parts: Sequence[RoundPart],
    ticks: int,
    policies: Mapping[str, Policy],
    decided: Callable[[], bool],
    mute: Collection[str],
) -> RoundPart:
    """Run the decided programs of the last part in real time, while people act.

    Args:
        nest: Nest of the episode.
        parts: All parts up to this one.
        ticks: Length of the part; it is longer if a person is awaited.
        policies: Policies by agent, including people.
        decided: Function that returns True when the outcome of the episode is certain; nobody is
            awaited then.
        mute: Agents whose programs may not speak.

    Returns:
        The part with its results and the tick at which it began.
    """
    part, (programs, past) = parts[-1], _programs(parts)
    people = people_in(policies)
    awaited = {
        name for name, each in policies.items() if isinstance(each, Person) and each.is_awaited
    }
    # Events while policies were deciding belong to the time before the part.
    nest["/"].step(0)
    began = nest.tick

    def acted() -> set[str]:
        state = nest["/"].state
        did = {e.actor for e in state.events if e.tick > began and e.kind.is_act}
        return {*people} & (did | {speaker for tick, speaker, _ in state.chat if tick > began})

    def is_over() -> bool:
        return awaited <= acted() or decided() if awaited else nest.tick >= began + ticks

    run = partial(nest["/"].run_all, senses="percepts", past=past, mute=mute)
    results = run(programs, ticks) if programs else {}
    until = nest.tick
    most = ticks * (_LONGEST if awaited else 1)
    nest.wait(is_over, max(0, began + most - until) / TICKS_PER_SECOND)
    did = acted()
    ended = {
        agent: Ended("", "ok") if agent in did else ended_as(each, results.get(agent))
        for agent, each in part.decisions.items()
    }
    cut = cut_in(results, ended, past, began, until)
    return RoundPart(part.decisions, ended, cut, began, reasons_in(results))


def look_around(nest: Nest) -> None:
    """Let all agents perceive the present state.

    Without this call, the times of observation in all beliefs change only at ticks with an event.
    An agent could then infer from its own times that something happened out of its sight.
    """
    nest["/"].edit()


def _programs(parts: Sequence[RoundPart]) -> tuple[dict[str, str], dict[str, ProgramPast]]:
    """Return the programs of the last part by agent, and the past of those that continue."""
    decisions = parts[-1].decisions
    programs = {agent: d.program for agent, d in decisions.items() if d.program}
    past = {
        agent: next(p.cut[agent] for p in reversed(parts[:-1]) if agent in p.cut)
        for agent, d in decisions.items()
        if d.goes_on and d.program
    }
    return programs, past
