"""Paths on foot in the scripted world: from one free cell to the next, one step a tick."""

import math
from collections.abc import Callable, Iterable
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from beliefnest.world.doors import is_doorway, is_open, moves_by_hand, passage
from beliefnest.world.frames import BlockGrid, places_of
from beliefnest.world.registry import AIR, Registry
from beliefnest.world.signs import is_sign
from beliefnest.world.values import EYE_HEIGHT, Box, Point, Position, feet_in

if TYPE_CHECKING:  # Compiled code takes its time to load.
    from beliefnest.worlds.scripted.footpath_kernels import Aim, Cells

__all__ = ["Goal", "Ground", "InReach", "Near"]

_MOST_CELLS = 100_000
_MARGIN = 2
_MOST_WAYS = 20_000
"""Largest number of paths that a ground caches."""
_MOST_STEPS = 8
"""Largest number of cells that one step leads to."""


@dataclass(frozen=True, slots=True)
class Near:
    """Goal of standing within a distance of a block.

    Attributes:
        block: Position of the block.
        within: Largest distance between the block's cell and the agent's.
    """

    block: Position
    within: float

    def is_met(self, cell: Position) -> bool:
        """Return True if a cell meets the goal."""
        return math.dist(cell, self.block) <= self.within


@dataclass(frozen=True, slots=True)
class InReach:
    """Goal of standing where a hand reaches a block.

    Attributes:
        block: Position of the block.
        reach: Largest distance between the eyes and the block's middle.
        beside: True if feet and head must be outside the block.
        has_free_line: Function of eyes and a block that returns whether the line between them is
            free; None if lines are always free.
    """

    block: Position
    reach: float
    beside: bool = False
    has_free_line: Callable[[Point, Position], bool] | None = None

    def is_met(self, cell: Position) -> bool:
        """Return True if a block can be reached from a cell."""
        if self.beside and self._is_within(cell):
            return False
        x, y, z = feet_in(cell)
        eye = (x, y + EYE_HEIGHT, z)
        middle = (self.block[0] + 0.5, self.block[1] + 0.5, self.block[2] + 0.5)
        if math.dist(eye, middle) > self.reach:
            return False
        return self.has_free_line is None or self.has_free_line(eye, self.block)

    def _is_within(self, cell: Position) -> bool:
        x, y, z = self.block
        return cell in ((x, y, z), (x, y - 1, z))


Goal = Near | InReach
"""Goal of a path."""


