"""Tables of an export: their columns, and functions from journal entries to rows.

All functions are pure. docs/export.md describes the columns for readers.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Literal

import msgspec
import numpy as np

from beliefnest.timeline.journal import Edit, Entry, TimelineInfo, TimelineKey
from beliefnest.timeline.run_records import ProgramRecord, PromptRecord, RunRecord
from beliefnest.world.claims import Claim, claims_from_plain, claims_written
from beliefnest.world.cuboids import cuboids
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.paths import BeliefPath, path_text
from beliefnest.world.registry import Registry
from beliefnest.world.signs import plain_state
from beliefnest.world.values import AgentState, Block, DroppedItem, Items, Position, Sign

ColumnForm = Literal["text", "integer", "number", "boolean", "object"]
"""Type of a column's values. Every value may also be null. An object is a JSON object or array."""

TableRow = tuple[str, dict[str, Any]]
"""Name of a table, and the values of one row by column."""


class BeliefRow(msgspec.Struct, frozen=True):
    """State of one belief at one tick.

    Attributes:
        path: Path of the belief.
        timeline: Timeline it was on.
        tick: Tick of that timeline.
        state: State as plain data.
        blocks: Blocks that changed since the previous row of this belief, as plain data.
    """

    path: BeliefPath
    timeline: TimelineKey
    tick: int
    state: Mapping[str, Any]
    blocks: Mapping[str, str | None]


_PLACE: Mapping[str, ColumnForm] = {
    "path": "text",
    "branch": "text",
    "entry": "integer",
    "tick": "integer",
}
_ON_TIMELINE: Mapping[str, ColumnForm] = {
    "path": "text",
    "timeline_path": "text",
    "timeline_branch": "text",
    "tick": "integer",
}
_CELL: Mapping[str, ColumnForm] = {"x": "integer", "y": "integer", "z": "integer"}
_POINT: Mapping[str, ColumnForm] = {"x": "number", "y": "number", "z": "number"}

TABLES: Mapping[str, Mapping[str, ColumnForm]] = MappingProxyType(
    {
        "run": {
            "scenario": "text",
            "condition": "text",
            "seed": "integer",
            "versions": "object",
            "text": "text",
            "templates": "object",
        },
        "timelines": {
            "path": "text",
            "branch": "text",
            "base_path": "text",
            "base_branch": "text",
            "base_entries": "integer",
            "base_tick": "integer",
            "start": "integer",
            "head": "integer",
            "entries": "integer",
            "description": "text",
        },
        "agents": {
            **_PLACE,
            "agent": "text",
            **_POINT,
            "yaw": "number",
            "pitch": "number",
            "on_ground": "boolean",
            "health": "number",
            "food": "number",
            "equipment": "object",
            "inventory": "object",
        },
        "blocks": {**_PLACE, **_CELL, "block": "text", "edited": "text"},
        "cuboids": {
            **_PLACE,
            **_CELL,
            "x2": "integer",
            "y2": "integer",
            "z2": "integer",
            "block": "text",
        },
        "signs": {**_PLACE, **_CELL, "text": "text", "claims": "object", "edited": "text"},
        "containers": {**_PLACE, **_CELL, "items": "object", "edited": "text"},
        "items": {**_PLACE, "item": "integer", "name": "text", "count": "integer", **_POINT},
        "events": {
            **_PLACE,
            "number": "integer",
            "kind": "text",
            "actor": "text",
            "detail": "object",
        },
        "programs": {
            "path": "text",
            "branch": "text",
            "tick": "integer",
            "agent": "text",
            "code": "text",
            "ok": "boolean",
            "error": "text",
            "ticks": "integer",
            "call": "integer",
            "lines": "object",
            "log": "object",
            "unfinished": "object",
            "detail": "object",
        },
        "prompts": {
            **_ON_TIMELINE,
            "model": "text",
            "attempt": "integer",
            "messages": "object",
            "sampling": "object",
            "answer": "text",
            "error": "text",
            "requests": "integer",
            "input_tokens": "integer",
            "output_tokens": "integer",
            "cost": "number",
            "cached": "boolean",
            "detail": "object",
        },
        "rounds": {
            "branch": "text",
            "round": "integer",
            "tick": "integer",
            "end": "integer",
            "agent": "text",
            "policy": "text",
            "program": "text",
            "goes_on": "boolean",
            "fault": "text",
            "ended": "text",
            "message": "text",
            "reason": "text",
        },
        "goals": {"branch": "text", "condition": "text", "never": "boolean", "tick": "integer"},
        "beliefs": {**_ON_TIMELINE, "state": "object", "blocks": "object"},
    }
)
"""Types of the columns by table and column, in output order."""

