"""Plots of what simulators believed about a matter over time."""

from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any, TypeVar

from beliefnest.belief.node_view import NodeView
from beliefnest.errors import InputError
from beliefnest.nest.explain.made_claims import claims_made
from beliefnest.nest.past.recording import Recording
from beliefnest.pictures.figure import Figure
from beliefnest.pictures.plot import Band, NotedClaim, PlotRow, belief_plot
from beliefnest.pictures.time_axis import NotedAct
from beliefnest.timeline.journal import ForkPoint
from beliefnest.viewer.figures.matters import (
    AgentPlace,
    BlockAt,
    Carried,
    Contained,
    Matter,
    OwnedCount,
    ValueCourse,
)
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.paths import BeliefPath, parse_path, path_text
from beliefnest.world.values import Position
from beliefnest.world.words import point_words, with_the

V = TypeVar("V")


def matter_of(
    recording: Recording,
    container: Position | None,
    item: str | None,
    agent: str | None,
    block: Position | None,
) -> Matter[Any]:
    """Return the matter that a plot follows; arguments and errors are those of `plot_beliefs`."""
    named = [each for each in (container, agent, block) if each is not None]
    if len(named) > 1 or not (named or item) or (block and item):
        raise InputError(
            "a plot follows one thing: give one of container, item, agent and block, or an item "
            "together with its container or with the agent that has it"
        )
    context = recording.context
    if item is not None:
        context.registry.item_stack(item)
    if container is not None:
        context.box.check(container)
        place = recording.state(()).container_at(container)
        label = recording.setting.labels.get(place, f"container {point_words(place)}")
        return Contained(place, item, label)
    if block is not None:
        context.box.check(block)
        return BlockAt(block, context.box.index(block), context.block_text)
    if agent is not None:
        parse_path(path_text((agent,)), recording.agents)
        return AgentPlace(agent, _names(recording)) if item is None else OwnedCount(agent, item)
    assert item is not None
    return Carried(item, _stores(recording))


def plot_of(
    recording: Recording,
    followed: tuple[Position | None, str | None, str | None, Position | None],
    paths: Sequence[str],
    until: int | None,
) -> Figure:
    """Return the plot of a matter in some simulators, up to a tick of the real world.

    Args:
        recording: Recording of the nest.
        followed: The arguments of `matter_of`, which say what the plot follows.
        paths: Belief paths of the simulators.
        until: Last tick; None: the latest one.

    Raises:
        InputError: There is no path, or there never was such a container.
        PathError: A path is malformed or names an unknown agent.
    """
    matter = matter_of(recording, *followed)
    if not paths:
        raise InputError("a plot needs at least one simulator; give belief paths")
    names = [parse_path(path, recording.agents) for path in paths]
    real = _course(recording, (), matter)
    courses = {path: _course(recording, path, matter) for path in names}
    if isinstance(matter, Contained):
        _check_held(recording, matter.container, [real, *courses.values()])
    ends = {path: recording.info(path).head if until is None else until for path in names}
    end = max(ends.values())
    acts = [*_acts(recording, matter, end), *_said(recording, matter, end)]
    rows = [
        PlotRow(
            path_text(path),
            _bands(matter, courses[path], real, ends[path] + 1),
            _heard(recording, matter, path, ends[path]),
        )
        for path in names
    ]
    return belief_plot(rows, sorted(acts, key=lambda act: act.tick), matter.title)


def _check_held(
    recording: Recording, container: Position, courses: Sequence[ValueCourse[Any]]
) -> None:
    """Raise InputError unless a container was ever at a position, in any of the courses."""
    if any(value is not None for course in courses for _, value in course):
        return
    there = ", ".join(map(str, sorted(recording.state(()).containers)))
    raise InputError(
        f"there never was a container at {container}; containers are at {there or 'no position'}"
    )


def _names(recording: Recording) -> Mapping[Position, str]:
    """Return the names of places and containers, by position. The name of a place comes first."""
    places = recording.setting.places
    return {**_stores(recording), **{place: name for name, place in places.items()}}


def _stores(recording: Recording) -> Mapping[Position, str]:
    """Return the names of containers, by position."""
    return {place: with_the(label) for place, label in recording.setting.labels.items()}


