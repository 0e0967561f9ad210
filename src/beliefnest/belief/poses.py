"""Table of agents' poses with their details, which the belief kernel reads."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt
from msgspec.structs import replace

from beliefnest.belief.arrays import NOBODY, Poses
from beliefnest.world.array_types import Ints
from beliefnest.world.values import AgentState, Items, Point


class Growing:
    """Array that grows by rows. New rows wait in a list until the array is read."""

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

    def extend_by(self, body: bytes) -> None:
        """Add rows from native bytes."""
        self.extend(np.frombuffer(body, self._rows.dtype).reshape(-1, *self._rows.shape[1:]))

    def view(self) -> npt.NDArray[Any]:
        """Return all rows added so far."""
        if self._waiting:
            count = len(self)
            if count > len(self._rows):
                size = (max(count, 2 * len(self._rows)), *self._rows.shape[1:])
                grown = np.zeros(size, dtype=self._rows.dtype)
                grown[: self._filled] = self._rows[: self._filled]
                self._rows = grown
            self._rows[self._filled : count] = self._waiting
            self._waiting.clear()
            self._filled = count
        return self._rows[: self._filled]


class PoseDetails(msgspec.Struct, frozen=True):
    """Footing and equipment of an agent in a pose, with facts that only the agent perceives.

    The attributes have the meaning of those of `AgentState`.
    """

    on_ground: bool
    equipment: Mapping[str, str]
    inventory: Items
    health: float
    food: float

    def are_of(self, agent: AgentState) -> bool:
        """Return True if they are the details of an agent; faster than a comparison of two."""
        return (
            self.on_ground == agent.on_ground
            and self.equipment == agent.equipment
            and self.inventory == agent.inventory
            and self.health == agent.health
            and self.food == agent.food
        )


class PoseTable:
    """Poses and their details, for one stretch of a timeline. The id of a pose is its row."""

    def __init__(self) -> None:
        self._feet = Growing(np.float64, 3)
        self._angles = Growing(np.float64, 2)
        self._details = Growing(np.int32)
        self._recorded = Growing(np.bool_)
        self._heard = Growing(np.int32)
        # Same order as the fields of `SavedPoses`.
        self._columns = (self._feet, self._angles, self._details, self._recorded, self._heard)
        self._table: list[PoseDetails | None] = [None]
        self._last: dict[str, int] = {}

    def __len__(self) -> int:
        return len(self._feet)

    def add(self, name: str, agent: AgentState) -> int:
        """Add a pose of an agent that the timeline itself recorded, and return its id."""
        last = self._last.get(name, 0)
        latest = self._table[last]
        if latest is None or not latest.are_of(agent):
            facts = (agent.on_ground, agent.equipment, agent.inventory, agent.health, agent.food)
            self._table.append(PoseDetails(*facts))
            last = self._last[name] = len(self._table) - 1
        return self._append(agent.position, agent.yaw, agent.pitch, last, recorded=True)

    def add_pose(self, position: Point, yaw: float, pitch: float, speaker: int = NOBODY) -> int:
        """Add a pose in which nobody was seen, and return its id.

        Args:
            position: Feet, scenario coordinates.
            yaw: Radians.
            pitch: Radians.
            speaker: Number of the agent that claimed the pose; `NOBODY`: it is no hearsay.
        """
        return self._append(position, yaw, pitch, 0, speaker, recorded=False)

    def without(self, pose: int, item: str) -> int:
        """Add a copy of a pose without an item in its equipment, and return its id."""
        details = self.details(pose)
        if details is None:
            raise AssertionError("nobody was seen in this pose")
        worn = {slot: name for slot, name in details.equipment.items() if name != item}
        self._table.append(replace(details, equipment=worn))
        yaw, pitch = self.angles(pose)
        recorded, last = self.is_recorded(pose), len(self._table) - 1
        return self._append(self.position(pose), yaw, pitch, last, recorded=recorded)

    def take(self, other: "PoseTable", numbers: Ints, *, recorded: bool = True) -> Ints:
        """Copy poses of another table, and return their ids in this one.

        Args:
            other: The other table.
            numbers: Ids of the poses in the other table.
            recorded: True if poses that the other's timeline recorded count as recorded by this
                one's.
        """
        table = {0: 0}
        first = len(self)
        feet, angles, details, was_recorded, heard = (
            column.view()[numbers] for column in other._columns
        )
        for number in np.unique(details).tolist():
            if number not in table:
                table[number] = len(self._table)
                self._table.append(other._table[number])
        renumbered = [table[number] for number in details.tolist()]
        taken: Sequence[Iterable[Any]] = (feet, angles, renumbered, was_recorded & recorded, heard)
        for column, rows in zip(self._columns, taken, strict=True):
            column.extend(rows)
        return np.arange(first, len(self), dtype=np.int32)

    def position(self, pose: int) -> Point:
        """Return the feet position of a pose."""
        x, y, z = self._feet.view()[pose].tolist()
        return (x, y, z)

    def angles(self, pose: int) -> tuple[float, float]:
        """Return the yaw and pitch of a pose."""
        yaw, pitch = self._angles.view()[pose].tolist()
        return yaw, pitch

    def details(self, pose: int) -> PoseDetails | None:
        """Return the details of a pose; None if it is unknown, or nobody was seen in it."""
        return None if pose < 0 else self._table[int(self._details.view()[pose])]

    def is_recorded(self, pose: int) -> bool:
        """Return True if the timeline recorded a pose. False: it was only believed at a fork."""
        return bool(self._recorded.view()[pose])

    def speaker(self, pose: int) -> int:
        """Return the number of the agent that claimed a pose; `NOBODY`: it is no hearsay."""
        return int(self._heard.view()[pose])

    def arrays(self) -> Poses:
        """Return the table for the kernel."""
        return Poses(self._feet.view(), self._angles.view())

    def saved(self) -> "SavedPoses":
        """Return the table as plain data."""
        feet, angles, details, recorded, heard = (
            column.view().tobytes() for column in self._columns
        )
        return SavedPoses(feet, angles, details, recorded, heard, self._table)

    @classmethod
    def restored(cls, saved: "SavedPoses") -> "PoseTable":
        """Return a saved table."""
        restored = cls()
        bodies = (saved.feet, saved.angles, saved.details, saved.recorded, saved.heard)
        for column, body in zip(restored._columns, bodies, strict=True):
            column.extend_by(body)
        restored._table = list(saved.table)
        return restored

    def _append(
        self,
        position: Point,
        yaw: float,
        pitch: float,
        details: int,
        speaker: int = NOBODY,
        *,
        recorded: bool,
    ) -> int:
        self._feet.append(position)
        self._angles.append((yaw, pitch))
        self._details.append(details)
        self._recorded.append(recorded)
        self._heard.append(speaker)
        return len(self._feet) - 1


class SavedPoses(msgspec.Struct, frozen=True):
    """Pose table as plain data: its columns as native bytes, and the details."""

    feet: bytes
    angles: bytes
    details: bytes
    recorded: bytes
    heard: bytes
    table: list[PoseDetails | None]
