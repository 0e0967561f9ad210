"""Tell only what the other does not know (Grice 1975; Bard and others 2020 on costly hints).

Max has to fetch several things and knows where they were. Some were moved while he was away; Nora
sees from behind glass where everything is. She may speak as often as things were moved and not once
more, and Max has not the time to look around.
"""

import random
from typing import Any

from beliefnest.episodes.tasks.building import belief, chest, hall, wall

PARAMETERS = {"items": (3, 1, 4), "moved": (1, 1, 2), "reach": (26, 26, 32), "agents": (2, 2, 4)}

_ITEMS = ("diamond", "emerald", "apple", "compass", "bread")
_ONLOOKERS = ("ben", "cleo")


def instance(
    chance: random.Random, items: int, moved: int, reach: int, agents: int
) -> dict[str, Any]:
    """An instance.

    Args:
        chance: Draws sides, places and things.
        items: How many things Max has to fetch.
        moved: How many of them were moved, at most all.
        reach: Blocks from the middle of the hall to its ends.
        agents: Max, Nora, and people behind glass who know what Max knows.
    """
    width, wanted = 2 * reach, chance.sample(_ITEMS, items)
    moved = min(moved, items)
    ends = chance.sample([1, width - 1], 2)
    rows = {x: chance.sample(range(1, 9), 8) for x in ends}
    near = chance.sample([(reach + dx, 1, z) for dx in (-4, -2, 2, 4) for z in (2, 8)], items)
    before, now = {}, {}
    for number, item in enumerate(wanted):
        if number < moved:
            before[(ends[0], 1, rows[ends[0]].pop())] = {item: 1}
            now[(ends[1], 1, rows[ends[1]].pop())] = {item: 1}
        else:
            before[near[number]] = now[near[number]] = {item: 1}
    places = sorted(before.keys() | now.keys())
    onlookers = _ONLOOKERS[: agents - 2]
    booths = {name: 4 + 4 * number for number, name in enumerate(("nora", *onlookers))}
    glass = [wall((x - 1, 1, 10), (x + 1, 2, 12), "glass") for x in booths.values()]
    glass += [wall((x, 1, 11), (x, 2, 11), "air") for x in booths.values()]
    return {
        "description": (
            f"Max fetches {', '.join(wanted)}. Some of it was moved while he was away. Nora sees "
            f"where everything is; she may speak {moved} times at most."
        ),
        "order": 1,
        "scenario": {
            "name": "tell-what-is-needed",
            **hall(width, 12, glass),
            "containers": [chest(place, now.get(place, {})) for place in places],
            "agents": {
                "max": {"position": [reach + 0.5, 1, 5.5], "facing": "north"},
                **{
                    name: {"position": [x + 0.5, 1, 11.5], "facing": "north"}
                    for name, x in booths.items()
                },
            },
            "perception": {"max_visible_distance": 80, "testimony": "accept"},
            "initial_beliefs": [
                belief("/**", before, complete=False),
                belief("/nora", {place: now.get(place, {}) for place in places}),
            ],
        },
        "goal": {"reach": [{"agent": "max", "items": dict.fromkeys(wanted, 1)}], "messages": moved},
        "players": ["nora"],
        "policies": {"max": "search:0", **dict.fromkeys(onlookers, "search:0")},
        "talk": ["nora", *onlookers],
        "round_ticks": 5,
        "rounds": -(-(reach + 20 + 6 * items) // 5),
    }
