"""Checks of worlds, policies and prompt filters of your own, for your tests.

Each check raises AssertionError, which says what the plugin did and what it should have done.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np
from msgspec.structs import replace

from beliefnest.episodes.agent_view import Policy
from beliefnest.episodes.episode import Episode
from beliefnest.episodes.task import Task
from beliefnest.errors import WorldError
from beliefnest.prompts import PromptFilter
from beliefnest.prompts.example import example_branch
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, Box
from beliefnest.worlds.protocol import Body, World

__all__ = ["check_filter", "check_policy", "check_world"]

_BOX = Box((0, 0, 0), (6, 4, 6))
_CHEST = (2, 1, 2)
_TIMEOUT = 400
_ACTS = (
    ("sally", "await depositItemIntoChest(bot, new Vec3(2, 1, 2), {diamond: 1})"),
    ("anne", "await getItemFromChest(bot, new Vec3(2, 1, 2), {emerald: 2})"),
    ("sally", "bot.chat('hello')"),
)
_DEEDS = [
    (EventKind.DEPOSIT_ITEM_INTO_CHEST, "sally", {"position": _CHEST, "items": {"diamond": 1}}),
    (EventKind.GET_ITEM_FROM_CHEST, "anne", {"position": _CHEST, "items": {"emerald": 2}}),
    (EventKind.CHAT, "sally", {"text": "hello"}),
]
_ON_THE_WAY = (EventKind.MOVE_TO, EventKind.OPEN_CONTAINER)


def check_world(world: World) -> None:
    """Check that a world keeps the protocol of worlds, in bodies that the check opens and closes.

    Args:
        world: World without bodies; the check does not close it.
    """
    for number, check in enumerate(_WORLD_CHECKS):
        frames: list[Frame] = []
        with _body(world, f"/check{number}", frames) as body:
            check(world, body, frames)


def check_policy(make: Callable[[], Policy], task: str, agent: str, rounds: int = 3) -> None:
    """Check that a policy plays, and that it decides the same again from the same beliefs.

    Args:
        make: Function that makes a new policy.
        task: Name of a task; it is played with seed 0 in the scripted world.
        agent: Agent of the task that the policy controls; the others do nothing.
        rounds: Number of rounds.
    """
    first, second = (_decisions(make(), task, agent, rounds) for _ in range(2))
    for number, (once, again) in enumerate(zip(first, second, strict=True)):
        assert isinstance(once, str), f"round {number}: act returned {once!r}; return a program"
        assert once == again, f"round {number}: {once!r} at first, and {again!r} when played again"


def check_filter(checked: PromptFilter[Any], *args: Any, **keywords: Any) -> None:
    """Check that a prompt filter returns the same text each time from a small example belief.

    Args:
        checked: The filter.
        args: Arguments that a template gives it in brackets.
        keywords: Those by name.
    """
    once, again = (checked(example_branch(), *args, **keywords) for _ in range(2))
    assert isinstance(once, str), f"{checked.name} returned {once!r}; return a text"
    assert once == again, f"{checked.name} returned {once!r} at first, and then {again!r}"


class _Noting:
    """Policy that notes what another one decides."""

    def __init__(self, policy: Policy) -> None:
        self._policy = policy
        self.decisions: list[Any] = []

    def act(self, view: Any) -> str:
        self.decisions.append(self._policy.act(view))
        decided: str = self.decisions[-1]
        return decided


def _decisions(policy: Policy, name: str, agent: str, rounds: int) -> list[Any]:
    task, noting = Task.load(name, seed=0), _Noting(policy)
    players: Mapping[str, Any] = {
        each: noting if each == agent else _Idle() for each in task.agents
    }
    with Episode(task, players, seed=0) as episode:
        episode.play(rounds=rounds)
    return noting.decisions


class _Idle:
    """Policy that does nothing."""

    def act(self, view: Any) -> str:
        del view
        return ""


def _start() -> Snapshot:
    registry = Registry.load()
    blocks = np.zeros(_BOX.shape, dtype=np.int32)
    blocks[:, 0, :] = registry.state_id("stone")
    blocks[_BOX.index(_CHEST)] = registry.state_id("chest")
    agents = {
        "sally": AgentState((1.5, 1.0, 3.5), inventory={"diamond": 2}),
        "anne": AgentState((4.5, 1.0, 2.5), 1.5, 0.25, inventory={"bread": 3}),
    }
    return Snapshot(7, _BOX, Terrain.of(blocks), {_CHEST: {"emerald": 2}}, agents)


@contextmanager
def _body(world: World, name: str, frames: list[Frame]) -> Iterator[Body]:
    body = world.open_body(name, "seed", _start(), frames.append)
    try:
        yield body
    finally:
        body.close()
    body.close()


def _act(body: Body, acts: int = len(_ACTS)) -> None:
    for agent, program in _ACTS[:acts]:
        result = body.run({agent: program}, _TIMEOUT)[agent]
        assert result.ok, f"{agent}: {program} failed: {result.error}"


def _holdings(snapshot: Snapshot) -> tuple[Any, Any]:
    agents = snapshot.agents.items()
    return dict(snapshot.containers), {name: dict(agent.inventory) for name, agent in agents}


def _same(actual: object, wanted: object, what: str) -> None:
    assert actual == wanted, f"{what}: {actual!r}, but {wanted!r} is right"


def _is_filled(world: World, body: Body, frames: list[Frame]) -> None:
    there, wanted = body.snapshot(), _start()
    _same(body.tick, wanted.tick, "tick of a new body")
    assert there.blocks == wanted.blocks, "a new body has other blocks than its snapshot"
    _same(_holdings(there), _holdings(wanted), "items in a new body")
    for name, agent in wanted.agents.items():
        _same(there.agents[name].position, agent.position, f"position of {name} in a new body")


def _passes_time(world: World, body: Body, frames: list[Frame]) -> None:
    body.step(5)
    passed = body.tick - _start().tick
    assert passed >= 5 if body.goes_on else passed == 5, f"step(5) took {passed} ticks"
    assert all(frame.is_empty for frame in frames), "something happened without a program"


def _tells_acts(world: World, body: Body, frames: list[Frame]) -> None:
    _act(body)
    events = [event for frame in frames for event in frame.events]
    deeds = [(e.kind, e.actor, dict(e.detail)) for e in events if e.kind not in _ON_THE_WAY]
    _same(deeds, _DEEDS, "events of three acts")
    ticks = [frame.tick for frame in frames]
    _same(ticks, sorted(set(ticks)), "ticks of frames")
    assert _start().tick < ticks[0] <= ticks[-1] <= body.tick, "a frame lies outside the call"
    contents: dict[Any, Any] = dict(_start().containers)
    agents: dict[Any, Any] = dict(_start().agents)
    for frame in frames:
        contents.update(frame.containers)
        agents.update(frame.agents)
    summed = replace(_start(), containers=contents, agents=agents)
    _same(_holdings(summed), _holdings(body.snapshot()), "items that frames add up to")


def _takes_a_state(world: World, body: Body, frames: list[Frame]) -> None:
    _act(body, 1)
    frames.clear()
    wanted = replace(_start(), tick=3)
    body.set_state(wanted)
    assert frames == [], "set_state sent frames"
    _same(body.tick, 3, "tick after set_state")
    _same(_holdings(body.snapshot()), _holdings(wanted), "items after set_state")


def _is_alone(world: World, body: Body, frames: list[Frame]) -> None:
    others: list[Frame] = []
    with _body(world, "/other", others) as other:
        _act(body)
        assert others == [], "acts in one body sent frames of another"
        _same(_holdings(other.snapshot()), _holdings(_start()), "items in another body")


def _repeats(world: World, body: Body, frames: list[Frame]) -> None:
    if body.goes_on:  # Real time is not repeated.
        return
    again: list[Frame] = []
    with _body(world, "/twin", again) as twin:
        _act(body)
        _act(twin)
    assert frames == again, "the same seed and programs gave other frames"


def _refuses_the_absent(world: World, body: Body, frames: list[Frame]) -> None:
    try:
        body.run({"nobody": "await think(bot, 'hm')"}, 20)
    except WorldError:
        return
    raise AssertionError("a program of an agent that is not there must raise WorldError")


_WORLD_CHECKS = (
    _is_filled,
    _passes_time,
    _tells_acts,
    _takes_a_state,
    _is_alone,
    _repeats,
    _refuses_the_absent,
)
