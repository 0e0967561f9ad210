"""A watchman who must not learn what the spy knows (Perner and Wimmer 1985, second-order belief).

The watchman knows what is in the coffers and believes that the spy does not know it. The spy knows
it, and wants gold. If the spy takes gold in view of the watchman, the watchman learns that the spy
knows the contents. A spy that does not consider what the watchman believes about the spy's beliefs
takes the nearest gold. Further agents are watchmen beside him, who must not learn it either.
"""

import itertools
import random
from collections.abc import Mapping, Sequence
from typing import Any

from beliefnest.episodes.tasks.building import abreast, also, belief, chest, hall, wall

PARAMETERS = {"coffers": (5, 2, 6), "reach": (10, 8, 16), "agents": (2, 2, 4)}

_WATCHMEN = ("watchman", "warden", "sentry")


def instance(chance: random.Random, coffers: int, reach: int, agents: int) -> dict[str, Any]:
    """Return an instance.

    Args:
        chance: Random source of places and sides.
        coffers: Number of coffers; the watchman cannot see one of them.
        reach: Blocks from the middle of the hall to its ends.
        agents: Number of agents: the spy, and watchmen side by side, none of whom may find out.
    """
    width, depth = 2 * reach, 10
    mirrored = chance.random() < 0.5
    spots = [(x, 1, 1) for x in chance.sample(range(4, reach), coffers - 1)]
    hidden = (width - 1, 1, chance.randint(1, 3))
    screen = wall((width - 5, 1, 0), (width - 5, 3, 6))

    def turned(x: float, *, feet: bool = False) -> float:
        if not mirrored:
            return x
        return width + 1 - x if feet else width - x

    places = [(int(turned(x)), y, z) for x, y, z in [*spots, hidden]]
    contents = {place: {"gold_ingot": 3} for place in places}
    (low, high) = sorted((screen["fill"][0][0], screen["fill"][1][0]))
    screen = wall((int(turned(low)), 1, 0), (int(turned(high)), 3, 6))
    watchmen = _WATCHMEN[: agents - 1]
    posts = abreast(watchmen, [turned(1.5, feet=True), 1, 5.5], (0, 1))
    return {
        "description": (
            "The spy wants a gold ingot. The watchman must not find out that the spy knows what is "
            f"in any of the coffers.{also(watchmen[1:], 'must not find out either.')}"
        ),
        "order": 2,
        "scenario": {
            "name": "watchman",
            **hall(width, depth, [screen]),
            "containers": [chest(place, contents[place], "coffer") for place in places],
            "agents": {
                "spy": {"position": [turned(reach + 0.5, feet=True), 1, 5.5], "facing": "north"},
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
        "policies": dict.fromkeys(watchmen, "search:0"),
        "round_ticks": 10,
        "rounds": -(-(2 * reach + 20) // 10),
    }


def _beliefs(
    watchmen: Sequence[str], contents: Mapping[tuple[int, int, int], Mapping[str, int]]
) -> list[dict[str, Any]]:
    """Return initial beliefs: all know the contents; watchmen believe that the spy does not."""
    nothing: dict[tuple[int, int, int], dict[str, int]] = {place: {} for place in contents}
    # Watchmen also attribute this belief about the spy to one another.
    pairs = [f"{one}/{other}" for one, other in itertools.permutations(watchmen, 2)]
    known = [f"spy/{name}" for name in watchmen]
    return [
        belief("/**", contents),
        *(
            belief(f"/{path}/spy/**", nothing, complete=False)
            for path in (*watchmen, *known, *pairs)
        ),
    ]
