"""Tell only what the other does not know (Grice 1975; Bard and others 2020 on costly hints).

Max has to fetch several things and knows where they were. Some were moved while he was away; Nora
sees from behind glass where everything is, and has to fetch a book herself, down a long passage.
Talk takes time: who tells nothing helps nobody, and who tells all there is to tell comes too late
to the book.
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
        chance: Draws sides, places and things.
        items: How many things Max has to fetch.
        moved: How many of them were moved, at most all.
        reach: Blocks from the middle of the hall to its ends.
        agents: Max, Nora, and people behind glass who know what Max knows.
    """
    width, wanted = 2 * reach, chance.sample(_ITEMS, items)
    moved = min(moved, items)
    before, now = _placed(chance, wanted, moved, reach)
    places = sorted(before.keys() | now.keys())
    onlookers = _ONLOOKERS[: agents - 2]
    behind_glass, glass = booths(onlookers, 8)
    fetched = {"agent": "max", "items": dict.fromkeys(wanted, 1)}
    rounds = -(-(reach + 24 + 6 * items + 20 * (moved - 1)) // _ROUND)
    # As far as she gets in the time that saying what has to be said leaves, and no further.
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
    """Where things were, and where they are: the moved ones at the ends, the rest between.

    Args:
        chance: Draws sides and places.
        wanted: The things.
        moved: How many of them were moved, the first ones.
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
    """Where the book is at the end of a passage behind glass, there and back, and its blocks.

    Args:
        width: Of the hall.
        errand: Steps from the passage's beginning to where the book can be reached.
    """
    # Its two ends lie too far apart to reach from one into the other.
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
