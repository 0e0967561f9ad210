"""Planners use levers, buttons and plates that move iron doors, alike in both worlds."""

from typing import Any

import pytest

from beliefnest.episodes.episode import Episode
from beliefnest.episodes.task import Task

pytestmark = pytest.mark.usefixtures("kept_worlds")

CHEST = [10, 1, 2]


def vault(switch: str) -> Task:
    """Return a task whose diamond lies behind an iron door that a switch opens by a wire."""
    blocks: list[dict[str, Any]] = [
        {"block": "stone", "fill": [[0, 0, 0], [12, 0, 8]]},
        {"block": "stone", "fill": [[6, 1, 0], [6, 3, 8]]},
        {"block": "iron_door[facing=east,half=lower]", "at": [6, 1, 4]},
        {"block": "iron_door[facing=east,half=upper]", "at": [6, 2, 4]},
        {"block": "redstone_wire", "fill": [[4, 1, 4], [5, 1, 4]]},
        {"block": switch, "at": [3, 1, 4]},
        # This lever lights a lamp, which is no use.
        {"block": "lever[face=floor]", "at": [1, 1, 7]},
        {"block": "redstone_lamp", "at": [0, 1, 7]},
    ]
    held = [{"at": CHEST, "items": {"diamond": 1}}]
    return Task.from_mapping(
        {
            "name": "vault",
            "scenario": {
                "name": "vault",
                "box": [[0, 0, 0], [12, 4, 8]],
                "blocks": blocks,
                "containers": held,
                "agents": {"bob": {"position": [1.5, 1, 1.5]}},
                "initial_beliefs": [{"path": "/**", "containers": held}],
            },
            "goal": {"reach": [{"agent": "bob", "items": {"diamond": 1}}]},
            "rounds": 4,
            "round_ticks": 30,
        }
    )


@pytest.mark.parametrize("world", ["scripted", "embedded"])
@pytest.mark.parametrize(
    ("switch", "use"),
    [
        ("lever[face=floor]", "await turnOnLever(bot, new Vec3(3, 1, 4))"),
        ("oak_button[face=floor]", "await pressButton(bot, new Vec3(3, 1, 4))"),
        ("stone_pressure_plate", "await goToPosition(bot, new Vec3(3, 1, 4), 0)"),
    ],
    ids=["lever", "button", "plate"],
)
def test_search_opens_an_iron_door(world: str, switch: str, use: str) -> None:
    with Episode(vault(switch), {"bob": "search:0"}, world=world) as episode:
        episode.play()
        assert episode.success
        first = episode.parts[0].decisions["bob"].program
        assert first.splitlines() == [
            use,
            f'await getItemFromChest(bot, new Vec3{tuple(CHEST)}, {{"diamond": 1}})',
        ]
