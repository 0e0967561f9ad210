"""Paths on foot in the scripted world: from one free cell to the next, one step a tick."""

import heapq
import math
from collections.abc import Callable, Iterator, Mapping
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from beliefnest.world.doors import is_doorway, is_open, moves_by_hand, passage
from beliefnest.world.frames import BlockGrid, places_of
from beliefnest.world.registry import AIR, Registry
from beliefnest.world.signs import is_sign
from beliefnest.world.values import EYE_HEIGHT, Box, Point, Position, feet_in

__all__ = ["Goal", "Ground", "InReach", "Near", "find_way"]

_DEEPEST_DROP = 3
_SIDES = ((1, 0), (0, 1), (-1, 0), (0, -1))
_CORNERS = ((1, 1), (-1, 1), (-1, -1), (1, -1))
_MOST_CELLS = 100_000
_MARGIN = 2
_MOST_WAYS = 20_000
"""Largest number of paths that a ground caches."""


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

    def steps_left(self, cell: Position) -> float:
        """Return a lower bound of the steps from a cell to the goal."""
        return max(0.0, math.dist(cell, self.block) - self.within)


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

    def steps_left(self, cell: Position) -> float:
        """Return a lower bound of the steps from a cell to the goal."""
        return max(0.0, math.dist(cell, self.block) - self.reach)

    def _is_within(self, cell: Position) -> bool:
        x, y, z = self.block
        return cell in ((x, y, z), (x, y - 1, z))


Goal = Near | InReach
"""Goal of a path."""


class Ground:
    """Cells in which agents can stand: two free cells above one another, with a solid one below.

    Unknown cells count as free to walk through and solid to stand on. Open doors and gates are
    free, but can only be crossed straight.

    Args:
        registry: Shapes of blocks.
        box: The known part of space.
        blocks: Block state ids, -1 is unknown.
        opens: True if doors and gates that can be opened by hand count as open.
    """

    def __init__(
        self, registry: Registry, box: Box, blocks: BlockGrid, *, opens: bool = False
    ) -> None:
        self._registry, self._box, self._blocks, self._opens = registry, box, blocks, opens
        states, places = np.unique(blocks, return_inverse=True)
        doorways = [s for s in states.tolist() if s >= 0 and is_doorway(registry.name(s))]
        ways = {s: passage(registry, s) for s in doorways if self._is_way(s)}
        self._has_shut_doors = any(
            moves_by_hand(registry.name(s)) for s in doorways if s not in ways
        )
        free_states = [s < 0 or s in ways or not registry.boxes(s) for s in states.tolist()]
        free = np.array(free_states, dtype=np.bool_)[places].reshape(blocks.shape)
        doors = places_of(np.isin(blocks, list(ways)), box) if ways else ()
        self._doorways = {place: ways[int(blocks[index])] for place, index in doors}
        # Add a margin, so that every neighbour of a cell has an index; above the box is air.
        passing, holding = _widened(free), _widened((blocks < 0) | ~free)
        passing[1:-1, _MARGIN + blocks.shape[1], 1:-1] = True
        standing = np.zeros_like(passing)
        standing[:, 1:-1] = holding[:, :-2] & passing[:, 1:-1] & passing[:, 2:]
        self._passing, self._standing = passing.tobytes(), standing.tobytes()
        self._corner = (box.low[0] - 1, box.low[1] - _MARGIN, box.low[2] - 1)
        width, height, depth = passing.shape
        self._shape = (int(width), int(height), int(depth))
        self._steps: dict[Position, tuple[Position, ...]] = {}
        self._ways: dict[tuple[Position, Goal], tuple[Position, ...] | None] = {}
        self._areas: list[frozenset[Position]] = []
        self._met: dict[tuple[int, Goal], bool] = {}

    def stands(self, cell: Position) -> bool:
        """Return True if an agent can stand in a cell."""
        return self._at(self._standing, cell)

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

    def steps(self, cell: Position) -> tuple[Position, ...]:
        """Return the cells that one step leads to: sideways, up one block, or down up to three."""
        found = self._steps.get(cell)
        if found is None:
            steps = self._steps_from(cell)
            if self._doorways:
                steps = (step for step in steps if self._is_straight(cell, step))
            found = self._steps[cell] = tuple(steps)
        return found

    @cached_property
    def with_doors_opened(self) -> "Ground":
        """Return the same ground for agents that open doors and gates by hand."""
        if not self._has_shut_doors:
            return self
        return Ground(self._registry, self._box, self._blocks, opens=True)

    @property
    def has_doorways(self) -> bool:
        """True if there is a door or gate that is open or counts as open."""
        return bool(self._doorways)

    def _is_way(self, state: int) -> bool:
        """Return True if a door or gate can be crossed."""
        by_hand = self._opens and moves_by_hand(self._registry.name(state))
        return by_hand or is_open(self._registry, state) is True

    def _is_straight(self, cell: Position, step: Position) -> bool:
        """Return True if a step leads through no doorway, or straight through it."""
        moved = (step[0] - cell[0], step[2] - cell[2])
        for at in (cell, step):
            along = self._doorways.get(at)
            if along is not None and (abs(moved[0]), abs(moved[1])) != along:
                return False
        around = ((step[0], cell[1], cell[2]), (cell[0], cell[1], step[2]))
        return 0 in moved or not any(at in self._doorways for at in around)

    def way(
        self, start: Position, goal: Goal, avoiding: AbstractSet[Position] = frozenset()
    ) -> tuple[Position, ...] | None:
        """Return the path of `find_way`, cached if no cells are to be avoided."""
        # Do not cache by what an agent knows of free lines: it changes, and does not belong to the
        # ground.
        if avoiding or (isinstance(goal, InReach) and goal.has_free_line is not None):
            return find_way(self, start, goal, avoiding)
        wanted = (start, goal)
        if wanted not in self._ways:
            if len(self._ways) >= _MOST_WAYS:
                self._ways.clear()
            known = any(start in area for area in self._areas)
            if known and not self.may_lead(start, goal):
                self._ways[wanted] = None
            else:
                self._ways[wanted] = found = find_way(self, start, goal)
                if found is None and not known:
                    # Remember the area, so that the next search there need not explore all of it.
                    self._areas.append(self._area(start))
        return self._ways[wanted]

    def may_lead(self, start: Position, goal: Goal) -> bool:
        """Return True if a path to a goal may exist; False if none does.

        An area is the set of all cells that can be reached from one cell. A path exists only if
        some cell in the area of `start` meets the goal.
        """
        number = next((n for n, area in enumerate(self._areas) if start in area), None)
        if number is None:
            number = len(self._areas)
            self._areas.append(self._area(start))
        asked = (number, goal)
        if asked not in self._met:
            self._met[asked] = any(goal.is_met(cell) for cell in self._areas[number])
        return self._met[asked]

    def _area(self, start: Position) -> frozenset[Position]:
        """Return all cells that can be reached from a cell, within the limit of searches."""
        area, waiting = {start}, [start]
        while waiting and len(area) < _MOST_CELLS:
            for cell in self.steps(waiting.pop()):
                if cell not in area:
                    area.add(cell)
                    waiting.append(cell)
        return frozenset(area)

    def _steps_from(self, cell: Position) -> Iterator[Position]:
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
        return self._at(self._passing, cell)

    def _at(self, flags: bytes, cell: Position) -> bool:
        x, y, z = cell[0] - self._corner[0], cell[1] - self._corner[1], cell[2] - self._corner[2]
        width, height, depth = self._shape
        inside = 0 <= x < width and 0 <= y < height and 0 <= z < depth
        return inside and flags[(x * height + y) * depth + z] != 0


