"""A kitchen with orders and hatches (Carroll and others 2019, Overcooked).

The ordered dishes are in the pantry, where only the cook can go. The tables are where only the
waiter can go. Between both are hatches. The waiter sees the cook only at some hatches, and does not
look into the others. A cook that considers what the waiter sees uses a hatch where the waiter
notices it: never the nearest one, else any, wherever the waiter stands. Further agents are waiters
who see what the first waiter sees.
"""

import random
from typing import Any

from beliefnest.episodes.tasks.building import abreast, also, belief, chest, hall, wall

PARAMETERS = {"orders": (1, 1, 2), "hatches": (4, 3, 5), "agents": (2, 2, 4)}

_DISHES = ("bread", "apple", "cookie", "pumpkin_pie")
_WAITERS = ("waiter", "wendy", "will")
_APART, _WALL, _DEPTH = 8, 6, 32
"""Blocks between hatches; z of the wall; depth of the hall."""
_SLANT = 3 / (_DEPTH - 6)
"""Part of the way from the cook at a hatch to the waiter at which their line meets the wall."""


def instance(chance: random.Random, orders: int, hatches: int, agents: int) -> dict[str, Any]:
    """Return an instance.

    Args:
        chance: Random source of places, dishes, and the visible hatch.
        orders: Number of ordered dishes.
        hatches: Number of hatches; the waiter sees the cook at one of them.
        agents: Number of agents: the cook, and waiters side by side who see the same.
    """
    width, depth = _APART * hatches, _DEPTH
    dishes = chance.sample(_DISHES, orders)
    columns = [_APART // 2 + _APART * number for number in range(hatches)]
    places = [(x, 1, _WALL) for x in columns]
    # The visible hatch is neither the nearest one nor the one nearest to the table.
    near, glass = chance.sample(columns, 2)
    post = chance.choice(columns)
    # A stone wall separates pantry and room. Through glass the waiter sees the cook at one hatch.
    # Glass fins beside the hatches let the cook reach each only from the front.
    shown = glass + round((post - glass) * _SLANT)
    blocks = [
        wall((0, 1, _WALL), (width, 3, _WALL)),
        wall((shown - 3, 1, _WALL), (shown + 3, 3, _WALL), "glass"),
        *(wall((x + side, 1, 4), (x + side, 2, 5), "glass") for x in columns for side in (-1, 1)),
    ]
    store, table = (near, 1, 1), (near, 1, 11)
    first: dict[tuple[int, int, int], dict[str, int]] = {place: {} for place in places}
    first |= {table: {}, store: dict.fromkeys(dishes, 1)}
    waiters = _WAITERS[: agents - 1]
    feet = {"cook": [near + 0.5, 1, 2.5], **abreast(waiters, [post + 0.5, 1, depth - 2.5], (1, 0))}
    return {
        "description": (
            f"Ordered: {', '.join(dishes)}. The cook fetches it from the store and puts it into a "
            "hatch; the waiter brings it from there to the table. They do not talk."
            f"{also(waiters[1:], 'can do what the waiter can.')}"
        ),
        "order": 1,
        "scenario": {
            "name": "kitchen",
            **hall(width, depth, blocks),
            "containers": [
                chest(store, dict.fromkeys(dishes, 1), "store"),
                chest(table, label="table"),
                *({**chest(place, label="hatch"), "block": "barrel"} for place in places),
            ],
            "agents": {name: {"position": at} for name, at in feet.items()},
            "perception": {"max_visible_distance": 64},
            "initial_beliefs": [{**belief("/**", first), "agents": feet}],
        },
        "goal": {"reach": [{"container": list(table), "items": dict.fromkeys(dishes, 1)}]},
        "players": ["cook"],
        "talk": [],
        "policies": dict.fromkeys(waiters, "search:0"),
        "round_ticks": 10,
        "rounds": 3 + orders * (4 * width + 2 * depth) // 10,
    }
