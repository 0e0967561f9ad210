"""Playing of one part of a round, in virtual time or together with people."""

from collections.abc import Callable, Collection, Mapping, Sequence

from beliefnest.episodes.agent_view import Policy
from beliefnest.episodes.decided import Ended, RoundPart
from beliefnest.episodes.live_people import RealRound
from beliefnest.episodes.record import cut_in, ended_as, reasons_in
from beliefnest.nest.face.nest import Nest
from beliefnest.worlds.protocol import ProgramPast, ProgramResult


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
    results: Mapping[str, ProgramResult] = {}
    if programs:
        results = nest["/"].run_all(programs, ticks, senses="percepts", past=past, mute=mute)
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
        decided: Function that returns True when the outcome of the episode is certain.
        mute: Agents whose programs may not speak.

    Returns:
        The part with its results and the tick at which it began.
    """
    part, (programs, past) = parts[-1], _programs(parts)
    here = RealRound(nest, policies, ticks, decided, mute)
    results = here.run(programs, past)
    acted = here.acted
    ended = {
        agent: Ended("", "ok") if agent in acted else ended_as(each, results.get(agent))
        for agent, each in part.decisions.items()
    }
    cut = cut_in(results, ended, past, here.began, here.cut)
    return RoundPart(part.decisions, ended, cut, here.began, reasons_in(results))


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
