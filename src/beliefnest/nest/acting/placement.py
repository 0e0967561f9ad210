"""Placement of agents in a body that cannot be where they are believed to be.

A belief may be physically impossible: an agent in a doorway whose door is now believed shut, two
agents in one place, a floor that is unknown (semantics, section 7). Every function here is a pure
function of the believed blocks, -1 unknown, and the believed agents, so that a body opened again is
the same. A place is the middle of an agent's feet. An agent takes up 0.6 by 1.8 by 0.6 blocks.
Unknown blocks stop nobody.
"""

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

from beliefnest.geometry.bodies import HARMFUL
from beliefnest.world.doors import is_open
from beliefnest.world.registry import BoxBounds, Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import HALF_WIDTH, AgentState, Box, Point, Position, block_at

__all__ = ["FARTHEST", "BodySpace", "PlacedBodies", "moved_agents", "placed", "unknown_floors"]

PlacedBodies = Mapping[str, tuple[Point, Point]]
"""Believed place and first place in the body, by agent."""

FARTHEST = 3.0
"""Greatest distance by which an agent is moved, in blocks."""

_HEIGHT = 1.8
_TOUCH = 1e-3
# Greatest height above a floor, in blocks, from which an agent settles on it without a fall.
_SETTLES = 0.5
_JUMP = 1.25
_DROP = 3.0
_AROUND = 4
_SIDES = ((1, 0), (-1, 0), (0, 1), (0, -1))


@dataclass(frozen=True, eq=False)
class BodySpace:
    """Believed blocks of a box, as obstacles and floors of agents."""

    registry: Registry
    box: Box
    blocks: Terrain

    def state(self, cell: Position) -> int:
        """Return the block state at a cell; -1 where it is unknown, air outside the box."""
        return self.blocks[self.box.index(cell)] if cell in self.box else self.registry.air

    def boxes_at(self, cell: Position) -> Iterator[BoxBounds]:
        """Yield the collision boxes of the block at a cell, in the coordinates of the box.

        Cells beside the box are invisible walls.
        """
        state = self.state(cell)
        x, y, z = cell
        (x_low, _, z_low), (x_high, _, z_high) = self.box.low, self.box.high
        if not (x_low <= x <= x_high and z_low <= z <= z_high):
            yield (x, y, z, x + 1, y + 1, z + 1)
            return
        for x0, y0, z0, x1, y1, z1 in self.registry.boxes(state) if state >= 0 else ():
            yield (x + x0, y + y0, z + z0, x + x1, y + y1, z + z1)

    def hits(self, room: BoxBounds) -> Iterator[BoxBounds]:
        """Yield the collision boxes that reach into a room by more than a touch."""
        x0, y0, z0, x1, y1, z1 = room
        xs, zs = _span(x0, x1), _span(z0, z1)
        # A shape may reach half a block out of its cell upwards, so test one more level below.
        for x, y, z in product(xs, _span(y0 - 1, y1), zs):
            for box in self.boxes_at((x, y, z)):
                sides = zip(box[:3], room[3:], box[3:], room[:3], strict=True)
                if all(a < b - _TOUCH and c > d + _TOUCH for a, b, c, d in sides):
                    yield box

    def is_free(self, *places: Point) -> bool:
        """Return True if no known block stops an agent at a place.

        Given two places at one height: if none stops it on the straight way between them.
        """
        return not any(True for _ in self.hits(_body(*places)))

    def has_floor(self, place: Point) -> bool:
        """Return True if known blocks hold an agent up."""
        x, y, z = place
        low = (x - HALF_WIDTH, y - _SETTLES, z - HALF_WIDTH)
        return any(True for _ in self.hits((*low, x + HALF_WIDTH, y, z + HALF_WIDTH)))

    def unknown_floor(self, place: Point) -> Position | None:
        """Return the unknown block into which an agent would fall; None if known blocks stop it."""
        if self.has_floor(place):
            return None
        x, y, z = block_at(place)
        for level in range(y - 1, self.box.low[1] - 1, -1):
            state = self.state((x, level, z))
            if state < 0:
                return (x, level, z)
            if self.registry.boxes(state):
                return None
        return None

    def heights(self, cell: Position) -> list[float]:
        """Return the heights in a cell at which an agent can stand in its middle on known floors.

        The lowest comes first.
        """
        x, y, z = cell
        column = (x + 0.5 - HALF_WIDTH, y - 1.0, z + 0.5 - HALF_WIDTH)
        room = (*column, x + 0.5 + HALF_WIDTH, y + 1.0, z + 0.5 + HALF_WIDTH)
        tops = {box[4] for box in self.hits(room) if y <= box[4] < y + 1}
        return [top for top in sorted(tops) if self.is_free((x + 0.5, top, z + 0.5))]

    def is_doorway(self, place: Point) -> bool:
        """Return True if the feet are in the block of a shut door."""
        state = self.state(block_at(place))
        named = state >= 0 and self.registry.name(state).endswith("_door")
        return named and is_open(self.registry, state) is False

    def is_clear(self, place: Point) -> bool:
        """Return True if nothing harmful or in the way is in an agent's cells or the one below."""
        x, y, z = block_at(place)
        cells = [(x, y + up, z) for up in (-1, 0, 1)]
        names = {self.registry.name(s) for cell in cells if (s := self.state(cell)) >= 0}
        beside = (box for cell in cells for box in self.boxes_at(cell))
        return not names & HARMFUL and all(box[4] <= place[1] + _TOUCH for box in beside)


