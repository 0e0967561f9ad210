"""What a picture shows: values, read from a nest, that know nothing of pixels."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
import numpy.typing as npt

from beliefnest.belief.view import State
from beliefnest.nest.face.nest import Nest, Past
from beliefnest.timeline.journal import Journal
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.values import EventKind, Point, Position

__all__ = [
    "Caption",
    "Floor",
    "Ghost",
    "HasPast",
    "Person",
    "Row",
    "Scene",
    "View",
    "decisive_tick",
    "read_scene",
    "read_trails",
]

_SILENT = frozenset(
    {EventKind.CHAT, EventKind.THINK, EventKind.MOVE_TO, EventKind.EMOTE, EventKind.BLOCK_UPDATE}
)


@dataclass(frozen=True, slots=True)
class Person:
    """An agent as it stands in the real world.

    Attributes:
        name: Its name.
        position: Middle of its feet.
        yaw: Radians, 0 looks along -z, pi/2 along -x.
        holds: Item in its main hand; None: nothing.
        trail: Where its feet were before, oldest first.
        acts: Whether it is the one who acts at this moment.
    """

    name: str
    position: Point
    yaw: float
    holds: str | None
    trail: tuple[Point, ...]
    acts: bool


@dataclass(frozen=True, slots=True)
class Ghost:
    """An agent where somebody wrongly believes it to be.

    Attributes:
        name: The agent.
        position: Where it was last seen.
        believer: Who saw it there.
    """

    name: str
    position: Point
    believer: str


@dataclass(frozen=True)
class View:
    """What an agent can see at this moment.

    Attributes:
        name: The agent.
        seen: bool (size along x, size along z): the blocks at the height of the picture.
    """

    name: str
    seen: npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Floor:
    """The ground plan.

    Attributes:
        low: x and z of the first column.
        ground: Block names (x, z) below the height of the picture.
        standing: Block names (x, z) at that height; `air` where there is none.
    """

    low: tuple[int, int]
    ground: tuple[tuple[str, ...], ...]
    standing: tuple[tuple[str, ...], ...]

    @property
    def size(self) -> tuple[int, int]:
        """Number of columns along x and z."""
        return len(self.standing), len(self.standing[0])


@dataclass(frozen=True, slots=True)
class Row:
    """What one simulator holds.

    Attributes:
        label: Whose belief it is, for people.
        path: Its belief path.
        contents: Position to known items; None: nothing is known of it.
        complete: The containers whose known items are known to be all.
        ok: Whether it is as expected; None: nothing was expected.
        notes: What else it holds that matters, as where somebody is and what was heard.
    """

    label: str
    path: str
    contents: Mapping[Position, Mapping[str, int] | None]
    complete: frozenset[Position]
    ok: bool | None
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Caption:
    """The words on a picture.

    Attributes:
        title: What it is.
        subtitle: What is special about it.
        moment: What happens at this moment.
        verdicts: What came of it, each with whether it is as expected.
        story: What has happened, in order.
    """

    title: str
    subtitle: str = ""
    moment: str = ""
    verdicts: tuple[tuple[str, bool | None], ...] = ()
    story: tuple[str, ...] = ()


@dataclass(frozen=True)
class Scene:
    """One moment of the real world, and what everybody makes of it."""

    caption: Caption
    floor: Floor
    containers: Mapping[Position, Mapping[str, int]]
    labels: Mapping[Position, str]
    people: tuple[Person, ...]
    views: tuple[View, ...]
    ghosts: tuple[Ghost, ...] = ()
    rows: tuple[Row, ...] = field(default_factory=tuple)


def decisive_tick(nest: Nest) -> int:
    """The tick of the last deed in the real world other than speech and walking."""
    deeds = [event.tick for event in nest["/"].state.events if event.kind not in _SILENT]
    return deeds[-1] if deeds else nest.tick


class HasPast(Protocol):
    """A nest, live or recorded."""

    def at(self, tick: int) -> Past:
        """All simulators at a tick."""


def read_scene(
    nest: HasPast,
    tick: int,
    caption: Caption,
    labels: Mapping[Position, str],
    viewers: Iterable[str],
    rows: Iterable[Row],
    trails: Mapping[str, tuple[Point, ...]],
) -> Scene:
    """The scene at a tick of the real world.

    Args:
        nest: Where to read.
        tick: The moment.
        caption: The words.
        labels: What people call the containers.
        viewers: Agents whose sight is shown, the outermost believer first.
        rows: What simulators hold.
        trails: Where agents were before.
    """
    names = list(dict.fromkeys(viewers))
    past = nest.at(tick=tick)["/"]
    state = past.state
    registry = Registry.load()
    height = _height(state)
    layer = height - state.box.low[1]
    return Scene(
        caption=caption,
        floor=_floor(state, height, registry),
        containers={place: held.items for place, held in state.containers.items()},
        labels=labels,
        people=_people(state, trails, tick),
        views=tuple(View(name, past.visible_blocks(name)[:, layer, :]) for name in names),
        ghosts=_ghosts(nest, tick, state, names),
        rows=tuple(rows),
    )


def _height(state: State) -> int:
    """The block height at which most containers, or else agents' feet, are."""
    heights = [place[1] for place in state.containers] or [
        int(np.floor(agent.position[1]))
        for agent in state.agents.values()
        if agent.position is not None
    ]
    return max(sorted(set(heights)), key=heights.count)


