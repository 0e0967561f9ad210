"""A watchman who must not learn what the spy knows (Perner and Wimmer 1985, second-order belief).

The watchman knows what is in the coffers and believes that the spy does not know it. The spy knows
it, and wants gold. If the spy takes gold in view of the watchman, the watchman learns that the spy
knows the contents. A spy that does not consider what the watchman believes about the spy's beliefs
takes the nearest gold. The coffer that the watchman cannot see is any of the others, wherever he
stands. Further agents are watchmen beside him, who must not learn it either.
"""

import itertools
import random
from collections.abc import Mapping, Sequence
from typing import Any

from beliefnest.episodes.tasks.building import abreast, also, belief, chest, hall, wall

PARAMETERS = {"coffers": (5, 3, 6), "reach": (10, 8, 16), "agents": (2, 2, 4)}

_WATCHMEN = ("watchman", "warden", "sentry")
_APART, _WALL, _FRONT = 8, 6, 3
"""Blocks between coffers; z of the glass; z at which the spy stands at a coffer."""


def instance(chance: random.Random, coffers: int, reach: int, agents: int) -> dict[str, Any]:
    """Return an instance.

    Args:
        chance: Random source of the places of the spy, the watchman and the hidden coffer.
        coffers: Number of coffers; the watchman cannot see one of them.
        reach: Half of the blocks between the watchman and the glass.
        agents: Number of agents: the spy, and watchmen side by side, none of whom may find out.
    """
    width, depth = _APART * coffers, 2 * reach + _WALL + 2
    columns = [_APART // 2 + _APART * number for number in range(coffers)]
    # The spy begins in front of a coffer that the watchman sees.
    near, hidden = chance.sample(columns, 2)
    post = chance.choice(columns)
    places = [(x, 1, 1) for x in columns]
    contents = {place: {"gold_ingot": 3} for place in places}
    # Spy and watchman are on two sides of a glass wall. Stone in it hides the spy at one coffer.
    # Fins beside the coffers let the spy reach each only from the front.
    slant = (_WALL - _FRONT) / (depth - 2 - _FRONT)
    stone = hidden + round((post - hidden) * slant)
    blocks = [
        wall((0, 1, _WALL), (width, 3, _WALL), "glass"),
        wall((max(0, stone - 3), 1, _WALL), (min(width, stone + 3), 3, _WALL)),
        *(wall((x + side, 1, 0), (x + side, 2, 2)) for x in columns for side in (-1, 1)),
    ]
    watchmen = _WATCHMEN[: agents - 1]
    posts = abreast(watchmen, [post + 0.5, 1, depth - 1.5], (1, 0))
    return {
        "description": (
            "The spy wants a gold ingot. The watchman must not find out that the spy knows what is "
            f"in any of the coffers.{also(watchmen[1:], 'must not find out either.')}"
        ),
        "order": 2,
        "scenario": {
            "name": "watchman",
            **hall(width, depth, blocks),
            "containers": [chest(place, contents[place], "coffer") for place in places],
            "agents": {
                "spy": {"position": [near + 0.5, 1, 4.5], "facing": "north"},
                **{name: {"position": at, "facing": "north"} for name, at in posts.items()},
            },
            "perception": {"max_visible_distance": 64},
            "initial_beliefs": _beliefs(watchmen, contents),
        },
        "goal": {
            "reach": [{"agent": "spy", "items": {"gold_ingot": 1}}],
            "never": [
                {"path": f"/{name}/spy", "container": list(place), "items": {"gold_ingot": 1}}
                for name in watchmen
                for place in places
            ],
        },
        "goals": {name: {} for name in watchmen},
        "players": ["spy"],
        "talk": [],
        "policies": dict.fromkeys(watchmen, "search:0"),
        "round_ticks": 10,
        "rounds": -(-(width + 10) // 10),
    }


def _beliefs(
    watchmen: Sequence[str], contents: Mapping[tuple[int, int, int], Mapping[str, int]]
) -> list[dict[str, Any]]:
    """Return initial beliefs: all know the contents; watchmen believe that the spy does not."""
    nothing: dict[tuple[int, int, int], dict[str, int]] = {place: {} for place in contents}
    # Watchmen also attribute this belief about the spy to one another.
    pairs = [f"{one}/{other}" for one, other in itertools.permutations(watchmen, 2)]
    spied = [f"spy/{name}" for name in watchmen]
    return [
        belief("/**", contents),
        *(
            belief(f"/{path}/spy/**", nothing, complete=False)
            for path in (*watchmen, *spied, *pairs)
        ),
    ]
