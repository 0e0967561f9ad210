"""Paths on foot: compared with a slow search that follows the rules of steps literally."""

import heapq
import math
from collections.abc import Iterator
from random import Random

import numpy as np
import pytest
from tests.profiles import few_by_day

from beliefnest.world import terrain
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box, Position
from beliefnest.worlds.scripted import footpaths
from beliefnest.worlds.scripted.footpaths import Ground, InReach, Near, WalkGoal

STONE, AIR, UNKNOWN = "stone", "air", ""
ALONG_X = "oak_fence_gate[facing=east,open=true]"
ALONG_Z = "oak_fence_gate[facing=north,open=true]"
SHUT = "oak_fence_gate[facing=east,open=false]"
LOW = (-7, 3, 20)

Blocks = dict[Position, str]


def ground_of(blocks: Blocks, shape: tuple[int, int, int]) -> Ground:
    """Return the ground of blocks that are given by position, else air."""
    registry = Registry.load()
    grid = np.zeros(shape, dtype=np.int32)
    for place, text in blocks.items():
        index = tuple(a - b for a, b in zip(place, LOW, strict=True))
        grid[index] = registry.state_id(text) if text else -1
    high = tuple(a + size - 1 for a, size in zip(LOW, shape, strict=True))
    return Ground(registry, Box(LOW, (high[0], high[1], high[2])), grid)


