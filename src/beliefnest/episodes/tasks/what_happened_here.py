"""Theft without a witness: who took it, and where is it (Jara-Ettinger and Schachner 2024).

Dan leaves Amy and Ben in a hall. One of them takes a treasure out of the vault and hides it in a
storeroom, the other fetches something to eat; each has a storeroom at one end of the hall. Dan
comes back, finds the vault empty, and has only time to look into one storeroom. The doors tell who
it was: thieves enter the vault by the door nearer to them, leave it on the side of their storeroom,
and leave doors open. If Dan does not infer who it was, he has to guess.
"""

import random
from typing import Any

from beliefnest.episodes.tasks.building import chest, hall, wall
from beliefnest.world.values import Position

PARAMETERS = {"reach": (14, 12, 20)}

_ITEMS = ("diamond", "emerald", "gold_ingot")
_FOOD = {"amy": "apple", "ben": "bread"}
_ROUND = 7
_NORTH, _SOUTH = 6, 13
"""z of the walls of the hall: to the vault and the storerooms, and to Dan's study."""
_SPARE = 8
"""Ticks that Dan has beyond the way to a storeroom."""


def instance(chance: random.Random, reach: int) -> dict[str, Any]:
    """Return an instance.

    Args:
        chance: Draws the treasure, who has which storeroom, who took it, and where Amy and Ben
            stood.
        reach: Blocks from the vault to the ends of the hall.
    """
    width, treasure = 2 * reach, chance.choice(_ITEMS)
    # The first one's storeroom is in the west. Not drawn: both cross, whose doors are alike.
    west, east = owners = chance.sample(sorted(_FOOD), 2)
    thief = chance.choice(owners)
    stood = dict(zip(owners, chance.choice([(-1, 1), (-1, -1), (1, 1)]), strict=True))
    vault = (reach, 1, 1)
    stash: dict[str, Position] = {west: (1, 1, 1), east: (width - 1, 1, 1)}
    contents: dict[Position, dict[str, int]] = {vault: {treasure: 1}}
    contents |= {place: {_FOOD[name]: 1} for name, place in stash.items()}
    doors = [3, reach - 3, reach + 3, width - 3]
    possible = {
        name: {
            "take": {"reach": [{"container": list(stash[name]), "items": {treasure: 1}}]},
            "eat": {"reach": [{"agent": name, "items": {food: 1}}]},
        }
        for name, food in _FOOD.items()
    }
    takes = f"await getItemFromChest(bot, new Vec3{vault}, {{{treasure}: 1}})\n"
    doings = {
        name: takes + f"await depositItemIntoChest(bot, new Vec3{at}, {{{treasure}: 1}})"
        if name == thief
        else f"await getItemFromChest(bot, new Vec3{at}, {{{_FOOD[name]}: 1}})"
        for name, at in stash.items()
    }
    study = f"await goToPosition(bot, new Vec3({reach + 3}, 1, {_SOUTH + 1}), 0)"
    middle = f"await goToPosition(bot, new Vec3({reach}, 1, {_NORTH + 3}), 0)"
    return {
        "description": (
            f"Somebody has taken the {treasure} out of the vault; it was {thief.capitalize()}, "
            "which Dan, who looks for it, does not know."
        ),
        "order": 1,
        "scenario": {
            "name": "what-happened-here",
            **hall(width, _SOUTH + 5, _rooms(width, reach, doors)),
            "containers": [chest(place, items) for place, items in contents.items()],
            "agents": {
                **{
                    name: {
                        "position": [reach + 0.5 + 6 * stood[name], 1, _NORTH + z],
                        "facing": "north",
                    }
                    for name, z in ((west, 3.5), (east, 5.5))
                },
                "dan": {"position": [reach + 0.5, 1, _SOUTH - 1.5], "facing": "north"},
            },
            "perception": {"max_visible_distance": 64},
            "initial_beliefs": [
                {
                    "path": "/**",
                    "containers": [
                        {"at": list(place), "items": items, "complete": place == vault}
                        for place, items in contents.items()
                    ],
                }
            ],
            "script": [
                {"label": "Dan leaves", "agent": "dan", "program": study},
                {"label": "Somebody takes the treasure", "programs": doings},
                {
                    "label": "Dan finds the vault empty",
                    "agent": "dan",
                    "program": f"await goToPosition(bot, new Vec3{vault}, 2)\n"
                    f"await bot.openContainer(bot.blockAt(new Vec3{vault}))\n{middle}",
                },
            ],
        },
        "goal": {"reach": [{"agent": "dan", "items": {treasure: 1}}]},
        "goals": {
            name: each["take" if name == thief else "eat"] for name, each in possible.items()
        },
        "goals_known": False,
        "possible_goals": possible,
        "players": ["dan"],
        "talk": [],
        "policies": dict.fromkeys(possible, "search:0"),
        "round_ticks": _ROUND,
        "rounds": -(-(reach + _NORTH + _SPARE) // _ROUND),
    }


def _rooms(width: int, reach: int, doors: list[int]) -> list[dict[str, Any]]:
    """Return walls and doors: storerooms and the vault in the north, a study in the south."""
    sides = [6, reach - 5, reach + 5, width - 6]
    hung = "oak_door[facing=north,half={},hinge=left,open=false,powered=false]"
    return [
        wall((0, 1, _NORTH), (width, 3, _NORTH)),
        *(wall((x, 1, 0), (x, 3, _NORTH)) for x in sides),
        wall((0, 1, _SOUTH), (width, 3, _SOUTH)),
        wall((reach, 1, _SOUTH), (reach, 3, _SOUTH), "air"),
        *(
            {"block": hung.format(half), "at": [x, y, _NORTH]}
            for x in doors
            for y, half in ((1, "lower"), (2, "upper"))
        ),
    ]
