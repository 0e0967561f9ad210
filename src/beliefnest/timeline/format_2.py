"""Conversion of run files from format 2 to format 3.

Format 2 kept the internal state of bodies among the checkpoints, under names such as `hidden 12`,
and some fields of programs as texts.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from beliefnest.timeline import codec
from beliefnest.timeline.database import Database, checked, checksum, damage
from beliefnest.timeline.run_records import ProgramRecord
from beliefnest.timeline.store_schema import BODY_STATE, STATEMENTS
from beliefnest.world.texts import quoted

FORMAT_2 = tuple(statement for statement in STATEMENTS if statement != BODY_STATE)
"""SQL statements that define the tables of format 2."""


@dataclass(frozen=True, slots=True)
class _Detail:
    detail: Mapping[str, str]


def convert_2(database: Database) -> None:
    """Convert a file of format 2 to format 3; StoreError if a row is damaged.

    The caller opens the transaction.
    """
    database.execute(BODY_STATE)
    hidden = "keyframe WHERE name LIKE 'hidden %'"
    columns, what = "timeline, name, entries, body", "the state of a body"
    for timeline, name, entries, state in database.sound_rows(
        columns, hidden, (), what, tuple[int, str, int, bytes]
    ):
        database.write(
            "INSERT INTO body_state",
            timeline=timeline,
            entries=entries,
            tick=_number(name.removeprefix("hidden "), database.path),
            state=state,
        )
    database.execute(f"DELETE FROM {hidden}")
    for number, *row in database.rows("SELECT id, path, branch, body, seal FROM program"):
        what = f"program {quoted(number)}"
        path, branch, old = checked(tuple(row), database.path, what, tuple[str, str, bytes])
        body = codec.encode(_typed(old, database.path))
        database.execute(
            "UPDATE program SET body = ?, seal = ? WHERE id = ?",
            (body, checksum(path, branch, body), number),
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
        raise damage(path, f"{quoted(text)} is no number")
    return int(text)
