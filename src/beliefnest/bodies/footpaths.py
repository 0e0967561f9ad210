"""Ways on foot in the scripted world: from one free cell to the next, one step a tick."""

import heapq
import math
from collections.abc import Callable, Iterator, Mapping
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from beliefnest.world.doors import is_doorway, is_open, moves_by_hand, passage
from beliefnest.world.frames import BlockGrid
from beliefnest.world.registry import AIR, Registry
from beliefnest.world.signs import is_sign
from beliefnest.world.values import EYE_HEIGHT, Box, Point, Position

__all__ = ["Goal", "Ground", "InReach", "Near", "feet_in", "find_way"]

_DEEPEST_DROP = 3
_SIDES = ((1, 0), (0, 1), (-1, 0), (0, -1))
_CORNERS = ((1, 1), (-1, 1), (-1, -1), (1, -1))
_MOST_CELLS = 100_000
_MARGIN = 2
_MOST_WAYS = 1000
"""That a ground remembers."""


@dataclass(frozen=True, slots=True)
class Near:
    """Standing no further from a block than so many blocks.

    Attributes:
        block: Its position.
        within: Distance between the block's cell and the one stood in.
    """

    block: Position
    within: float

    def is_met(self, cell: Position) -> bool:
        """Return True if a cell is near enough."""
        return math.dist(cell, self.block) <= self.within

    def steps_left(self, cell: Position) -> float:
        """How many steps it is to such a cell at least."""
        return max(0.0, math.dist(cell, self.block) - self.within)


@dataclass(frozen=True, slots=True)
class InReach:
    """Standing where a hand reaches a block.

    Attributes:
        block: Its position.
        reach: Distance between eyes and the block's middle.
        beside: Whether one must not stand in it, neither with the feet nor with the head.
        has_free_line: Given eyes and a block, whether the hand's way there is free; None: always.
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
        """How many steps it is to such a cell at least."""
        return max(0.0, math.dist(cell, self.block) - self.reach)

    def _is_within(self, cell: Position) -> bool:
        x, y, z = self.block
        return cell in ((x, y, z), (x, y - 1, z))


Goal = Near | InReach
"""Where a way is to lead."""


def feet_in(cell: Position) -> Point:
    """Where the feet are of somebody who stands in a cell."""
    return (cell[0] + 0.5, float(cell[1]), cell[2] + 0.5)


class Ground:
    """Where one can stand: two free cells above one another, and below them something solid.

    What is not known is free, and holds whoever stands on it. Open doors and gates are free, and
    gone through straight on.

    Args:
        registry: Shapes of blocks.
        box: The part of space.
        blocks: Block state ids, -1 is unknown.
        opens: Whether doors and gates that are moved by hand are as good as open.
    """

    def __init__(
        self, registry: Registry, box: Box, blocks: BlockGrid, *, opens: bool = False
    ) -> None:
        self._registry, self._box, self._blocks, self._opens = registry, box, blocks, opens
        states, places = np.unique(blocks, return_inverse=True)
        ways = {s: passage(registry, s) for s in states.tolist() if self._is_way(s)}
        free_states = [s < 0 or s in ways or not registry.boxes(s) for s in states.tolist()]
        free = np.array(free_states, dtype=np.bool_)[places].reshape(blocks.shape)
        x, y, z = box.low
        doors = np.argwhere(np.isin(blocks, list(ways))).tolist() if ways else []
        self._doorways = {(x + i, y + j, z + k): ways[int(blocks[i, j, k])] for i, j, k in doors}
        # A margin all around, so that whatever lies a step away has a place; above the box is air.
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
        """Return True if somebody can stand in a cell."""
        return self._at(self._standing, cell)

    def may_hold(self, place: Position) -> bool:
        """Whether there may be a container at a position: there is one, or it is not known."""
        if place not in self._box:
            return False
        state = int(self._blocks[self._box.index(place)])
        return state < 0 or self._registry.is_container(self._registry.name(state))

    def is_sign(self, place: Position) -> bool | None:
        """Return True if there is a sign at a position; None: what is there is not known."""
        state = int(self._blocks[self._box.index(place)]) if place in self._box else AIR
        return None if state < 0 else is_sign(self._registry.name(state))

    def steps(self, cell: Position) -> tuple[Position, ...]:
        """Return the cells that one step leads to: aside, up one block, or down up to three."""
        found = self._steps.get(cell)
        if found is None:
            steps = self._steps_from(cell)
            if self._doorways:
                steps = (step for step in steps if self._is_straight(cell, step))
            found = self._steps[cell] = tuple(steps)
        return found

    @cached_property
    def with_doors_opened(self) -> "Ground":
        """The same for who opens doors and gates by hand."""
        return Ground(self._registry, self._box, self._blocks, opens=True)

    @property
    def has_doorways(self) -> bool:
        """True if there is a door or gate that is open, or as good as open."""
        return bool(self._doorways)

    def _is_way(self, state: int) -> bool:
        """Return True if a block is a door or gate that can be gone through."""
        if state < 0 or not is_doorway(name := self._registry.name(state)):
            return False
        by_hand = self._opens and moves_by_hand(name)
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
        """Return the way that `find_way` finds, looked for once where nothing is to be avoided."""
        # What somebody knows of free lines is not kept: it changes, and is no matter of the ground.
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
                    # Who asks next from there need not look for a way through all of it.
                    self._areas.append(self._area(start))
        return self._ways[wanted]

    def may_lead(self, start: Position, goal: Goal) -> bool:
        """Return True if a way may lead somewhere; False: none does.

        The goal is met in a part of the ground that has all cells in it that can be got to.
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
        """Return all cells that can be got to from one, as far as ways are looked for."""
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
    """Return the shortest way on foot; of several the same one each time.

    Args:
        ground: Where one can stand.
        start: The cell one stands in.
        goal: Where the way is to lead.
        avoiding: Cells that it must not lead through.

    Returns:
        The cells after `start`, in order; None: there is no way.
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
