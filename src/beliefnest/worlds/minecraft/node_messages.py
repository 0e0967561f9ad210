"""Conversion of the channel's messages to Python values and back (design/channel.md)."""

import math
from collections.abc import Callable, Mapping
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt
from msgspec.structs import replace

from beliefnest.errors import BeliefNestError, BodyError
from beliefnest.world.claims import Claim, claims_from_plain
from beliefnest.world.frames import BlockGrid, Frame, Snapshot
from beliefnest.world.terrain import MARGIN, SIDE, VOLUME, Lattice, Terrain
from beliefnest.world.values import (
    AgentState,
    Block,
    Box,
    DroppedItem,
    Event,
    Items,
    Position,
    Sign,
)
from beliefnest.worlds.protocol import Aim, Called, Fault, ProgramResult, Sensed, Unfinished

CUT = {"side": SIDE, "margin": MARGIN}
"""Cut of a box into the cubes of `Terrain`, for requests."""


class _Frame(msgspec.Struct, frozen=True):
    region: str
    tick: int
    agents: dict[str, AgentState | None] = {}
    blocks: list[list[int | str]] = []
    containers: list[tuple[int, int, int, dict[str, int] | None]] = []
    items: dict[int, DroppedItem | None] = {}
    events: list[Event] = []


class Cubes(msgspec.Struct, frozen=True):
    """Blocks of a box in cubes, as Node sends them if it is asked for `CUT`."""

    side: int
    counts: tuple[int, int, int]
    rows: bytes
    states: bytes


class _Snapshot(msgspec.Struct, frozen=True):
    tick: int
    containers: list[tuple[int, int, int, dict[str, int]]]
    agents: dict[str, AgentState]
    items: dict[int, DroppedItem] = {}
    internal_state: bytes = b""
    signs: list[tuple[int, int, int, str]] = []
    blocks: bytes | Cubes | None = None
    changes: list[tuple[int, int, int, int]] = []


class _Result(msgspec.Struct, frozen=True):
    ok: bool
    ticks: int
    lines: tuple[int, ...]
    log: tuple[str, ...]
    unfinished: tuple[Unfinished, ...]
    aims: tuple[Aim, ...] = ()
    error: Fault | None = None
    calls: tuple[Called, ...] = ()


def frame_of(message: Mapping[str, Any]) -> tuple[str, Frame]:
    """Return region and frame of a frame message.

    Raises:
        BodyError: The message is malformed.
    """
    got = _converted(message, _Frame)
    return got.region, Frame(
        got.tick,
        dict(sorted(got.agents.items())),
        dict(sorted(map(_block, got.blocks))),
        dict(sorted(((x, y, z), items) for x, y, z, items in got.containers)),
        dict(sorted(got.items.items())),
        tuple(map(_frozen, got.events)),
    )


def snapshot_of(message: Mapping[str, Any], box: Box, before: Terrain | None = None) -> Snapshot:
    """Return the snapshot in a message about a box.

    Args:
        message: The message.
        box: The box.
        before: Blocks of the last snapshot, of which a message may contain only the changes.

    Raises:
        BodyError: The message is malformed.
    """
    got = _converted(message, _Snapshot)
    return Snapshot(
        got.tick,
        box,
        _terrain_of(got, box, before),
        {(x, y, z): items for x, y, z, items in sorted(got.containers, key=lambda c: c[:3])},
        dict(sorted(got.agents.items())),
        dict(sorted(got.items.items())),
        got.internal_state,
        {(x, y, z): text for x, y, z, text in sorted(got.signs)},
    )


def snapshot_message(snapshot: Snapshot) -> dict[str, Any]:
    """Return a snapshot as the arguments of `create_region`."""
    return {
        "tick": snapshot.tick,
        "box": [snapshot.box.low, snapshot.box.high],
        "blocks": blocks_message(snapshot.blocks, snapshot.box.low),
        "containers": contents_message(snapshot.containers),
        "agents": {name: agent_message(agent) for name, agent in snapshot.agents.items()},
        "items": items_message(snapshot.items),
        "internal_state": snapshot.internal_state,
        **signs_message(snapshot.signs),
    }


