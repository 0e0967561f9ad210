"""What happened here: who took it, and where is it now (Jara-Ettinger and Schachner 2024).

Amy and Ben left the hall in which Dan was. One of them went home, the other went through the vault,
took the treasure and hid it at home. What happened in the rooms nobody else saw; Dan has found the
vault empty, and there is only time to look into one home. Whoever does not infer who took the
treasure from the ways that Dan saw them walk has to guess.
"""

import random
from typing import Any

from beliefnest.episodes.tasks.building import belief, chest, hall, wall

PARAMETERS = {"reach": (14, 12, 20)}

_ITEMS = ("diamond", "emerald", "gold_ingot")
_ROUND = 4
_SOUTH = 5
"""z of the wall between the rooms and the hall."""


def instance(chance: random.Random, reach: int) -> dict[str, Any]:
    """Return an instance.

    Args:
        chance: Draws the treasure, who lives where, who took it, and where they set out.
        reach: Blocks from the vault to the ends of the homes.
    """
    width, treasure = 2 * reach, chance.choice(_ITEMS)
    west, east = chance.sample(("amy", "ben"), 2)
    thief = chance.choice((west, east))
    vault = (reach, 1, 1)
    stash = {west: (1, 1, 1), east: (width - 1, 1, 1)}
    home = {west: (3, 1, 2), east: (width - 3, 1, 2)}
    blocks = [
        wall((0, 1, _SOUTH), (width, 3, _SOUTH)),
        # A screen behind the vault's door keeps anybody in the hall from looking in.
        wall((reach - 2, 1, 3), (reach + 2, 3, 3)),
        *(wall((x, 1, 0), (x, 3, _SOUTH)) for x in (reach - 4, reach + 4)),
        *(wall((x, 1, _SOUTH), (x, 3, _SOUTH), "air") for x in (4, reach, width - 4)),
        *(wall((x, 1, 1), (x, 3, 1), "air") for x in (reach - 4, reach + 4)),
    ]
    contents: dict[tuple[int, int, int], dict[str, int]] = {vault: {treasure: 1}}
    chests = {**contents, **{place: {} for place in stash.values()}}
    jitter = chance.randint(0, 2)
    feet = {
        west: [reach - 1.5 - jitter, 1, 10.5],
        east: [reach + 2.5 + jitter, 1, 10.5],
        "dan": [reach + 0.5, 1, 13.5],
    }
    possible = {
        name: {
            "take": {"reach": [{"container": stash[name], "items": {treasure: 1}}]},
            "go home": {"reach": [{"agent": name, "at": home[name]}]},
        }
        for name in ("amy", "ben")
    }
    walks = {
        name: (
            f"await getItemFromChest(bot, new Vec3{vault}, {{{treasure}: 1}})\n"
            f"await depositItemIntoChest(bot, new Vec3{stash[name]}, {{{treasure}: 1}})"
            if name == thief
            else f"await goToPosition(bot, new Vec3{home[name]}, 0)"
        )
        for name in ("amy", "ben")
    }
    look = (
        f"await goToPosition(bot, new Vec3{vault}, 2)\n"
        f"const chest = await bot.openContainer(bot.blockAt(new Vec3{vault}))\n"
        "chest.close()"
    )
    return {
        "description": (
            f"Somebody took the {treasure} out of the vault; it was {thief.capitalize()}, and Dan, "
            "who looks for it, does not know."
        ),
        "order": 1,
        "scenario": {
            "name": "what-happened-here",
            **hall(width, 15, blocks),
            "containers": [chest(place, held) for place, held in chests.items()],
            "agents": {name: {"position": at, "facing": "north"} for name, at in feet.items()},
            "perception": {"max_visible_distance": 64},
            "initial_beliefs": [
                {
                    "path": "/**",
                    "containers": [
                        *belief("/**", contents)["containers"],
                        *belief("/**", {place: {} for place in stash.values()}, complete=False)[
                            "containers"
                        ],
                    ],
                },
            ],
            "script": [
                {"label": "Amy and Ben leave", "programs": walks},
                {"label": "Dan looks into the vault", "agent": "dan", "program": look},
            ],
        },
        "goal": {"reach": [{"agent": "dan", "items": {treasure: 1}}]},
        "goals": {
            name: goals["take" if name == thief else "go home"] for name, goals in possible.items()
        },
        "goals_known": False,
        "possible_goals": possible,
        "players": ["dan"],
        "policies": dict.fromkeys(possible, "search:0"),
        "round_ticks": _ROUND,
        "rounds": -(-(reach + 12) // _ROUND),
    }
