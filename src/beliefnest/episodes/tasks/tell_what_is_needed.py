"""Tell only what the other agent does not know (Grice 1975; Bard and others 2020, costly hints).

Max must fetch several things, each out of a passage of its own, and knows where they were. Some of
them, any, were moved while he was away. Nora sees from behind glass where everything is, and must
fetch a book herself, down a long passage. Speech takes time: if Nora says nothing, or something
that Max knows, she does not help him; if she says everything, she is too late for the book.
"""

import random
from typing import Any

from beliefnest.episodes.tasks.building import WINDOW, belief, booths, chest, hall, passages, wall
from beliefnest.world.values import Position

PARAMETERS = {"items": (3, 2, 4), "moved": (1, 1, 2), "reach": (20, 20, 26), "agents": (2, 2, 4)}

_SPEECH, _ROUND, _REACH = 10, 10, 3
_ITEMS = ("diamond", "emerald", "apple", "compass", "bread")
_ONLOOKERS = ("ben", "cleo")


def instance(
    chance: random.Random, items: int, moved: int, reach: int, agents: int
) -> dict[str, Any]:
    """Return an instance.

    Args:
        chance: Random source of sides, places and things.
        items: Number of things that Max must fetch.
        moved: Number of things that were moved; at least one was not. A true word at random is of
            one of these in `moved` of `items` cases.
        reach: Blocks from the middle of the hall to its ends.
        agents: Number of agents: Max, Nora, and agents behind glass who know what Max knows.
    """
    wanted = chance.sample(_ITEMS, items)
    moved = min(moved, items - 1)
    places, walls = passages(reach, items + moved)
    ends = chance.sample(places, items + moved)
    now: dict[Position, dict[str, int]] = {
        at: {item: 1} for at, item in zip(ends[:items], wanted, strict=True)
    }
    left = dict(zip(chance.sample(ends[:items], moved), ends[items:], strict=True))
    before = {left.get(at, at): items_there for at, items_there in now.items()}
    onlookers = _ONLOOKERS[: agents - 2]
    behind_glass, glass = booths(onlookers, 8)
    fetched = {"agent": "max", "items": dict.fromkeys(wanted, 1)}
    # Max hears of the first moved thing before he is at the passages, of another one after.
    ticks = _ROUND + (2 * items - 1) * (reach - 2) + 2 * _ROUND * (moved - 1) + 18
    # Exactly as far as Nora can walk in the time that the needed utterances leave.
    errand = ticks - _SPEECH * moved - 8
    width = max(2 * reach + 1, errand // 2 + 6)
    book, passage = _passage(width, errand)
    east = wall((2 * reach + 1, 1, 0), (width, 3, 12), WINDOW)
    return {
        "description": (
            f"Max fetches {', '.join(wanted)}. Some of it was moved while he was away. Nora sees "
            "where everything is; she has to fetch a book herself, and talk takes time."
        ),
        "order": 1,
        "scenario": {
            "name": "tell-what-is-needed",
            **hall(width, 22, [*walls, east, *glass, *passage]),
            "containers": [
                *(chest(place, now.get(place, {})) for place in places),
                chest(book, {"book": 1}),
            ],
            "agents": {
                "nora": {"position": [2.5, 1, 14.5], "facing": "north"},
                "max": {"position": [reach - _ROUND + 0.5, 1, 8.5], "facing": "north"},
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
        "goal": {
            "reach": [fetched, {"agent": "nora", "items": {"book": 1}}],
            "messages": items,
            "ticks": ticks,
        },
        "goals": {"max": {"reach": [fetched]}},
        "players": ["nora"],
        "policies": {"max": "search:0", **dict.fromkeys(onlookers, "search:0")},
        "talk": ["nora", *onlookers],
        "round_ticks": _ROUND,
        "rounds": -(-ticks // _ROUND),
    }


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
        wall((1, 1, 13), (width, 3, 21), WINDOW),
        wall((2, 1, 14), (width - 2, 3, 14), "air"),
        wall((2, 1, 20), (width - 2, 3, 20), "air"),
        wall((width - 2, 1, 15), (width - 2, 3, 19), "air"),
    ]
    return book, blocks
