"""Nothing that an agent cannot perceive reaches its policy."""

import copy
import math
from typing import Any

import numpy as np
import pytest
from tests.profiles import at_night, few_by_day

import beliefnest as bn
from beliefnest.episodes.policies.model import ModelPolicy
from beliefnest.llm.offline import OfflineModel

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
            self.read.append([dict(node.containers), dict(node.agents), node.grid.tolist()])
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


READS = """
const [low, high] = %s
let sum = 0
for (let x = low[0]; x <= high[0]; x++) {
  for (let y = low[1]; y <= high[1]; y++) {
    for (let z = low[2]; z <= high[2]; z++) {
      const name = bot.blockAt(new Vec3(x, y, z))?.name ?? '?'
      for (const letter of name) sum = (sum * 31 + letter.charCodeAt(0)) | 0
    }
  }
}
const there = Object.values(bot.entities).map(each => `${each.username} ${each.position}`)
await think(bot, `${sum} ${there.sort()}`)
"""
"""Lets an agent think of all that its program can read: it reads that in the next round."""


class ReadsAll(Records):
    """Keeps all that a policy and its programs can read, of whatever task."""

    def __init__(self, task: bn.Task) -> None:
        super().__init__()
        self.task = task
        self.model = ModelPolicy(OfflineModel(), 2)
        self.known: Any = False
        self.thoughts = 0

    def act(self, view: bn.AgentView) -> str:
        names = [name for name in self.task.agents if name != view.agent]
        below = [(a, b) for a in names for b in self.task.agents if b != a]
        mind = view.imagine(2)
        for path in ((), *((name,) for name in names), *below):
            node = mind.view(path)
            self.read.append(plain(view.about(*path) if path else view.state))
            self.read.append([dict(node.containers), dict(node.agents), node.grid.tolist()])
        self.read += [view.last, view.brief, view.heard, view.ticks_left, self.model.prompt(view)]
        self.known = self.known | (np.asarray(view.state.blocks.grid) >= 0)
        self.thoughts = len(view.state.thoughts)
        return READS % [list(corner) for corner in self.task.plain()["scenario"]["box"]]


def played_by_reader(content: dict[str, Any], agent: str) -> tuple[ReadsAll, Any, set[Any]]:
    """Play a task with a reader; return it, the blocks, and the containers that it used."""
    task = bn.Task.from_mapping(content)
    reader = ReadsAll(task)
    with bn.Episode(task, {agent: reader}) as episode:
        episode.play(3)
        events = episode.nest["/"].state.events
        used = {event.detail.get("position") for event in events if event.actor == agent}
        return reader, np.asarray(episode.nest["/"].state.blocks.grid), used


def hidden_in(content: dict[str, Any], agent: str, unseen: Any, used: set[Any]) -> bool:
    """Put into a task what an agent cannot perceive; whether there is anything of that kind."""
    scenario = content["scenario"]
    chests = scenario.get("containers", [])
    for chest in chests:
        # All are opaque.
        if tuple(chest["at"]) in used:
            continue
        chest["items"] = {**chest.get("items", {}), "stick": 1}
    beliefs = {each["path"]: each for each in scenario.get("initial_beliefs", [])}
    for held in beliefs.get("/**", {}).get("containers", [])[:1]:
        # The others believe to themselves that there is one more.
        for other in scenario["agents"].keys() - {agent}:
            own = beliefs.setdefault(f"/{other}", {"path": f"/{other}"})
            there = {tuple(each["at"]): each for each in own.get("containers", [])}
            first = there.get(tuple(held["at"]), held)
            more = {**first, "items": {**first.get("items", {}), "stick": 2}}
            own["containers"] = list({**there, tuple(held["at"]): more}.values())
    scenario["initial_beliefs"] = list(beliefs.values())
    if len(unseen):
        feet = [each["position"] for each in scenario["agents"].values()]
        at = max(unseen.tolist(), key=lambda place: min(math.dist(place, each) for each in feet))
        scenario["blocks"] = [*scenario["blocks"], {"block": "dirt", "at": at}]
    return bool(chests) or len(unseen) > 0


LEFT_OUT = ("watch-and-help",)
"""Tasks in which everybody sees all there is; they hide goals (policies/test_infer.py)."""

AGENTS = [
    (name, agent)
    for name in bn.Task.names()
    if name not in LEFT_OUT
    for agent in bn.Task.load(name).agents[: at_night(9, 1)]
]


@pytest.mark.parametrize(("name", "agent"), few_by_day(AGENTS, 3))
def test_what_cannot_be_perceived_changes_nothing_in_any_task(name: str, agent: str) -> None:
    content = bn.Task.load(name, seed=2).plain()
    expected, blocks, used = played_by_reader(content, agent)
    low = np.array(content["scenario"]["box"]).min(0)
    unseen = np.argwhere(~expected.known & (blocks == 0)) + low
    changed = copy.deepcopy(content)
    assert hidden_in(changed, agent, unseen[unseen[:, 1] > 1], used)
    assert changed != content
    found, _, _ = played_by_reader(changed, agent)
    assert found.read == expected.read
    # Its programs did read.
    assert (expected.thoughts, found.thoughts) == (2, 2)
