"""Judging of probes by what programs did in the world and what simulators believe."""

import math
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from beliefnest.belief.view import State
from beliefnest.bodies.protocol import NO_WAY, ProgramResult
from beliefnest.scenarios.expected import (
    Answers,
    Arrives,
    Believes,
    Content,
    Expected,
    Hears,
    Holds,
    Intends,
    Is,
    Judge,
    Opens,
    Reads,
    Says,
    Stands,
    Takes,
    Tells,
)
from beliefnest.scenarios.naming import items_text, place_text
from beliefnest.scenarios.trial import Trial
from beliefnest.world.signs import sign_words
from beliefnest.world.values import Event, EventKind, Items, Point, Position

__all__ = [
    "OUTCOMES",
    "Judgement",
    "answer_verdict",
    "found_instead",
    "opened_by",
    "outcome_of",
    "places_of",
    "verdict_of",
]

OUTCOMES = ("ok", "wrong", "no_way", "program_failed", "no_answer", "error")
"""Possible outcomes of a probe.

`ok`: all expectations hold. `wrong`: the program did or said something else, or the model answered
something else. `no_way`: the program did none of it, because it could not walk to its target.
`program_failed`: the program did none of it, because it failed for another reason. `no_answer`: the
model gave no program or no answer. `error`: the world or the judging function failed.
"""


@dataclass(frozen=True, slots=True)
class Judgement:
    """Judgement of one expectation of a probe.

    Attributes:
        expected: The expectation.
        ok: True if it holds.
        why_not: What happened instead, for people; empty if `ok`.
        outcome: One of `OUTCOMES`; None: not ok, and the end of the program decides.
    """

    expected: Expected
    ok: bool
    why_not: str = ""
    outcome: str | None = None


def opened_by(agent: str, events: Iterable[Event]) -> tuple[Position, ...]:
    """Return the containers that an agent opened, in order."""
    return tuple(
        _position(event.detail["position"])
        for event in events
        if event.kind is EventKind.OPEN_CONTAINER and event.actor == agent
    )


def verdict_of(expected: Tells, trial: Trial) -> Judgement:
    """Judge one expectation by what a program did."""
    by_deed = False
    match expected:
        case Opens(container):
            first = trial.opened[:1]
            ok, by_deed = first == (container,), bool(first)
            found = f"opened {place_text(first[0])} first" if first else "opened nothing"
        case Arrives(place, within):
            arrived = trial.arrived
            ok = arrived is not None and math.dist(place, arrived) <= within
            found = "is nowhere" if arrived is None else f"ended at {place_text(arrived)}"
        case Intends():
            intended = trial.intended
            ok, by_deed = _intends(expected, trial), intended is not None
            found = f"made for {'nothing' if intended is None else place_text(intended)}"
        case Takes(items):
            taken = _taken(trial)
            ok = all(taken.get(name, 0) >= count for name, count in items.items())
            by_deed = bool(taken)
            found = f"took {items_text(taken)}"
        case Says(text):
            said = [line for _, line in trial.result.said]
            ok = any(text.casefold() in line.casefold() for line in said)
            found = f"said {said[-1]!r}" if said else "said nothing"
        case Believes(expectation):
            instead = found_instead(expectation.content, trial.belief(expectation.path))
            ok = instead is None
            found = f"{'reality' if expectation.path == '/' else expectation.path}: {instead}"
        case Judge():
            return _judged(expected, trial)
    return _verdict(expected, ok, found, by_deed=by_deed)


def outcome_of(verdicts: Sequence[Judgement], result: ProgramResult | None) -> str:
    """Return the overall outcome of a probe, one of `OUTCOMES`.

    Args:
        verdicts: Judgements of all expectations.
        result: Result of the program; None: there is no program.
    """
    failed = [each for each in verdicts if not each.ok]
    told = [each.outcome for each in failed]
    if result is not None and result.killed:
        return "error"
    for outcome in ("error", "no_answer", "wrong"):
        if outcome in told:
            return outcome
    if result is not None and result.error is not None and (failed or not verdicts):
        return "no_way" if result.error.reason == NO_WAY else "program_failed"
    return "wrong" if failed else "ok"


