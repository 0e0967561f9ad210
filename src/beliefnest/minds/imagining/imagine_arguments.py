"""Arguments of `imagine`, and their checks."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import msgspec

from beliefnest.errors import InputError, PathError, TickError
from beliefnest.facts.kinds import StatedFact
from beliefnest.facts.reading import PlainScene, conditions_of, fact_entry
from beliefnest.minds.imagining.course_agreement import Tolerance
from beliefnest.nest.face.given import tick_of, whole
from beliefnest.nest.past.recording import Recording
from beliefnest.timeline.journal import ForkPoint
from beliefnest.world.paths import BeliefPath

_SUM_SLACK = 1e-9

Evidence = Sequence[tuple[Sequence[StatedFact], float]]
"""Conditions at the end of histories, each with the probability that it is mistaken."""


class Asked(msgspec.Struct, frozen=True):
    """Arguments of a call, as given; see `ShownSimulator.imagine`."""

    since: int
    until: int | None
    actors: Mapping[str, Mapping[str, object]]
    n: int
    seed: int
    weights: Mapping[str, Mapping[str, float]] | None
    evidence: Sequence[Mapping[str, Any]] | None
    tolerance: tuple[int, int]


class Checked(msgspec.Struct, frozen=True):
    """Arguments of a call, checked."""

    base: ForkPoint
    end: ForkPoint
    n: int
    weights: Mapping[str, Sequence[float]]
    tolerance: Tolerance
    evidence: Evidence | None

    @classmethod
    def of(cls, recording: Recording, path: BeliefPath, asked: Asked) -> "Checked":
        """Check the arguments of a call.

        Raises:
            InputError, PathError, TickError: An argument is wrong.
        """
        actors, n = asked.actors, asked.n
        begin = tick_of(asked.since)
        end = recording.moment(path, None if asked.until is None else tick_of(asked.until))
        if begin > end.tick:
            raise TickError(
                f"since is {begin}, after until, which is {end.tick}; histories go forward"
            )
        first = recording.journal.info(recording.stretches(end)[0].timeline).start
        begin = max(begin, first) if begin == 0 else begin
        key, entries = recording.place_of(end.timeline, begin)
        count = whole(n)
        if count is None or count < 1:
            raise InputError(f"n is {n!r}; give a whole number from 1")
        if whole(asked.seed) is None:
            raise InputError(f"seed is {asked.seed!r}; give a whole number")
        if not isinstance(actors, Mapping) or not actors:
            raise InputError(f"actors is {actors!r}; give candidates by name, by agent")
        for agent, named in actors.items():
            if agent not in recording.agents:
                raise PathError(f"no agent {agent!r}; there are {', '.join(recording.agents)}")
            if not isinstance(named, Mapping) or not named:
                raise InputError(f"the candidates of {agent} are {named!r}; give them by name")
        return cls(
            ForkPoint(key, entries, begin),
            end,
            count,
            _weights(actors, asked.weights or {}),
            _tolerance(asked.tolerance),
            None if asked.evidence is None else _evidence(recording, asked.evidence),
        )


def _tolerance(tolerance: object) -> Tolerance:
    parts = [whole(part) for part in tolerance] if isinstance(tolerance, Sequence) else []
    if len(parts) != 2 or any(part is None or part < 0 for part in parts):
        raise InputError(
            f"tolerance is {tolerance!r}; give (cells, ticks), whole numbers that are 0 or more"
        )
    return Tolerance(int(parts[0] or 0), int(parts[1] or 0))


def _weights(
    actors: Mapping[str, Mapping[str, object]], weights: Mapping[str, Mapping[str, float]]
) -> Mapping[str, Sequence[float]]:
    if not isinstance(weights, Mapping):
        raise InputError(f"weights are {weights!r}; give weights by candidate, by agent")
    for agent in weights:
        if agent not in actors:
            raise PathError(f"weights name {agent!r}, who has no candidates")
    lists: dict[str, Sequence[float]] = {}
    for agent, named in actors.items():
        mine = weights.get(agent)
        if mine is None:
            lists[agent] = [1 / len(named)] * len(named)
            continue
        if not isinstance(mine, Mapping):
            raise InputError(f"the weights of {agent} are {mine!r}; give them by candidate")
        unknown = [str(name) for name in mine if name not in named]
        if unknown:
            raise InputError(
                f"weights of {agent} name {', '.join(unknown)}; the candidates are "
                f"{', '.join(map(repr, named))}"
            )
        listed = [mine.get(name, 0.0) for name in named]
        if not all(_is_weight(weight) for weight in listed):
            raise InputError(
                f"weights of {agent} are {dict(mine)!r}; give numbers that are 0 or more"
            )
        total = math.fsum(listed)
        if abs(total - 1) > _SUM_SLACK:
            raise InputError(f"the weights of {agent} sum to {total:.6g}; let them sum to 1")
        lists[agent] = listed
    return lists


def _is_weight(value: object) -> bool:
    return (
        isinstance(value, int | float)
        and not isinstance(value, bool)
        and math.isfinite(value)
        and value >= 0
    )


def goal_conditions(
    recording: Recording, entries: Mapping[str, Any] | Sequence[Mapping[str, Any]]
) -> list[StatedFact]:
    """Parse one condition, or a list of conditions, written as in goals."""
    listed = [entries] if isinstance(entries, Mapping) else entries
    is_list = isinstance(entries, Sequence) and not isinstance(entries, str)
    if not listed or not (is_list or isinstance(entries, Mapping)):
        raise InputError(f"the condition is {entries!r}; give a mapping, or a list of mappings")
    scene = PlainScene(recording.agents, recording.box)
    return [
        condition
        for each in listed
        for condition in conditions_of(fact_entry(each, scene), recording.agents)
    ]


def _evidence(recording: Recording, evidence: Sequence[Mapping[str, Any]]) -> Evidence:
    if isinstance(evidence, Mapping) or not isinstance(evidence, Sequence) or not evidence:
        raise InputError(f"evidence is {evidence!r}; give a list of conditions, or None")
    entries = []
    for each in evidence:
        if not isinstance(each, Mapping):
            raise InputError(f"evidence has {each!r}; give conditions as mappings")
        mistaken = each.get("mistaken", 0.0)
        if not _is_weight(mistaken) or mistaken > 1:
            raise InputError(f"mistaken is {mistaken!r}; give a probability")
        plain = {key: value for key, value in each.items() if key != "mistaken"}
        entries.append((goal_conditions(recording, plain), float(mistaken)))
    return entries