class Ground:
    """Cells in which agents can stand: two free cells above one another, with a solid one below.

    Unknown cells count as free to walk through and solid to stand on. Open doors and gates are
    free, but can only be crossed straight. `footpath_kernels` has the rules of steps.

    Args:
        registry: Shapes of blocks.
        box: The known part of space.
        blocks: Block state ids, -1 is unknown.
        opens: True if doors and gates that can be opened by hand count as open.

    Attributes:
        has_doors: True if there is a door or gate.
        has_doorways: True if there is a door or gate that is open or counts as open.
    """

    def __init__(
        self, registry: Registry, box: Box, blocks: BlockGrid, *, opens: bool = False
    ) -> None:
        self._registry, self._box, self._blocks, self._opens = registry, box, blocks, opens
        # Counting is faster than sorting, as `np.unique` does.
        states = np.flatnonzero(np.bincount(blocks.ravel() + 1)) - 1
        doorways = [s for s in states.tolist() if s >= 0 and is_doorway(registry.name(s))]
        ways = {s: passage(registry, s) for s in doorways if self._is_way(s)}
        self.has_doors, self.has_doorways = bool(doorways), bool(ways)
        self._has_shut_doors = any(
            moves_by_hand(registry.name(s)) for s in doorways if s not in ways
        )
        is_free = np.zeros(int(states[-1]) + 2, dtype=np.bool_)
        is_free[states + 1] = [s < 0 or s in ways or not registry.boxes(s) for s in states.tolist()]
        free = is_free[blocks + 1]
        # Add a margin, so that every neighbour of a cell has an index; above the box is air.
        passing, holding = _widened(free), _widened((blocks < 0) | ~free)
        passing[1:-1, _MARGIN + blocks.shape[1], 1:-1] = True
        standing = np.zeros_like(passing)
        standing[:, 1:-1] = holding[:, :-2] & passing[:, 1:-1] & passing[:, 2:]
        self._passing, self._standing = passing, standing
        self._stands = standing.tobytes()
        self._count = int(np.count_nonzero(standing))
        self._doors = places_of(np.isin(blocks, list(ways)), box) if ways else ()
        self._directions = ways
        self._corner = (box.low[0] - 1, box.low[1] - _MARGIN, box.low[2] - 1)
        width, height, depth = passing.shape
        self._shape = (int(width), int(height), int(depth))
        self._ways: dict[tuple[Position, Goal], tuple[Position, ...] | None] = {}
        self._areas: list[npt.NDArray[np.bool_]] = []
        self._met: dict[tuple[int, Goal], bool] = {}
        self._leads: dict[tuple[Position, Goal], bool] = {}

    def stands(self, cell: Position) -> bool:
        """Return True if an agent can stand in a cell."""
        index = self._index(cell)
        return index is not None and self._stands[index] != 0

    def may_hold(self, place: Position) -> bool:
        """Return True if a position has a container or is unknown."""
        if place not in self._box:
            return False
        state = int(self._blocks[self._box.index(place)])
        return state < 0 or self._registry.is_container(self._registry.name(state))

    def is_sign(self, place: Position) -> bool | None:
        """Return True if there is a sign at a position; None if the position is unknown."""
        state = int(self._blocks[self._box.index(place)]) if place in self._box else AIR
        return None if state < 0 else is_sign(self._registry.name(state))

    @cached_property
    def with_doors_opened(self) -> "Ground":
        """Return the same ground for agents that open doors and gates by hand."""
        if not self._has_shut_doors:
            return self
        return Ground(self._registry, self._box, self._blocks, opens=True)

    def way(
        self, start: Position, goal: Goal, avoiding: AbstractSet[Position] = frozenset()
    ) -> tuple[Position, ...] | None:
        """Return the shortest path on foot; among several always the same one.

        Paths are cached if no cells are to be avoided.

        Args:
            start: Cell in which the agent stands.
            goal: Goal of the path.
            avoiding: Cells that the path must not contain.

        Returns:
            The cells after `start`, in order; None if there is no path.
        """
        # Do not cache by what an agent knows of free lines: it changes, and does not belong to the
        # ground.
        if avoiding or (isinstance(goal, InReach) and goal.has_free_line is not None):
            return self._found_way(start, goal, avoiding)
        wanted = (start, goal)
        if wanted not in self._ways:
            if len(self._ways) >= _MOST_WAYS:
                self._ways.clear()
            number = self._first_area(start)
            if number is not None and not self.may_lead(start, goal):
                self._ways[wanted] = None
            else:
                self._ways[wanted] = found = self._found_way(start, goal)
                if found is None and number is None:
                    # Remember the area, so that the next search there need not explore all of it.
                    self._add_area(start)
        return self._ways[wanted]

    def may_lead(self, start: Position, goal: Goal) -> bool:
        """Return True if a path to a goal may exist; False if none does.

        An area is the set of all cells that can be reached from one cell. A path exists only if
        some cell in the area of `start` meets the goal.
        """
        asked = (start, goal)
        known = self._leads.get(asked)
        if known is None:
            if len(self._leads) >= _MOST_WAYS:
                self._leads.clear()
            known = self._leads[asked] = self._leads_there(start, goal)
        return known

    def _leads_there(self, start: Position, goal: Goal) -> bool:
        from beliefnest.worlds.scripted.footpath_kernels import holds_target

        if self._index(start) is None:
            return goal.is_met(start)
        number = self._first_area(start)
        if number is None:
            number = self._add_area(start)
        asked = (number, goal)
        if asked not in self._met:
            self._met[asked] = holds_target(self._cells, self._aim(goal), self._areas[number])
        return self._met[asked]

    @cached_property
    def _cells(self) -> "Cells":
        from beliefnest.worlds.scripted.footpath_kernels import ALONG_X, ALONG_Z, Cells

        doorways = np.zeros(self._passing.size, dtype=np.uint8)
        for place, at in self._doors:
            direction = self._directions[int(self._blocks[at])]
            doorways[self._index(place)] = ALONG_X if direction == (1, 0) else ALONG_Z
        standing, passing = (
            each.ravel().view(np.uint8) for each in (self._standing, self._passing)
        )
        return Cells(standing, passing, doorways, self._shape)

    def _found_way(
        self, start: Position, goal: Goal, avoiding: Iterable[Position] = ()
    ) -> tuple[Position, ...] | None:
        """Search for a path; see `way`."""
        from beliefnest.worlds.scripted.footpath_kernels import AVOIDED

        first = self._index(start)
        if first is None:
            return () if goal.is_met(start) else None
        search = _Search(self._cells, first, self._count)
        for index in map(self._index, avoiding):
            if index is not None:
                search.trail.marks[index] = AVOIDED
        has_free_line = isinstance(goal, InReach) and goal.has_free_line is not None
        aim = self._aim(goal)
        while (end := search.next(aim)) is not None:
            if not has_free_line or goal.is_met(self._cell(end)):
                return self._traced(search.trail.came, end)
        return None

    def _traced(self, came: npt.NDArray[np.int32], end: int) -> tuple[Position, ...]:
        way, at = [], end
        while (before := int(came[at])) > 0:
            way.append(self._cell(at))
            at = before - 1
        return tuple(way[::-1])

    def _aim(self, goal: Goal) -> "Aim":
        from beliefnest.worlds.scripted.footpath_kernels import Aim

        x, y, z = (a - b for a, b in zip(goal.block, self._corner, strict=True))
        if isinstance(goal, Near):
            return Aim(x, y, z, float(goal.within), False, False)
        return Aim(x, y, z, float(goal.reach), True, goal.beside)

    def _first_area(self, start: Position) -> int | None:
        """Return the number of the first known area that contains a cell; None: there is none."""
        index = self._index(start)
        if index is None:
            return None
        return next((n for n, area in enumerate(self._areas) if area[index]), None)

    def _add_area(self, start: Position) -> int:
        """Add the area of all cells that can be reached from a cell; return its number."""
        from beliefnest.worlds.scripted.footpath_kernels import NOWHERE

        index = self._index(start)
        if index is None:
            self._areas.append(np.zeros(self._passing.size, dtype=np.bool_))
        else:
            search = _Search(self._cells, index, self._count)
            search.next(NOWHERE)
            self._areas.append(search.trail.came != 0)
        return len(self._areas) - 1

    def _index(self, cell: Position) -> int | None:
        """Return the flat index of a cell; None: it is outside the grid and its margin."""
        x, y, z = cell[0] - self._corner[0], cell[1] - self._corner[1], cell[2] - self._corner[2]
        width, height, depth = self._shape
        inside = 0 <= x < width and 0 <= y < height and 0 <= z < depth
        return (x * height + y) * depth + z if inside else None

    def _cell(self, index: int) -> Position:
        _, height, depth = self._shape
        x, y, z = self._corner
        return (x + index // (height * depth), y + index // depth % height, z + index % depth)

    def _is_way(self, state: int) -> bool:
        """Return True if a door or gate can be crossed."""
        by_hand = self._opens and moves_by_hand(self._registry.name(state))
        return by_hand or is_open(self._registry, state) is True


class _Search:
    """A* from one cell, which finds one goal cell after the other.

    Args:
        cells: Cells of the ground.
        first: Flat index of the first cell.
        count: Number of cells in which agents can stand.

    Attributes:
        trail: Cells found so far.
    """

    def __init__(self, cells: "Cells", first: int, count: int) -> None:
        from beliefnest.worlds.scripted.footpath_kernels import Queue, Trail

        size, room = len(cells.passing), _MOST_STEPS * min(count + 1, _MOST_CELLS) + 1
        self._cells = cells
        # Memory of `zeros` is not touched before it is needed.
        came, marks = np.zeros(size, dtype=np.int32), np.zeros(size, dtype=np.uint8)
        self.trail = Trail(came, np.empty(size), marks)
        orders, waiting = np.empty((2, room), dtype=np.int32)
        self._queue = Queue(np.empty(room), orders, waiting, np.array([1, 0, 0, -1]))
        self._found = np.empty(_MOST_STEPS, dtype=np.int32)
        came[first], self.trail.costs[first] = -1, 0.0
        self._queue.keys[0], orders[0], waiting[0] = 0.0, 0, first

    def next(self, aim: "Aim") -> int | None:
        """Return the next cell that meets an aim, the same in each call; None: there is none."""
        from beliefnest.worlds.scripted.footpath_kernels import find

        end = find(self._cells, aim, self.trail, self._queue, self._found, _MOST_CELLS)
        return None if end < 0 else end


def _widened(flags: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    wide: npt.NDArray[np.bool_] = np.pad(flags, ((1, 1), (_MARGIN, _MARGIN), (1, 1)))
    return wide
