"""Paths on foot in the scripted world: from one free cell to the next, one step a tick.

A small box is prepared as a whole. Of a large one only windows are prepared: parts around the
cells that somebody walks from, which grow as searches for paths reach their edges.
"""

import math
from collections.abc import Iterable, Iterator
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
import numpy.typing as npt

from beliefnest.geometry.bodies import (
    ALONG_X,
    ALONG_Z,
    FLOOR,
    FULL,
    ROOM,
    BodyCodes,
    Doorways,
    body_codes,
)
from beliefnest.geometry.free_lines import can_touch, can_use, eye_in
from beliefnest.world.doors import is_doorway
from beliefnest.world.frames import BlockGrid
from beliefnest.world.registry import AIR, Registry
from beliefnest.world.terrain import Index, Terrain
from beliefnest.world.values import Box, Point, Position, block_at, feet_in

if TYPE_CHECKING:  # Compiled code takes its time to load.
    from beliefnest.worlds.scripted.footpath_kernels import PathAim, PathCells, Trail


_MARGIN = (1, 2, 1)
"""Cells around the box, so that every neighbour of a cell has an index."""
_BELOW, _ABOVE, _ASIDE = 8, 2, 4
"""Greatest distances, in cells, at which a step looks at cells; `geometry.steps` has the rules."""
_HALF = 24
"""Cells from the middle of a new window to each side."""
_MOST_WINDOWS = 16
"""Largest number of windows that a footing keeps."""
_STACKED = 512
"""Number of chunks whose states are counted together."""