def _widened(flags: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    wide: npt.NDArray[np.bool_] = np.pad(flags, ((1, 1), (_MARGIN, _MARGIN), (1, 1)))
    return wide


def find_way(
    ground: Ground, start: Position, goal: Goal, avoiding: AbstractSet[Position] = frozenset()
) -> tuple[Position, ...] | None:
    """Return the shortest path on foot; among several always the same one.

    Args:
        ground: Cells in which agents can stand.
        start: Cell in which the agent stands.
        goal: Goal of the path.
        avoiding: Cells that the path must not contain.

    Returns:
        The cells after `start`, in order; None if there is no path.
    """
    came: dict[Position, Position | None] = {start: None}
    costs: dict[Position, float] = {start: 0.0}
    waiting: list[tuple[float, int, Position]] = [(goal.steps_left(start), 0, start)]
    order = 0
    done: set[Position] = set()
    while waiting and len(done) < _MOST_CELLS:
        _, _, cell = heapq.heappop(waiting)
        if cell in done:
            continue
        if goal.is_met(cell):
            return _traced(came, cell)
        done.add(cell)
        for following in ground.steps(cell):
            cost = costs[cell] + math.dist(cell, following)
            if following not in avoiding and cost < costs.get(following, math.inf):
                costs[following], came[following] = cost, cell
                order += 1
                heapq.heappush(waiting, (cost + goal.steps_left(following), order, following))
    return None


def _traced(came: Mapping[Position, Position | None], cell: Position) -> tuple[Position, ...]:
    way = []
    at: Position | None = cell
    while at is not None and came[at] is not None:
        way.append(at)
        at = came[at]
    return tuple(way[::-1])
