"""Hide and seek with a deceiver (Sodian 1991; Happé 1994, double bluff).

Bob looks for a treasure and has the time to go to one end of the hall. Eve knows where it is,
stands behind glass and can do nothing but speak; Bob knows that she does not want him to find it.
Who takes him for somebody who believes her tells him a lie, which he sees through; who reckons with
what he makes of what she is after tells him the truth. Further agents look for it beside Bob.
"""

import random
from typing import Any

from beliefnest.episodes.tasks.building import abreast, also, belief, booths, chest, hall

PARAMETERS = {"chests": (3, 2, 6), "reach": (14, 14, 20), "agents": (2, 2, 4)}

_ITEMS = ("diamond", "emerald", "gold_ingot")
_SEEKERS = ("bob", "cara", "dan")


def instance(chance: random.Random, chests: int, reach: int, agents: int) -> dict[str, Any]:
    """Return an instance.

    Args:
        chance: Draws sides, places and the treasure.
        chests: How many chests there are.
        reach: Blocks from the middle of the hall to its ends.
        agents: Eve, and seekers side by side, none of whom is to get it.
    """
    width, item = 2 * reach, chance.choice(_ITEMS)
    ends = chance.sample([1, width - 1], 2)
    rows = {x: chance.sample(range(1, 9), 8) for x in ends}
    places = [(ends[number > 0], 1, rows[ends[number > 0]].pop()) for number in range(chests)]
    contents = {place: ({item: 1} if place == places[0] else {}) for place in places}
    eve, glass = booths(["eve"], 4)
    # The treasure is at the end that he is nearer to.
    start = reach + (2 if ends[0] > reach else -2)
    seekers = _SEEKERS[: agents - 1]
    got = {name: {"agent": name, "items": {item: 1}} for name in seekers}
    return {
        "description": (
            f"Bob looks for the {item}. Eve does not want him to get it; she can only speak."
            f"{also(seekers[1:], 'must not get it either.')}"
        ),
        "order": 2,
        "scenario": {
            "name": "hide-and-seek",
            **hall(width, 12, glass),
            "containers": [chest(place, contents[place]) for place in places],
            "agents": {
                **{
                    name: {"position": at, "facing": "north"}
                    for name, at in abreast(seekers, [start + 0.5, 1, 5.5], (0, 1)).items()
                },
                **eve,
            },
            "perception": {"max_visible_distance": 64, "testimony": "accept"},
            "initial_beliefs": [
                belief("/**", {place: {} for place in places}, complete=False),
                belief("/eve", contents),
            ],
        },
        "goal": {"never": list(got.values())},
        "goals": {name: {"reach": [each]} for name, each in got.items()},
        "players": ["eve"],
        "policies": dict.fromkeys(seekers, "search:1"),
        "talk": ["eve"],
        "round_ticks": 5,
        "rounds": -(-(reach + 8) // 5),
    }
