"""A joint lift without a word (Sebanz, Bekkering and Knoblich 2006; Tomasello 2014).

A lift rises while all its levers are on, with an agent at each of them. Each lift is in a stall
behind a door. Anne knows all lifts, and knows that Bob has been shown only one of them: never the
one nearest to both, which is in the middle, else any. They cannot talk. An agent that considers
what the other one knows goes to the lift where the other one will be. Further agents stand beside
Bob and know what he knows; each lift then has a lever for each of them.
"""

import random
from typing import Any

from beliefnest.episodes.tasks.building import FLOOR, WALL, abreast, also, hall, wall

PARAMETERS = {"far": (14, 12, 20), "lifts": (5, 3, 5), "agents": (2, 2, 4)}

_COMPANIONS = ("bob", "carl", "dora")
_STALL, _DEPTH, _ROUND = 6, 12, 15
"""Depth of a stall; depth of the hall; ticks of a round."""


def instance(chance: random.Random, far: int, lifts: int, agents: int) -> dict[str, Any]:
    """Return an instance.

    Args:
        chance: Random source of the lift that Bob knows, and of the nearest one if none is in the
            middle.
        far: Blocks from one lift to the next.
        lifts: Number of lifts.
        agents: Number of agents: Anne, Bob, and agents beside Bob who know what he knows; each lift
            has a lever for each agent.
    """
    width, depth = far * lifts, _DEPTH
    columns = [far // 2 + far * number for number in range(lifts)]
    # At both sides is a lift so far away: the time that is left does not tell which one it is.
    near = chance.choice(columns[1:-1]) if lifts % 2 == 0 else columns[lifts // 2]
    shown = chance.choice([x for x in columns if x != near and 2 * near - x in columns])
    companions = _COMPANIONS[: agents - 1]
    sites = {x: _site(x, agents) for x in columns}
    hung = "oak_door[facing=south,half={},hinge=left,open=false,powered=false]"
    blocks = [wall((0, 1, _STALL), (width, 3, _STALL))]
    blocks += [wall((x, 1, 0), (x, 3, _STALL)) for x in range(0, width + 1, far)]
    blocks += [
        {"block": hung.format(half), "at": [x, y, _STALL]}
        for x in columns
        for y, half in ((1, "lower"), (2, "upper"))
    ]
    levers = [place for site in sites.values() for place in site]
    feet = {
        "anne": [near + 0.5, 1, _STALL + 2.5],
        **abreast(companions, [near + 0.5, 1, _STALL + 3.5], (0, 1)),
    }
    every = "both" if agents == 2 else "all"
    return {
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
            "static_blocks": [FLOOR, WALL, "oak_door"],
            "initial_beliefs": [
                {"path": path, "blocks": [_lever(place) for place in places], "agents": feet}
                for path, places in (("/anne", levers), ("/**", sites[shown]))
            ],
        },
        "goal": {
            "reach": [{"agents": list(feet), "sites": [list(map(list, s)) for s in sites.values()]}]
        },
        "players": ["anne"],
        "talk": [],
        "policies": dict.fromkeys(companions, "search:0"),
        "round_ticks": _ROUND,
        # Long enough to go there, too short to come back from another lift.
        "rounds": -(-(abs(shown - near) + _STALL + 3) // _ROUND),
    }


def _site(x: int, levers: int) -> list[tuple[int, int, int]]:
    """Return the places of a lift's levers, at the walls of its stall."""
    places = [(x - 1, 1, 1), (x + 1, 1, 1), (x - 1, 1, 3), (x + 1, 1, 3)]
    return places[:levers]


def _lever(at: tuple[int, int, int]) -> dict[str, Any]:
    return {"block": "lever[face=floor,facing=north,powered=false]", "at": list(at)}
