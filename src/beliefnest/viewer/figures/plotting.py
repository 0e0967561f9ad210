"""Plots of what simulators believed over time about contents, items, blocks and agents."""

import math
from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise, zip_longest
from typing import Any, Protocol, TypeVar

import msgspec
import numpy as np

from beliefnest.belief.grounds import PerceivedEvent
from beliefnest.belief.node_view import NodeView
from beliefnest.errors import InputError
from beliefnest.nest.explain.comparison import are_elsewhere, are_false
from beliefnest.nest.explain.made_claims import claims_made
from beliefnest.nest.explain.parts import Contents
from beliefnest.nest.past.recording import Recording
from beliefnest.pictures.figure import Figure
from beliefnest.pictures.plot import Band, NotedClaim, PlotRow, belief_plot
from beliefnest.pictures.time_axis import NotedAct
from beliefnest.timeline.journal import ForkPoint
from beliefnest.world.claims import Claim, ClaimKind
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.event_words import EVENT_WORDS, did_to_block
from beliefnest.world.paths import BeliefPath, parse_path, path_text
from beliefnest.world.values import Items, Point, Position
from beliefnest.world.words import contents_words, point_words, told_apart, with_the

V = TypeVar("V")
_ValueCourse = list[tuple[int, V | None]]
"""Believed values, each with the tick at which the belief began; None: nothing was known."""

_Held = tuple[tuple[Position | str, int], ...]
"""Containers and agents that hold an item, with its number."""

_NEAR = 3.0
"""Greatest distance in blocks at which an agent counts as near a named thing."""
_STEP = 1.5
_PAUSE = 10
"""Greatest pause in ticks between two steps (of at most `_STEP` blocks) of one walk."""


class _Matter(Protocol[V]):
    """Matter that is followed in some simulators."""

    @property
    def title(self) -> str:
        """The title of the plot."""

    def value(self, view: NodeView) -> V | None:
        """Return the value that a simulator believes; None: nothing is known."""

    def words(self, course: _ValueCourse[V]) -> list[str]:
        """Return each value of a course in words; an empty text if nothing is known."""

    def is_false(self, real: V | None, believed: V) -> bool:
        """Return True if reality contradicts the value."""

    def act(self, event: PerceivedEvent) -> str:
        """Return an act on the matter in words, without its actor; empty for other events."""

    def is_claimed(self, claim: Claim) -> bool:
        """Return True if a claim is about the matter."""


class _Amounts:
    """Base of matters whose values are contents, of all items or of one."""

    __slots__ = ()

    item: str | None

    def words(self, course: _ValueCourse[Contents]) -> list[str]:
        """Return the contents in words."""
        return [_contents_words(content, self.item) for _, content in course]

    def is_false(self, real: Contents | None, believed: Contents) -> bool:
        """Return True if the value is false by the rules of `false_beliefs`."""
        return are_false(real, believed)


@dataclass(frozen=True, slots=True)
class Contained(_Amounts):
    """Contents of a container: all items, or one of them.

    Attributes:
        container: Position of the container.
        item: The item; None: all items.
        label: Name of the container for people.
    """

    container: Position
    item: str | None
    label: str

    @property
    def title(self) -> str:
        """The title of the plot."""
        item = "" if self.item is None else f" and the {_plain(self.item)}"
        return f"What is believed of {with_the(self.label)}{item}"

    def value(self, view: NodeView) -> Contents | None:
        """Return the contents of the container."""
        there = view.containers.get(self.container)
        return None if there is None else _only(self.item, there.items, complete=there.complete)

    def act(self, event: PerceivedEvent) -> str:
        """Return deposits, withdrawals and looks into the container in words."""
        if tuple(event.detail.get("position", ())) != self.container:
            return ""
        return EVENT_WORDS[event.kind].in_container

    def is_claimed(self, claim: Claim) -> bool:
        """Return True for a claim about the item, or without one about this container.

        A claim that the item is elsewhere counts too, as it removes the item from here.
        """
        if self.item is not None:
            return claim.item == self.item
        return claim.item is not None and claim.cell == self.container


