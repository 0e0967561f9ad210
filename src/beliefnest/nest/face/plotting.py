"""What simulators held of a container, tick by tick, for a plot."""

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from itertools import pairwise

from beliefnest.belief.columns import cell_of, place_of
from beliefnest.belief.node_view import NodeView
from beliefnest.errors import InputError, PositionError
from beliefnest.nest.explain.comparison import are_false
from beliefnest.nest.explain.parts import Contents
from beliefnest.nest.past.recording import Recording
from beliefnest.pictures.figure import Figure
from beliefnest.pictures.plot import Act, Band, Row, belief_plot
from beliefnest.pictures.words import items_words, place_words
from beliefnest.timeline.journal import TimelineKey
from beliefnest.world.paths import parse_path, path_text
from beliefnest.world.values import EventKind, Position

__all__ = ["plot_of_container"]

Path = tuple[str, ...]
_Course = list[tuple[int, Contents | None]]
"""From which tick on what was held."""

_ACTS = {
    EventKind.DEPOSIT_ITEM_INTO_CHEST: "puts in",
    EventKind.GET_ITEM_FROM_CHEST: "takes out",
    EventKind.OPEN_CONTAINER: "looks in",
}


def plot_of_container(
    recording: Recording,
    container: Position,
    item: str | None,
    paths: Sequence[str],
    until: int | None,
) -> Figure:
    """The plot of what simulators held of a container, up to a tick of the real world.

    Raises:
        InputError: There is no path, or never was a container there.
        PathError: A path is malformed or names an unknown agent.
        PositionError: The container lies outside the box.
        UnknownNameError: There is no such item.
    """
    if not paths:
        raise InputError("a plot of no simulator is empty; give belief paths")
    box = recording.setting.snapshot.box
    if container not in box:
        raise PositionError(f"position {container} is outside the box {box.low}..{box.high}")
    context = recording.history.context
    if item is not None:
        context.registry.item_stack(item)
    with recording.turn:
        names = [parse_path(path, recording.agents) for path in paths]
        real = _course(recording, (), container, item)
        courses = {path: _course(recording, path, container, item) for path in names}
        if cell_of(box, container) not in context.tracked:
            known = ", ".join(str(place_of(box, cell)) for cell in sorted(context.tracked))
            raise InputError(
                f"there is no container at {container}; containers are at {known or 'no place'}"
            )
        ends = {path: recording.info(path).head if until is None else until for path in names}
        acts = _acts(recording, container, max(ends.values()))
    rows = [
        Row(path_text(path), _bands(courses[path], real, item, ends[path] + 1)) for path in names
    ]
    label = recording.setting.labels.get(container, f"container {place_words(container)}")
    title = f"What is believed of the {label}" + (f" and the {_plain(item)}" if item else "")
    return belief_plot(rows, acts, title)


def _course(recording: Recording, path: Path, container: Position, item: str | None) -> _Course:
    """The changes of what a simulator held, on its timeline and what that was forked from."""
    key = recording.controller(path)
    stretches = [(key, recording.journal.info(key).entries)]
    while (base := recording.journal.info(stretches[0][0]).base) is not None:
        stretches.insert(0, (base.timeline, base.entries))
    course: _Course = []
    for each, entries in stretches:
        for tick, value in _stretch(recording, each, path, entries, container):
            shown = value if item is None or value is None else _only(item, value)
            # What holds at the end of a tick counts.
            while course and course[-1][0] == tick:
                course.pop()
            if not course or course[-1][1] != shown:
                course.append((tick, shown))
    return course


def _stretch(
    recording: Recording, key: TimelineKey, path: Path, stop: int, container: Position
) -> Iterator[tuple[int, Contents | None]]:
    """What a simulator held after each of the first entries of a timeline."""
    start = recording.journal.info(key).start
    ticks = [start, *(entry.tick for entry in recording.journal.entries(key, 0, stop))]
    steps = recording.history.steps(key, path, 0, stop)
    for tick, forest in zip(ticks, steps, strict=True):
        held = NodeView(forest, path).containers.get(container)
        yield tick, None if held is None else Contents(dict(held.items), held.complete)


def _only(item: str, held: Contents) -> Contents:
    count = held.items.get(item, 0)
    return Contents({item: count} if count else {}, held.complete)


def _bands(course: _Course, real: _Course, item: str | None, end: int) -> tuple[Band, ...]:
    """Bands that end wherever the value, or whether it is false, changes."""
    starts = sorted({tick for tick, _ in (*course, *real) if course[0][0] <= tick < end})
    starts = starts or [min(course[0][0], end)]
    bands: list[Band] = []
    for start, stop in pairwise([*starts, max(end, starts[-1] + 1)]):
        held, true = _at(course, start), _at(real, start)
        false = held is not None and are_false(true, held)
        words = _words(held, item)
        if bands and (bands[-1].words, bands[-1].false) == (words, false):
            bands[-1] = Band(bands[-1].start, stop, words, false)
        else:
            bands.append(Band(start, stop, words, false))
    return tuple(bands)


def _at(course: _Course, tick: int) -> Contents | None:
    number = bisect_right([start for start, _ in course], tick)
    return course[number - 1][1] if number else None


def _words(held: Contents | None, item: str | None) -> str:
    """The value; empty where nothing is known."""
    if held is None or not (held.items or held.complete):
        return ""
    if item is not None and not held.items:
        return f"no {_plain(item)}"
    return items_words(held.items, complete=held.complete)


def _acts(recording: Recording, container: Position, end: int) -> list[Act]:
    """Who did what to the container in the real world."""
    found: dict[tuple[int, str | None], str] = {}
    for event in recording.reading(()).events():
        if event.kind not in _ACTS or tuple(event.detail.get("position", ())) != container:
            continue
        # Whoever puts in or takes out looks in as well.
        key = (event.tick, event.actor)
        if event.tick <= end and (event.kind is not EventKind.OPEN_CONTAINER or key not in found):
            found[key] = _ACTS[event.kind]
    return [Act(tick, f"{actor or 'somebody'} {deed}") for (tick, actor), deed in found.items()]


def _plain(item: str) -> str:
    return item.replace("_", " ")