def blocks_message(blocks: Terrain, low: Position) -> bytes | dict[str, Any]:
    """Return all blocks of a box as a message; `low` is the box's lowest corner.

    The message is as long as what the box contains: a chunk that occurs often is in it once.
    """
    if blocks.is_dense:
        return runs_of(blocks.dense())
    used, rows = np.unique(blocks.rows, return_inverse=True)
    return {
        "first": [part + step for part, step in zip(low, blocks.lattice.start(0), strict=True)],
        "side": SIDE,
        "counts": blocks.lattice.counts,
        "rows": runs_of(rows.astype(np.int32)),
        "states": runs_of(np.stack([blocks.chunks[row] for row in used.tolist()])),
    }


def runs_of(numbers: npt.NDArray[np.int32]) -> bytes:
    """Return numbers as a message: rows (number, count of consecutive elements with it) of int32.

    Args:
        numbers: Block states, or other numbers, in C order; not empty.
    """
    flat = numbers.reshape(-1)
    ends = np.append(np.flatnonzero(flat[1:] != flat[:-1]), flat.size - 1)
    counts = np.diff(ends, prepend=-1)
    return np.stack([flat[ends], counts], axis=1).astype("<i4").tobytes()


def _terrain_of(got: _Snapshot, box: Box, before: Terrain | None) -> Terrain:
    if isinstance(got.blocks, Cubes):
        return terrain_of_cubes(got.blocks, box)
    if got.blocks is not None:
        return Terrain.of(_blocks_of(got.blocks, box))
    if before is None:
        raise BodyError("Node sent changes of blocks where it had to send all blocks")
    blocks = before.draft()
    for x, y, z, state in got.changes:
        if (x, y, z) not in box:
            raise BodyError(f"Node sent a block at ({x}, {y}, {z}), outside the box")
        blocks[box.index((x, y, z))] = state
    return blocks.terrain()


def terrain_of_cubes(cubes: Cubes, box: Box) -> Terrain:
    """Return the terrain of a box in cubes.

    Raises:
        BodyError: The cubes do not fill the box.
    """
    lattice = Lattice(box.shape, is_one=False)
    if cubes.side != SIDE or cubes.counts != lattice.counts:
        raise BodyError(f"Node sent {cubes.counts} cubes of side {cubes.side} for {box}")
    rows = _expanded(cubes.rows, math.prod(cubes.counts), box)
    states = _expanded(cubes.states, (int(rows.max()) + 1) * VOLUME, box)
    try:
        return Terrain.of_cubes(box.shape, rows, states)
    except ValueError as fault:
        raise BodyError(f"Node sent blocks that do not fill {box}: {fault}") from fault


def _blocks_of(runs: bytes, box: Box) -> BlockGrid:
    """Return the blocks of a box from a message as `runs_of` makes it.

    Raises:
        BodyError: The runs have not as many blocks as the box.
    """
    return _expanded(runs, math.prod(box.shape), box).reshape(box.shape)


