"""Task of trust: a speaker is a helper or a deceiver (Koenig and Harris 2005; Sodian 1991).

Bob wants an apple and a treasure. The apple is in one of two chests beside him, the treasure at one
end of the hall, and he has time to go to one end only. Eve knows both places. She wants him to get
both, or wants to keep the treasure from him, and does not say which. She has told him where the
treasure is. One of two things reveals her goal: a claim about the apple, which Bob can check, or
her walk, since a helper and a deceiver go to different places. If Bob does not infer her goal, he
can only believe her always or never.
"""

import random
from typing import Any

from beliefnest.episodes.tasks.building import belief, booths, chest, hall, wall
from beliefnest.world.values import Position

PARAMETERS = {"reach": (16, 14, 22)}

_ITEMS = ("diamond", "emerald", "gold_ingot")
_ROUND = 4
_CORRIDOR = 12
"""z of the passage behind glass in which Eve walks."""


def instance(chance: random.Random, reach: int) -> dict[str, Any]:
    """Return an instance.

    Args:
        chance: Draws the places, the treasure, whether Eve helps or deceives, and whether a claim
            or a deed shows it.
        reach: Blocks from the middle of the hall to its ends.
    """
    width, treasure = 2 * reach, chance.choice(_ITEMS)
    near = chance.sample([(reach - 2, 1, 1), (reach + 2, 1, 1)], 2)
    far = [(x, 1, chance.randrange(1, 9)) for x in chance.sample([1, width - 1], 2)]
    contents: dict[Position, dict[str, int]] = {place: {} for place in (*near, *far)}
    contents |= {near[0]: {"apple": 1}, far[0]: {treasure: 1}}
    helps, acts = chance.random() < 0.5, chance.random() < 0.5
    got = [{"agent": "bob", "items": {item: 1}} for item in ("apple", treasure)]
    help_goal: dict[str, Any] = {"reach": got}
    deceive_goal: dict[str, Any] = {"never": got[1:]}
    eve, blocks = booths(["eve"], reach)
    if acts:
        west, east = chance.sample([(reach - 8, 1, _CORRIDOR), (reach + 8, 1, _CORRIDOR)], 2)
        help_goal = {"reach": [*got, {"agent": "eve", "at": west}]}
        deceive_goal = {"reach": [{"agent": "eve", "at": east}], "never": got[1:]}
        eve["eve"]["position"] = [reach + 0.5, 1, _CORRIDOR + 0.5]
        blocks = [wall((0, 1, _CORRIDOR - 1), (width, 3, _CORRIDOR - 1), "glass")]
    # She claims what is the case if she helps, and the opposite if she deceives.
    claimed = [] if acts else [("apple", near[not helps])]
    claimed.append((treasure, far[not helps]))
    claims = ", ".join(f"located('{item}', new Vec3{place})" for item, place in claimed)
    return {
        "description": (
            f"Bob wants an apple and the {treasure}. Eve has told him where the {treasure} is; she "
            f"{'helps' if helps else 'deceives'} him, which he does not know."
        ),
        "order": 1,
        "scenario": {
            "name": "whom-to-trust",
            **hall(width, _CORRIDOR, blocks),
            "containers": [chest(place, items) for place, items in contents.items()],
            "agents": {"bob": {"position": [reach + 0.5, 1, 5.5], "facing": "north"}, **eve},
            "perception": {"max_visible_distance": 64, "testimony": "accept"},
            "initial_beliefs": [
                belief("/**", {place: {} for place in contents}, complete=False),
                belief("/eve", contents),
            ],
            "script": [
                {
                    "label": "Eve says where things are",
                    "agent": "eve",
                    "program": f"await say(bot, 'They are there.', [{claims}])",
                }
            ],
        },
        "goal": {"reach": got},
        "goals": {"eve": help_goal if helps else deceive_goal},
        "goals_known": False,
        "possible_goals": {
            "bob": {"both": {"reach": got}},
            "eve": {"help": help_goal, "deceive": deceive_goal},
        },
        "players": ["bob"],
        "talk": [],
        "policies": {"eve": "search:0"},
        "round_ticks": _ROUND,
        "rounds": -(-(reach + 18) // _ROUND),
    }