@dataclass(frozen=True, eq=False)
class _WalkWindow:
    """Part of a box and its margin, prepared for searches of paths.

    An index of it is a flat index into its cells; x is slowest, z is fastest.

    Attributes:
        low: Position of its lowest cell.
        codes: What each block is to a body, as in `geometry.bodies`.
        ends: By axis, True for each side (low, high) at which the box with its margin ends.
    """

    low: Position
    codes: BodyCodes
    ends: tuple[tuple[bool, bool], ...]

    @cached_property
    def shape(self) -> Index:
        """Number of cells along x, y, z."""
        x, y, z = self.codes.shape
        return (int(x), int(y), int(z))

    @cached_property
    def inner(self) -> tuple[Index, Index]:
        """First and last cell along x, y, z from which each step stays inside the window."""
        near = ((_ASIDE, _ASIDE), (_BELOW, _ABOVE), (_ASIDE, _ASIDE))
        first = [0 if end[0] else far[0] for end, far in zip(self.ends, near, strict=True)]
        last = [
            size - 1 - (0 if end[1] else far[1])
            for size, end, far in zip(self.shape, self.ends, near, strict=True)
        ]
        return (first[0], first[1], first[2]), (last[0], last[1], last[2])

    @cached_property
    def count(self) -> int:
        """Number of cells that a body may move through."""
        return int(np.count_nonzero(self.codes & (ROOM | ALONG_X | ALONG_Z)))

    @cached_property
    def cells(self) -> "PathCells":
        """The cells in the form of the kernels."""
        from beliefnest.worlds.scripted.footpath_kernels import PathCells

        return PathCells(self.codes.ravel(), self.shape, *self.inner)

    def index(self, cell: Position) -> int | None:
        """Return the index of a cell; None: it is outside the window."""
        x, y, z = cell[0] - self.low[0], cell[1] - self.low[1], cell[2] - self.low[2]
        width, height, depth = self.shape
        inside = 0 <= x < width and 0 <= y < height and 0 <= z < depth
        return (x * height + y) * depth + z if inside else None

    def cell(self, index: int) -> Position:
        """Return the cell at an index."""
        _, height, depth = self.shape
        x, y, z = self.low
        return (x + index // (height * depth), y + index // depth % height, z + index % depth)

    def holds(self, cell: Position) -> bool:
        """Return True if each step from a cell stays inside the window."""
        return all(
            first <= at - low <= last
            for at, low, first, last in zip(cell, self.low, *self.inner, strict=True)
        )


class _Footing:
    """Windows of a terrain.

    Args:
        registry: Shapes of blocks.
        box: The known part of space.
        blocks: Block states, -1 is unknown.
        doors: The doors and gates that count as doorways.

    Attributes:
        is_whole: True if the box is prepared as a whole.
        has_doors: True if there is a door or gate.
    """

    def __init__(self, registry: Registry, box: Box, blocks: Terrain, doors: Doorways) -> None:
        self._registry, self._box, self._blocks = registry, box, blocks
        self.is_whole = blocks.is_dense
        self._codes = body_codes(registry, doors, guesses=True)
        self._states = _states_of(blocks)
        named = (registry.name(s) for s in self._states.tolist() if s >= 0)
        self.has_doors = any(map(is_doorway, named))
        self._windows: list[_WalkWindow] = []

    def is_same(self, doors: Doorways) -> bool:
        """Return True if it makes no difference whether other doors count as doorways."""
        codes = body_codes(self._registry, doors, guesses=True)
        return np.array_equal(codes[self._states + 1], self._codes[self._states + 1])

    def window(self, cell: Position) -> _WalkWindow | None:
        """Return a window for walks from a cell; None: it is outside the box and its margin."""
        if self.is_whole:
            return self._whole if self._whole.index(cell) is not None else None
        for window in self._windows:
            if window.holds(cell):
                return window
        at = [a - b + m for a, b, m in zip(cell, self._box.low, _MARGIN, strict=True)]
        sizes = self._sizes
        if not all(0 <= a < size for a, size in zip(at, sizes, strict=True)):
            return None
        low = [max(a - _HALF, 0) for a in at]
        high = [min(a + _HALF + 1, size) for a, size in zip(at, sizes, strict=True)]
        return self._keep(self._made(_index(low), _index(high)))

    def wider(self, window: _WalkWindow, index: int) -> _WalkWindow:
        """Return a wider window that replaces one, with room for steps from a cell.

        Args:
            window: The window.
            index: Index of a cell of the window, not `held` by it.
        """
        _, height, depth = window.shape
        at = (index // (height * depth), index // depth % height, index % depth)
        start = [a - b + m for a, b, m in zip(window.low, self._box.low, _MARGIN, strict=True)]
        low, high = [], []
        for axis, (first, last) in enumerate(zip(*window.inner, strict=True)):
            more = max(_HALF, window.shape[axis] // 2)
            begin, end = start[axis], start[axis] + window.shape[axis]
            low.append(max(begin - more, 0) if at[axis] < first else begin)
            high.append(min(end + more, self._sizes[axis]) if at[axis] > last else end)
        self._windows = [each for each in self._windows if each is not window]
        return self._keep(self._made(_index(low), _index(high)))

    def stands(self, cell: Position) -> bool:
        """Return True if an agent can stand in a cell."""
        from beliefnest.geometry.steps import stands

        return bool(stands(*self._near(cell)))

    def feet_height(self, cell: Position) -> float:
        """Return the height of an agent's feet above a cell, in blocks; negative on low blocks."""
        from beliefnest.geometry.steps import feet_height

        return feet_height(*self._near(cell)) / FULL

    def is_obstacle(self, place: Position) -> bool:
        """Return True if a body can stand on a block, but not in it."""
        code = self._code(place)
        return bool(code & FLOOR) and not code & (ROOM | ALONG_X | ALONG_Z)

    def _near(self, cell: Position) -> tuple[BodyCodes, Index, int, int, int]:
        """Return the codes of a grid that holds a cell and those around it, and its index."""
        window = self.window(cell)
        if window is None:
            return (np.zeros(1, dtype=np.uint32), (1, 1, 1), 0, 0, 0)
        x, y, z = (a - b for a, b in zip(cell, window.low, strict=True))
        return (window.cells.codes, window.shape, x, y, z)

    def _code(self, place: Position) -> int:
        if place in self._box:
            return int(self._codes[self._blocks[self._box.index(place)] + 1])
        x, y, z = place
        # Above the box is air.
        return ROOM if y == self._box.high[1] + 1 and (x, y - 1, z) in self._box else 0

    def _keep(self, window: _WalkWindow) -> _WalkWindow:
        self._windows = [window, *self._windows[: _MOST_WINDOWS - 1]]
        return window

    @cached_property
    def _whole(self) -> _WalkWindow:
        return self._made((0, 0, 0), self._sizes)

    @property
    def _sizes(self) -> Index:
        """Number of cells of the box and its margin along x, y, z."""
        x, y, z = (
            size + 2 * margin for size, margin in zip(self._blocks.shape, _MARGIN, strict=True)
        )
        return (x, y, z)

    def _made(self, low: Index, high: Index) -> _WalkWindow:
        """Return the window of the cells from index `low` to before `high`, margins included."""
        shape = (high[0] - low[0], high[1] - low[1], high[2] - low[2])
        codes = np.zeros(shape, dtype=np.uint32)
        cut, first, last = self._cut(low, shape)
        if all(a < b for a, b in zip(first, last, strict=True)):
            codes[cut] = self._codes[self._blocks.cut(first, last) + 1]
        above = self._blocks.shape[1] + _MARGIN[1] - low[1]
        if 0 <= above < shape[1]:
            codes[cut[0], above, cut[2]] = ROOM
        ends = tuple((a == 0, b == size) for a, b, size in zip(low, high, self._sizes, strict=True))
        corner = [a + b - m for a, b, m in zip(low, self._box.low, _MARGIN, strict=True)]
        return _WalkWindow((corner[0], corner[1], corner[2]), codes, ends)

    def _cut(
        self, begin: Index, shape: tuple[int, int, int]
    ) -> tuple[tuple[slice, slice, slice], Index, Index]:
        """Return the part of a window that lies in the box, and its corners as indices of the box.

        Args:
            begin: Index of the window's lowest cell, margins included.
            shape: Shape of the window.
        """
        first, last, cut = [], [], []
        for axis in range(3):
            start = begin[axis] - _MARGIN[axis]
            low = max(start, 0)
            high = max(min(start + shape[axis], self._blocks.shape[axis]), low)
            first.append(low)
            last.append(high)
            cut.append(slice(low - start, high - start))
        return (cut[0], cut[1], cut[2]), _index(first), _index(last)


def _states_of(blocks: Terrain) -> npt.NDArray[np.intp]:
    """Return the states that occur, in order; in chunks also those of cells beside the box."""
    # Counting is faster than sorting, as `np.unique` does.
    counts = np.zeros(1, dtype=np.bool_)
    for part in _parts_of(blocks):
        occurs = np.bincount(part.reshape(-1) + 1) > 0
        short, long = sorted((counts, occurs), key=len)
        counts = long.copy()
        counts[: len(short)] |= short
    return np.flatnonzero(counts) - 1


def _parts_of(blocks: Terrain) -> Iterator[npt.NDArray[np.int32]]:
    if blocks.is_dense:
        yield blocks.dense()
        return
    used = np.flatnonzero(np.bincount(blocks.rows)).tolist()
    for start in range(0, len(used), _STACKED):
        yield np.stack([blocks.chunks[row] for row in used[start : start + _STACKED]])


def _index(parts: list[int]) -> Index:
    return (parts[0], parts[1], parts[2])


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
        self._footing = _Footing(registry, box, self._blocks, doors)
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

    window: _WalkWindow
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
        footing: _Footing,
        window: _WalkWindow,
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

    def _emptied(self, window: _WalkWindow) -> "Trail":
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


def _aim(goal: WalkGoal, window: _WalkWindow) -> "PathAim":
    from beliefnest.worlds.scripted.footpath_kernels import PathAim

    x, y, z = (a - b for a, b in zip(goal.block, window.low, strict=True))
    if isinstance(goal, Near):
        return PathAim(x, y, z, float(goal.within), False, False)
    return PathAim(x, y, z, float(goal.reach), True, goal.beside)