def _said(recording: Recording, matter: Matter[V], end: int) -> list[NotedAct]:
    """Return the claims about a matter in the real world: speaker, text, and if false or a lie."""
    names = _names(recording)
    acts = []
    for made in claims_made(recording, (), end):
        if matter.is_claimed(made.about):
            where = names.get(made.about.cell)
            said = str(made.claim) if where is None else made.claim.about(where)
            kind = " (a lie)" if made.lie else " (false)" if made.false else ""
            acts.append(NotedAct(made.tick, f"{made.speaker or 'a sign'}: {said}{kind}"))
    return acts


def _heard(
    recording: Recording, matter: Matter[V], path: BeliefPath, end: int
) -> tuple[NotedClaim, ...]:
    """Return the claims about a matter that a simulator heard.

    Claims that its owner made in reality are left out: they change nothing (rule 8.4).
    """
    own, text = recording.controller(path).path, path_text(path)
    if not path or own == path or recording.setting.perception.testimony == "none":
        return ()
    return tuple(
        NotedClaim(made.heard_at(text), made.taken_up(text))
        for made in claims_made(recording, own, end)
        if matter.is_claimed(made.about) and made.is_heard(text) and made.condition(text) != "4"
    )


def _course(recording: Recording, path: BeliefPath, matter: Matter[V]) -> ValueCourse[V]:
    """Return the course of a simulator's values, on its timeline and those it was forked from."""
    course: ValueCourse[V] = []
    for stretch in recording.stretches(recording.moment(path)):
        for tick, view in _held(recording, path, stretch):
            value = matter.value(view)
            # Only the value at the end of a tick counts.
            while course and course[-1][0] == tick:
                course.pop()
            if not course or course[-1][1] != value:
                course.append((tick, value))
    return course


def _held(
    recording: Recording, path: BeliefPath, stretch: ForkPoint
) -> Iterator[tuple[int, NodeView]]:
    """Yield a simulator at the beginning of a timeline, and after each of its entries."""
    key, stop = stretch.timeline, stretch.entries
    start = recording.journal.info(key).start
    ticks = [start, *(entry.tick for entry in recording.journal.entries(key, 0, stop))]
    steps = recording.history.steps(key, path, 0, stop)
    for tick, forest in zip(ticks, steps, strict=True):
        yield tick, NodeView(forest, path)


def _bands(
    matter: Matter[V], course: ValueCourse[V], real: ValueCourse[V], end: int
) -> tuple[Band, ...]:
    """Return the bands of a course. A new one begins where the value or its truth changes."""
    starts = sorted({tick for tick, _ in (*course, *real) if course[0][0] <= tick < end})
    starts = starts or [min(course[0][0], end)]
    texts = matter.words(course)
    bands: list[Band] = []
    for start, stop in pairwise([*starts, max(end, starts[-1] + 1)]):
        number = _number(course, start)
        believed, true = course[number][1], real[_number(real, start)][1]
        false, words = believed is not None and matter.is_false(true, believed), texts[number]
        if bands and (bands[-1].words, bands[-1].false) == (words, false):
            bands[-1] = Band(bands[-1].start, stop, words, false)
        else:
            bands.append(Band(start, stop, words, false))
    return tuple(bands)


def _number(course: ValueCourse[V], tick: int) -> int:
    """Return the index of a course's value at a tick; that of the first value before its start."""
    return max(0, bisect_right([start for start, _ in course], tick) - 1)


def _acts(recording: Recording, matter: Matter[V], end: int) -> list[NotedAct]:
    """Return the acts on a matter in the real world."""
    deeds: dict[tuple[int, str | None], str] = {}
    for event in recording.state(()).perceived:
        deed = matter.act(event)
        if not deed or event.tick > end:
            continue
        # An agent that moves items also opens the container: list only the move.
        key = (event.tick, event.actor)
        if event.kind is not EventKind.OPEN_CONTAINER or key not in deeds:
            deeds[key] = deed
    return [
        NotedAct(tick, f"{actor or 'somebody'} {deed}") for (tick, actor), deed in deeds.items()
    ]
