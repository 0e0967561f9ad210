"""Ways on foot in the scripted world: from one free cell to the next, one step a tick."""

import heapq
import math
from collections.abc import Callable, Iterator, Mapping

from beliefnest.world.frames import BlockGrid
from beliefnest.world.registry import Registry
from beliefnest.world.values import Box, Point, Position

__all__ = ["Ground", "feet_in", "find_way"]

_DEEPEST_DROP = 3
_SIDES = ((1, 0), (0, 1), (-1, 0), (0, -1))
_CORNERS = ((1, 1), (-1, 1), (-1, -1), (1, -1))
_MOST_CELLS = 100_000


def feet_in(cell: Position) -> Point:
    """Where the feet are of somebody who stands in a cell."""
    return (cell[0] + 0.5, float(cell[1]), cell[2] + 0.5)


class Ground:
    """Where one can stand: two free cells above one another, and below them something solid.

    What is not known is free, and holds whoever stands on it.

    Args:
        registry: Shapes of blocks.
        box: The part of space.
        blocks: Block state ids, -1 is unknown.
    """

    def __init__(self, registry: Registry, box: Box, blocks: BlockGrid) -> None:
        self._registry = registry
        self._box = box
        self._blocks = blocks
        self._free: dict[int, bool] = {-1: True}

    def stands(self, cell: Position) -> bool:
        """Whether somebody can stand in a cell."""
        x, y, z = cell
        below = self._state((x, y - 1, z))
        held = below == -1 or (below is not None and not self._is_free(below))
        return held and self._passes(cell) and self._passes((x, y + 1, z))

    def may_hold(self, place: Position) -> bool:
        """Whether there may be a container at a position: there is one, or it is not known."""
        state = self._state(place)
        if state is None or state < 0:
            return state is not None
        return self._registry.is_container(self._registry.name(state))

    def steps(self, cell: Position) -> Iterator[Position]:
        """The cells that one step leads to: aside, up one block, or down up to three."""
        x, y, z = cell
        for dx, dz in _SIDES:
            aside = (x + dx, y, z + dz)
            if self.stands(aside):
                yield aside
            elif self._passes((x, y + 2, z)) and self.stands((x + dx, y + 1, z + dz)):
                yield (x + dx, y + 1, z + dz)
            elif self._passes(aside) and self._passes((x + dx, y + 1, z + dz)):
                yield from self._drop(aside)
        for dx, dz in _CORNERS:
            open_sides = all(
                self._passes((x + a, y + up, z + b)) for a, b in ((dx, 0), (0, dz)) for up in (0, 1)
            )
            if open_sides and self.stands((x + dx, y, z + dz)):
                yield (x + dx, y, z + dz)

    def _drop(self, aside: Position) -> Iterator[Position]:
        for depth in range(1, _DEEPEST_DROP + 1):
            below = (aside[0], aside[1] - depth, aside[2])
            if not self._passes(below):
                return
            if self.stands(below):
                yield below
                return

    def _passes(self, cell: Position) -> bool:
        state = self._state(cell)
        return state is not None and self._is_free(state)

    def _state(self, cell: Position) -> int | None:
        """None outside the box; above it is air."""
        # Asked for a hundred times a search: spelled out.
        x, y, z = cell
        (x0, y0, z0), (x1, y1, z1) = self._box.low, self._box.high
        if not (x0 <= x <= x1 and z0 <= z <= z1 and y0 <= y <= y1 + 1):
            return None
        if y > y1:
            return self._registry.air
        return int(self._blocks[x - x0, y - y0, z - z0])

    def _is_free(self, state: int) -> bool:
        if state not in self._free:
            self._free[state] = not self._registry.boxes(state)
        return self._free[state]


def find_way(
    ground: Ground,
    start: Position,
    arrived: Callable[[Position], bool],
    distance: Callable[[Position], float],
) -> list[Position] | None:
    """The shortest way on foot; of several the same one each time.

    Args:
        ground: Where one can stand.
        start: The cell one stands in.
        arrived: Whether a cell is where the way is to lead.
        distance: How many steps it is to there at least.

    Returns:
        The cells after `start`, in order; None: there is no way.
    """
    came: dict[Position, Position | None] = {start: None}
    costs: dict[Position, float] = {start: 0.0}
    waiting: list[tuple[float, int, Position]] = [(distance(start), 0, start)]
    order = 0
    done: set[Position] = set()
    while waiting and len(done) < _MOST_CELLS:
        _, _, cell = heapq.heappop(waiting)
        if cell in done:
            continue
        if arrived(cell):
            return _traced(came, cell)
        done.add(cell)
        for following in ground.steps(cell):
            cost = costs[cell] + math.dist(cell, following)
            if cost < costs.get(following, math.inf):
                costs[following], came[following] = cost, cell
                order += 1
                heapq.heappush(waiting, (cost + distance(following), order, following))
    return None


def _traced(came: Mapping[Position, Position | None], cell: Position) -> list[Position]:
    way = []
    at: Position | None = cell
    while at is not None and came[at] is not None:
        way.append(at)
        at = came[at]
    return way[::-1]
