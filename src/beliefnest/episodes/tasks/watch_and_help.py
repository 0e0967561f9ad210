"""Watch and help an agent whose goal is not known (Puig and others 2021).

Each lift rises while its two levers are on, with an agent at each of them. Bob wants one of the
lifts to rise, and walks to its lever. The other lever is at the end of a passage on Anne's side.
She has no time to try two passages. Nobody tells Anne which lift it is: she must infer it from his
walk, or guess.
"""

import random
from typing import Any

from beliefnest.episodes.tasks.building import FLOOR, WINDOW, hall, wall

PARAMETERS = {"goals": (3, 2, 4), "reach": (14, 12, 20)}

_LOBBY, _APART, _GAP = 5, 8, 4
_ROUND = 4
_WATCHED = 3
"""Rounds that there is time to watch."""


def instance(chance: random.Random, goals: int, reach: int) -> dict[str, Any]:
    """Return an instance.

    Args:
        chance: Draws which lift Bob wants to rise, and where he and Anne stand.
        goals: How many lifts there are.
        reach: Length of the passages in blocks.
    """
    middle = _LOBBY + reach + _GAP
    width, depth = 2 * middle, _APART * goals
    rows = [_APART // 2 + _APART * number for number in range(goals)]
    west, east = _LOBBY, width - _LOBBY
    blocks = [wall((x, 1, 0), (x, 3, depth), WINDOW) for x in (west, middle, east)]
    blocks += [
        wall((west, 1, _APART * number), (east, 3, _APART * number), WINDOW)
        for number in range(1, goals)
    ]
    blocks += [wall((x, 1, z), (x, 3, z), "air") for z in rows for x in (west, east)]
    sites = [[[middle - _GAP, 1, z], [middle + _GAP, 1, z]] for z in rows]
    levers = [
        {"block": "lever[face=floor,facing=north,powered=false]", "at": place}
        for site in sites
        for place in site
    ]
    wanted = chance.randrange(goals)
    possible = {
        f"lift {number + 1}": {"reach": [{"agents": ["anne", "bob"], "sites": [site]}]}
        for number, site in enumerate(sites)
    }
    return {
        "description": (
            f"Bob wants lift {wanted + 1} to rise, and has not said so. Anne can help him: a lift "
            "rises while somebody is at each of its two levers."
        ),
        "order": 1,
        "scenario": {
            "name": "watch-and-help",
            **hall(width, depth, [*blocks, *levers]),
            "agents": {
                "anne": {"position": [width - 1.5, 1, chance.choice(rows) + 0.5], "facing": "west"},
                "bob": {"position": [1.5, 1, chance.choice(rows) + 0.5], "facing": "east"},
            },
            "perception": {"max_visible_distance": 64},
            "static_blocks": [FLOOR, WINDOW],
        },
        "goal": possible[f"lift {wanted + 1}"],
        "goals": {"anne": {"helps": "bob"}},
        "goals_known": False,
        "possible_goals": {"bob": possible},
        "players": ["anne"],
        "talk": [],
        "policies": {"bob": "search:0"},
        "round_ticks": _ROUND,
        "rounds": _WATCHED - (-(reach + _LOBBY + depth - _APART) // _ROUND),
    }
