"""A blueprint that each builder sees only in part (Clark and Krych 2004).

The builders must copy a model with blocks. Each builder sees only the models of the plots that the
other one can reach. Both have been shown these models but one of each side. Each may say one thing:
a builder that considers what the other one has not seen describes that. Further agents build
beside Bob: they see what he sees, and say nothing.
"""

import random
from typing import Any

from beliefnest.episodes.tasks.building import FLOOR, WALL, abreast, also, belief, chest, hall, wall

PARAMETERS = {"plots": (2, 2, 3), "agents": (2, 2, 4)}

_COLOURS = ("red_wool", "white_wool")
_BUILDERS = ("bob", "carl", "dora")


def instance(chance: random.Random, plots: int, agents: int) -> dict[str, Any]:
    """Return an instance.

    Args:
        chance: Random source of the model and of the first blocks on plots.
        plots: Number of plots that each builder can reach. One of their models is news to it.
        agents: Number of agents: Anne, Bob, and builders beside Bob who see what he sees and say
            nothing.
    """
    width, depth, middle = 26, 3 * plots + 4, 13
    rows = [3 + 3 * number for number in range(plots)]
    # Models are behind glass and out of reach; a stone wall separates the halves.
    blocks = [
        wall((middle, 1, 0), (middle, 3, depth)),
        wall((6, 1, 0), (6, 3, depth), "glass"),
        wall((width - 6, 1, 0), (width - 6, 3, depth), "glass"),
    ]
    pairs, stand, models, stores = [], [], [], {}
    for x, model_x in ((9, width), (width - 9, 0)):
        news = chance.randrange(plots)
        for number, z in enumerate(rows):
            wanted, other = chance.sample(_COLOURS, 2)
            model = {"block": wanted, "at": [model_x, 1, z]}
            pairs.append(((x, 1, z), (model_x, 1, z)))
            stand.append({"block": chance.choice(("air", other)), "at": [x, 1, z]})
            blocks.append(model)
            if number != news:
                models.append(model)
        stores[(x, 1, depth - 1)] = dict.fromkeys(_COLOURS, plots)
    builders = _BUILDERS[: agents - 1]
    feet = {"anne": [11.5, 1, 1.5], **abreast(builders, [width - 10.5, 1, 1.5], (0, 1))}
    return {
        "description": (
            "On each plot is to stand what stands in its model. Anne and Bob cannot leave their "
            "halves. Each sees only the models of the other's plots, and may say one thing."
            f"{also(builders[1:], 'can build where Bob can, but cannot talk.')}"
        ),
        "order": 1,
        "scenario": {
            "name": "blueprint",
            **hall(width, depth, [*blocks, *stand]),
            "containers": [chest(place, items, "store") for place, items in stores.items()],
            "agents": {name: {"position": at, "facing": "south"} for name, at in feet.items()},
            "perception": {"max_visible_distance": 64, "testimony": "accept"},
            "static_blocks": [FLOOR, WALL, "glass"],
            "initial_beliefs": [
                {**belief("/**", stores), "blocks": stand + models, "agents": feet}
            ],
        },
        "goal": {
            "reach": [{"block": list(place), "like": list(model)} for place, model in pairs],
            "messages": 2,
        },
        "players": ["anne", "bob"],
        **({"policies": dict.fromkeys(builders[1:], "search:0")} if builders[1:] else {}),
        "talk": ["anne", "bob"],
        "round_ticks": 10,
        "rounds": 4 + 5 * plots,
    }