def answer_verdict(expected: Answers, answer: str | None) -> Judgement:
    """Judge the answer to a question; an answer of None means that there was no answer."""
    if answer is None:
        return Judgement(expected, ok=False, why_not="gave no answer", outcome="no_answer")
    if expected.options:
        ok = answer in expected.right
    else:
        named = [
            any(_has(answer, each) for each in texts) for texts in (expected.right, expected.wrong)
        ]
        ok = named == [True, False]
    return _verdict(expected, ok, f"answered {answer!r}", by_deed=True)


def found_instead(content: Content, state: State) -> str | None:
    """Return what a simulator believes instead of what was expected; None: it is as expected."""
    match content:
        case Holds(place, items):
            # A container that was never perceived has no known contents, so compare with nothing.
            container = state.containers.get(place)
            held = dict(container.items) if container else {}
            if held == dict(items):
                return None
            return f"{place_text(place)} holds {items_text(held)}, not {items_text(items)}"
        case Hears(text, ever):
            heard = any(text in line for _, _, line in state.chat)
            return None if ever is heard else f"{text!r} was {'not ' if ever else ''}heard"
        case Reads(place, written):
            meant = "unknown" if written is None else repr(sign_words(written))
            return (
                None
                if state.signs.get(place) == written
                else f"{sign_found(state, place)}, not {meant}"
            )
        case Is(place, wanted):
            found = state.blocks[place]
            there, meant = ("unknown" if each is None else each for each in (found, wanted))
            return None if found == wanted else f"{place_text(place)} is {there}, not {meant}"
        case Stands():
            return _stands_instead(content, state)


def _stands_instead(content: Stands, state: State) -> str | None:
    agent, wanted = content.agent, content.place
    position = state.agents[agent].position
    if wanted is None or position is None:
        ok = wanted is None and position is None
    else:
        ok = math.dist(wanted, position) <= content.within
    there = "nowhere" if position is None else f"at {place_text(position)}"
    meant = "nowhere" if wanted is None else f"at {place_text(wanted)}"
    return None if ok else f"{agent} is {there}, not {meant}"


def sign_found(state: State, place: Position) -> str:
    """Return what is known about the sign at a place, in words."""
    text = state.signs.get(place)
    if text is None:
        return f"of a sign at {place_text(place)} nothing is known"
    return f"the sign at {place_text(place)} says {sign_words(text)!r}"


def places_of(items: Items, state: State) -> tuple[Position, ...]:
    """Return the containers that are known to hold at least these items, in order of position."""
    return tuple(
        place
        for place, container in sorted(state.containers.items())
        if items and all(container.items.get(name, 0) >= n for name, n in items.items())
    )


def _verdict(expected: Expected, ok: bool, found: str, *, by_deed: bool = False) -> Judgement:
    if ok:
        return Judgement(expected, ok=True, outcome="ok")
    return Judgement(expected, ok=False, why_not=found, outcome="wrong" if by_deed else None)


def _judged(expected: Judge, trial: Trial) -> Judgement:
    try:
        answer: object = expected.function(trial)
    except Exception as error:  # noqa: BLE001  # a user's function may raise anything; report it
        answer = None
        said = f"{expected.name} raised {type(error).__name__}: {error}"
    else:
        said = f"{expected.name} returned {answer!r}; it returns True, False or a text"
    if not isinstance(answer, bool | str):
        return Judgement(expected, ok=False, why_not=said, outcome="error")
    said = answer if isinstance(answer, str) else f"{expected.name} says no"
    return _verdict(expected, answer is True, said)


def _intends(expected: Intends, trial: Trial) -> bool:
    used, walked = trial.used, trial.walked
    if used and _block(used[0]) == _block(expected.place):
        return True
    if expected.is_container and used:
        return False
    return bool(walked) and math.dist(_block(walked[-1]), _block(expected.place)) <= expected.within


def _taken(trial: Trial) -> dict[str, int]:
    taken: Counter[str] = Counter()
    for event in trial.result.events:
        if event.kind is EventKind.GET_ITEM_FROM_CHEST and event.actor == trial.agent:
            taken.update(event.detail["items"])
    return dict(sorted(taken.items()))


def _has(answer: str, text: str) -> bool:
    """Return True if an answer contains a text as whole words."""
    return re.search(rf"(?<!\w){re.escape(text.casefold())}(?!\w)", answer.casefold()) is not None


def _block(point: Point) -> Position:
    x, y, z = point
    return (math.floor(x), math.floor(y), math.floor(z))


def _position(value: Iterable[int]) -> Position:
    x, y, z = value
    return (int(x), int(y), int(z))
