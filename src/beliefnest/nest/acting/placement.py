"""Placement of agents in a body that cannot be where they are believed to be.

A belief may be physically impossible: an agent in a doorway whose door is now believed shut, two
agents in one place, a floor that is unknown (semantics, section 7). Every function here is a pure
function of the believed blocks, -1 unknown, and the believed agents, so that a body opened again is
the same. A place is the middle of an agent's feet. An agent takes up 0.6 by 1.8 by 0.6 blocks.
Unknown blocks stop nobody. `geometry` says where agents stand and walk; the boxes of blocks say
whether an agent fits at a place between cells, such as beside the leaf of a shut door.
"""

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import product

import msgspec
from msgspec.structs import replace

from beliefnest.geometry.bodies import HARMFUL
from beliefnest.world.doors import is_open
from beliefnest.world.registry import BoxBounds, Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import HALF_WIDTH, AgentState, Box, Point, Position, block_at
from beliefnest.worlds.scripted.footpaths import Ground, Near

PlacedBodies = Mapping[str, tuple[Point, Point]]
"""Believed place and first place in the body, by agent."""

FARTHEST = 3.0
"""Greatest distance by which an agent is moved, in blocks."""

_HEIGHT = 1.8
_TOUCH = 1e-3
# Greatest height above a floor, in blocks, from which an agent settles on it without a fall.
_SETTLES = 0.5
_AROUND = 4
_BEYOND = 3
"""Cells beyond a part at which its steps look."""


class BodySpace(msgspec.Struct, frozen=True, eq=False):
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

    def ground(self, low: Position, high: Position) -> Ground:
        """Return the ground between two corners, for steps up to some cells beyond them."""
        corners = [
            tuple(
                min(max(at + far, first), last)
                for at, first, last in zip(corner, self.box.low, self.box.high, strict=True)
            )
            for corner, far in ((low, -_BEYOND), (high, _BEYOND))
        ]
        (a, b, c), (d, e, f) = corners
        i, j, k = self.box.index((d, e, f))
        part = self.blocks.cut(self.box.index((a, b, c)), (i + 1, j + 1, k + 1))
        return Ground(self.registry, Box((a, b, c), (d, e, f)), part)

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
    is_supported = space.has_floor(place) or space.unknown_floor(place) is not None
    return is_supported or not agent.on_ground


def _is_taken(place: Point, taken: Sequence[Point]) -> bool:
    """Return True if another agent's feet are in the same block."""
    return block_at(place) in map(block_at, taken)


def _nearest(space: BodySpace, place: Point, taken: Sequence[Point]) -> Point | None:
    low, high = (_moved(block_at(place), far) for far in (-_AROUND, _AROUND))
    ground = space.ground(low, high)
    cells = {
        ground.feet(cell): cell for cell in _cells_near(block_at(place)) if ground.stands(cell)
    }
    goals = _ends(space, ground, place, cells)
    candidates = [
        (not _leads(ground, cell, goals), not space.has_floor(to), math.dist(place, to), to)
        for to, cell in cells.items()
        if math.dist(place, to) <= FARTHEST
        and space.is_free(to)
        and space.is_clear(to)
        and not _is_taken(to, taken)
    ]
    return min(candidates)[-1] if candidates else None


def _ends(
    space: BodySpace, ground: Ground, place: Point, cells: Mapping[Point, Position]
) -> list[Position]:
    """Return the cell of a place or, where nobody stands there, the cells open towards it.

    The leaf of a shut door stands on one side of its block, and the other side is open.
    """
    own = ground.cell_of(place)
    if ground.stands(own):
        return [own]
    x, _, z = own
    beside = [(to, cell) for to, cell in cells.items() if abs(cell[0] - x) + abs(cell[2] - z) == 1]
    levels = [(max(to[1], place[1]), to, cell) for to, cell in beside]
    return [
        cell
        for level, to, cell in levels
        if abs(to[1] - place[1]) <= 1
        and space.is_free((to[0], level, to[2]), (x + 0.5, level, z + 0.5))
    ]


def _leads(ground: Ground, cell: Position, goals: Sequence[Position]) -> bool:
    """Return True if an agent can walk from a cell to one of some goals."""
    return any(ground.way(cell, Near(goal, 0)) is not None for goal in goals)


def _moved(cell: Position, by: int) -> Position:
    return (cell[0] + by, cell[1] + by, cell[2] + by)


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
