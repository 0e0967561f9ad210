"""A recipe of which each cook knows a half (Stasser and Titus 1985, hidden profiles).

Two cooks in separate rooms share one pot. The ingredient that each cook must bring is in the cook's
own room, in a chest that only the other cook knows. A cook that considers what the other cook
does not know tells it. Further agents cook beside Bob: they know what he knows, and say nothing.
"""

import random
from typing import Any

from beliefnest.episodes.tasks.building import abreast, also, belief, chest, hall, wall

PARAMETERS = {"chests": (4, 2, 6), "reach": (18, 16, 24), "agents": (2, 2, 4)}

_ITEMS = ("wheat", "sugar", "egg", "apple", "carrot")
_COOKS = ("bob", "carl", "dora")


def instance(chance: random.Random, chests: int, reach: int, agents: int) -> dict[str, Any]:
    """Return an instance.

    Args:
        chance: Random source of places and ingredients.
        chests: Number of chests in each room.
        reach: Blocks from the pot to the end of each room.
        agents: Number of agents: Anne, Bob, and cooks beside Bob who know what he knows and say
            nothing.
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
    cooks = _COOKS[: agents - 1]
    feet = {
        "anne": [reach - 3.5, 1, 4.5],
        **abreast(cooks, [reach + 4.5, 1, 4.5], (0, 1)),
    }
    return {
        "description": (
            f"The pot needs {wanted['anne']} and {wanted['bob']}. Anne and Bob cannot leave their "
            "rooms. Each knows where the other's half is in the other's room, but not its own."
            f"{also(cooks[1:], 'can go where Bob can, but cannot talk.')}"
        ),
        "order": 1,
        "scenario": {
            "name": "recipe",
            **hall(width, depth, [wall((reach, 1, 0), (reach, 3, depth), "glass")]),
            "containers": [chest(pot, label="pot")]
            + [chest(place, items) for place, items in sorted({**others, **contents}.items())],
            "agents": {name: {"position": at, "facing": "north"} for name, at in feet.items()},
            "perception": {"max_visible_distance": 64, "testimony": "accept"},
            "initial_beliefs": [
                belief("/**", {pot: {}}),
                belief("/anne", {pot: {}, **known["bob"]}, complete=False),
                *(belief(f"/{name}", {pot: {}, **known["anne"]}, complete=False) for name in cooks),
            ],
        },
        "goal": {"reach": [{"container": list(pot), "items": dict.fromkeys(wanted.values(), 1)}]},
        "players": ["anne", "bob"],
        **({"policies": dict.fromkeys(cooks[1:], "search:0")} if cooks[1:] else {}),
        "talk": ["anne", "bob"],
        "round_ticks": 5,
        "rounds": -(-(2 * reach + 4) // 5),
    }


def _room(
    chance: random.Random, chests: int, columns: list[int], farthest: int
) -> list[tuple[int, int, int]]:
    """Return the places of a room's chests; the first is the farthest from the pot."""
    places = [(x, 1, chance.choice((0, 8))) for x in sorted(chance.sample(columns, chests - 1))]
    return [(farthest, 1, chance.choice((1, 7))), *places]
