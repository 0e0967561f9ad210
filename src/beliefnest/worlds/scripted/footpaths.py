"""Paths on foot in the scripted world: from one free cell to the next, one step a tick."""

import math
from collections.abc import Iterable
from collections.abc import Set as AbstractSet
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
import numpy.typing as npt

from beliefnest.geometry.bodies import Doorways
from beliefnest.geometry.free_lines import can_touch, can_use, eye_in
from beliefnest.world.frames import BlockGrid
from beliefnest.world.registry import AIR, Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box, Point, Position, block_at, feet_in
from beliefnest.worlds.scripted.footing import Footing, WalkWindow

if TYPE_CHECKING:  # Compiled code takes its time to load.
    from beliefnest.worlds.scripted.footpath_kernels import PathAim, Trail

_MOST_CELLS = 100_000
_TOUCH = 1e-3
"""Height of feet above a block's face, in blocks, from which on they are on something there."""
_MOST_WAYS = 20_000
"""Largest number of paths that a ground caches."""


class Near(msgspec.Struct, frozen=True):
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


class InReach(msgspec.Struct, frozen=True):
    """Goal of standing where a hand is near enough to a block; `Ground.meets` tests free lines.

    Attributes:
        block: Position of the block.
        reach: Largest distance between the eyes and the block's middle.
        beside: True if feet and head must be outside the block.
    """

    block: Position
    reach: float
    beside: bool = False

    def is_met(self, cell: Position) -> bool:
        """Return True if a block is near enough to a cell."""
        x, y, z = self.block
        if self.beside and cell in ((x, y, z), (x, y - 1, z)):
            return False
        return math.dist(eye_in(cell), (x + 0.5, y + 0.5, z + 0.5)) <= self.reach


WalkGoal = Near | InReach
"""Goal of a path."""


