"""Hide and seek with a deceiver (Sodian 1991; Happé 1994, double bluff).

Bob looks for a treasure and has time to go to one end of the hall. There is a treasure in each
chest at the nearer end; Bob found these chests empty before, except one that he did not open. Eve
knows that. She stands behind glass and can only speak, once. Bob knows that she does not want him
to find a treasure. If Eve expects Bob to believe her, she tells a lie, and he sees through it. If
she considers what Bob concludes from her goal, she tells the truth about the chest that he did not
open; the truth about another one does not keep him from it. Further agents look beside Bob.
"""

import random
from typing import Any

from beliefnest.episodes.tasks.building import abreast, also, belief, booths, chest, hall

PARAMETERS = {"chests": (4, 3, 6), "reach": (14, 14, 20), "agents": (2, 2, 4)}

_ITEMS = ("diamond", "emerald", "gold_ingot")
_SEEKERS = ("bob", "cara", "dan")


def instance(chance: random.Random, chests: int, reach: int, agents: int) -> dict[str, Any]:
    """Return an instance.

    Args:
        chance: Random source of sides, places, the treasure, and the chest that Bob did not open.
        chests: Number of chests: one at the far end, which is empty, and the others at the near
            end, with a treasure in each. A true word at random helps Eve in one of `chests - 1`
            cases.
        reach: Blocks from the middle of the hall to its ends.
        agents: Number of agents: Eve, and seekers side by side, none of whom may get a treasure.
    """
    width, item = 2 * reach, chance.choice(_ITEMS)
    near, far = chance.sample([1, width - 1], 2)
    full = [(near, 1, row) for row in chance.sample(range(1, 9), chests - 1)]
    empty, unopened = (far, 1, chance.randint(1, 8)), full[0]
    contents = {**{place: {item: 1} for place in full}, empty: {}}
    common = belief("/**", {place: {} for place in full if place != unopened})
    unknown = belief("/**", {unopened: {}, empty: {}}, complete=False)
    eve, glass = booths(["eve"], 4)
    start = reach + (2 if near > reach else -2)
    seekers = _SEEKERS[: agents - 1]
    got = {name: {"agent": name, "items": {item: 1}} for name in seekers}
    return {
        "description": (
            f"Bob looks for a treasure: {item}. Eve does not want him to get it; she can only "
            "speak, once. Some chests were empty when he opened them, and no longer are."
            f"{also(seekers[1:], 'must not get it either.')}"
        ),
        "order": 2,
        "scenario": {
            "name": "hide-and-seek",
            **hall(width, 12, glass),
            "containers": [chest(place, contents[place]) for place in sorted(contents)],
            "agents": {
                **{
                    name: {"position": at, "facing": "north"}
                    for name, at in abreast(seekers, [start + 0.5, 1, 5.5], (0, 1)).items()
                },
                **eve,
            },
            "perception": {"max_visible_distance": 64, "testimony": "accept"},
            "initial_beliefs": [
                {**common, "containers": common["containers"] + unknown["containers"]},
                belief("/eve", contents),
            ],
        },
        "goal": {"never": list(got.values()), "messages": 1},
        "goals": {name: {"reach": [each]} for name, each in got.items()},
        "players": ["eve"],
        "policies": dict.fromkeys(seekers, "search:1"),
        "talk": ["eve"],
        "round_ticks": 5,
        "rounds": -(-(reach + 8) // 5),
    }
