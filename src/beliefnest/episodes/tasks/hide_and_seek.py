"""Hide and seek with a deceiver (Sodian 1991; Happé 1994, double bluff).

Bob looks for a treasure and has time to go to one end of the hall. Eve knows where the treasure is,
stands behind glass and can only speak. Bob knows that she does not want him to find it. If Eve
expects Bob to believe her, she tells a lie, and he sees through it. If she considers what Bob
concludes from her goal, she tells the truth. Further agents look for the treasure beside Bob.
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
        chance: Random source of sides, places and the treasure.
        chests: Number of chests.
        reach: Blocks from the middle of the hall to its ends.
        agents: Number of agents: Eve, and seekers side by side, none of whom may get the treasure.
    """
    width, item = 2 * reach, chance.choice(_ITEMS)
    ends = chance.sample([1, width - 1], 2)
    rows = {x: chance.sample(range(1, 9), 8) for x in ends}
    places = [(ends[number > 0], 1, rows[ends[number > 0]].pop()) for number in range(chests)]
    contents = {place: ({item: 1} if place == places[0] else {}) for place in places}
    eve, glass = booths(["eve"], 4)
    # The treasure is at the end that is nearer to Bob.
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