class _Carried(msgspec.Struct, frozen=True):
    """Places of an item: containers and agents.

    Attributes:
        item: The item.
        names: Names of containers for people.
    """

    item: str
    names: Mapping[Position, str]

    @property
    def title(self) -> str:
        """The title of the plot."""
        return f"Where the {_plain(self.item)} is believed to be"

    def value(self, view: NodeView) -> _Held | None:
        """Return the number of items at each place; None: no place is known."""
        places: list[tuple[Position | str, Items]] = [
            *((place, each.items) for place, each in sorted(view.containers.items())),
            *((name, each.inventory) for name, each in sorted(view.agents.items())),
        ]
        carried = tuple((where, items[self.item]) for where, items in places if self.item in items)
        return carried or None

    def words(self, course: _ValueCourse[_Held]) -> list[str]:
        """Return the containers by their names, and the agents that have the item."""
        return [", ".join(self._at(*each) for each in carried or ()) for _, carried in course]

    def _at(self, where: Position | str, count: int) -> str:
        many = "" if count == 1 else f"{count} "
        if isinstance(where, str):
            return f"{many}with {where}"
        return f"{many}in {self.names.get(where, f'container {point_words(where)}')}"

    def is_false(self, real: _Held | None, believed: _Held) -> bool:
        """Return True if one of the places really has fewer of the item."""
        real_counts = dict(real or ())
        return any(count > real_counts.get(where, 0) for where, count in believed)

    def act(self, event: PerceivedEvent) -> str:
        """Return withdrawals, deposits and gifts of the item in words."""
        moved = self.item in event.detail.get("items", {})
        return EVENT_WORDS[event.kind].of_item if moved else ""

    def is_claimed(self, claim: Claim) -> bool:
        """Return True for claims that the item is, or is not, in a container."""
        return claim.item == self.item


class _BlockAt(msgspec.Struct, frozen=True):
    """Block at a position, for example a door that is open or shut, or a sign with its text.

    Attributes:
        block: The position.
        index: Index of the position in arrays of the box.
        text: Function from a block number to the block in words; None: unknown.
    """

    block: Position
    index: tuple[int, int, int]
    text: Callable[[int], str | None]

    @property
    def title(self) -> str:
        """The title of the plot."""
        return f"What is believed of the block at {point_words(self.block)}"

    def value(self, view: NodeView) -> str | None:
        """Return the block."""
        return self.text(int(view.numbers[self.index]))

    def words(self, course: _ValueCourse[str]) -> list[str]:
        """Return each block, with the properties in which the blocks of the course differ."""
        texts = list(dict.fromkeys(text for _, text in course if text is not None))
        words = dict(zip(texts, told_apart(texts), strict=True))
        return ["" if text is None else words[text] for _, text in course]

    def is_false(self, real: str | None, believed: str) -> bool:
        """Return True if the value is false by the rules of `false_beliefs`."""
        return real != believed

    def act(self, event: PerceivedEvent) -> str:
        """Return acts on the block in words: use, placing, mining, writing."""
        if tuple(event.detail.get("position", ())) != self.block:
            return ""
        return did_to_block(event)

    def is_claimed(self, claim: Claim) -> bool:
        """Return True for claims about the block."""
        return claim.kind is ClaimKind.BLOCK and claim.cell == self.block


@dataclass(frozen=True, slots=True)
class _OwnedCount(_Amounts):
    """Number of an item that an agent has.

    Attributes:
        agent: Name of the agent.
        item: The item.
    """

    agent: str
    item: str

    @property
    def title(self) -> str:
        """The title of the plot."""
        return f"What {self.agent} is believed to have: {_plain(self.item)}"

    def value(self, view: NodeView) -> Contents | None:
        """Return the number of the item that the agent has, as contents."""
        agent = view.agents[self.agent]
        return _only(self.item, agent.inventory, complete=agent.inventory_complete)

    def act(self, event: PerceivedEvent) -> str:
        """Return withdrawals, deposits and gifts of the item by the agent in words."""
        mine = event.actor == self.agent and self.item in event.detail.get("items", {})
        return EVENT_WORDS[event.kind].of_item if mine else ""

    def is_claimed(self, claim: Claim) -> bool:
        """Return False: no claim is about an agent's possessions."""
        return False


