"""Stages: tables of a map for a planner, in all alternatives of a doubt.

Cells are positions of feet. A set of alternatives is a number whose bit `a` is set if it contains
alternative `a`.
"""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from beliefnest.world.values import Position

SIDES = ((1, 0), (0, 1), (-1, 0), (0, -1))
"""Steps to the four neighbours: change of x and z."""

DIAGONALS = ((1, 1), (-1, 1), (-1, -1), (1, -1))

Masks = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Stage:
    """Reachable cells, with the actions and percepts that are possible there.

    Attributes:
        cells: The cells.
        moves: int32 (alternatives, cells, steps), cell that each step leads to; the cell itself
            where there is none.
        doors: bool (alternatives, cells, steps), whether a step opens a door, which is an act of
            its own.
        same: int64 (alternatives, cells), the alternatives with the same percept, looking all
            round from the middle of the cell.
        acts: bool (alternatives, goals, cells), whether a goal can be acted on.
        marked: bool (goals,), whether acting on a goal is an event that a witness perceives.
        boxes: Containers whose contents are in doubt.
        reach: bool (containers, cells), whether an agent can open one.
        content: int64 (containers, alternatives), the alternatives with the same content.
    """

    cells: tuple[Position, ...]
    moves: npt.NDArray[np.int32]
    doors: npt.NDArray[np.bool_]
    same: Masks
    acts: npt.NDArray[np.bool_]
    marked: npt.NDArray[np.bool_]
    boxes: tuple[Position, ...]
    reach: npt.NDArray[np.bool_]
    content: Masks

    @cached_property
    def index(self) -> Mapping[Position, int]:
        """Number of each cell."""
        return {cell: number for number, cell in enumerate(self.cells)}

    @cached_property
    def box_index(self) -> Mapping[Position, int]:
        """Number of each container in doubt."""
        return {place: number for number, place in enumerate(self.boxes)}

    @cached_property
    def key(self) -> bytes:
        """Digest of all that it contains."""
        digest = hashlib.blake2b(repr((self.cells, self.boxes)).encode())
        for table in (
            self.moves,
            self.doors,
            self.same,
            self.acts,
            self.marked,
            self.reach,
            self.content,
        ):
            digest.update(repr(table.shape).encode())
            digest.update(np.ascontiguousarray(table).tobytes())
        return digest.digest()


def numbers_in(mask: int) -> list[int]:
    """Return the numbers of the bits that are set."""
    return [bit for bit in range(mask.bit_length()) if mask >> bit & 1]


def shortest(stage: Stage, actual: int, start: Position, end: Position) -> int | None:
    """Return the number of steps from one cell to another in an alternative; None: no way."""
    if start not in stage.index or end not in stage.index:
        return None
    goal, front, steps = stage.index[end], [stage.index[start]], 0
    seen = set(front)
    while front:
        if goal in front:
            return steps
        reached = set(stage.moves[actual, front].reshape(-1).tolist()) - seen
        seen |= reached
        front, steps = list(reached), steps + 1
    return None
