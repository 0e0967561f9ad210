"""Floor plan of a story: rooms along a corridor, with no line of sight between them.

Seen from above, with two rooms and two cells; `B` is a barrel, `a` a stand, `.` floor:

    #############
    #BBB..#BB...#
    #aa...#aa...#     rooms
    #.....#.....#
    ####.#####.##
    #....##....##     every way in goes around two corners
    #.####.######
    #...........#     the corridor
    #.####.######
    #....#....###
    ####a####a###     cells, one for each agent

An entrance has two openings that are offset by `_BEND` blocks, so that no ray passes both:
with one block between the corners, a ray would have to pass through the wall of the first
opening. Agents in the corridor or in a room therefore see into no other room or cell. The
walls are as high as the box, and eyes (1.62) are above barrels (1), so that agents in a room
see all of it.

In a story with testimony, agents that are in no room are in the hall instead of their cells.
The hall is a further room without barrels; agents there see and hear each other.
"""

from collections.abc import Mapping, Sequence

import msgspec
import numpy as np

from beliefnest.errors import InputError
from beliefnest.suites.stories.story import WAITING_ROOM, HandOver, Place, Story
from beliefnest.world.frames import BlockGrid, Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, Box, Items, Point, Position

WALL = "stone"
"""Block of walls and floors, which nothing else is made of."""

_CONTAINER = "barrel"
_DOOR = "oak_door"
_SIGN = "oak_sign[rotation=8]"
_HEIGHT = 3
_CELL, _CORRIDOR, _ROOM, _STANDS, _BARRELS, _DEPTH = 1, 4, 8, 9, 10, 12
"""Rows along z."""

_BEND = 3


class FloorPlan(msgspec.Struct, frozen=True):
    """Positions of everything in a story, in blocks.

    Attributes:
        snapshot: The world before the story.
        places: Position of each container.
        apart: Block of each agent's feet while it is in no room: in its own cell, or at its
            stand in the hall.
        stands: Block of an agent's feet in a room, by (room, agent).
        doors: Position of the lower half of each door, by room.
        items: Minecraft item of each thing; different things have different items.
        signs: Position of each sign, by room.
    """

    snapshot: Snapshot
    places: Mapping[Place, Position]
    apart: Mapping[str, Position]
    stands: Mapping[tuple[str, str], Position]
    items: Mapping[str, str]
    doors: Mapping[str, Position]
    signs: Mapping[str, Position]

    def place_at(self, position: Position) -> Place:
        """Return the container at a position; there must be one."""
        return next(place for place, where in self.places.items() if where == position)


def lay_out(story: Story) -> FloorPlan:
    """Return a plan with all rooms, containers and agents of a story; no agent is in a room.

    Raises:
        InputError: The story has more things than Minecraft has items.
    """
    registry = Registry.load()
    places: dict[Place, Position] = {}
    stands: dict[tuple[str, str], Position] = {}
    spans: list[tuple[int, int]] = []
    start = 1
    for room in (*story.rooms, WAITING_ROOM) if story.tells else story.rooms:
        inside = [place for place in story.places if place.room == room]
        width = max(_BEND + 1, len(inside), len(story.agents))
        places.update({p: (start + i, 1, _BARRELS) for i, p in enumerate(inside)})
        stands.update({(room, a): (start + i, 1, _STANDS) for i, a in enumerate(story.agents)})
        spans.append((start, width))
        start += width + 1
    cells = {
        agent: (1 + number * (_BEND + 2) + _BEND, 1, _CELL)
        for number, agent in enumerate(() if story.tells else story.agents)
    }
    apart = {agent: stands.pop((WAITING_ROOM, agent)) for agent in story.agents if story.tells}
    length = max(start, 1 + len(cells) * (_BEND + 2), 3)
    box = Box((0, 0, 0), (length - 1, _HEIGHT - 1, _DEPTH - 1))
    grid = _carved(box, spans, cells, registry)
    for position in places.values():
        grid[position] = registry.state_id(_CONTAINER)
    doors = {
        room: (start + _BEND, 1, _ROOM - 1)
        for room, (start, _) in zip(story.rooms, spans, strict=False)
        if room in story.doors
    }
    for x, y, z in doors.values():
        for height, half in enumerate(("lower", "upper")):
            grid[x, y + height, z] = registry.state_id(
                f"{_DOOR}[facing=north,half={half},open=true]"
            )
    # Put the sign above a container if there is one: agents in the room see both.
    signs = {
        room: (start, 2 if any(place.room == room for place in story.places) else 1, _BARRELS)
        for room, (start, _) in zip(story.rooms, spans, strict=False)
        if room in story.signs
    }
    for position in signs.values():
        grid[position] = registry.state_id(_SIGN)
    items = item_names(tuple(story.things), registry)
    owned: dict[Place | HandOver, dict[str, int]] = {}
    for thing, place in story.things.items():
        owned.setdefault(place, {})[items[thing]] = 1
    contents: dict[Position, Items] = {at: owned.get(place, {}) for place, at in places.items()}
    apart = apart or cells
    begins = apart | {agent: stands[room, agent] for agent, room in story.present.items()}
    agents = {
        name: AgentState(feet(block), inventory=owned.get(HandOver(name), {}))
        for name, block in begins.items()
    }
    snapshot = Snapshot(0, box, Terrain.of(grid), contents, agents)
    return FloorPlan(snapshot, places, apart, stands, items, doors, signs)


def feet(block: Position) -> Point:
    """Return the feet position of an agent in the middle of a block."""
    x, y, z = block
    return (x + 0.5, float(y), z + 0.5)


def _carved(
    box: Box, spans: Sequence[tuple[int, int]], cells: Mapping[str, Position], registry: Registry
) -> BlockGrid:
    """Return walls and floors with all rooms, entrances and cells cut out.

    Args:
        box: Box of the whole plan.
        spans: First x and width of each room.
        cells: Cell of each agent.
        registry: Registry of block states.

    Returns:
        Block state ids, shape `box.shape`.
    """
    grid: BlockGrid = np.full(box.shape, registry.state_id(WALL), dtype=np.int32)
    air = registry.air
    grid[1:-1, 1:, _CORRIDOR] = air
    for start, width in spans:
        grid[start : start + width, 1:, _ROOM : _BARRELS + 1] = air
        grid[start, 1:, _CORRIDOR + 1] = air
        grid[start : start + _BEND + 1, 1:, _CORRIDOR + 2] = air
        grid[start + _BEND, 1:, _CORRIDOR + 3] = air
    for x, _, z in cells.values():
        grid[x, 1:, z] = air
        grid[x - _BEND : x + 1, 1:, z + 1] = air
        grid[x - _BEND, 1:, z + 2] = air
    return grid


def item_names(things: Sequence[str], registry: Registry) -> dict[str, str]:
    """Assign a different Minecraft item to every thing.

    A thing with the name of an item gets that item. The others get the remaining items in the
    registry's order.

    Raises:
        InputError: There are not enough items.
    """
    named = {thing: thing for thing in things if registry.has_item(thing) and thing != "air"}
    rest = [thing for thing in things if thing not in named]
    free = (i for i in registry.item_names if i not in ("air", WALL) and i not in named)
    named.update(zip(rest, free, strict=False))
    if len(named) < len(things):
        raise InputError(
            f"the story has {len(things)} things and Minecraft {len(registry.item_names)} items; "
            "leave some out"
        )
    return {thing: named[thing] for thing in things}
