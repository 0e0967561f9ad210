"""Stretches of timelines in columns, with their poses, as the belief kernel reads them."""

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from beliefnest.belief.arrays import (
    KIND_ACT,
    KIND_CHAT,
    KIND_THINK,
    KIND_UPDATE,
    NOBODY,
    UNKNOWN,
    Facts,
    Ints,
    Poses,
)
from beliefnest.world.frames import Frame
from beliefnest.world.values import AgentState, Box, Event, EventKind, Items, Point, Position

__all__ = ["Columns", "Looks", "SavedVersions", "Versions", "cell_of", "place_of"]

_KINDS = {
    EventKind.CHAT: KIND_CHAT,
    EventKind.THINK: KIND_THINK,
    EventKind.BLOCK_UPDATE: KIND_UPDATE,
}


def cell_of(box: Box, place: Position) -> int:
    """Flat cell of a block position of a box."""
    _, ny, nz = box.shape
    i, j, k = box.index(place)
    return (i * ny + j) * nz + k


def place_of(box: Box, cell: int) -> Position:
    """Block position of a flat cell of a box."""
    _, ny, nz = box.shape
    x, y, z = box.low
    return (x + cell // (ny * nz), y + cell // nz % ny, z + cell % nz)


class _Column:
    """A growing array of rows; new rows wait in a list until the array is looked at."""

    def __init__(self, dtype: npt.DTypeLike, width: int = 0) -> None:
        shape = (64, width) if width else (64,)
        self._rows: npt.NDArray[Any] = np.zeros(shape, dtype=dtype)
        self._filled = 0
        self._waiting: list[Any] = []
        self.append = self._waiting.append

    def __len__(self) -> int:
        return self._filled + len(self._waiting)

    def extend(self, rows: Iterable[Any]) -> None:
        """Add rows."""
        self._waiting.extend(rows)

    def view(self) -> npt.NDArray[Any]:
        """The rows so far."""
        count = len(self)
        if count > self._filled:
            if count > len(self._rows):
                size = (max(count, 2 * len(self._rows)), *self._rows.shape[1:])
                grown = np.zeros(size, dtype=self._rows.dtype)
                grown[: self._filled] = self._rows[: self._filled]
                self._rows = grown
            self._rows[self._filled : count] = self._waiting
            self._waiting.clear()
            self._filled = count
        return self._rows[:count]


@dataclass(frozen=True, slots=True)
class Looks:
    """What goes with a pose: footing, equipment, and what only the agent itself perceives."""

    on_ground: bool
    equipment: Mapping[str, str]
    inventory: Items
    health: float
    food: float


class Versions:
    """Poses and what goes with them, numbered as they came: those that one stretch needs."""

    def __init__(self) -> None:
        self._feet = _Column(np.float64, 3)
        self._angles = _Column(np.float64, 2)
        self._looks = _Column(np.int32)
        self._told = _Column(np.bool_)
        self._table: list[Looks | None] = [None]
        self._last: dict[str, int] = {}

    def __len__(self) -> int:
        return len(self._feet)

    def add(self, name: str, agent: AgentState) -> int:
        """Number of a new version of an agent, told by the timeline itself."""
        looks = Looks(agent.on_ground, agent.equipment, agent.inventory, agent.health, agent.food)
        last = self._last.get(name, 0)
        if self._table[last] != looks:
            self._table.append(looks)
            last = self._last[name] = len(self._table) - 1
        return self._add(agent.position, agent.yaw, agent.pitch, last, told=True)

    def add_pose(self, position: Point, yaw: float, pitch: float) -> int:
        """Number of a pose that nobody was seen in."""
        return self._add(position, yaw, pitch, 0, told=False)

    def take(self, other: "Versions", numbers: Ints, *, told: bool = True) -> Ints:
        """Numbers here of versions of another table.

        Args:
            other: The other table.
            numbers: Their numbers there.
            told: Whether what its timeline told is told by the timeline of this table.
        """
        table = {0: 0}
        first = len(self)
        feet, angles = other._feet.view()[numbers], other._angles.view()[numbers]
        looks, was_told = other._looks.view()[numbers], other._told.view()[numbers]
        for number in np.unique(looks).tolist():
            if number not in table:
                table[number] = len(self._table)
                self._table.append(other._table[number])
        self._feet.extend(feet)
        self._angles.extend(angles)
        self._looks.extend([table[number] for number in looks.tolist()])
        self._told.extend(was_told & told)
        return np.arange(first, len(self), dtype=np.int32)

    def position(self, version: int) -> Point:
        """Feet of a version."""
        x, y, z = self._feet.view()[version].tolist()
        return (x, y, z)

    def angles(self, version: int) -> tuple[float, float]:
        """Yaw and pitch of a version."""
        yaw, pitch = self._angles.view()[version].tolist()
        return yaw, pitch

    def looks(self, version: int) -> Looks | None:
        """What goes with a version; None for a pose that nobody was seen in."""
        return self._table[int(self._looks.view()[version])]

    def is_told(self, version: int) -> bool:
        """Whether the timeline told a version, so that it is not only believed since a fork."""
        return bool(self._told.view()[version])

    def poses(self) -> Poses:
        """The table for the kernel."""
        return Poses(self._feet.view(), self._angles.view())

    def saved(self) -> "SavedVersions":
        """All versions as plain data."""
        return SavedVersions(
            self._feet.view().tobytes(),
            self._angles.view().tobytes(),
            self._looks.view().tobytes(),
            self._told.view().tobytes(),
            self._table,
        )

    @classmethod
    def restored(cls, saved: "SavedVersions") -> "Versions":
        """The table that was saved."""
        versions = cls()
        versions._feet.extend(np.frombuffer(saved.feet, np.float64).reshape(-1, 3))
        versions._angles.extend(np.frombuffer(saved.angles, np.float64).reshape(-1, 2))
        versions._looks.extend(np.frombuffer(saved.looks, np.int32))
        versions._told.extend(np.frombuffer(saved.told, np.bool_))
        versions._table = list(saved.table)
        return versions

    def _add(self, position: Point, yaw: float, pitch: float, looks: int, *, told: bool) -> int:
        self._feet.append(position)
        self._angles.append((yaw, pitch))
        self._looks.append(looks)
        self._told.append(told)
        return len(self._feet) - 1


@dataclass(frozen=True, slots=True)
class SavedVersions:
    """A table of versions as plain data: rows of `Versions` as native bytes, and their looks."""

    feet: bytes
    angles: bytes
    looks: bytes
    told: bytes
    table: list[Looks | None]


class Columns:
    """A stretch of one timeline's entries in columns; all numbers are those of the timeline.

    Args:
        box: The part of space covered.
        agents: All agents, in the order in which arrays count them.
        holds: By block state, and at the end for unknown, whether it is a container.
        first: Number of the first entry of the stretch.
        first_event: How many events lie before it.

    Attributes:
        first: Number of the first entry.
        versions: Poses of its agents.
        frames: By entry, the frames that carry contents, dropped items or arrivals that
            the kernel knows nothing of.
        events: The stretch's events, in order.
        acts: By entry, the numbers of its events that are deeds.
        held: Cells where a container came or went, in order, possibly again.
        item_entries: Entries with dropped items, rising.
        act_entries: Entries with deeds, rising.
    """

    def __init__(
        self,
        box: Box,
        agents: Sequence[str],
        holds: npt.NDArray[np.bool_],
        first: int = 0,
        first_event: int = 0,
    ) -> None:
        self._box = box
        self._holds = holds
        self.first = first
        self._first_event = first_event
        self.versions = Versions()
        self.held: list[int] = []
        self.item_entries: list[int] = []
        self.act_entries: list[int] = []
        self._effects: list[int] = []
        self._numbers = {name: number for number, name in enumerate(agents)}
        self.frames: dict[int, Frame] = {}
        self.events: list[Event] = []
        self.acts: dict[int, list[int]] = {}
        self._tick = _Column(np.int32)
        self._pose_at, self._block_at, self._event_at = (_Column(np.int32) for _ in range(3))
        self._pose = [_Column(np.int32) for _ in range(2)]
        self._block = [_Column(np.int32) for _ in range(2)]
        self._event = [_Column(np.int32) for _ in range(4)]
        self._close_entry()

    @property
    def end(self) -> int:
        """Number of the entry after the last one."""
        return self.first + len(self._tick)

    def extend(self, frames: Iterable[Frame]) -> None:
        """Add frames."""
        for frame in frames:
            self._add(frame)

    def add_quiet(self, tick: int) -> None:
        """Add an entry in which nothing happens by itself."""
        self._tick.append(tick)
        self._close_entry()

    def tick(self, entry: int) -> int:
        """Tick of an entry."""
        return int(self._tick.view()[entry - self.first])

    def events_until(self, entry: int) -> int:
        """How many of the timeline's events lie before an entry."""
        return self._first_event + int(self._event_at.view()[entry - self.first])

    def event(self, number: int) -> Event:
        """An event of the stretch."""
        return self.events[number - self._first_event]

    def told_since(self, entry: int) -> Iterator[tuple[int, Event]]:
        """Events from an entry of the stretch on, each with its tick."""
        at, tick = self._event_at.view(), self._tick.view()
        for row in range(entry - self.first, len(tick)):
            for number in range(int(at[row]), int(at[row + 1])):
                yield int(tick[row]), self.events[number]

    def with_effects(self, start: int, stop: int) -> set[int]:
        """Entries start to stop - 1 that change contents, possessions or dropped items."""
        if stop - start == 1:
            return {start} if start in self.frames or start in self.acts else set()
        low, high = bisect_left(self._effects, start), bisect_left(self._effects, stop)
        return set(self._effects[low:high])

    def facts(self) -> Facts:
        """The columns for the kernel, which counts entries and events from the stretch's first."""
        agent, version = (column.view() for column in self._pose)
        block_cell, state = (column.view() for column in self._block)
        kind, actor, event_cell, event_to = (column.view() for column in self._event)
        return Facts(
            self._tick.view(),
            self._pose_at.view(),
            agent,
            version,
            self._block_at.view(),
            block_cell,
            state,
            self._event_at.view(),
            kind,
            actor,
            event_cell,
            event_to,
        )

    def _add(self, frame: Frame) -> None:
        entry = self.end
        if frame.containers or frame.items:
            self.frames[entry] = frame
        if frame.items:
            self.item_entries.append(entry)
        for name, agent in frame.agents.items():
            version = UNKNOWN if agent is None else self.versions.add(name, agent)
            self._pose[0].append(self._numbers[name])
            self._pose[1].append(version)
        for place, state in frame.blocks.items():
            cell = cell_of(self._box, place)
            self._block[0].append(cell)
            self._block[1].append(state)
            if self._holds[state]:
                self.held.append(cell)
        for event in frame.events:
            self._add_event(entry, event)
        if entry in self.frames or entry in self.acts:
            self._effects.append(entry)
        self._tick.append(frame.tick)
        self._close_entry()

    def _add_event(self, entry: int, event: Event) -> None:
        kind = _KINDS.get(event.kind, KIND_ACT)
        place = event.detail.get("position")
        if kind == KIND_ACT:
            if entry not in self.acts:
                self.act_entries.append(entry)
            number = self._first_event + len(self.events)
            self.acts.setdefault(entry, []).append(number)
        self._event[0].append(kind)
        self._event[1].append(NOBODY if event.actor is None else self._numbers[event.actor])
        self._event[2].append(
            cell_of(self._box, place) if kind == KIND_UPDATE and place is not None else UNKNOWN
        )
        to = event.detail.get("to") if kind == KIND_CHAT else None
        self._event[3].append(NOBODY if to is None else self._numbers[to])
        self.events.append(event)

    def _close_entry(self) -> None:
        self._pose_at.append(len(self._pose[0]))
        self._block_at.append(len(self._block[0]))
        self._event_at.append(len(self._event[0]))
