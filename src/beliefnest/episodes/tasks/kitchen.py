"""A kitchen with orders and hatches (Carroll and others 2019, Overcooked).

The ordered dishes are in the pantry, where only the cook can go. The tables are where only the
waiter can go. Between both are hatches. The waiter sees the cook only at some hatches, and does not
look into the others. A cook that considers what the waiter sees uses a hatch where the waiter
notices it. Further agents are waiters who see what the first waiter sees.
"""

import random
from typing import Any

from beliefnest.episodes.tasks.building import abreast, also, belief, chest, hall, wall

PARAMETERS = {"orders": (1, 1, 2), "hatches": (2, 2, 3), "agents": (2, 2, 4)}

_DISHES = ("bread", "apple", "cookie", "pumpkin_pie")
_WAITERS = ("waiter", "wendy", "will")


def instance(chance: random.Random, orders: int, hatches: int, agents: int) -> dict[str, Any]:
    """Return an instance.

    Args:
        chance: Random source of places, dishes, and the visible hatch.
        orders: Number of ordered dishes.
        hatches: Number of hatches; the waiter sees the cook at one of them.
        agents: Number of agents: the cook, and waiters side by side who see the same.
    """
    width, depth = 10 * hatches, 12
    dishes = chance.sample(_DISHES, orders)
    places = [(4 + 10 * number, 1, 6) for number in range(hatches)]
    seen = chance.randrange(hatches)
    # A stone wall separates pantry and room; glass lets the waiter see the cook.
    glass = places[seen][0]
    blocks = [
        wall((0, 1, 6), (width, 3, 6)),
        wall((glass - 3, 1, 6), (glass + 3, 3, 6), "glass"),
        # Walls between hatches, so that the glass shows only one hatch.
        *(wall((x + 5, 1, 3), (x + 5, 3, 5)) for x, _, _ in places[:-1]),
    ]
    # The visible hatch is neither the nearest one nor the one nearest to the table.
    near = chance.choice([x for x, _, _ in places if x != glass])
    store, table = (near, 1, 1), (near, 1, 11)
    first: dict[tuple[int, int, int], dict[str, int]] = {place: {} for place in places}
    first |= {table: {}, store: dict.fromkeys(dishes, 1)}
    waiters = _WAITERS[: agents - 1]
    feet = {
        "cook": [near + 0.5, 1, 2.5],
        **abreast(waiters, [glass + 0.5, 1, 9.5], (1, 0)),
    }
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
                *(chest(place, label="hatch") for place in places),
            ],
            "agents": {name: {"position": at} for name, at in feet.items()},
            "perception": {"max_visible_distance": 64},
            "initial_beliefs": [{**belief("/**", first), "agents": feet}],
        },
        "goal": {"reach": [{"container": list(table), "items": dict.fromkeys(dishes, 1)}]},
        "players": ["cook"],
        "policies": dict.fromkeys(waiters, "search:0"),
        "round_ticks": 10,
        "rounds": 3 + 3 * orders,
    }
