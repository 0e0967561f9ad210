"""Hide and seek with a deceiver (Sodian 1991; Wimmer and Perner 1983).

Bob saw where the treasure was put and runs for it. Eve stands behind glass and can do nothing but
speak; Bob takes her at her word. Who reckons with what he will make of it tells him a lie.
"""

import random
from typing import Any

from beliefnest.episodes.tasks.building import belief, chest, hall, wall

PARAMETERS = {"chests": (3, 2, 6), "reach": (14, 14, 20)}

_ITEMS = ("diamond", "emerald", "gold_ingot")


def instance(chance: random.Random, chests: int, reach: int) -> dict[str, Any]:
    """An instance.

    Args:
        chance: Draws sides, places and the treasure.
        chests: How many chests there are.
        reach: Blocks from the middle of the hall to its ends.
    """
    width, item = 2 * reach, chance.choice(_ITEMS)
    ends = chance.sample([1, width - 1], 2)
    rows = {x: chance.sample(range(1, 9), 8) for x in ends}
    places = [(ends[number > 0], 1, rows[ends[number > 0]].pop()) for number in range(chests)]
    contents = {place: ({item: 1} if place == places[0] else {}) for place in places}
    booth = 4
    return {
        "description": (
            f"Bob runs for the {item}. Eve does not want him to get it in time; she can only speak."
        ),
        "order": 1,
        "scenario": {
            "name": "hide-and-seek",
            **hall(
                width,
                12,
                [
                    wall((booth - 1, 1, 10), (booth + 1, 2, 12), "glass"),
                    wall((booth, 1, 11), (booth, 2, 11), "air"),
                ],
            ),
            "containers": [chest(place, contents[place]) for place in places],
            "agents": {
                "bob": {"position": [reach + 0.5, 1, 5.5], "facing": "north"},
                "eve": {"position": [booth + 0.5, 1, 11.5], "facing": "north"},
            },
            "perception": {"max_visible_distance": 64, "testimony": "accept"},
            "initial_beliefs": [
                belief("/**", {places[0]: {item: 1}}, complete=False),
                belief("/eve", contents),
            ],
        },
        "goal": {"never": [{"agent": "bob", "items": {item: 1}}]},
        "goals": {"bob": {"reach": [{"agent": "bob", "items": {item: 1}}]}},
        "players": ["eve"],
        "policies": {"bob": "search:0"},
        "talk": ["eve"],
        "round_ticks": 5,
        "rounds": -(-(reach + 8) // 5),
    }
