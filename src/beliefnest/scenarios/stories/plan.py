"""The floor plan of a story: rooms along a corridor, without sight from one to another.

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

A way in is `_BEND` blocks wide between its two openings, so that no ray passes both: with
one block between the corners it would have to leave the first opening by its wall. So
nobody in the corridor or in a room sees into any other room or cell. The walls are as high
as the box, and eyes (1.62) are above barrels (1): within a room all is seen.

In a story in which somebody tells something, who is in no room is in a further room without
barrels, the hall, in place of a cell: there all see who comes, and hear each other.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from beliefnest.errors import InputError
from beliefnest.scenarios.stories.story import WAITING_ROOM, Place, Story
from beliefnest.world.frames import BlockGrid, Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.values import AgentState, Box, Items, Point, Position

__all__ = ["WALL", "FloorPlan", "feet", "lay_out"]

WALL = "stone"
"""The block of walls and floors; nothing else is made of it."""

_CONTAINER = "barrel"
_DOOR = "oak_door"
_SIGN = "oak_sign[rotation=8]"
_HEIGHT = 3
_CELL, _CORRIDOR, _ROOM, _STANDS, _BARRELS, _DEPTH = 1, 4, 8, 9, 10, 12
"""Rows along z."""

_BEND = 3


@dataclass(frozen=True, slots=True)
class FloorPlan:
    """Where everything of a story is, in blocks.

    Attributes:
        snapshot: The world before the story.
        places: Position of each container's block.
        apart: Where each agent is while it is in no room, the block of its feet: a cell of its
            own, or its stand in the hall.
        stands: Where each agent stands in each room, by (room, agent), block of the feet.
        doors: Where the door of each room that has one is, its lower half.
        items: The Minecraft item that stands for each thing; no two share one.
        signs: Where the sign of each room that has one is.
    """

    snapshot: Snapshot
    places: Mapping[Place, Position]
    apart: Mapping[str, Position]
    stands: Mapping[tuple[str, str], Position]
    items: Mapping[str, str]
    doors: Mapping[str, Position]
    signs: Mapping[str, Position]

    def place_at(self, position: Position) -> Place:
        """Return the container at a position of one."""
        return next(place for place, where in self.places.items() if where == position)


def lay_out(story: Story) -> FloorPlan:
    """Return a plan with all rooms, containers and agents of a story; everyone is in no room.

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
    # Above a container if there is one: who stands in the room sees both.
    signs = {
        room: (start, 2 if any(place.room == room for place in story.places) else 1, _BARRELS)
        for room, (start, _) in zip(story.rooms, spans, strict=False)
        if room in story.signs
    }
    for position in signs.values():
        grid[position] = registry.state_id(_SIGN)
    grid.flags.writeable = False
    items = item_names(tuple(story.things), registry)
    contents: dict[Position, Items] = {position: {} for position in places.values()}
    for thing, place in story.things.items():
        contents[places[place]] = {**contents[places[place]], items[thing]: 1}
    apart = apart or cells
    agents = {name: AgentState(feet(block)) for name, block in apart.items()}
    snapshot = Snapshot(0, box, grid, contents, agents)
    return FloorPlan(snapshot, places, apart, stands, items, doors, signs)


def feet(block: Position) -> Point:
    """Middle of the feet of one who stands in the middle of a block."""
    x, y, z = block
    return (x + 0.5, float(y), z + 0.5)


def _carved(
    box: Box,
    spans: Sequence[tuple[int, int]],
    cells: Mapping[str, Position],
    registry: Registry,
) -> BlockGrid:
    """Walls and floors, with all rooms, ways and cells cut out.

    Args:
        box: The whole.
        spans: First x and width of each room.
        cells: Each agent's cell.
        registry: Of the blocks.

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
    """Return a Minecraft item of its own for every thing.

    A thing that is an item by name stands for itself, the others take the remaining
    items in the registry's order.

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