IF_ANY = frozenset({"cuboids", "signs", "rounds", "goals"})
"""Tables that are written only if they have a row."""

_MOST_BLOCKS = 2_000_000
"""Most blocks of a first state that have a row each."""

FIRST_ENTRY = -1
"""Entry number of the rows that describe the first state of a timeline."""


def timeline_row(info: TimelineInfo) -> TableRow:
    """Return the row of a timeline."""
    base = info.base
    return _row(
        "timelines",
        info,
        path=path_text(info.key.path),
        branch=info.key.branch,
        base_path=None if base is None else path_text(base.timeline.path),
        base_branch=None if base is None else base.timeline.branch,
        base_entries=None if base is None else base.entries,
        base_tick=None if base is None else base.tick,
    )


def entry_rows(
    key: TimelineKey, number: int, entry: Entry, registry: Registry
) -> Iterator[TableRow]:
    """Yield the rows of one entry; UnknownNameError if the registry lacks a block state."""
    place = _place(key, number, entry.tick)
    edited = path_text(entry.path) if isinstance(entry, Edit) else None
    claims = {}
    if isinstance(entry, Frame):
        claims = {at: claims_written(entry, at) for at in entry.blocks}
    yield from _block_rows(place, entry.blocks.items(), claims, registry, edited)
    yield from _container_rows(place, entry.containers.items(), edited)
    if isinstance(entry, Frame):
        yield from _agent_rows(place, entry.agents.items())
        yield from _item_rows(place, entry.items.items())
        for order, event in enumerate(entry.events):
            yield (
                "events",
                {
                    **place,
                    "number": order,
                    "kind": event.kind.value,
                    "actor": event.actor,
                    "detail": dict(event.detail),
                },
            )


def snapshot_rows(key: TimelineKey, snapshot: Snapshot, registry: Registry) -> Iterator[TableRow]:
    """Yield the rows of a timeline's first state; air has no rows.

    If there are very many blocks, only those with a text have rows of their own; cuboids tell all.
    """
    place = _place(key, FIRST_ENTRY, snapshot.tick)
    claims = {at: claims_from_plain(plain) for at, plain in snapshot.sign_claims.items()}
    blocks: Iterable[tuple[Position, Block]] = _solid(snapshot, registry)
    if snapshot.blocks.size - snapshot.blocks.count([registry.air]) > _MOST_BLOCKS:
        blocks = [(at, snapshot.block(at)) for at in sorted(snapshot.signs)]
        yield from _cuboid_rows(place, snapshot, registry)
    yield from _block_rows(place, blocks, claims, registry, None)
    yield from _container_rows(place, snapshot.containers.items(), None)
    yield from _agent_rows(place, snapshot.agents.items())
    yield from _item_rows(place, snapshot.items.items())


def _cuboid_rows(
    place: Mapping[str, Any], snapshot: Snapshot, registry: Registry
) -> Iterator[TableRow]:
    for state, part in cuboids(snapshot.blocks, registry.air):
        low, high = (
            [int(i) + first for i, first in zip(corner, snapshot.box.low, strict=True)]
            for corner in (part.low, part.high)
        )
        row = {**place, **dict(zip("xyz", low, strict=True))}
        row |= {f"{axis}2": value for axis, value in zip("xyz", high, strict=True)}
        yield "cuboids", {**row, "block": registry.text(state)}


def _solid(snapshot: Snapshot, registry: Registry) -> Iterator[tuple[Position, Block]]:
    """Yield the blocks of a snapshot other than air, in order of position."""
    x, y, z = snapshot.box.low
    for first, states in snapshot.blocks.slabs():
        solid = states != registry.air
        for (i, j, k), state in zip(
            np.argwhere(solid).tolist(), states[solid].tolist(), strict=True
        ):
            place = (x + first + i, y + j, z + k)
            is_written = place in snapshot.signs
            yield place, Sign(state, snapshot.signs[place]) if is_written else state


