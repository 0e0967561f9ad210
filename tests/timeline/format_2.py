"""Run files as format 2 kept them, made of present ones."""

import sqlite3
from contextlib import closing
from pathlib import Path

import msgspec

from beliefnest.timeline.database import checksum


def make_format_2(path: Path) -> None:
    """Rewrite a closed run file in place, as programs before format 3 left it."""
    with closing(sqlite3.connect(path)) as file, file:
        for timeline, entries, tick, state in file.execute(
            "SELECT timeline, entries, tick, state FROM body_state"
        ).fetchall():
            values = (timeline, f"hidden {tick}", entries, state)
            file.execute(
                "INSERT INTO keyframe (timeline, name, entries, body, seal) VALUES (?, ?, ?, ?, ?)",
                (*values, checksum(*values)),
            )
        file.execute("DROP TABLE body_state")
        for number, place, branch, body in file.execute(
            "SELECT id, path, branch, body FROM program"
        ).fetchall():
            old = msgspec.msgpack.encode(_with_texts(msgspec.msgpack.decode(body)))
            file.execute(
                "UPDATE program SET body = ?, seal = ? WHERE id = ?",
                (old, checksum(place, branch, old), number),
            )
        file.execute("PRAGMA user_version = 2")


def _with_texts(program: dict) -> dict:
    facts = {name: program.pop(name) for name in ("entries", "timeout_ticks", "step", "kept")}
    detail = {
        "timeout_ticks": str(facts["timeout_ticks"]),
        "entries": str(facts["entries"]),
        **({} if facts["step"] is None else {"step": str(facts["step"])}),
        **({} if facts["kept"] else {"undone": "killed"}),
    }
    return {**program, "detail": detail}
