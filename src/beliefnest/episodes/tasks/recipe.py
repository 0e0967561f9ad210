"""A recipe of which each cook knows a part (Stasser and Titus 1985, hidden profiles).

Two cooks fetch two ingredients each, every one out of a passage of its own, in separate rooms. Both
know where one of the two is, and only the other cook knows where the other one is. Talk takes time:
a cook that says what the other knows as well, or everything, is too late, and so is one that has to
look into one more chest. Further agents stand behind glass and know what both cooks know.
"""

import random
from typing import Any

from beliefnest.episodes.tasks.building import belief, booths, chest, hall, passages, wall
from beliefnest.world.values import Position

PARAMETERS = {"chests": (6, 4, 6), "reach": (20, 16, 24), "agents": (2, 2, 4)}

_ITEMS = ("wheat", "sugar", "egg", "apple", "carrot")
_COOKS = ("anne", "bob")
_ONLOOKERS = ("carl", "dora")
_SPEECH, _MIDDLE = 15, 11
"""Ticks of an utterance; z of the wall between the rooms, which mirror each other."""


def instance(chance: random.Random, chests: int, reach: int, agents: int) -> dict[str, Any]:
    """Return an instance.

    Args:
        chance: Random source of places and ingredients. Of three true things that a cook can say,
            one is news.
        chests: Number of chests in each room.
        reach: Blocks from the middle of the hall to its ends.
        agents: Number of agents: the cooks, and agents behind glass.
    """
    places, walls = passages(reach, chests)
    mirrored = [{**each, "fill": [list(_across(at)) for at in each["fill"]]} for each in walls]
    items = chance.sample(_ITEMS, 2 * len(_COOKS))
    wanted = {"anne": items[:2], "bob": items[2:]}
    common: dict[Position, dict[str, int]] = {}
    secret: dict[str, dict[Position, dict[str, int]]] = {}
    for cook, (own, hidden) in wanted.items():
        one = chance.choice(places)
        # Neither at the same end nor opposite: there one looks next who is not told.
        other = chance.choice([at for at in places if at[0] != one[0] and at[2] != one[2]])
        common[_of(cook, one)] = {own: 1}
        secret[cook] = {_of(cook, other): {hidden: 1}}
    full = {**common, **secret["anne"], **secret["bob"]}
    onlookers = _ONLOOKERS[: agents - len(_COOKS)]
    behind_glass, glass = booths(onlookers, 4)
    # Enough for three ways through a passage and one utterance, too little for a second one.
    ticks = _SPEECH + 3 * reach + 3
    return {
        "description": (
            f"Anne fetches {' and '.join(wanted['anne'])}, Bob {' and '.join(wanted['bob'])}, each "
            "in a room of its own. Each knows where everything is in the other's room, but not in "
            "its own; talk takes time."
        ),
        "order": 1,
        "scenario": {
            "name": "recipe",
            **hall(
                2 * reach,
                2 * _MIDDLE,
                [
                    *walls,
                    *mirrored,
                    wall((0, 1, _MIDDLE), (2 * reach, 3, _MIDDLE), "glass"),
                    *glass,
                ],
            ),
            "containers": [
                chest(at, full.get(at)) for cook in _COOKS for at in (_of(cook, p) for p in places)
            ],
            "agents": {
                "anne": {"position": [reach + 0.5, 1, 8.5], "facing": "north"},
                "bob": {"position": [reach + 0.5, 1, 14.5], "facing": "south"},
                **behind_glass,
            },
            "perception": {
                "max_visible_distance": 64,
                "testimony": "accept",
                "speech_ticks": _SPEECH,
            },
            "initial_beliefs": [
                belief("/**", common, complete=False),
                belief("/anne", secret["bob"], complete=False),
                belief("/bob", secret["anne"], complete=False),
            ],
        },
        "goal": {
            "reach": [{"agent": cook, "items": dict.fromkeys(wanted[cook], 1)} for cook in _COOKS],
            "ticks": ticks,
        },
        "players": list(_COOKS),
        **({"policies": dict.fromkeys(onlookers, "search:0")} if onlookers else {}),
        "talk": list(_COOKS),
        "round_ticks": _SPEECH,
        "rounds": -(-ticks // _SPEECH),
    }


def _of(cook: str, at: Position) -> Position:
    """Return the place in the room of a cook that is at a place of Anne's room."""
    return at if cook == "anne" else _across(at)


def _across(at: Any) -> Position:
    x, y, z = at
    return (x, y, 2 * _MIDDLE - z)