class Rules:
    """Rules of steps, read cell by cell."""

    def __init__(self, blocks: Blocks, shape: tuple[int, int, int], *, opens: bool) -> None:
        self._blocks, self._shape, self._opens = blocks, shape, opens

    def text(self, cell: Position) -> str | None:
        """Return the block at a cell; None outside the box."""
        inside = (0 <= a - b < size for a, b, size in zip(cell, LOW, self._shape, strict=True))
        return self._blocks.get(cell, AIR) if all(inside) else None

    def gate(self, cell: Position) -> str | None:
        """Return the axis of an open gate."""
        text = self.text(cell)
        if self._opens and text == SHUT:
            return "x"
        return {ALONG_X: "x", ALONG_Z: "z"}.get(text or "")

    def room(self, cell: Position) -> bool:
        """Return True if there is nothing in a cell; above the box there is air."""
        (x, y, z), (_, height, _) = cell, self._shape
        if y == LOW[1] + height:
            return self.text((x, y - 1, z)) is not None
        return self.text(cell) in (AIR, UNKNOWN)

    def passes(self, cell: Position) -> bool:
        """Return True if a body passes through a cell, also through a gate."""
        return self.room(cell) or self.gate(cell) is not None

    def bears(self, cell: Position) -> bool:
        """Return True if a block holds up what is above it; the tops of shut gates are flat.

        A gate that opens does so only if nobody can walk through it.
        """
        (x, y, z), text = cell, self.text(cell)
        if self._opens and text == SHUT:
            return not self.room((x + 1, y, z)) and not self.room((x - 1, y, z))
        return text in (STONE, UNKNOWN, SHUT)

    def top(self, cell: Position) -> float:
        """Return the height of a block; unknown ones count as full."""
        text = self.text(cell)
        return {None: 0.0, AIR: 0.0, ALONG_X: 0.0, ALONG_Z: 0.0, SHUT: 1.5}.get(text, 1.0)

    def stands(self, cell: Position) -> bool:
        """Return True if an agent can stand in a cell."""
        x, y, z = cell
        head = (x, y + 1, z)
        # In a gate at the height of the head alone nobody stands, and of two gates one is opened.
        in_gates = self.gate(head) is not None and self.gate(head) == self.gate(cell)
        has_room = self.room(head) or (in_gates and self.text(head) != SHUT)
        return self.bears((x, y - 1, z)) and self.passes(cell) and has_room

    def steps(self, cell: Position) -> Iterator[Position]:
        """Yield the cells that one step leads to."""
        x, y, z = cell
        for dx in (-1, 0, 1):
            for dz in (-1, 0, 1):
                if dx or dz:
                    yield from self._beside(cell, dx, dz)
                if bool(dx) != bool(dz) and not self.gate(cell):
                    yield from self._jumps(cell, dx, dz)
        if self.room((x, y - 1, z)):
            yield from self._fallen((x, y, z))

    def _crosses(self, at: Position, dx: int, dz: int, *, high: bool) -> bool:
        axis = self.gate(at)
        straight = axis is None or not (dx, dz)["xz".index(axis) ^ 1]
        return straight or (high and self.text(at) != SHUT)

    def _beside(self, cell: Position, dx: int, dz: int) -> Iterator[Position]:
        x, y, z = cell
        ahead = (x + dx, y, z + dz)
        over = [(i, y + up, k) for i, k in ((x, z), (x + dx, z + dz)) for up in (1, 2)]
        high = all(map(self.room, over))
        if not self._crosses(cell, dx, dz, high=high):
            return
        level = self.stands(ahead) and self._crosses(ahead, dx, dz, high=high)
        if dx and dz:
            sides = [(i, y + up, k) for i, k in ((x + dx, z), (x, z + dz)) for up in (0, 1)]
            if level and all(map(self.room, sides)):
                yield ahead
            return
        above, below = (ahead[0], y + 1, ahead[2]), (ahead[0], y - 1, ahead[2])
        if level:
            yield ahead
            return
        if self.room(ahead) and self.room(above) and self.bears(below):
            return
        tall = self.top(ahead) + 1 - self.top((x, y - 1, z)) <= 1.2
        clear = self.room((x, y + 2, z)) and self.room((above[0], y + 2, above[2]))
        is_floor = self.text(ahead) in (STONE, SHUT) and self.bears(ahead)
        hops = is_floor and self.room(above) and tall and clear
        if hops and (self.gate(cell) is None or self.room((x, y + 1, z))):
            yield above
        elif self.room(ahead) and self.room(above) and self.room(below):
            yield from self._fallen(ahead)

    def _fallen(self, cell: Position) -> Iterator[Position]:
        x, y, z = cell
        for depth in range(2, 5):
            if self.bears((x, y - depth, z)):
                yield (x, y - depth + 1, z)
                return
            if not self.room((x, y - depth, z)):
                return

    def _jumps(self, cell: Position, dx: int, dz: int) -> Iterator[Position]:
        x, y, z = cell

        def at(far: int, up: int) -> Position:
            return (x + far * dx, y + up, z + far * dz)

        is_edge = not self.bears(at(1, -1)) or self.top(at(1, -1)) < self.top(at(0, -1))
        if not (is_edge and self.room(at(1, 0)) and self.room(at(1, 1))):
            return
        high = self.room(at(0, 2)) and self.room(at(1, 2))
        deep = not self.bears(at(1, -2))
        for far in (2, 3, 4):
            room = self.room(at(far, 0)) and self.room(at(far, 1))
            if high and room and self.bears(at(far, -1)):
                yield at(far, 0)
                return
            solid = self.text(at(far, 0)) in (STONE, SHUT)
            if high and solid and self.room(at(far, 1)) and self.room(at(far, 2)) and far < 4:
                if self.top(at(far, 0)) + 1 - self.top(at(0, -1)) <= 1.2:
                    yield at(far, 1)
                return
            if (high or far == 2) and room and self.room(at(far, -1)) and deep:
                if self.bears(at(far, -2)):
                    yield at(far, -1)
                    deep = False
            elif not room:
                return
            high = high and self.room(at(far, 2))

    def cost(self, cell: Position, step: Position) -> float:
        """Return the cost of a step: its length, or more for a step up or one that opens a gate."""
        (x, y, z), (i, j, k) = cell, step
        is_up = j == y + 1 and (i - x) ** 2 + (k - z) ** 2 == 1
        opens = self._opens and self.text(step) == SHUT
        return (2.0 if is_up else math.dist(cell, step)) + opens

    def lengths(self, start: Position) -> dict[Position, float]:
        """Return the lengths of shortest paths to all cells that can be reached."""
        found, waiting = {start: 0.0}, [(0.0, start)]
        while waiting:
            length, cell = heapq.heappop(waiting)
            for step in self.steps(cell):
                further = length + self.cost(cell, step)
                if further < found.get(step, math.inf) - 1e-9:
                    found[step] = further
                    heapq.heappush(waiting, (further, step))
        return found


