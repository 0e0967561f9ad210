"""Search among many agents: chains longer than those of the built-in tasks, and handing over."""

from typing import Any

import pytest

import beliefnest as bn
from beliefnest.episodes.policies.candidates import calls_of
from beliefnest.world.values import EventKind

BARREL = [10, 1, 10]
NAMES = ["ann", "bob", "carl", "dora", "eve", "finn"]
PLACES = [(4, 6), (16, 6), (4, 14), (16, 14), (10, 4)]
ITEMS = ["apple", "bread", "carrot"]


def hall(agents: int, wall: bool = False) -> bn.Scenario:
    """Return a hall in which agents who each know one item must bring all three to a barrel.

    Args:
        agents: Number of agents.
        wall: True for a wall of glass between the agents, with two chests, and the barrel.
    """
    held: list[dict[str, int]] = [*({item: 1} for item in ITEMS), {"bone": 1}, {}]
    contents = [
        {"at": [x, 1, z], "items": items} for (x, z), items in zip(PLACES, held, strict=True)
    ]
    names = NAMES[:agents]
    blocks: list[dict[str, Any]] = [{"block": "stone", "fill": [[0, 0, 0], [20, 0, 20]]}]
    if wall:
        blocks.append({"block": "glass", "fill": [[0, 1, 12], [20, 3, 12]]})
    return bn.Scenario.from_mapping(
        {
            "name": "hall",
            "box": [[0, 0, 0], [20, 3, 20]],
            "blocks": blocks,
            "static_blocks": ["stone", "glass", "chest", "barrel"],
            "containers": [
                *({"label": "chest", **each} for each in contents),
                {"label": "barrel", "at": BARREL, "block": "barrel"},
            ],
            "agents": {
                name: {"position": [2.5 + 3 * number, 1, 18.5]} for number, name in enumerate(names)
            },
            "perception": {"max_visible_distance": 64, "testimony": "accept", "hearing": "global"},
            "initial_beliefs": [
                {"path": f"/{name}", "containers": [contents[number % len(ITEMS)]]}
                for number, name in enumerate(names)
            ],
            "episode": {
                "goal": {"reach": [{"container": BARREL, "items": dict.fromkeys(ITEMS, 1)}]},
                "talk": names,
                "rounds": 8,
                "round_ticks": 20,
            },
        }
    )


@pytest.mark.long
def test_six_agents_do_a_chain_of_six_calls() -> None:
    with bn.Episode(hall(6), dict.fromkeys(NAMES, "search:1")) as episode:
        assert episode.play().success
        events = episode.nest["/"].state.events
        for kind in (EventKind.GET_ITEM_FROM_CHEST, EventKind.DEPOSIT_ITEM_INTO_CHEST):
            moved = [item for each in events if each.kind is kind for item in each.detail["items"]]
            assert set(ITEMS) <= set(moved)


@pytest.mark.parametrize(
    ("agents", "wall", "hands_over"), [(4, False, True), (5, False, False), (5, True, True)]
)
def test_who_brings_an_item_itself_hands_it_over_only_in_a_small_group(
    agents: int, wall: bool, hands_over: bool
) -> None:
    with bn.Episode(hall(agents, wall)) as episode:
        view = episode.view("ann")
        mind = view.imagine(1)
        mind.world.withdraw("ann", (PLACES[0][0], 1, PLACES[0][1]), {ITEMS[0]: 1})
        calls = calls_of(mind, "ann", [view.goal])
        put = {each.args[0] for each in calls if each.skill == "depositItemIntoChest"}
        to_others = [each for each in calls if each.skill in ("giveItemToOther", "goToPosition")]
        assert bool(to_others) is hands_over
        assert (len(put) > 1) is hands_over
        assert (tuple(BARREL) in put) is not wall