class Ground:
    """Cells in which agents can stand, and paths between them; `geometry` has the rules.

    Unknown cells count as free to walk through and solid to stand on. In a large box cells are
    prepared only where paths lead, with the same paths.

    Args:
        registry: Shapes of blocks.
        box: The known part of space.
        blocks: Block states, -1 is unknown; of a dense grid all cells are prepared.
        doors: The doors and gates that count as doorways.

    Attributes:
        has_doors: True if there is a door or gate.
    """

    def __init__(
        self,
        registry: Registry,
        box: Box,
        blocks: Terrain | BlockGrid,
        doors: Doorways = Doorways.OPEN,
    ) -> None:
        self._registry, self._box = registry, box
        self._blocks = blocks if isinstance(blocks, Terrain) else Terrain.of_one(blocks)
        self._footing = Footing(registry, box, self._blocks, doors)
        self.has_doors = self._footing.has_doors
        states = self._blocks  # the cache does not hold its ground, which would live on
        self._has_line = lru_cache(_MOST_WAYS)(
            lambda cell, block: can_use(box, states, eye_in(cell), block)
        )
        self._ways: dict[tuple[Position, WalkGoal], tuple[Position, ...] | None] = {}
        self._areas: list[_Area] = []
        self._met: dict[tuple[int, WalkGoal], bool] = {}

    def stands(self, cell: Position) -> bool:
        """Return True if an agent can stand in a cell."""
        return self._footing.stands(cell)

    def feet(self, cell: Position) -> Point:
        """Return the place of the feet of an agent that stands in the middle of a cell."""
        x, y, z = feet_in(cell)
        return (x, y + self._footing.feet_height(cell), z)

    def cell_of(self, feet: Point) -> Position:
        """Return the cell of an agent; on a low block it is the one above the block."""
        x, y, z = block_at(feet)
        is_on_it = feet[1] - y > _TOUCH and self._footing.is_obstacle((x, y, z))
        return (x, y + is_on_it, z)

    def name_at(self, place: Position) -> str | None:
        """Return the name of the block at a position, air outside of the box; None if unknown."""
        state = int(self._blocks[self._box.index(place)]) if place in self._box else AIR
        return None if state < 0 else self._registry.name(state)

    @cached_property
    def with_doors_opened(self) -> "Ground":
        """Return the same ground for agents that open doors and gates by hand."""
        return self._with(Doorways.BY_HAND)

    @cached_property
    def without_doors(self) -> "Ground":
        """Return the same ground for agents that pass no door or gate with a leaf."""
        return self._with(Doorways.NONE)

    def _with(self, doors: Doorways) -> "Ground":
        if self._footing.is_same(doors):
            return self
        return Ground(self._registry, self._box, self._blocks, doors)

    def way(
        self, start: Position, goal: WalkGoal, avoiding: AbstractSet[Position] = frozenset()
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
        if avoiding:
            return self._found_way(start, goal, avoiding)
        wanted = (start, goal)
        if wanted not in self._ways:
            if len(self._ways) >= _MOST_WAYS:
                self._ways.clear()
            number = self._first_area(start)
            if number is not None and not self.may_lead(start, goal):
                self._ways[wanted] = None
            else:
                self._ways[wanted] = way = self._found_way(start, goal)
                if way is None and number is None and self._footing.window(start) is not None:
                    # Remember the area, so that the next search there need not explore all of it.
                    self._add_area(start)
        return self._ways[wanted]

    def may_lead(self, start: Position, goal: WalkGoal) -> bool:
        """Return True if a path to a goal may exist; False if none does.

        An area is the set of all cells that can be reached from one cell. A path exists only if
        some cell in an area with `start` meets the goal.
        """
        if self._footing.window(start) is None:
            return self.meets(goal, start)
        number = self._first_area(start)
        if number is None:
            number = self._add_area(start)
        area = self._areas[number]
        if not area.is_complete:
            return True
        asked = (number, goal)
        if asked not in self._met:
            self._met[asked] = self._is_met_in(area, goal)
        return self._met[asked]

    def _is_met_in(self, area: "_Area", goal: WalkGoal) -> bool:
        """Return True if a cell of an area meets a goal; a hand also needs a free line there."""
        from beliefnest.worlds.scripted.footpath_kernels import next_target

        window, cell = area.window, -1
        aim = _aim(goal, window)
        while (cell := next_target(window.cells, aim, area.cells, cell)) >= 0:
            if isinstance(goal, Near) or self._has_line(window.cell(cell), goal.block):
                return True
        return False

    def _found_way(
        self, start: Position, goal: WalkGoal, avoiding: Iterable[Position] = ()
    ) -> tuple[Position, ...] | None:
        """Search for a path; see `way`."""
        window = self._footing.window(start)
        if window is None:
            return () if self.meets(goal, start) else None
        search = _Search(self._footing, window, start, avoiding)
        while (end := search.next(goal)) is not None:
            if isinstance(goal, Near) or self._has_line(search.window.cell(end), goal.block):
                return search.way(end)
        return None

    def meets(self, goal: WalkGoal, cell: Position) -> bool:
        """Return True if a cell meets a goal; a hand also needs a free line to its block."""
        return goal.is_met(cell) and (isinstance(goal, Near) or self._has_line(cell, goal.block))

    def can_touch(self, eye: Point, block: Position) -> bool:
        """Return True if nothing solid lies between an eye and some point of a block."""
        return can_touch(self._box, self._blocks, eye, block)

    def _first_area(self, start: Position) -> int | None:
        """Return the number of the first known area that contains a cell; None: there is none."""
        for number, area in enumerate(self._areas):
            index = area.window.index(start)
            if index is not None and area.cells[index]:
                return number
        return None

    def _add_area(self, start: Position) -> int:
        """Add the area of all cells that can be reached from a cell; return its number."""
        window = self._footing.window(start)
        assert window is not None  # other cells have no paths
        search = _Search(self._footing, window, start)
        search.next(None)
        self._areas.append(_Area(search.window, search.found, search.is_complete))
        return len(self._areas) - 1


class _Area(msgspec.Struct, frozen=True, eq=False):
    """Cells that can be reached from one cell.

    Attributes:
        window: Window that contains them.
        cells: By index of the window, True for those of the area.
        is_complete: False if there may be more.
    """

    window: WalkWindow
    cells: npt.NDArray[np.bool_]
    is_complete: bool


class _Search:
    """A* from one cell, which finds one goal cell after the other.

    Args:
        footing: Cells of the ground.
        window: Window of the first cell; the search widens it as needed.
        start: The first cell.
        avoiding: Cells that paths must not contain.

    Attributes:
        window: The window by now, to which indices refer.
    """

    def __init__(
        self,
        footing: Footing,
        window: WalkWindow,
        start: Position,
        avoiding: Iterable[Position] = (),
    ) -> None:
        from beliefnest.worlds.scripted.footpath_kernels import MOST_STEPS, SCRATCH, Queue

        room = MOST_STEPS * _MOST_CELLS + 1
        if footing.is_whole:
            room = MOST_STEPS * min(window.count + 1, _MOST_CELLS) + 1
        self._footing, self.window = footing, window
        self._avoiding = tuple(avoiding)
        self._trail = self._emptied(window)
        # Memory of `empty` is not touched before it is needed.
        orders, waiting = np.empty((2, room), dtype=np.int32)
        self._queue = Queue(np.empty(room), orders, waiting, np.array([1, 0, 0, -1]))
        self._found = np.empty(SCRATCH, dtype=np.int32)
        first = window.index(start)
        assert first is not None  # windows of cells contain them
        self._trail.came[first], self._trail.costs[first] = -1, 0.0
        self._queue.keys[0], orders[0], waiting[0] = 0.0, 0, first

    @property
    def found(self) -> npt.NDArray[np.bool_]:
        """By index, True for the cells found so far."""
        is_reached: npt.NDArray[np.bool_] = self._trail.came != 0
        return is_reached

    @property
    def is_complete(self) -> bool:
        """True if no further cell can be found: the search did not end for its length."""
        return bool(self._queue.counts[2] < _MOST_CELLS)

    def next(self, goal: WalkGoal | None) -> int | None:
        """Return the index of the next cell that meets a goal; None: there is none.

        Args:
            goal: The goal, the same in each call; its free lines are not considered. None: no cell
                meets it, so that the search finds the whole area.
        """
        from beliefnest.worlds.scripted.footpath_kernels import NOWHERE, WIDER, find

        while True:
            aim = NOWHERE if goal is None else _aim(goal, self.window)
            end = find(self.window.cells, aim, self._trail, self._queue, self._found, _MOST_CELLS)
            if end != WIDER:
                return None if end < 0 else end
            self._widen()

    def way(self, end: int) -> tuple[Position, ...]:
        """Return the cells after the first up to a found one, in order."""
        way, at = [], end
        while (before := int(self._trail.came[at])) > 0:
            way.append(self.window.cell(at))
            at = before - 1
        return tuple(way[::-1])

    def _emptied(self, window: WalkWindow) -> "Trail":
        """Return a trail without found cells, with the cells to avoid."""
        from beliefnest.worlds.scripted.footpath_kernels import AVOIDED, Trail

        size = len(window.cells.codes)
        # Memory of `zeros` is not touched before it is needed.
        marks = np.zeros(size, dtype=np.uint8)
        for index in map(window.index, self._avoiding):
            if index is not None:
                marks[index] = AVOIDED
        return Trail(np.zeros(size, dtype=np.int32), np.empty(size), marks)

    def _widen(self) -> None:
        """Go on in a wider window, with room for steps from the cell that waits for them."""
        before, counts = self.window, self._queue.counts
        after = self._footing.wider(before, int(counts[3]))
        shift = [a - b for a, b in zip(before.low, after.low, strict=True)]

        def moved(indices: npt.NDArray[np.signedinteger[Any]]) -> npt.NDArray[np.intp]:
            places = np.unravel_index(indices, before.shape)
            return np.ravel_multi_index(
                tuple(p + by for p, by in zip(places, shift, strict=True)), after.shape
            )

        old, new = self._trail, self._emptied(after)
        reached = np.flatnonzero(old.came)
        here, came = moved(reached), old.came[reached]
        is_start = came < 0
        new.came[here] = np.where(is_start, -1, moved(np.where(is_start, 0, came - 1)) + 1)
        new.costs[here] = old.costs[reached]
        new.marks[here] = old.marks[reached]
        waiting = self._queue.cells[: counts[0]]
        waiting[:] = moved(waiting)
        counts[3] = moved(counts[3:4])[0]
        self.window, self._trail = after, new


def _aim(goal: WalkGoal, window: WalkWindow) -> "PathAim":
    from beliefnest.worlds.scripted.footpath_kernels import PathAim

    x, y, z = (a - b for a, b in zip(goal.block, window.low, strict=True))
    if isinstance(goal, Near):
        return PathAim(x, y, z, float(goal.within), False, False)
    return PathAim(x, y, z, float(goal.reach), True, goal.beside)