def placed(
    space: BodySpace,
    agents: Mapping[str, AgentState],
    seen_at: Mapping[str, int | None],
    seen_now: Collection[str] = (),
) -> PlacedBodies:
    """Return the agents that cannot be where they are believed to be, with their new places.

    The new place is the nearest one within 3 blocks where the agent can stand. Places from which it
    can walk to the block where it was last seen are preferred, then places with a known floor. If
    there is no place at all the agent stays. Of two agents in one place, the one that was seen
    there last stays. If both were seen there at the same tick they did stand so, and both stay.

    Args:
        space: The believed blocks.
        agents: The believed agents.
        seen_at: Tick at which each agent was last seen; None: never.
        seen_now: Agents that are seen in this tick. These may stand in the block of a shut door,
            beside its leaf. Any other agent last seen in a doorway was there while it was open.

    Returns:
        Moves by agent, in order of names.
    """
    last = {name: -1 if tick is None else tick for name, tick in seen_at.items()}
    moved: dict[str, tuple[Point, Point]] = {}
    taken: list[tuple[Point, int | None]] = []
    for name in sorted(agents, key=lambda name: (-last[name], name)):
        agent, tick = agents[name], seen_at[name]
        place = agent.position
        others = [other for other, seen in taken if tick is None or seen != tick]
        shut_in = name not in seen_now and space.is_doorway(place)
        if shut_in or not _can_be(space, agent) or _is_taken(place, others):
            nearest = _nearest(space, place, [other for other, _ in taken])
            if nearest is not None:
                moved[name] = (place, nearest)
                place = nearest
        taken.append((place, tick))
    return dict(sorted(moved.items()))


def moved_agents(agents: Mapping[str, AgentState], moves: PlacedBodies) -> dict[str, AgentState]:
    """Return the states of the moved agents at their new places."""
    return {
        name: replace(agents[name], position=to, on_ground=True) for name, (_, to) in moves.items()
    }


def unknown_floors(space: BodySpace, agents: Mapping[str, AgentState]) -> frozenset[Position]:
    """Return the unknown blocks into which agents would fall. A body makes them solid."""
    floors = (space.unknown_floor(agent.position) for agent in agents.values())
    return frozenset(floor for floor in floors if floor is not None)


def _can_be(space: BodySpace, agent: AgentState) -> bool:
    place = agent.position
    if not space.is_free(place):
        return False
    held = space.has_floor(place) or space.unknown_floor(place) is not None
    return held or not agent.on_ground


def _is_taken(place: Point, taken: Sequence[Point]) -> bool:
    """Return True if another agent's feet are in the same block."""
    return block_at(place) in map(block_at, taken)


def _nearest(space: BodySpace, place: Point, taken: Sequence[Point]) -> Point | None:
    near = _walkable(space, block_at(place))
    found = [
        (block_at(to) not in near, not space.has_floor(to), math.dist(place, to), to)
        for to in _places(space, place)
        if math.dist(place, to) <= FARTHEST and space.is_clear(to) and not _is_taken(to, taken)
    ]
    return min(found)[-1] if found else None


def _places(space: BodySpace, place: Point) -> Iterator[Point]:
    """Yield the places near a place where an agent can stand, also on unknown floors."""
    for x, y, z in _cells_near(block_at(place)):
        # An agent on the topmost blocks has its feet one cell above the box.
        if (x, min(y, space.box.high[1]), z) in space.box:
            for height in _levels(space, (x, y, z)):
                yield (x + 0.5, height, z + 0.5)


def _levels(space: BodySpace, cell: Position) -> list[float]:
    """Return the heights of a cell, or its lower face if the floor there is unknown."""
    x, y, z = cell
    known = space.heights(cell)
    if known or space.state((x, y - 1, z)) >= 0 or not space.is_free((x + 0.5, y, z + 0.5)):
        return known
    return [float(y)]


def _walkable(space: BodySpace, goal: Position) -> set[Position]:
    """Return the cells near a goal from whose middle an agent can walk to the goal.

    This is a search backwards from the goal, cell by cell. A step is possible if the agent need not
    jump higher than `_JUMP` or drop deeper than `_DROP`, and if nothing stops it on the straight
    way at the higher of the two levels. The goal itself is included.
    """
    near = set(_cells_near(goal))
    waiting = [(goal, height) for height in _levels(space, goal)]
    seen = set(waiting)
    while waiting:
        (x, y, z), height = waiting.pop()
        for (dx, dz), up in product(_SIDES, range(-1, 4)):
            cell = (x + dx, y + up, z + dz)
            for other in space.heights(cell) if cell in near else ():
                higher, step = max(height, other), (cell, other)
                ends = (x + 0.5, higher, z + 0.5), (cell[0] + 0.5, higher, cell[2] + 0.5)
                climbs = -_DROP <= height - other <= _JUMP
                if climbs and step not in seen and space.is_free(*ends):
                    seen.add(step)
                    waiting.append(step)
    return {cell for cell, _ in seen}


def _cells_near(cell: Position) -> Iterator[Position]:
    reach = range(-_AROUND, _AROUND + 1)
    for dx, dy, dz in product(reach, reach, reach):
        yield (cell[0] + dx, cell[1] + dy, cell[2] + dz)


def _span(low: float, high: float) -> range:
    return range(math.floor(low), math.floor(high) + 1)


def _body(*places: Point) -> BoxBounds:
    """Return the room that an agent takes up at places and between them."""
    xs, ys, zs = zip(*places, strict=True)
    return (
        min(xs) - HALF_WIDTH,
        min(ys),
        min(zs) - HALF_WIDTH,
        max(xs) + HALF_WIDTH,
        max(ys) + _HEIGHT,
        max(zs) + HALF_WIDTH,
    )
