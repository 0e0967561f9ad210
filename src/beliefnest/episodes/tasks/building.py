"""Common parts of built-in tasks: halls with a floor, walls, chests."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from beliefnest.world.values import Position

FLOOR, WALL, WINDOW = "smooth_stone", "stone_bricks", "glass"


def floor(width: int, depth: int) -> dict[str, Any]:
    """Return the floor of a hall, at y = 0."""
    return {"block": FLOOR, "fill": [[0, 0, 0], [width, 0, depth]]}


def wall(low: Position, high: Position, block: str = WALL) -> dict[str, Any]:
    """Return blocks between two corners."""
    return {"block": block, "fill": [list(low), list(high)]}


def chest(at: Position, items: Mapping[str, int] | None = None, label: str = "") -> dict[str, Any]:
    """Return a chest with its contents."""
    return {"at": list(at), "items": dict(items or {}), "label": label}


def abreast(
    names: Sequence[str], first: Sequence[float], step: tuple[float, float]
) -> dict[str, list[float]]:
    """Return feet positions of agents in a row.

    Args:
        names: Names of the agents.
        first: Feet of the first agent.
        step: Blocks in x and z from each agent to the next.
    """
    x, y, z = first
    return {
        name: [x + number * step[0], y, z + number * step[1]] for number, name in enumerate(names)
    }


def booths(
    names: Sequence[str], first: int
) -> tuple[dict[str, dict[str, Any]], list[dict[str, Any]]]:
    """Return agents in glass booths, four blocks apart, who can see and speak but reach nothing.

    Args:
        names: Names of the agents.
        first: Coordinate x of the first agent.

    Returns:
        The agents as in a scenario, facing north at z = 11, and the blocks around them.
    """
    places = {name: first + 4 * number for number, name in enumerate(names)}
    people = {
        name: {"position": [x + 0.5, 1, 11.5], "facing": "north"} for name, x in places.items()
    }
    panes = [wall((x - 1, 1, 10), (x + 1, 2, 12), WINDOW) for x in places.values()]
    return people, panes + [wall((x, 1, 11), (x, 2, 11), "air") for x in places.values()]


def also(names: Sequence[str], text: str) -> str:
    """Return a sentence about further agents, such as " Ben and Cleo can ..."; empty for none."""
    return f" {' and '.join(name.capitalize() for name in names)} {text}" if names else ""


def belief(
    path: str, contents: Mapping[Position, Mapping[str, int]], *, complete: bool = True
) -> dict[str, Any]:
    """Return an initial belief about contents of containers; `complete`: they hold nothing else."""
    return {
        "path": path,
        "containers": [
            {"at": list(place), "items": dict(items), "complete": complete}
            for place, items in sorted(contents.items())
        ],
    }


def hall(width: int, depth: int, blocks: Iterable[Mapping[str, Any]] = ()) -> dict[str, Any]:
    """Return a scenario's box and blocks: a hall with a floor that all agents know.

    Feet stand at y = 1; x goes from 0 to `width`, z from 0 to `depth`.
    """
    return {
        "box": [[0, 0, 0], [width, 3, depth]],
        "blocks": [floor(width, depth), *map(dict, blocks)],
        "static_blocks": [FLOOR, WALL, WINDOW],
    }


def passages(reach: int, number: int) -> tuple[list[Position], list[dict[str, Any]]]:
    """Return places of chests, each at the end of a passage, and the walls between the passages.

    Passages go west and east in turn from the middle of a hall, and are equally long. Whoever looks
    into one more chest than needed loses the way into a passage and back.

    Args:
        reach: Blocks from the middle of the hall to its ends.
        number: Number of chests, at most 6.
    """
    width, rows = 2 * reach, (1, 3, 5)
    places = [((1, width - 1)[each % 2], 1, rows[each // 2]) for each in range(number)]
    walls = [
        wall((x, 1, z), (x + reach - 2, 3, z), WINDOW)
        for z in (row + 1 for row in rows)
        for x in (0, reach + 2)
    ]
    return places, walls