def _floor(state: State, height: int, registry: Registry) -> Floor:
    (x0, y0, z0), (x1, _, z1) = state.box.low, state.box.high

    def name(x: int, y: int, z: int) -> str:
        text = state.blocks[x, y, z] if y >= y0 else None
        return "air" if text is None else registry.name(registry.state_id(text))

    def layer(y: int) -> tuple[tuple[str, ...], ...]:
        return tuple(tuple(name(x, y, z) for z in range(z0, z1 + 1)) for x in range(x0, x1 + 1))

    return Floor((x0, z0), layer(height - 1), layer(height))


def read_trails(journal: Journal, start: Snapshot, tick: int) -> dict[str, tuple[Point, ...]]:
    """Where the agents of the real world stood up to a tick, oldest first.

    Args:
        journal: The run's timelines.
        start: The first tick.
        tick: The last tick to read.
    """
    trails = {name: [agent.position] for name, agent in start.agents.items()}
    key = next(info.key for info in journal.timelines() if not info.key.path)
    for entry in journal.entries(key, 0, journal.entries_until(key, tick)):
        if isinstance(entry, Frame):
            for name, agent in entry.agents.items():
                if agent is not None:
                    trails.setdefault(name, []).append(agent.position)
    return {name: tuple(points) for name, points in trails.items()}


def _people(state: State, trails: Mapping[str, tuple[Point, ...]], tick: int) -> tuple[Person, ...]:
    acting = {e.actor for e in state.events if e.tick == tick and e.kind not in _SILENT}
    people = []
    for name, agent in state.agents.items():
        if agent.position is None:
            continue
        holds = (agent.equipment or {}).get("main_hand")
        trail = trails.get(name, ())
        people.append(Person(name, agent.position, agent.yaw, holds, trail, name in acting))
    return tuple(people)


def _ghosts(nest: HasPast, tick: int, state: State, viewers: list[str]) -> tuple[Ghost, ...]:
    """Where the first viewer believes the other viewers to be, if they are elsewhere."""
    if not viewers:
        return ()
    believer, *others = viewers
    believed = nest.at(tick=tick)[f"/{believer}"].state.agents
    ghosts = []
    for name in others:
        position = believed[name].position
        if position is not None and position != state.agents[name].position:
            ghosts.append(Ghost(name, position, believer))
    return tuple(ghosts)
