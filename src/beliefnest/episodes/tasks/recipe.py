"""A recipe of which each knows a half (Stasser and Titus 1985, hidden profiles).

Two cooks in rooms apart have one pot between them. What each has to bring lies in its own room, in
a chest that only the other knows. Whoever reckons with what the other does not know says it.
"""

import random
from typing import Any

from beliefnest.episodes.tasks.building import belief, chest, hall, wall

PARAMETERS = {"chests": (4, 2, 6), "reach": (18, 16, 24)}

_ITEMS = ("wheat", "sugar", "egg", "apple", "carrot")


def instance(chance: random.Random, chests: int, reach: int) -> dict[str, Any]:
    """An instance.

    Args:
        chance: Draws places and ingredients.
        chests: How many chests stand in each room.
        reach: Blocks from the pot to the end of each room.
    """
    width, depth = 2 * reach, 8
    wanted = dict(zip(("anne", "bob"), chance.sample(_ITEMS, 2), strict=True))
    pot = (reach, 1, 4)
    rooms = {
        "anne": _room(chance, chests, list(range(2, reach - 4)), farthest=1),
        "bob": _room(chance, chests, list(range(reach + 5, width - 1)), farthest=width - 1),
    }
    contents = {place: {wanted[cook]: 1} for cook, (place, *_) in rooms.items()}
    others: dict[tuple[int, int, int], dict[str, int]] = {
        place: {} for places in rooms.values() for place in places[1:]
    }
    known = {cook: {rooms[cook][0]: {wanted[cook]: 1}} for cook in wanted}
    return {
        "description": (
            f"The pot needs {wanted['anne']} and {wanted['bob']}. Anne and Bob cannot leave their "
            "rooms. Each knows where in the other's room the other's half is, and not its own."
        ),
        "order": 1,
        "scenario": {
            "name": "recipe",
            **hall(width, depth, [wall((reach, 1, 0), (reach, 3, depth), "glass")]),
            "containers": [chest(pot, label="pot")]
            + [chest(place, items) for place, items in sorted({**others, **contents}.items())],
            "agents": {
                "anne": {"position": [reach - 3.5, 1, 4.5], "facing": "north"},
                "bob": {"position": [reach + 4.5, 1, 4.5], "facing": "north"},
            },
            "perception": {"max_visible_distance": 64, "testimony": "accept"},
            "initial_beliefs": [
                belief("/**", {pot: {}}),
                belief("/anne", {pot: {}, **known["bob"]}, complete=False),
                belief("/bob", {pot: {}, **known["anne"]}, complete=False),
            ],
        },
        "goal": {"reach": [{"container": list(pot), "items": dict.fromkeys(wanted.values(), 1)}]},
        "players": ["anne", "bob"],
        "talk": ["anne", "bob"],
        "round_ticks": 5,
        "rounds": -(-(2 * reach + 4) // 5),
    }


def _room(
    chance: random.Random, chests: int, columns: list[int], farthest: int
) -> list[tuple[int, int, int]]:
    """Places of a room's chests; the first is the farthest from the pot."""
    places = [(x, 1, chance.choice((0, 8))) for x in sorted(chance.sample(columns, chests - 1))]
    return [(farthest, 1, chance.choice((1, 7))), *places]
