"""Changes of run files that keep every seal: what only a check of the values can find."""

import sqlite3
from collections.abc import Callable, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import msgspec

from beliefnest.timeline.database import checksum
from beliefnest.world.compression import compressed, decompressed

__all__ = ["change_checkpoint", "change_entries", "change_rows", "change_start"]

_MSGPACK = msgspec.msgpack
Change = Callable[[Any], Any]


def change_rows(path: Path, table: str, where: str, change: Change) -> None:
    """Change rows of a table, each given as a dict, and seal them again."""
    with closing(sqlite3.connect(path)) as connection:
        connection.row_factory = sqlite3.Row
        for row in connection.execute(f"SELECT rowid AS this, * FROM {table} WHERE {where}"):
            values = dict(row)
            this = values.pop("this")
            values.pop("seal")
            unsealed = {"piece": ["id"], "keyframe": ["id"], "program": ["id"]}.get(table, [])
            changed = change(dict(values))
            sealed = [value for name, value in changed.items() if name not in unsealed]
            names = ", ".join(f"{name} = ?" for name in [*changed, "seal"])
            connection.execute(
                f"UPDATE {table} SET {names} WHERE rowid = ?",
                [*changed.values(), checksum(*sealed), this],
            )
        connection.commit()


def change_entries(path: Path, change: Change, which: str = "body") -> None:
    """Change the entries of all chunks, given as a list of plain [kind, value]."""

    def changed(row: dict[str, Any]) -> dict[str, Any]:
        body = row[which]
        if row["compressed"]:
            body = decompressed(body, 2**26)
        body = _MSGPACK.encode(change(_MSGPACK.decode(body, strict=False)))
        if row["compressed"]:
            body = compressed(body, 3)
        return {**row, which: body}

    change_rows(path, "piece", "1" if which == "body" else "compressed", changed)


def change_checkpoint(path: Path, change: Change) -> None:
    """Change the body of all checkpoints, given as a plain dict."""

    def changed(row: dict[str, Any]) -> dict[str, Any]:
        body = _MSGPACK.decode(decompressed(row["body"], 2**26))
        return {**row, "body": compressed(_MSGPACK.encode(change(body)), 3)}

    change_rows(path, "keyframe", "1", changed)


def change_start(path: Path, change: Change) -> None:
    """Change the stored start of the run: a dict, in which `snapshot` is a dict, too."""

    def changed(row: dict[str, Any]) -> dict[str, Any]:
        run = _MSGPACK.decode(row["value"])
        start = _MSGPACK.decode(run["setting"])
        start["snapshot"] = _MSGPACK.decode(start["snapshot"])
        start = change(start)
        start["snapshot"] = _MSGPACK.encode(start["snapshot"])
        run["setting"] = _MSGPACK.encode(start)
        return {**row, "value": _MSGPACK.encode(run)}

    change_rows(path, "meta", "name = 'run'", changed)


def node_changed(body: dict[str, Any], change: Change) -> dict[str, Any]:
    """Return the body of a checkpoint with all of its nodes changed."""
    nodes: list[Sequence[Any]] = []
    for place, packed in body["nodes"]:
        node = _MSGPACK.decode(decompressed(packed, 2**26))
        nodes.append((place, compressed(_MSGPACK.encode(change(node)), 3)))
    return {**body, "nodes": nodes}
