"""Explanations and lines of sight: single ones on request, or many in advance for a file."""

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from beliefnest.belief.columns import place_of
from beliefnest.belief.forest import Forest
from beliefnest.belief.node_view import NodeView
from beliefnest.errors import InputError, PathError
from beliefnest.nest.explain.parts import Element, Sighting
from beliefnest.nest.explain.sightings import sighting_of_agent, sighting_of_block
from beliefnest.nest.face.reader import Reader
from beliefnest.nest.past.views import VisiblePart, visible_part
from beliefnest.timeline.journal import TimelineInfo, TimelineKey
from beliefnest.viewer.page.run import About, RunData
from beliefnest.viewer.page.runs import numbers_text
from beliefnest.viewer.page.tracks import Onlooker
from beliefnest.world.frames import Frame
from beliefnest.world.paths import BeliefPath, path_text
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box, Position

_THING = re.compile(r"(agent|block|container|inventory)-(\d{1,9})", re.ASCII)

_EXPLANATIONS = 36
"""Largest number of explanations in a page without a server; together they take some seconds."""

_ENTRIES = 6000
"""Largest number of entries folded for explanations; pages of longer runs need a server."""

_LOOKS = 6000
"""Largest number of lines of sight between agents per timeline in such a page."""

_ALL_AROUND = 360.0
"""Field of view, in degrees, of an agent that sees in all directions."""

_NODES = 12
"""Largest number of nodes per timeline with lines of sight in such a page."""


def explanation_of(
    reader: Reader, key: TimelineKey, path: BeliefPath, tick: int, thing: str
) -> dict[str, Any]:
    """Return the reasons for a node's belief about a thing, in words.

    Args:
        reader: Reader of the nest.
        key: Key of the timeline.
        path: Path of the node.
        tick: Tick of the belief.
        thing: `agent-1`; `container-7`, contents of cell 7; `block-7`, block of cell 7.

    Raises:
        InputError: There is no such thing.
        TickError: The timeline has no such tick.
    """
    (explanation,) = _told_reasons(reader, key, path, [(tick, thing)])
    return explanation


def _told_reasons(
    reader: Reader, key: TimelineKey, path: BeliefPath, asked: Sequence[tuple[int, str]]
) -> list[dict[str, Any]]:
    """Return the answers of `explanation_of` for several ticks and things, found together."""
    reasons = reader.explain(key, path, [(tick, _element(reader, thing)) for tick, thing in asked])
    return [
        {"t": tick, "lines": each.lines} for (tick, _), each in zip(asked, reasons, strict=True)
    ]


def _element(reader: Reader, thing: str) -> Element:
    kind, number = _named(thing)
    if kind in ("agent", "inventory"):
        return reader.element(agent=_agent(reader, number))
    place = _place(reader, number)
    return reader.element(container=place) if kind == "container" else reader.element(block=place)


def look_of(
    reader: Reader, key: TimelineKey, path: BeliefPath, tick: int, viewer: str, target: str
) -> list[Any] | None:
    """Return an agent's line of sight to a thing in a node: `[outcome, distance, blocker]`.

    Args:
        reader: Reader of the nest.
        key: Key of the timeline.
        path: Path of the node.
        tick: Tick of the view.
        viewer: Name of the agent that looks.
        target: `agent-1` or `block-7`, as for `explanation_of`.

    Returns:
        None if the viewer's pose is unknown.
    """
    kind, number = _named(target)
    what = _agent(reader, number) if kind == "agent" else _place(reader, number)
    return _told(reader.look(key, path, tick, viewer, what))


def _named(thing: str) -> tuple[str, int]:
    """Return the kind and the number of a thing; raises InputError if it is malformed."""
    match = _THING.fullmatch(thing)
    if match is None:
        raise InputError(
            f"{thing[:50]!r} is not a thing; write one such as agent-0, block-7 or container-7"
        )
    return match[1], int(match[2])


def sight_of(
    reader: Reader, key: TimelineKey, path: BeliefPath, tick: int, viewer: str
) -> list[int]:
    """Return an agent's view in a node as lengths of runs of cells: unseen, seen, unseen, ..."""
    return _runs(reader.visible_part(key, path, tick, viewer), reader.setting.snapshot.box)