def _expanded(runs: bytes, size: int, box: Box) -> npt.NDArray[np.int32]:
    rows = np.frombuffer(runs, dtype="<i4", count=len(runs) // 8 * 2).reshape(-1, 2)
    states, counts = rows.astype(np.int32).T
    if len(runs) % 8 or (counts < 1).any() or counts.sum(dtype=np.int64) != size:
        raise BodyError(
            f"Node sent runs of {counts.sum(dtype=np.int64)} blocks where {box} needs {size}"
        )
    return np.repeat(states, counts)


def signs_message(signs: Mapping[Position, str]) -> dict[str, Any]:
    """Return the texts on signs as a further part of a message; empty if there are none."""
    return {"signs": [[*place, text] for place, text in sorted(signs.items())]} if signs else {}


def items_message(items: Mapping[int, DroppedItem]) -> dict[str, Any]:
    """Return dropped items by number as a message."""
    return {str(number): item for number, item in sorted(items.items())}


def contents_message(containers: Mapping[Position, Items]) -> list[list[Any]]:
    """Return container contents as rows of x, y, z, items."""
    return [[*place, dict(items)] for place, items in sorted(containers.items())]


def agent_message(agent: AgentState) -> dict[str, Any]:
    """Return an agent's state as a message."""
    return {
        **pose_message(agent),
        "inventory": dict(agent.inventory),
        "health": agent.health,
        "food": agent.food,
    }


def percepts_message(sensed: Sensed, low: Position) -> dict[str, Any]:
    """Return PERCEPTS of an agent whose program begins: everything that it knows.

    Args:
        sensed: Its knowledge.
        low: Lowest corner of the box.
    """
    return {
        "states": blocks_message(sensed.blocks, low),
        "agents": {name: pose_message(agent) for name, agent in sensed.agents.items()},
        "items": items_message(sensed.items),
        **signs_message(sensed.signs),
        **({"announced": sensed.announced} if sensed.announced else {}),
    }


def percepts_changes(before: Sensed, after: Sensed, low: Position) -> dict[str, Any]:
    """Return PERCEPTS of an agent's new knowledge; `low` is the box's lowest corner."""
    agents = agents_changes(before.agents, after.agents, pose_message)
    items: dict[str, Any] = {str(number): None for number in before.items.keys() - after.items}
    for number, item in after.items.items():
        if before.items.get(number) != item:
            items[str(number)] = item
    parts = {
        "blocks": terrain_changes(before.blocks, after.blocks, low),
        "agents": dict(sorted(agents.items())),
        "items": dict(sorted(items.items(), key=lambda item: int(item[0]))),
        "announced": after.announced,
    }
    changes = {name: part for name, part in parts.items() if part}
    if before.signs != after.signs:
        changes["signs"] = [[*place, text] for place, text in sorted(after.signs.items())]
    return changes


def terrain_changes(before: Terrain, after: Terrain, low: Position) -> list[list[int]]:
    """Return changed blocks as rows of x, y, z, state; `low` is the box's lowest corner."""
    return [
        [low[0] + i, low[1] + j, low[2] + k, after[i, j, k]]
        for i, j, k in before.differing(after).tolist()
    ]


def agents_changes(
    before: Mapping[str, AgentState],
    after: Mapping[str, AgentState],
    message: Callable[[AgentState], dict[str, Any]],
) -> dict[str, dict[str, Any] | None]:
    """Return the changed agents as messages by name; None for those that are gone."""
    changes: dict[str, dict[str, Any] | None] = dict.fromkeys(sorted(before.keys() - after.keys()))
    for name, agent in after.items():
        if before.get(name) != agent:
            changes[name] = message(agent)
    return changes


def pose_message(agent: AgentState) -> dict[str, Any]:
    """Return the visible part of an agent's state as a message."""
    return {
        "position": agent.position,
        "yaw": agent.yaw,
        "pitch": agent.pitch,
        "on_ground": agent.on_ground,
        "equipment": dict(agent.equipment),
    }


def results_of(
    message: Mapping[str, Any], happened: tuple[tuple[int, Event], ...]
) -> Mapping[str, ProgramResult]:
    """Return results of programs by agent; the events of the run, by tick, belong to all.

    Raises:
        BodyError: The message is malformed.
    """
    got = _converted(message, dict[str, _Result])
    return {
        agent: ProgramResult(
            agent,
            r.ok,
            r.error,
            r.ticks,
            happened,
            r.lines,
            r.log,
            r.unfinished,
            r.aims,
            calls=r.calls,
        )
        for agent, r in got.items()
    }


def _block(row: list[int | str]) -> tuple[Position, Block]:
    """Return position and block of a row x, y, z, state, and a sign's text if it has one."""
    match row:
        case [int(x), int(y), int(z), int(state)]:
            return (x, y, z), state
        case [int(x), int(y), int(z), int(state), str(text)]:
            return (x, y, z), Sign(state, text)
    raise BodyError(f"Node sent a malformed block: {row}")


def _frozen(event: Event) -> Event:
    """Return the event with tuples in its detail, and claims in their stored form."""
    detail = {
        key: tuple(value) if isinstance(value, list) else value
        for key, value in event.detail.items()
    }
    if "claims" in detail:
        detail["claims"] = tuple(claim.plain() for claim in _claims(detail["claims"]))
    return replace(event, detail=detail)


def _claims(plain: Any) -> tuple[Claim, ...]:
    try:
        return claims_from_plain(plain)
    except BeliefNestError as fault:
        raise BodyError(f"Node sent malformed claims: {fault}") from fault


def _converted(message: Any, kind: type[Any]) -> Any:
    try:
        return msgspec.convert(message, kind, strict=False)
    except msgspec.ValidationError as error:
        raise BodyError(f"Node sent a malformed message: {error}") from error
