"""Nothing that an agent cannot perceive reaches its policy."""

from typing import Any

import numpy as np
import pytest

import beliefnest as bn

ROOM: dict[str, Any] = {
    "name": "rooms",
    "box": [[0, 0, 0], [12, 3, 6]],
    "static_blocks": ["stone"],
    "perception": {"hearing": "sight"},
}
FLOOR = {"block": "stone", "fill": [[0, 0, 0], [12, 0, 6]]}
WALL = {"block": "bricks", "fill": [[6, 1, 0], [6, 3, 6]]}


def task_with(blocks: list[Any], items: dict[str, int], bob: list[float], doing: str) -> bn.Task:
    return bn.Task.from_mapping(
        {
            "name": "rooms",
            "scenario": {
                **ROOM,
                "blocks": [FLOOR, WALL, *blocks],
                "containers": [
                    {"at": [2, 1, 2], "items": {"apple": 1}},
                    {"at": [10, 1, 2], "items": items},
                ],
                "agents": {"ann": {"position": [3.5, 1, 3.5]}, "bob": {"position": bob}},
                "script": [{"agent": "bob", "program": doing}],
            },
            "goal": {"reach": [{"agent": "ann", "items": {"diamond": 1}}]},
            "talk": ["ann", "bob"],
            "policies": {"bob": "search:1"},
            "rounds": 3,
            "round_ticks": 10,
        }
    )


class Records:
    """Keeps all that a policy can read, and does what a planner would."""

    def __init__(self) -> None:
        self.read: list[Any] = []

    def act(self, view: bn.AgentView) -> str:
        states = [view.state, view.about("bob"), view.about("bob", "ann")]
        self.read.append([plain(state) for state in states])
        mind = view.imagine(2)
        self.read.append([(name, repr(state)) for name, state in mind.world.agents.items()])
        self.read.append(mind.world.blocks.tolist())
        for path in ((), ("bob",), ("bob", "ann")):
            node = mind.view(path)
            self.read.append([dict(node.containers), dict(node.agents), node.blocks.tolist()])
        self.read += [
            view.tick,
            view.round,
            view.last,
            view.brief,
            view.render("{{ branch.state }}"),
        ]
        return "await getItemFromChest(bot, new Vec3(2, 1, 2), {diamond: 1})"


def plain(state: Any) -> Any:
    grid = np.asarray(state.blocks.grid).tolist()
    return [
        *(state.path, state.tick, grid, dict(state.containers), dict(state.agents)),
        *(dict(state.items), state.events, list(state.chat), list(state.thoughts)),
    ]


def read_of(task: bn.Task) -> list[Any]:
    records = Records()
    with bn.Episode(task, {"ann": records}) as episode:
        episode.play()
    return records.read


@pytest.mark.parametrize(
    ("blocks", "items", "bob", "doing"),
    [
        ([], {"diamond": 3}, [8.5, 1, 3.5], "await waitTicks(bot, 3)"),
        ([{"block": "dirt", "at": [9, 1, 5]}], {}, [8.5, 1, 3.5], "await waitTicks(bot, 3)"),
        ([], {}, [11.5, 1, 5.5], "await waitTicks(bot, 3)"),
        ([], {}, [8.5, 1, 3.5], "await goToPosition(bot, new Vec3(8, 1, 0), 0)"),
    ],
    ids=["items", "a block", "somebody's place", "somebody's doing"],
)
def test_what_cannot_be_perceived_changes_nothing_of_a_policys_input(
    blocks: list[Any], items: dict[str, int], bob: list[float], doing: str
) -> None:
    expected = read_of(task_with([], {}, [8.5, 1, 3.5], "await waitTicks(bot, 3)"))
    assert read_of(task_with(blocks, items, bob, doing)) == expected


def test_what_can_be_perceived_does() -> None:
    expected = read_of(task_with([], {}, [8.5, 1, 3.5], "await waitTicks(bot, 3)"))
    seen = [{"block": "dirt", "at": [4, 1, 5]}]
    assert read_of(task_with(seen, {}, [8.5, 1, 3.5], "await waitTicks(bot, 3)")) != expected
