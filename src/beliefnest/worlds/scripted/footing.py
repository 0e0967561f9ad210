"""Cells of the scripted world in which bodies can stand and through which they pass.

A small box is prepared as a whole. Of a large one only windows are prepared: parts around the
cells that somebody walks from, which grow as searches for paths reach their edges.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from beliefnest.world.doors import is_doorway, is_open, moves_by_hand, passage
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Index, Terrain
from beliefnest.world.values import Box, Position

if TYPE_CHECKING:  # Compiled code takes its time to load.
    from beliefnest.worlds.scripted.footpath_kernels import Cells

__all__ = ["Footing", "Window"]

_MARGIN = (1, 2, 1)
"""Cells around the box, so that every neighbour of a cell has an index."""
_BELOW, _ABOVE, _ASIDE = 3, 2, 1
"""Greatest distances, in cells, at which a step looks at cells; the kernels have the rules."""
_HALF = 24
"""Cells from the middle of a new window to each side."""
_MOST_WINDOWS = 16
"""Largest number of windows that a footing keeps."""
_STACKED = 512
"""Number of chunks whose states are counted together."""

_Bools = npt.NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Window:
    """Part of a box and its margin, prepared for searches of paths.

    An index of it is a flat index into its cells; x is slowest, z is fastest.

    Attributes:
        low: Position of its lowest cell.
        standing: Cells in which an agent can stand.
        passing: Cells through which a body passes.
        doorways: By cell, the direction through doors and gates that can be crossed, or 0.
        ends: By axis, True for each side (low, high) at which the box with its margin ends.
    """

    low: Position
    standing: _Bools
    passing: _Bools
    doorways: npt.NDArray[np.uint8]
    ends: tuple[tuple[bool, bool], ...]

    @cached_property
    def shape(self) -> Index:
        """Number of cells along x, y, z."""
        x, y, z = self.passing.shape
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
        """Number of cells in which agents can stand."""
        return int(np.count_nonzero(self.standing))

    @cached_property
    def stands(self) -> bytes:
        """By index, 1 for cells in which an agent can stand."""
        return self.standing.tobytes()

    @cached_property
    def cells(self) -> "Cells":
        """The cells in the form of the kernels."""
        from beliefnest.worlds.scripted.footpath_kernels import Cells

        standing, passing = (each.ravel().view(np.uint8) for each in (self.standing, self.passing))
        return Cells(standing, passing, self.doorways.ravel(), self.shape, *self.inner)

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


class Footing:
    """Windows of a terrain.

    Args:
        registry: Shapes of blocks.
        box: The known part of space.
        blocks: Block states, -1 is unknown.
        opens: True if doors and gates that can be opened by hand count as open.

    Attributes:
        is_whole: True if the box is prepared as a whole.
        has_doors: True if there is a door or gate.
        has_doorways: True if there is a door or gate that is open or counts as open.
        has_shut_doors: True if there is a shut one that can be opened by hand.
    """

    def __init__(self, registry: Registry, box: Box, blocks: Terrain, *, opens: bool) -> None:
        self._registry, self._box, self._blocks, self._opens = registry, box, blocks, opens
        self.is_whole = blocks.is_dense
        states = _states_of(blocks)
        doorways = [s for s in states.tolist() if s >= 0 and is_doorway(registry.name(s))]
        ways = {s: passage(registry, s) for s in doorways if self._is_way(s)}
        self.has_doors, self.has_doorways = bool(doorways), bool(ways)
        self.has_shut_doors = any(
            moves_by_hand(registry.name(s)) for s in doorways if s not in ways
        )
        self._free = np.zeros(int(states[-1]) + 2, dtype=np.bool_)
        self._free[states + 1] = [
            s < 0 or s in ways or not registry.boxes(s) for s in states.tolist()
        ]
        self._ways = ways
        self._windows: list[Window] = []

    def window(self, cell: Position) -> Window | None:
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

    def wider(self, window: Window, index: int) -> Window:
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
        if self.is_whole:
            index = self._whole.index(cell)
            return index is not None and self._whole.stands[index] != 0
        x, y, z = cell
        return (
            self._holds((x, y - 1, z)) and self._passes((x, y, z)) and self._passes((x, y + 1, z))
        )

    def _passes(self, place: Position) -> bool:
        if place in self._box:
            return bool(self._free[self._blocks[self._box.index(place)] + 1])
        x, y, z = place
        # Above the box is air.
        return y == self._box.high[1] + 1 and (x, y - 1, z) in self._box

    def _holds(self, place: Position) -> bool:
        if place not in self._box:
            return False
        state = self._blocks[self._box.index(place)]
        return state < 0 or not self._free[state + 1]

    def _keep(self, window: Window) -> Window:
        self._windows = [window, *self._windows[: _MOST_WINDOWS - 1]]
        return window

    @cached_property
    def _whole(self) -> Window:
        return self._made((0, 0, 0), self._sizes)

    @property
    def _sizes(self) -> Index:
        """Number of cells of the box and its margin along x, y, z."""
        x, y, z = (
            size + 2 * margin for size, margin in zip(self._blocks.shape, _MARGIN, strict=True)
        )
        return (x, y, z)

    def _made(self, low: Index, high: Index) -> Window:
        """Return the window of the cells from index `low` to before `high`, margins included."""
        # Whether one can stand in a cell depends on the cells above and below.
        floor, roof = max(low[1] - 1, 0), min(high[1] + 1, self._sizes[1])
        begin = (low[0], floor, low[2])
        shape = (high[0] - low[0], roof - floor, high[2] - low[2])
        passing, holding = np.zeros(shape, dtype=np.bool_), np.zeros(shape, dtype=np.bool_)
        doorways = np.zeros(shape, dtype=np.uint8)
        cut, first, last = self._cut(begin, shape)
        if all(a < b for a, b in zip(first, last, strict=True)):
            blocks = self._blocks.cut(first, last)
            free = self._free[blocks + 1]
            passing[cut], holding[cut] = free, (blocks < 0) | ~free
            if self._ways:
                doorways[cut] = self._directions[blocks + 1]
        above = self._blocks.shape[1] + _MARGIN[1] - floor
        if 0 <= above < shape[1]:
            passing[cut[0], above, cut[2]] = True
        standing = np.zeros(shape, dtype=np.bool_)
        standing[:, 1:-1] = holding[:, :-2] & passing[:, 1:-1] & passing[:, 2:]
        part = (slice(None), slice(low[1] - floor, high[1] - floor), slice(None))
        ends = tuple((a == 0, b == size) for a, b, size in zip(low, high, self._sizes, strict=True))
        corner = [a + b - m for a, b, m in zip(low, self._box.low, _MARGIN, strict=True)]
        return Window(
            (corner[0], corner[1], corner[2]),
            np.ascontiguousarray(standing[part]),
            np.ascontiguousarray(passing[part]),
            np.ascontiguousarray(doorways[part]),
            ends,
        )

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

    @cached_property
    def _directions(self) -> npt.NDArray[np.uint8]:
        """By state and 1, the direction through doors and gates that can be crossed, or 0."""
        from beliefnest.worlds.scripted.footpath_kernels import ALONG_X, ALONG_Z

        directions = np.zeros(len(self._free), dtype=np.uint8)
        for state, way in self._ways.items():
            directions[state + 1] = ALONG_X if way == (1, 0) else ALONG_Z
        return directions

    def _is_way(self, state: int) -> bool:
        """Return True if a door or gate can be crossed."""
        by_hand = self._opens and moves_by_hand(self._registry.name(state))
        return by_hand or is_open(self._registry, state) is True


def _states_of(blocks: Terrain) -> npt.NDArray[np.intp]:
    """Return the states that occur, in order; in chunks also those of cells beside the box."""
    # Counting is faster than sorting, as `np.unique` does.
    counts = np.zeros(1, dtype=np.bool_)
    for part in _parts_of(blocks):
        found = np.bincount(part.reshape(-1) + 1) > 0
        short, long = sorted((counts, found), key=len)
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
