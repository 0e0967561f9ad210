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
from beliefnest.world.doors import is_doorway
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Index, Terrain
from beliefnest.world.values import Box, Position

if TYPE_CHECKING:  # Compiled code takes its time to load.
    from beliefnest.worlds.scripted.footpath_kernels import PathCells

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
class WalkWindow:
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


class Footing:
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
        self._windows: list[WalkWindow] = []

    def is_same(self, doors: Doorways) -> bool:
        """Return True if it makes no difference whether other doors count as doorways."""
        codes = body_codes(self._registry, doors, guesses=True)
        return np.array_equal(codes[self._states + 1], self._codes[self._states + 1])

    def window(self, cell: Position) -> WalkWindow | None:
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

    def wider(self, window: WalkWindow, index: int) -> WalkWindow:
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

    def _keep(self, window: WalkWindow) -> WalkWindow:
        self._windows = [window, *self._windows[: _MOST_WINDOWS - 1]]
        return window

    @cached_property
    def _whole(self) -> WalkWindow:
        return self._made((0, 0, 0), self._sizes)

    @property
    def _sizes(self) -> Index:
        """Number of cells of the box and its margin along x, y, z."""
        x, y, z = (
            size + 2 * margin for size, margin in zip(self._blocks.shape, _MARGIN, strict=True)
        )
        return (x, y, z)

    def _made(self, low: Index, high: Index) -> WalkWindow:
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
        return WalkWindow((corner[0], corner[1], corner[2]), codes, ends)

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
