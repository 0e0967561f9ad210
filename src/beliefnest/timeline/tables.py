"""The tables of an export: their columns, and their rows from what a journal holds.

Pure functions from entries to rows; docs/export.md describes the columns for readers.
"""

from collections.abc import Iterable, Iterator, Mapping
from types import MappingProxyType
from typing import Any, Literal

import numpy as np

from beliefnest.timeline.journal import Entry, TimelineInfo, TimelineKey, path_text
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.values import AgentState, DroppedItem, Items, Position

__all__ = [
    "FIRST_ENTRY",
    "TABLES",
    "BeliefRow",
    "Column",
    "Row",
    "belief_row",
    "entry_rows",
    "snapshot_rows",
    "timeline_row",
]

Column = Literal["text", "integer", "number", "boolean", "object"]
"""Type of a column's values; every value may also be null. An object is a JSON object."""

Row = tuple[str, dict[str, Any]]
"""Name of a table, and values by column."""

BeliefRow = tuple[int, tuple[str, ...], Mapping[str, Any]]
"""Tick, belief path, and state as plain data."""

_PLACE: Mapping[str, Column] = {
    "path": "text",
    "branch": "text",
    "entry": "integer",
    "tick": "integer",
}
_CELL: Mapping[str, Column] = {"x": "integer", "y": "integer", "z": "integer"}
_POINT: Mapping[str, Column] = {"x": "number", "y": "number", "z": "number"}

TABLES: Mapping[str, Mapping[str, Column]] = MappingProxyType(
    {
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
        "containers": {**_PLACE, **_CELL, "items": "object", "edited": "text"},
        "items": {
            **_PLACE,
            "item": "integer",
            "name": "text",
            "count": "integer",
            **_POINT,
        },
        "events": {
            **_PLACE,
            "number": "integer",
            "kind": "text",
            "actor": "text",
            "detail": "object",
        },
        "beliefs": {"tick": "integer", "path": "text", "state": "object"},
    }
)
"""Table to column to type, in the order in which they are written."""

FIRST_ENTRY = -1
"""Number under which the first state of a timeline is listed."""


def timeline_row(info: TimelineInfo) -> Row:
    """The row of a timeline."""
    base = info.base
    return "timelines", {
        "path": path_text(info.key.path),
        "branch": info.key.branch,
        "base_path": None if base is None else path_text(base.timeline.path),
        "base_branch": None if base is None else base.timeline.branch,
        "base_entries": None if base is None else base.entries,
        "base_tick": None if base is None else base.tick,
        "start": info.start,
        "head": info.head,
        "entries": info.entries,
        "description": info.description,
    }


def entry_rows(key: TimelineKey, number: int, entry: Entry, registry: Registry) -> Iterator[Row]:
    """The rows of one entry.

    Raises:
        UnknownNameError: A block state is none of the registry's version.
    """
    place = _place(key, number, entry.tick)
    edited = None if isinstance(entry, Frame) else path_text(entry.path)
    yield from _block_rows(place, entry.blocks.items(), registry, edited)
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


def snapshot_rows(key: TimelineKey, snapshot: Snapshot, registry: Registry) -> Iterator[Row]:
    """The rows of a timeline's first state; of the blocks, those that are not air."""
    place = _place(key, FIRST_ENTRY, snapshot.tick)
    low = snapshot.box.low
    cells = (
        ((x + low[0], y + low[1], z + low[2]), int(snapshot.blocks[x, y, z]))
        for x, y, z in np.argwhere(snapshot.blocks != registry.air).tolist()
    )
    yield from _block_rows(place, cells, registry, None)
    yield from _container_rows(place, snapshot.containers.items(), None)
    yield from _agent_rows(place, snapshot.agents.items())
    yield from _item_rows(place, snapshot.items.items())


def belief_row(row: BeliefRow) -> Row:
    """The row of one node's state at one tick."""
    tick, path, state = row
    return "beliefs", {"tick": tick, "path": path_text(path), "state": dict(state)}


def _place(key: TimelineKey, number: int, tick: int) -> dict[str, Any]:
    return {"path": path_text(key.path), "branch": key.branch, "entry": number, "tick": tick}


def _block_rows(
    place: Mapping[str, Any],
    cells: Iterable[tuple[Position, int]],
    registry: Registry,
    edited: str | None,
) -> Iterator[Row]:
    for (x, y, z), state in cells:
        text = None if state < 0 else registry.text(state)
        yield "blocks", {**place, "x": x, "y": y, "z": z, "block": text, "edited": edited}


def _container_rows(
    place: Mapping[str, Any],
    contents: Iterable[tuple[Position, Items | None]],
    edited: str | None,
) -> Iterator[Row]:
    for (x, y, z), items in contents:
        held = None if items is None else dict(items)
        yield "containers", {**place, "x": x, "y": y, "z": z, "items": held, "edited": edited}


def _agent_rows(
    place: Mapping[str, Any], agents: Iterable[tuple[str, AgentState | None]]
) -> Iterator[Row]:
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
) -> Iterator[Row]:
    for number, item in items:
        values: dict[str, Any] = dict.fromkeys(TABLES["items"])
        values |= {**place, "item": number}
        if item is not None:
            x, y, z = item.position
            values |= {"name": item.name, "count": item.count, "x": x, "y": y, "z": z}
        yield "items", values