def drawn(random: Random) -> tuple[Blocks, tuple[int, int, int]]:
    """Return a rough terrain with gates and unknown blocks."""
    shape = (random.randint(3, 8), random.randint(3, 6), random.randint(3, 8))
    blocks: Blocks = {}
    for i in range(shape[0]):
        for k in range(shape[2]):
            top = random.choice((0, 0, 0, 1, 1, 2, 3))
            for j in range(min(top, shape[1] - 1) + 1):
                blocks[LOW[0] + i, LOW[1] + j, LOW[2] + k] = STONE
            odd = random.choice((AIR, AIR, AIR, AIR, UNKNOWN, ALONG_X, ALONG_Z, SHUT))
            if top + 1 < shape[1] and odd != AIR:
                blocks[LOW[0] + i, LOW[1] + top + 1, LOW[2] + k] = odd
    return blocks, shape


@pytest.mark.parametrize("seed", range(25))
def test_paths_are_shortest_and_keep_the_rules(seed: int) -> None:
    random = Random(seed)
    blocks, shape = drawn(random)
    plain = ground_of(blocks, shape)
    for opens, ground in ((False, plain), (True, plain.with_doors_opened)):
        rules = Rules(blocks, shape, opens=opens)
        around = [
            (LOW[0] + i, LOW[1] + j, LOW[2] + k)
            for i in range(-1, shape[0] + 1)
            for j in range(-1, shape[1] + 3)
            for k in range(-1, shape[2] + 1)
        ]
        standing = [cell for cell in around if rules.stands(cell)]
        assert standing == [cell for cell in around if ground.stands(cell)]
        for _ in range(10):
            start, block = random.choice(standing), random.choice(around)
            goal: WalkGoal = random.choice(
                (Near(block, 0), Near(block, 1.5), InReach(block, 4.0), InReach(block, 2.0, True))
            )
            _check(ground, rules, start, goal)


def _check(ground: Ground, rules: Rules, start: Position, goal: WalkGoal) -> None:
    lengths = {
        cell: length for cell, length in rules.lengths(start).items() if ground.meets(goal, cell)
    }
    way = ground.way(start, goal)
    if way is None:
        assert not lengths
        return
    course = [start, *way]
    assert ground.meets(goal, course[-1])
    assert all(step in rules.steps(cell) for cell, step in zip(course, way, strict=False))
    length = sum(map(rules.cost, course, way))
    assert length == pytest.approx(min(lengths.values()))
    assert ground.may_lead(start, goal)


def floor() -> tuple[Blocks, tuple[int, int, int]]:
    """Return an empty floor of 7 x 7 blocks."""
    return {(LOW[0] + i, LOW[1], LOW[2] + k): STONE for i in range(7) for k in range(7)}, (7, 4, 7)


def at(i: int, k: int) -> Position:
    """Return a cell on the floor."""
    return (LOW[0] + i, LOW[1] + 1, LOW[2] + k)


def test_cells_to_avoid_are_gone_around() -> None:
    ground = ground_of(*floor())
    goal = Near(at(4, 0), 0)
    assert ground.way(at(0, 0), goal) == tuple(at(i, 0) for i in range(1, 5))
    assert at(2, 0) not in (ground.way(at(0, 0), goal, {at(2, 0)}) or ())
    assert ground.way(at(0, 0), goal, {at(i, k) for i in (2,) for k in range(7)}) is None


def test_a_path_goes_on_until_the_line_is_free() -> None:
    blocks, shape = floor()
    wall = {(LOW[0] + 4, LOW[1] + j, LOW[2] + k): STONE for j in range(4) for k in range(6)}
    goal = InReach(at(5, 2), 4.0)
    way = ground_of(blocks | wall, shape).way(at(1, 2), goal)
    assert way is not None
    # Through the gap of the wall, and not to where the block is near but hidden.
    assert goal.is_met(at(2, 2))
    assert way[-1][0] >= LOW[0] + 4
    glass = dict.fromkeys(wall, "glass") | {
        (*at(4, 6)[:1], LOW[1] + j, at(4, 6)[2]): STONE for j in range(4)
    }
    assert ground_of(blocks | glass, shape).way(at(1, 2), goal) is None


