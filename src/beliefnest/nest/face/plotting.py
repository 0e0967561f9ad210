"""What simulators held of a matter, tick by tick, for a plot."""

from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any, TypeVar

from beliefnest.belief.node_view import NodeView
from beliefnest.errors import InputError, PositionError
from beliefnest.nest.face.matters import Contained, Course, Matter, Owned, Whereabouts
from beliefnest.nest.past.recording import Recording
from beliefnest.pictures.figure import Figure
from beliefnest.pictures.plot import Act, Band, Row, belief_plot
from beliefnest.pictures.words import place_words
from beliefnest.timeline.journal import TimelineKey
from beliefnest.world.paths import parse_path, path_text
from beliefnest.world.values import EventKind, Position

__all__ = ["plot_of"]

Path = tuple[str, ...]
V = TypeVar("V")


def plot_of(
    recording: Recording,
    container: Position | None,
    item: str | None,
    agent: str | None,
    paths: Sequence[str],
    until: int | None,
) -> Figure:
    """The plot of what simulators held of a matter, up to a tick of the real world.

    Raises:
        InputError: There is no path, not one matter, or never was a container there.
        PathError: A path is malformed or names an unknown agent, or there is no such agent.
        PositionError: The container lies outside the box.
        UnknownNameError: There is no such item.
    """
    if not paths:
        raise InputError("a plot of no simulator is empty; give belief paths")
    if (container is None) is (agent is None):
        raise InputError("a plot follows a container or an agent; give one of the two")
    if item is not None:
        recording.history.context.registry.item_stack(item)
    with recording.turn:
        if container is not None:
            return _figure(
                recording, _contained(recording, container, item), paths, until, container
            )
        assert agent is not None
        parse_path(path_text((agent,)), recording.agents)
        if item is not None:
            return _figure(recording, Owned(agent, item), paths, until)
        return _figure(recording, Whereabouts(agent, _names(recording)), paths, until)


def _contained(recording: Recording, container: Position, item: str | None) -> Contained:
    box = recording.setting.snapshot.box
    if container not in box:
        raise PositionError(f"position {container} is outside the box {box.low}..{box.high}")
    label = recording.setting.labels.get(container, f"container {place_words(container)}")
    return Contained(container, item, label)


def _check_held(recording: Recording, container: Position, courses: Sequence[Course[Any]]) -> None:
    """That a container ever was there, in reality or in one of the beliefs."""
    if any(value is not None for course in courses for _, value in course):
        return
    key = recording.controller(())
    *_, (_, real) = _stretch(recording, key, (), recording.journal.info(key).entries)
    known = ", ".join(map(str, sorted(real.containers)))
    raise InputError(
        f"there is no container at {container}; containers are at {known or 'no place'}"
    )


def _names(recording: Recording) -> Mapping[Position, str]:
    """What people call places, and containers where they have no other name."""
    setting = recording.setting
    stores = {place: f"the {label}" for place, label in setting.labels.items()}
    return {**stores, **{place: name for name, place in setting.places.items()}}


def _figure(
    recording: Recording,
    matter: Matter[V],
    paths: Sequence[str],
    until: int | None,
    container: Position | None = None,
) -> Figure:
    names = [parse_path(path, recording.agents) for path in paths]
    real = _course(recording, (), matter)
    courses = {path: _course(recording, path, matter) for path in names}
    if container is not None:
        _check_held(recording, container, [real, *courses.values()])
    ends = {path: recording.info(path).head if until is None else until for path in names}
    acts = _acts(recording, matter, max(ends.values()))
    rows = [
        Row(path_text(path), _bands(matter, courses[path], real, ends[path] + 1)) for path in names
    ]
    return belief_plot(rows, acts, matter.title)


def _course(recording: Recording, path: Path, matter: Matter[V]) -> Course[V]:
    """The changes of what a simulator held, on its timeline and what that was forked from."""
    key = recording.controller(path)
    stretches = [(key, recording.journal.info(key).entries)]
    while (base := recording.journal.info(stretches[0][0]).base) is not None:
        stretches.insert(0, (base.timeline, base.entries))
    course: Course[V] = []
    for each, entries in stretches:
        for tick, held in _stretch(recording, each, path, entries):
            value = matter.value(held)
            # What holds at the end of a tick counts.
            while course and course[-1][0] == tick:
                course.pop()
            if not course or course[-1][1] != value:
                course.append((tick, value))
    return course


def _stretch(
    recording: Recording, key: TimelineKey, path: Path, stop: int
) -> Iterator[tuple[int, NodeView]]:
    """A simulator after each of the first entries of a timeline."""
    start = recording.journal.info(key).start
    ticks = [start, *(entry.tick for entry in recording.journal.entries(key, 0, stop))]
    steps = recording.history.steps(key, path, 0, stop)
    for tick, forest in zip(ticks, steps, strict=True):
        yield tick, NodeView(forest, path)


def _bands(matter: Matter[V], course: Course[V], real: Course[V], end: int) -> tuple[Band, ...]:
    """Bands that end wherever the value, or whether it is false, changes."""
    starts = sorted({tick for tick, _ in (*course, *real) if course[0][0] <= tick < end})
    starts = starts or [min(course[0][0], end)]
    told = matter.words(course)
    bands: list[Band] = []
    for start, stop in pairwise([*starts, max(end, starts[-1] + 1)]):
        number = _number(course, start)
        held, true = course[number][1], real[_number(real, start)][1]
        false, words = held is not None and matter.is_false(true, held), told[number]
        if bands and (bands[-1].words, bands[-1].false) == (words, false):
            bands[-1] = Band(bands[-1].start, stop, words, false)
        else:
            bands.append(Band(start, stop, words, false))
    return tuple(bands)


def _number(course: Course[V], tick: int) -> int:
    """Which value of a course held at a tick; the first one before its start."""
    return max(0, bisect_right([start for start, _ in course], tick) - 1)


def _acts(recording: Recording, matter: Matter[V], end: int) -> list[Act]:
    """Who did what that mattered in the real world."""
    found: dict[tuple[int, str | None], str] = {}
    for event in recording.reading(()).events():
        deed = matter.act(event)
        if not deed or event.tick > end:
            continue
        # Whoever puts in or takes out looks in as well.
        key = (event.tick, event.actor)
        if event.kind is not EventKind.OPEN_CONTAINER or key not in found:
            found[key] = deed
    return [Act(tick, f"{actor or 'somebody'} {deed}") for (tick, actor), deed in found.items()]
