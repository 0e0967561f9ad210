"""One part of a round: what was decided is done, in virtual time or while people act."""

from collections.abc import Callable, Mapping, Sequence

from beliefnest.bodies.protocol import ProgramPast, ProgramResult
from beliefnest.episodes.decided import Ended, Part
from beliefnest.episodes.people import RealRound
from beliefnest.episodes.record import cut_in, ended_as, reasons_in
from beliefnest.episodes.view import Policy
from beliefnest.nest.face.nest import Nest

__all__ = ["look_around", "play_part", "play_part_with_people"]


def play_part(nest: Nest, parts: Sequence[Part], ticks: int, end: int) -> Part:
    """Do what was decided in the last of the parts, in virtual time.

    Args:
        nest: Where it is played.
        parts: All up to this one.
        ticks: How long it lasts.
        end: The tick at which it is over.

    Returns:
        The part, with how it ended.
    """
    part, (programs, past) = parts[-1], _programs(parts)
    results: Mapping[str, ProgramResult] = {}
    if programs:
        results = nest["/"].run_all(programs, ticks, senses="percepts", past=past)
    if nest.tick < end:
        nest["/"].step(end - nest.tick)
    look_around(nest)
    ended = {agent: ended_as(each, results.get(agent)) for agent, each in part.decisions.items()}
    cut = cut_in(results, ended, past, end - ticks, end)
    return Part(part.decisions, ended, cut, reasons=reasons_in(results))


def play_part_with_people(
    nest: Nest,
    parts: Sequence[Part],
    ticks: int,
    policies: Mapping[str, Policy],
    decided: Callable[[], bool],
) -> Part:
    """Do what was decided in the last of the parts, while people do what they do.

    Args:
        nest: Where it is played.
        parts: All up to this one.
        ticks: How long it lasts; longer, if somebody is waited for.
        policies: By agent, people among them.
        decided: Whether nothing that is done any more matters.

    Returns:
        The part, with how it ended and when it began.
    """
    part, (programs, past) = parts[-1], _programs(parts)
    here = RealRound(nest, policies, ticks, decided)
    results = here.run(programs, past)
    acted = here.acted
    ended = {
        agent: Ended("", "ok") if agent in acted else ended_as(each, results.get(agent))
        for agent, each in part.decisions.items()
    }
    cut = cut_in(results, ended, past, here.began, here.cut)
    return Part(part.decisions, ended, cut, here.began, reasons_in(results))


def look_around(nest: Nest) -> None:
    """Let everybody perceive what there is now.

    When something was last seen is otherwise noted at ticks at which something happened, be it
    where nobody sees it: from that an agent could tell that something did.
    """
    nest["/"].edit()


def _programs(parts: Sequence[Part]) -> tuple[dict[str, str], dict[str, ProgramPast]]:
    """Return the programs of the last part by agent, and what those that go on had done before."""
    decisions = parts[-1].decisions
    programs = {agent: d.program for agent, d in decisions.items() if d.program}
    past = {
        agent: next(p.cut[agent] for p in reversed(parts[:-1]) if agent in p.cut)
        for agent, d in decisions.items()
        if d.goes_on and d.program
    }
    return programs, past
