"""Run files of format 2: what they define, and how they become files of format 3.

They kept the internal state of bodies among checkpoints, under names like `hidden 12`, and some
facts of programs as texts.
"""

import sqlite3
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from beliefnest.errors import StoreError
from beliefnest.timeline import codec
from beliefnest.timeline.database import checked, checksum
from beliefnest.timeline.records import ProgramRecord
from beliefnest.timeline.schema import BODY_STATE, STATEMENTS

__all__ = ["FORMAT_2", "convert_2"]

FORMAT_2 = tuple(statement for statement in STATEMENTS if statement != BODY_STATE)
"""What a file of format 2 consists of."""


@dataclass(frozen=True, slots=True)
class _Detail:
    detail: Mapping[str, str]


def convert_2(connection: sqlite3.Connection, path: Path) -> None:
    """Make a file of format 2 one of format 3; the caller opens the transaction.

    Raises:
        StoreError: A row is damaged.
    """
    connection.execute(BODY_STATE)
    hidden = "FROM keyframe WHERE name LIKE 'hidden %'"
    for row in connection.execute(
        f"SELECT timeline, name, entries, body, seal {hidden}"
    ).fetchall():
        timeline, name, entries, state = checked(row, path, "the state of a body")
        values = (timeline, entries, _number(name.removeprefix("hidden "), path), state)
        connection.execute(
            "INSERT INTO body_state (timeline, entries, tick, state, seal) VALUES (?, ?, ?, ?, ?)",
            (*values, checksum(*values)),
        )
    connection.execute(f"DELETE {hidden}")
    programs = connection.execute("SELECT id, path, branch, body, seal FROM program").fetchall()
    for number, *row in programs:
        *place, body = checked(tuple(row), path, f"program {number}")
        body = codec.encode(_typed(body, path))
        connection.execute(
            "UPDATE program SET body = ?, seal = ? WHERE id = ?",
            (body, checksum(*place, body), number),
        )


def _typed(body: bytes, path: Path) -> ProgramRecord:
    detail = codec.decode(body, _Detail).detail
    return replace(
        codec.decode(body, ProgramRecord),
        entries=_number(detail.get("entries", "0"), path),
        timeout_ticks=_number(detail.get("timeout_ticks", "0"), path),
        step=_number(detail["step"], path) if "step" in detail else None,
        kept="undone" not in detail,
    )


def _number(text: str, path: Path) -> int:
    if not text.isdecimal():
        raise StoreError(f"{path} is damaged; restore it from a copy ({text!r} is no number)")
    return int(text)
