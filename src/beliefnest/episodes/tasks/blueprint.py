"""A blueprint of which each sees another part (Clark and Krych 2004, building from another's plan).

Gates are to stand as in a model. Each builder can reach gates whose model only the other sees. Who
reckons with what the other does not see tells it.
"""

import random
from typing import Any

from beliefnest.episodes.tasks.building import FLOOR, WALL, hall, wall

PARAMETERS = {"gates": (2, 1, 3)}

_GATE = "oak_fence_gate"


def instance(chance: random.Random, gates: int) -> dict[str, Any]:
    """An instance.

    Args:
        chance: Draws how gates stand, in the model and at first.
        gates: How many gates each builder can reach.
    """
    width, depth, middle = 26, 3 * gates + 4, 13
    rows = [3 + 3 * number for number in range(gates)]
    pairs, stand = [], []
    # Models stand behind glass, too far off to be reached; between the halves is a wall of stone.
    blocks = [
        wall((middle, 1, 0), (middle, 3, depth)),
        wall((6, 1, 0), (6, 3, depth), "glass"),
        wall((width - 6, 1, 0), (width - 6, 3, depth), "glass"),
    ]
    for x, model_x in ((9, width), (width - 9, 0)):
        wrong = chance.randrange(gates)
        for number, z in enumerate(rows):
            wanted = chance.random() < 0.5
            stands = wanted if number != wrong and chance.random() < 0.5 else not wanted
            pairs.append(((x, 1, z), (model_x, 1, z)))
            stand.append(_gate((x, 1, z), opened=stands))
            blocks.append(_gate((model_x, 1, z), opened=wanted))
    blocks += stand
    feet = {"anne": [11.5, 1, 1.5], "bob": [width - 10.5, 1, 1.5]}
    return {
        "description": (
            "Each gate is to be open or shut as its model is. Anne and Bob cannot leave their "
            "halves; each sees only the model of the other's gates."
        ),
        "order": 1,
        "scenario": {
            "name": "blueprint",
            **hall(width, depth, blocks),
            "agents": {name: {"position": at, "facing": "south"} for name, at in feet.items()},
            "perception": {"max_visible_distance": 64, "testimony": "accept"},
            "static_blocks": [FLOOR, WALL, "glass"],
            "initial_beliefs": [{"path": "/**", "blocks": stand, "agents": feet}],
        },
        "goal": {"reach": [{"block": list(place), "like": list(model)} for place, model in pairs]},
        "players": ["anne", "bob"],
        "talk": ["anne", "bob"],
        "round_ticks": 10,
        "rounds": 4 + 3 * gates,
    }


def _gate(at: tuple[int, int, int], *, opened: bool) -> dict[str, Any]:
    state = f"{_GATE}[facing=east,open={'true' if opened else 'false'}]"
    return {"block": state, "at": list(at)}