def ahead(reader: Reader, about: About, depth: int) -> dict[str, Any]:
    """Return a run's present data, with explanations, lines of sight and views.

    Lines of sight and views are given where they change. If there are too many, only some ticks are
    examined.
    """
    views = _Views(reader)
    data = RunData(reader, about, depth, views.onlooker)
    update = data.update()
    reasons = {
        "explanations": _explanations(data, list(data.nodes())),
        "looks": views.looks,
        "sights": views.sights,
        "views": views.texts,
    }
    return {**update, "ahead": reasons}


class _Views:
    """Collector of the views in the nodes of some timelines, at the ticks where they change."""

    def __init__(self, reader: Reader) -> None:
        self._reader = reader
        # Cache by position and surroundings: the same ones give the same view.
        self._known: dict[Any, Any] = {}
        self._all_around = reader.setting.perception.field_of_view >= _ALL_AROUND
        self.looks: dict[str, list[Any]] = {}
        self.sights: dict[str, list[Any]] = {}
        # Several nodes have the same views, which are long: rows of `sights` have their numbers.
        self.texts: list[str] = []
        self._numbers: dict[str, int] = {}

    def onlooker(self, info: TimelineInfo, paths: Sequence[BeliefPath]) -> Onlooker:
        """Return an onlooker that records the views in some nodes of a timeline, at some ticks."""
        reader, some = self._reader, paths[:_NODES]
        room = _LOOKS // (len(some) * max(1, len(reader.agents)) ** 2)
        ticks: dict[int, int] = {}
        for tick in _some(range(info.start, info.head + 1), max(4, room)):
            ticks.setdefault(reader.entries_until(info.key, tick), tick)

        def look(forest: Forest) -> None:
            if forest.position in ticks:
                for path in some:
                    self._look_around(info, ticks[forest.position], NodeView(forest, path))

        return look

    def _look_around(self, info: TimelineInfo, tick: int, reading: NodeView) -> None:
        agents = self._reader.agents
        grid = _fingerprint(reading.terrain)
        cells = sorted(self._reader.history.context.tracked)
        for number, viewer in enumerate(agents):
            name = f"{name_of(info.key, reading.path)} agent-{number}"
            here = self._standing(reading, viewer)
            _add(self.sights, name, tick, self._sight(reading, viewer, (grid, here)))
            for at, other in enumerate(agents):
                if at != number:
                    mark = (grid, here, _place_of(reading, other))
                    _add(
                        self.looks,
                        f"{name} agent-{at}",
                        tick,
                        self._look(reading, viewer, other, mark),
                    )
            for cell in cells:
                place = place_of(self._reader.setting.snapshot.box, cell)
                look = self._look(reading, viewer, place, (grid, here, cell))
                _add(self.looks, f"{name} container-{cell}", tick, look)

    def _standing(self, reading: NodeView, name: str) -> Any:
        """Return everything on which an agent's view depends.

        With a view in all directions, its direction does not matter.
        """
        agent = reading.agents[name]
        if agent.position is None or self._all_around:
            return agent.position
        return agent.position, agent.yaw, agent.pitch

    def _sight(self, reading: NodeView, viewer: str, mark: Any) -> int:
        if mark[1] is None:
            return self._number("")
        if mark not in self._known:
            sight = self._reader.history.context.sight
            runs = _runs(visible_part(reading, sight, viewer), self._reader.setting.snapshot.box)
            self._known[mark] = self._number(numbers_text(runs))
        number: int = self._known[mark]
        return number

    def _number(self, text: str) -> int:
        """Return the number of a view, as a text of the lengths of its runs."""
        if text not in self._numbers:
            self._numbers[text] = len(self.texts)
            self.texts.append(text)
        return self._numbers[text]

    def _look(self, reading: NodeView, viewer: str, target: str | Position, mark: Any) -> Any:
        if mark[1] is None:
            return None
        if mark not in self._known:
            box = self._reader.setting.snapshot.box
            if isinstance(target, str):
                look = sighting_of_agent(reading, box, viewer, target)
            else:
                look = sighting_of_block(reading, box, viewer, target)
            self._known[mark] = _told(look)
        return self._known[mark]


def _place_of(reading: NodeView, name: str) -> Any:
    return reading.agents[name].position


def _add(rows: dict[str, list[Any]], name: str, tick: int, value: Any) -> None:
    values = rows.setdefault(name, [])
    if not values or values[-1][1] != value:
        values.append([tick, value])


