"""Tell only what the other agent does not know (Grice 1975; Bard and others 2020, costly hints).

Max must fetch several things and knows where they were. Some of them were moved while he was away.
Nora sees from behind glass where everything is, and must fetch a book herself, down a long passage.
Speech takes time: if Nora says nothing, she does not help Max; if she says everything, she is too
late for the book.
"""

import random
from collections.abc import Sequence
from typing import Any

from beliefnest.episodes.tasks.building import Position, belief, booths, chest, hall, wall

PARAMETERS = {"items": (3, 1, 4), "moved": (1, 1, 2), "reach": (26, 26, 32), "agents": (2, 2, 4)}

_SPEECH, _ROUND, _REACH = 12, 15, 3
_ITEMS = ("diamond", "emerald", "apple", "compass", "bread")
_ONLOOKERS = ("ben", "cleo")

_Contents = dict[Position, dict[str, int]]


def instance(
    chance: random.Random, items: int, moved: int, reach: int, agents: int
) -> dict[str, Any]:
    """Return an instance.

    Args:
        chance: Random source of sides, places and things.
        items: Number of things that Max must fetch.
        moved: Number of things that were moved; not more than `items` count.
        reach: Blocks from the middle of the hall to its ends.
        agents: Number of agents: Max, Nora, and agents behind glass who know what Max knows.
    """
    width, wanted = 2 * reach, chance.sample(_ITEMS, items)
    moved = min(moved, items)
    before, now = _placed(chance, wanted, moved, reach)
    places = sorted(before.keys() | now.keys())
    onlookers = _ONLOOKERS[: agents - 2]
    behind_glass, glass = booths(onlookers, 8)
    fetched = {"agent": "max", "items": dict.fromkeys(wanted, 1)}
    rounds = -(-(reach + 24 + 6 * items + 20 * (moved - 1)) // _ROUND)
    # Exactly as far as Nora can walk in the time that the needed utterances leave.
    book, passage = _passage(width, rounds * _ROUND - _SPEECH * moved - 10)
    return {
        "description": (
            f"Max fetches {', '.join(wanted)}. Some of it was moved while he was away. Nora sees "
            "where everything is; she has to fetch a book herself, and talk takes time."
        ),
        "order": 1,
        "scenario": {
            "name": "tell-what-is-needed",
            **hall(width, 22, [*glass, *passage]),
            "containers": [
                *(chest(place, now.get(place, {})) for place in places),
                chest(book, {"book": 1}),
            ],
            "agents": {
                "nora": {"position": [2.5, 1, 14.5], "facing": "north"},
                "max": {"position": [reach + 0.5, 1, 5.5], "facing": "north"},
                **behind_glass,
            },
            "perception": {
                "max_visible_distance": 80,
                "testimony": "accept",
                "speech_ticks": _SPEECH,
            },
            "initial_beliefs": [
                belief("/**", before, complete=False),
                belief("/nora", {**{p: now.get(p, {}) for p in places}, book: {"book": 1}}),
            ],
        },
        "goal": {"reach": [fetched, {"agent": "nora", "items": {"book": 1}}]},
        "goals": {"max": {"reach": [fetched]}},
        "players": ["nora"],
        "policies": {"max": "search:0", **dict.fromkeys(onlookers, "search:0")},
        "talk": ["nora", *onlookers],
        "round_ticks": _ROUND,
        "rounds": rounds,
    }


def _placed(
    chance: random.Random, wanted: Sequence[str], moved: int, reach: int
) -> tuple[_Contents, _Contents]:
    """Return the first and the present contents of chests.

    Moved things are at the ends of the hall, the other things between.

    Args:
        chance: Random source of sides and places.
        wanted: The things.
        moved: Number of things that were moved: the first ones of `wanted`.
        reach: Blocks from the middle of the hall to its ends.
    """
    ends = chance.sample([1, 2 * reach - 1], 2)
    rows = {x: chance.sample(range(1, 9), 8) for x in ends}
    middle = [(reach + dx, 1, z) for dx in (-4, -2, 2, 4) for z in (2, 8)]
    near = chance.sample(middle, len(wanted))
    before: _Contents = {}
    now: _Contents = {}
    for number, item in enumerate(wanted):
        if number < moved:
            before[(ends[0], 1, rows[ends[0]].pop())] = {item: 1}
            now[(ends[1], 1, rows[ends[1]].pop())] = {item: 1}
        else:
            before[near[number]] = now[near[number]] = {item: 1}
    return before, now


def _passage(width: int, errand: int) -> tuple[Position, list[dict[str, Any]]]:
    """Return the place of the book in a U-shaped passage behind glass, and the passage's blocks.

    Args:
        width: Width of the hall.
        errand: Steps from the beginning of the passage to where the book can be reached.
    """
    # The two legs of the passage are too far apart to reach from one into the other.
    straight, turn = width - 4, 6
    back = errand + _REACH - straight - turn
    book = (2 + errand + _REACH, 1, 14) if back <= 0 else (width - 2 - back, 1, 20)
    blocks = [
        wall((1, 1, 13), (width, 3, 21), "glass"),
        wall((2, 1, 14), (width - 2, 3, 14), "air"),
        wall((2, 1, 20), (width - 2, 3, 20), "air"),
        wall((width - 2, 1, 15), (width - 2, 3, 19), "air"),
    ]
    return book, blocks
