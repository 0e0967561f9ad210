"""A joint lift without a word (Sebanz, Bekkering and Knoblich 2006; Tomasello 2014).

A lift rises while both its levers are on, with an agent at each of them. There are two lifts. Both
agents are nearer to one of them, but only Anne sees it, and Bob does not know of it. They cannot
talk. An agent that considers what the other one sees goes to the lift where the other one will be.
Further agents stand beside Bob and see what he sees; each lift then has a lever for each of them.
"""

import random
from typing import Any

from beliefnest.episodes.tasks.building import FLOOR, WALL, abreast, also, hall, wall

PARAMETERS = {"far": (14, 12, 20), "agents": (2, 2, 4)}

_COMPANIONS = ("bob", "carl", "dora")


def instance(chance: random.Random, far: int, agents: int) -> dict[str, Any]:
    """Return an instance.

    Args:
        chance: Random source of the side and the places.
        far: Blocks between the lift that Bob does not see and the lift that he sees.
        agents: Number of agents: Anne, Bob, and agents beside Bob who see what he sees; each lift
            has a lever for each agent.
    """
    corner = 5
    width, depth = corner + far + 5, 12
    x, z = corner + far + chance.randint(0, 2), chance.randint(1, 3)
    sites = [_site((0, 1, 0), 6, agents), _site((x, 1, z), 8, agents)]
    # These walls, with a gap at their corner, hide the lift that Bob does not see.
    blocks = [
        wall((corner, 1, 0), (corner, 2, 5)),
        wall((0, 1, 7), (corner + 1, 2, 7)),
    ]
    # All agents stand nearer to this lift than to the other one.
    companions = _COMPANIONS[: agents - 1]
    feet = {
        "anne": [corner - 1.5, 1, 4.5],
        **abreast(companions, [corner + 2.5, 1, 10.5], (1, 0)),
    }
    mirrored = chance.random() < 0.5
    levers = [place for site in sites for place in site]
    every = "both" if agents == 2 else "all"
    content = {
        "description": (
            f"A lift rises while {every} of its levers are on, with somebody at each. Anne and Bob "
            f"do not talk.{also(companions[1:], 'cannot talk either.')}"
        ),
        "order": 1,
        "scenario": {
            "name": "joint-lift",
            **hall(width, depth, [*blocks, *map(_lever, levers)]),
            "agents": {name: {"position": at, "facing": "north"} for name, at in feet.items()},
            "perception": {"max_visible_distance": 64},
            "static_blocks": [FLOOR, WALL],
            "initial_beliefs": [
                {
                    "path": path,
                    "blocks": [_lever(place) for place in known],
                    "agents": feet,
                }
                for path, known in (("/anne", levers), ("/**", sites[-1]))
            ],
        },
        "goal": {"reach": [{"agents": list(feet), "sites": [list(map(list, s)) for s in sites]}]},
        "players": ["anne"],
        "policies": dict.fromkeys(companions, "search:0"),
        "round_ticks": 5,
        "rounds": -(-(far + 11) // 5),
    }
    return _mirror(content, width) if mirrored else content


def _site(first: tuple[int, int, int], length: int, levers: int) -> list[tuple[int, int, int]]:
    """Return the places of a lift's levers, in a row from north to south."""
    x, y, z = first
    return [(x, y, z + length * number // (levers - 1)) for number in range(levers)]


def _lever(at: tuple[int, int, int]) -> dict[str, Any]:
    return {"block": "lever[face=floor,facing=north,powered=false]", "at": list(at)}


def _mirror(content: dict[str, Any], width: int) -> dict[str, Any]:
    """Return the instance with east and west exchanged."""

    def swapped(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: swapped(each) for key, each in value.items()}
        if isinstance(value, list | tuple):
            items = list(value)
            if len(items) == 3 and all(isinstance(each, int | float) for each in items):
                x = width + 1 - items[0] if isinstance(items[0], float) else width - items[0]
                return [x, *items[1:]]
            return [swapped(each) for each in items]
        return value

    mirrored: dict[str, Any] = swapped(content)
    return mirrored