class _AgentPlace(msgspec.Struct, frozen=True):
    """Position of an agent.

    Attributes:
        agent: Name of the agent.
        names: Names of places and containers for people.
    """

    agent: str
    names: Mapping[Position, str]

    @property
    def title(self) -> str:
        """The title of the plot."""
        return f"Where {self.agent} is believed to be"

    def value(self, view: NodeView) -> Point | None:
        """Return the agent's feet position."""
        return view.agents[self.agent].position

    def words(self, course: _ValueCourse[Point]) -> list[str]:
        """Return places by the names of near things. An agent that walks is "on the way"."""
        runs = [list(run) for _, run in groupby(_stays(course), key=lambda stay: stay[1])]
        words: list[str] = []
        for run, after in zip_longest(runs, runs[1:]):
            text = self._run_words(run[0], None if after is None else after[0])
            words += [text] * len(run)
        return words

    def _run_words(
        self, here: tuple[int, Point | None], after: tuple[int, Point | None] | None
    ) -> str:
        """Return the place from a tick on in words; `after` is the next place."""
        tick, place = here
        if place is None:
            return ""
        if (
            after is not None
            and after[1] is not None
            and after[0] - tick < _PAUSE
            and math.dist(place, after[1]) <= _STEP
        ):
            return "on the way"
        return self._place_words(place)

    def _place_words(self, place: Point) -> str:
        """Return the nearest name; if no name is near, the block in which the feet are."""
        away = {
            name: math.dist(place, (x + 0.5, y, z + 0.5)) for (x, y, z), name in self.names.items()
        }
        if away and min(away.values()) <= _NEAR:
            return f"near {min(away, key=lambda name: (away[name], name))}"
        x, y, z = (math.floor(value + 1e-6) for value in place)
        return f"at {point_words((x, y, z))}"

    def is_false(self, real: Point | None, believed: Point) -> bool:
        """Return True if the value is false by the rules of `false_beliefs`."""
        return real is None or bool(are_elsewhere(np.array(real), np.array(believed)))

    def act(self, event: PerceivedEvent) -> str:
        """Return the arrival at the end of a walk, in words."""
        return EVENT_WORDS[event.kind].of_agent if event.actor == self.agent else ""

    def is_claimed(self, claim: Claim) -> bool:
        """Return True for claims about the agent's position."""
        return claim.kind is ClaimKind.POSITION and claim.agent == self.agent


def _stays(course: _ValueCourse[Point]) -> _ValueCourse[Point]:
    """Return a course in which a movement that is no real change of place is left out."""
    stays: _ValueCourse[Point] = []
    for tick, place in course:
        last = stays[-1][1] if stays else None
        stayed = (
            place is not None
            and last is not None
            and not are_elsewhere(np.array(last), np.array(place))
        )
        stays.append((tick, last if stayed else place))
    return stays


def _only(item: str | None, items: Items, *, complete: bool) -> Contents:
    if item is None:
        return Contents(dict(items), complete)
    count = items.get(item, 0)
    return Contents({item: count} if count else {}, complete)


def _contents_words(contents: Contents | None, item: str | None) -> str:
    """Return contents in words; an empty text if nothing is known."""
    if contents is None or not (contents.items or contents.complete):
        return ""
    if item is not None and not contents.items:
        return f"no {_plain(item)}"
    return contents_words(contents.items, complete=contents.complete)


def _plain(item: str) -> str:
    return item.replace("_", " ")


def matter_of(
    recording: Recording,
    container: Position | None,
    item: str | None,
    agent: str | None,
    block: Position | None,
) -> _Matter[Any]:
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
        return _BlockAt(block, context.box.index(block), context.block_text)
    if agent is not None:
        parse_path(path_text((agent,)), recording.agents)
        return _AgentPlace(agent, _names(recording)) if item is None else _OwnedCount(agent, item)
    assert item is not None
    return _Carried(item, _stores(recording))


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
    recording: Recording, container: Position, courses: Sequence[_ValueCourse[Any]]
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


def _said(recording: Recording, matter: _Matter[V], end: int) -> list[NotedAct]:
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
    recording: Recording, matter: _Matter[V], path: BeliefPath, end: int
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


def _course(recording: Recording, path: BeliefPath, matter: _Matter[V]) -> _ValueCourse[V]:
    """Return the course of a simulator's values, on its timeline and those it was forked from."""
    course: _ValueCourse[V] = []
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
    matter: _Matter[V], course: _ValueCourse[V], real: _ValueCourse[V], end: int
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


def _number(course: _ValueCourse[V], tick: int) -> int:
    """Return the index of a course's value at a tick; that of the first value before its start."""
    return max(0, bisect_right([start for start, _ in course], tick) - 1)


def _acts(recording: Recording, matter: _Matter[V], end: int) -> list[NotedAct]:
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