def test_areas_behind_a_wall_are_out_of_reach() -> None:
    blocks, shape = floor()
    wall = {(LOW[0] + 3, LOW[1] + j, LOW[2] + k): STONE for j in range(4) for k in range(7)}
    ground = ground_of(blocks | wall, shape)
    for start, end, is_apart in ((0, 2, False), (0, 6, True), (6, 0, True), (6, 4, False)):
        goal = Near(at(end, 3), 0)
        assert ground.may_lead(at(start, 3), goal) is not is_apart
        assert (ground.way(at(start, 3), goal) is None) is is_apart
    outside = (LOW[0] - 9, LOW[1], LOW[2])
    assert ground.way(outside, Near(at(0, 0), 0)) is None
    assert not ground.may_lead(outside, Near(at(0, 0), 0))


def hills(random: Random) -> tuple[Box, np.ndarray]:
    """Return hills with walls, gates and unknown blocks, in a box that has several chunks."""
    registry = Registry.load()
    texts = [AIR] * 60 + [STONE] * 6 + [ALONG_X, ALONG_Z, SHUT]
    states = [registry.state_id(text) for text in texts] + [-1] * 3
    shape = (random.randint(18, 40), random.randint(5, 20), random.randint(18, 40))
    grid = np.zeros(shape, dtype=np.int32)
    for i, k in np.ndindex(shape[0], shape[2]):
        top = int(2 + 2 * math.sin(i / 5) * math.cos(k / 6)) + (random.random() < 0.1)
        grid[i, : top + 1, k] = registry.state_id(STONE)
        if top + 1 < shape[1]:
            grid[i, top + 1, k] = random.choice(states)
        if random.random() < 0.02:
            grid[i, :, k] = registry.air
    high = tuple(a + size - 1 for a, size in zip(LOW, shape, strict=True))
    return Box(LOW, (high[0], high[1], high[2])), grid


@pytest.mark.parametrize("seed", few_by_day(range(12), 3))
@pytest.mark.parametrize("most", [footpaths._MOST_CELLS, 60])
def test_windows_of_a_large_box_have_the_paths_of_all_of_it(
    monkeypatch: pytest.MonkeyPatch, seed: int, most: int
) -> None:
    random, registry = Random(seed), Registry.load()
    box, grid = hills(random)
    whole = Ground(registry, box, grid)
    monkeypatch.setattr(terrain, "DENSE", 100)
    monkeypatch.setattr(footpaths, "_HALF", random.choice((4, 7)))
    monkeypatch.setattr(footpaths, "_MOST_CELLS", most)
    widened = []
    wider = footpaths._Footing.wider
    monkeypatch.setattr(
        footpaths._Footing, "wider", lambda *given: widened.append(1) or wider(*given)
    )
    parts = Ground(registry, box, Terrain.of(grid))
    around = [
        (LOW[0] + i, LOW[1] + j, LOW[2] + k)
        for i in range(-2, grid.shape[0] + 2)
        for j in range(-3, grid.shape[1] + 3)
        for k in range(-2, grid.shape[2] + 2)
    ]
    standing = [cell for cell in around if whole.stands(cell)]
    assert standing == [cell for cell in around if parts.stands(cell)]
    kinds = set()

    for _ in range(60):
        start, block = random.choice(standing), random.choice(random.choice((standing, around)))
        goal: WalkGoal = random.choice(
            (
                Near(block, 0),
                Near(block, 1.5),
                InReach(block, 4.0),
                InReach(block, 3.0),
            )
        )
        avoided = frozenset(random.sample(standing, random.choice((0, 0, 9))))
        opened = random.random() < 0.5
        pair = [each.with_doors_opened if opened else each for each in (whole, parts)]
        found, wanted = (each.way(start, goal, avoided) for each in pair)
        assert found == wanted
        kinds.add(found is None)
        if found is not None:
            assert pair[1].may_lead(start, goal)
        elif most > len(standing):
            assert pair[1].may_lead(start, goal) is pair[0].may_lead(start, goal)
    assert kinds == {True, False}
    assert len(widened) > 1
