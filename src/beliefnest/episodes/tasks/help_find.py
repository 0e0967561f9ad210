"""Help an agent with a false belief (Buttelmann, Carpenter and Tomasello 2009, with speech).

Sally wants a thing that was moved while she was away, and has no time to look into every chest.
Anne stands behind glass: she saw the move, and can only speak, once. An agent that does not
consider what Sally believes sees no need to speak.
"""

import random
from typing import Any

from beliefnest.episodes.tasks.building import belief, booths, chest, hall

PARAMETERS = {"chests": (4, 2, 8), "reach": (16, 16, 24), "agents": (2, 2, 4)}

_ITEMS = ("diamond", "emerald", "apple", "compass")
_ONLOOKERS = ("ben", "cleo")


def instance(chance: random.Random, chests: int, reach: int, agents: int) -> dict[str, Any]:
    """Return an instance.

    Args:
        chance: Random source of sides, places and the thing.
        chests: Number of chests.
        reach: Blocks from the middle of the hall to its ends.
        agents: Number of agents: Sally, Anne, and agents behind glass who know what Sally knows.
    """
    width, item = 2 * reach, chance.choice(_ITEMS)
    sides = [("west", 1), ("east", width - 1)]
    chance.shuffle(sides)
    places = _places(chance, chests, sides)
    before, now = places[0], places[1]
    onlookers = _ONLOOKERS[: agents - 2]
    behind_glass, glass = booths(["anne", *onlookers], 4)
    contents = {place: ({item: 1} if place == now else {}) for place in places}
    jitter = chance.randint(-1, 1)
    return {
        "description": (
            f"Sally wants the {item}. It was moved while she was away; Anne saw that. Anne cannot "
            "leave her booth, but Sally hears her."
        ),
        "order": 1,
        "scenario": {
            "name": "help-find",
            **hall(width, 12, glass),
            "containers": [chest(place, contents[place]) for place in places],
            "agents": {
                "sally": {"position": [reach + jitter + 0.5, 1, 5.5], "facing": "north"},
                **behind_glass,
            },
            "perception": {"max_visible_distance": 64, "testimony": "accept"},
            "initial_beliefs": [
                belief("/**", {before: {item: 1}}, complete=False),
                belief("/anne", contents),
            ],
        },
        "goal": {"reach": [{"agent": "sally", "items": {item: 1}}], "messages": 1},
        "players": ["anne"],
        "policies": {"sally": "search:0", **dict.fromkeys(onlookers, "search:0")},
        "talk": ["anne", *onlookers],
        "round_ticks": 5,
        "rounds": -(-(reach + 14) // 5),
    }


def _places(
    chance: random.Random, chests: int, sides: list[tuple[str, int]]
) -> list[tuple[int, int, int]]:
    """Return places of chests: the first at one end of the hall, the second at the other."""
    rows = {name: chance.sample(range(1, 9), 8) for name, _ in sides}
    places = []
    for number in range(chests):
        name, x = sides[number % 2]
        places.append((x, 1, rows[name].pop()))
    return places