def _explanations(
    data: RunData, nodes: Sequence[tuple[TimelineInfo, BeliefPath]]
) -> dict[str, list[Any]]:
    reader = data.reader
    rows_by_thing: dict[str, list[Any]] = {}
    wanted = sorted(nodes, key=lambda each: (each[1] not in data.about.paths, bool(each[0].base)))
    longest = max((info.entries for info, _ in nodes), default=1)
    left = min(_EXPLANATIONS, _ENTRIES // max(1, longest))
    infos = {info.key: info for info, _ in wanted}
    deeds = {key: _deeds(reader, info) for key, info in infos.items()} if left else {}
    asked: dict[tuple[TimelineKey, BeliefPath], list[tuple[int, str]]] = {}
    for kind in ("container", "agent"):
        for info, path in wanted:
            for thing in _things(reader, kind) if path else ():
                ticks = deeds.get(info.key, [])[: max(0, left)]
                left -= len(ticks)
                if ticks:
                    rows_by_thing[f"{name_of(info.key, path)} {thing}"] = []
                    asked.setdefault((info.key, path), []).extend((tick, thing) for tick in ticks)
    for (key, path), questions in asked.items():
        # In order of time, a forest is folded further from tick to tick.
        questions.sort()
        reasons = _told_reasons(reader, key, path, questions)
        for (_, thing), row in zip(questions, reasons, strict=True):
            rows_by_thing[f"{name_of(key, path)} {thing}"].insert(0, row)
    return rows_by_thing


def _deeds(reader: Reader, info: TimelineInfo) -> list[int]:
    """Return the ticks of deeds that others can perceive, and the last tick."""
    ticks = {
        entry.tick
        for entry in reader.entries(info.key, 0, info.entries)
        if isinstance(entry, Frame) and any(event.kind.is_public_deed for event in entry.events)
    }
    return sorted(ticks | {info.head}, reverse=True)


def _things(reader: Reader, kind: str) -> Iterator[str]:
    numbers: Iterable[int] = range(len(reader.agents))
    if kind == "container":
        numbers = sorted(reader.history.context.tracked)
    yield from (f"{kind}-{number}" for number in numbers)


def _some(ticks: range, count: int) -> list[int]:
    """Return at most `count` of some ticks, evenly spread, with the last one among them."""
    step = -(-len(ticks) // count)
    return [*ticks[:-1:step], ticks[-1]]


def _runs(part: VisiblePart | None, box: Box) -> list[int]:
    """Return a view as lengths of runs of cells of the box: unseen, seen, unseen, ..."""
    cells = math.prod(box.shape)
    if part is None or not part.seen.any():
        return [cells]
    index = np.stack(np.nonzero(part.seen)) + np.array(part.low)[:, None]
    seen = np.ravel_multi_index(tuple(index), box.shape)
    firsts = np.flatnonzero(np.diff(seen, prepend=-2) != 1)
    begins, ends = seen[firsts], seen[np.append(firsts[1:], len(seen)) - 1] + 1
    edges = np.stack([begins, ends], axis=1).reshape(-1)
    lengths: list[int] = np.diff(edges, prepend=0).tolist()
    return lengths if edges[-1] == cells else [*lengths, cells - int(edges[-1])]


def _fingerprint(terrain: Terrain) -> int:
    """Return a number that is the same for equal blocks."""
    chunks = np.array([hash(chunk.tobytes()) for chunk in terrain.chunks], dtype=np.int64)
    return hash(chunks[terrain.rows].tobytes())


def name_of(key: TimelineKey, path: BeliefPath) -> str:
    """Return the page's name of a node of a timeline."""
    return " ".join((path_text(key.path), path_text(path), key.branch))


def _told(look: Sighting | None) -> list[Any] | None:
    if look is None:
        return None
    distance = None if look.distance is None else round(look.distance, 1)
    blocker = None if look.blocker is None else [*look.blocker, look.blocker_name]
    return [look.view.value, distance, blocker]


def _agent(reader: Reader, number: int) -> str:
    if not 0 <= number < len(reader.agents):
        raise PathError(f"no agent number {number}; there are {', '.join(reader.agents)}")
    return reader.agents[number]


def _place(reader: Reader, cell: int) -> Position:
    if not 0 <= cell < reader.history.context.cells:
        raise InputError(f"no cell {cell}; the box has {reader.history.context.cells}")
    return place_of(reader.history.context.box, cell)