def run_row(run: RunRecord, versions: Sequence[Mapping[str, str]]) -> TableRow:
    """Return the row of the run itself."""
    return _row("run", run, condition=run.condition or None, versions=versions)


def program_row(program: ProgramRecord) -> TableRow:
    """Return the row of a program."""
    path, detail = path_text(program.path), _program_detail(program)
    return _row("programs", program, path=path, call=program.group, detail=detail)


def _program_detail(program: ProgramRecord) -> dict[str, str]:
    """Return further facts about a program, as texts."""
    return {
        **({} if program.step is None else {"step": str(program.step)}),
        "timeout_ticks": str(program.timeout_ticks),
        **({} if program.kept else {"undone": "killed"}),
        **({} if program.senses == "world" else {"senses": program.senses}),
        "entries": str(program.entries),
    }


def prompt_row(prompt: PromptRecord) -> TableRow:
    """Return the row of a request to a model."""
    place = _on_timeline(prompt.path, prompt.timeline, prompt.tick)
    messages = [{"role": role, "text": text} for role, text in prompt.messages]
    return _row("prompts", prompt, **place, messages=messages)


def belief_row(row: BeliefRow) -> TableRow:
    """Return the row of one node's state at one tick."""
    place = _on_timeline(row.path, row.timeline, row.tick)
    return "beliefs", {**place, "state": dict(row.state), "blocks": dict(row.blocks)}


def _row(table: str, record: object, **others: object) -> TableRow:
    """Return a row with the values of `others`; the record's attributes fill the other columns."""
    columns = TABLES[table]
    return table, {
        name: others[name] if name in others else getattr(record, name) for name in columns
    }


def _on_timeline(path: BeliefPath, timeline: TimelineKey, tick: int) -> dict[str, Any]:
    return {
        "path": path_text(path),
        "timeline_path": path_text(timeline.path),
        "timeline_branch": timeline.branch,
        "tick": tick,
    }


def _place(key: TimelineKey, number: int, tick: int) -> dict[str, Any]:
    return {"path": path_text(key.path), "branch": key.branch, "entry": number, "tick": tick}


def _block_rows(
    place: Mapping[str, Any],
    cells: Iterable[tuple[Position, Block]],
    claims: Mapping[Position, Iterable[Claim]],
    registry: Registry,
    edited: str | None,
) -> Iterator[TableRow]:
    for (x, y, z), block in cells:
        state = plain_state(block)
        text = None if state < 0 else registry.text(state)
        row = {**place, "x": x, "y": y, "z": z, "edited": edited}
        yield "blocks", {**row, "block": text}
        if isinstance(block, Sign):
            claim_rows = [claim.plain() for claim in claims.get((x, y, z), ())]
            yield "signs", {**row, "text": block.text, "claims": claim_rows}


def _container_rows(
    place: Mapping[str, Any], contents: Iterable[tuple[Position, Items | None]], edited: str | None
) -> Iterator[TableRow]:
    for (x, y, z), items in contents:
        content = None if items is None else dict(items)
        yield "containers", {**place, "x": x, "y": y, "z": z, "items": content, "edited": edited}


def _agent_rows(
    place: Mapping[str, Any], agents: Iterable[tuple[str, AgentState | None]]
) -> Iterator[TableRow]:
    for name, agent in agents:
        values: dict[str, Any] = dict.fromkeys(TABLES["agents"])
        values |= {**place, "agent": name}
        if agent is not None:
            x, y, z = agent.position
            values |= {"x": x, "y": y, "z": z, "yaw": agent.yaw, "pitch": agent.pitch}
            values |= {"on_ground": agent.on_ground, "health": agent.health, "food": agent.food}
            values |= {"equipment": dict(agent.equipment), "inventory": dict(agent.inventory)}
        yield "agents", values


def _item_rows(
    place: Mapping[str, Any], items: Iterable[tuple[int, DroppedItem | None]]
) -> Iterator[TableRow]:
    for number, item in items:
        values: dict[str, Any] = dict.fromkeys(TABLES["items"])
        values |= {**place, "item": number}
        if item is not None:
            x, y, z = item.position
            values |= {"name": item.name, "count": item.count, "x": x, "y": y, "z": z}
        yield "items", values
