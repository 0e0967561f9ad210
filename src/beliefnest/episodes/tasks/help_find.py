"""Help an agent with a false belief (Buttelmann, Carpenter and Tomasello 2009, with speech).

Sally wants some things, each in a passage of its own. One of them was moved while she was away, and
she has no time to look into every chest. Anne stands behind glass: she saw the move, and can only
speak, once. An agent that does not consider what Sally believes sees no need to speak, or tells
her what she knows already.
"""

import random
from typing import Any

from beliefnest.episodes.tasks.building import belief, booths, chest, hall, passages
from beliefnest.world.values import Position

PARAMETERS = {"chests": (4, 3, 6), "reach": (16, 16, 24), "agents": (2, 2, 4)}

_ITEMS = ("diamond", "emerald", "apple", "compass", "bread")
_ONLOOKERS = ("ben", "cleo")


def instance(chance: random.Random, chests: int, reach: int, agents: int) -> dict[str, Any]:
    """Return an instance.

    Args:
        chance: Random source of places and things, and of the one that was moved.
        chests: Number of chests: one for each thing, and the one out of which a thing was moved.
            A true word at random helps Sally in one of `chests - 1` cases.
        reach: Blocks from the middle of the hall to its ends.
        agents: Number of agents: Sally, Anne, and agents behind glass who know what Sally knows.
    """
    width, wanted = 2 * reach, chance.sample(_ITEMS, chests - 1)
    places, walls = passages(reach, chests)
    left, *full = chance.sample(places, chests)
    now: dict[Position, dict[str, int]] = {
        at: {item: 1} for at, item in zip(full, wanted, strict=True)
    }
    moved = chance.choice(full)
    before = {left if at == moved else at: items for at, items in now.items()}
    onlookers = _ONLOOKERS[: agents - 2]
    behind_glass, glass = booths(["anne", *onlookers], 4)
    return {
        "description": (
            f"Sally wants {', '.join(wanted)}. One of these was moved while she was away; Anne saw "
            "that. Anne cannot leave her booth, but Sally hears her."
        ),
        "order": 1,
        "scenario": {
            "name": "help-find",
            **hall(width, 12, [*walls, *glass]),
            "containers": [chest(at, now.get(at, {})) for at in places],
            "agents": {
                "sally": {"position": [reach + 0.5, 1, 3.5], "facing": "north"},
                **behind_glass,
            },
            "perception": {"max_visible_distance": 64, "testimony": "accept"},
            "initial_beliefs": [
                belief("/**", before, complete=False),
                belief("/anne", {left: {}, **now}),
            ],
        },
        "goal": {
            "reach": [{"agent": "sally", "items": dict.fromkeys(wanted, 1)}],
            "messages": 1,
            "ticks": _ticks(reach, len(wanted)),
        },
        "players": ["anne"],
        "policies": {"sally": "search:0", **dict.fromkeys(onlookers, "search:0")},
        "talk": ["anne", *onlookers],
        "round_ticks": 5,
        "rounds": -(-_ticks(reach, len(wanted)) // 5),
    }


def _ticks(reach: int, things: int) -> int:
    """Return the ticks in which Sally can go to the ends of so many passages, and of no more."""
    return (2 * things - 1) * reach + 4
