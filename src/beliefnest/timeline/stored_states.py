"""Checkpoints and internal states of bodies in a database, compressed; timelines have row ids."""

from beliefnest.timeline.chunks import Chunks
from beliefnest.timeline.database import Database

__all__ = ["StoredStates"]


class StoredStates:
    """Checkpoints and internal states of the bodies of all timelines of a database.

    Args:
        database: The database.
        chunks: Compressor of the bytes.
    """

    def __init__(self, database: Database, chunks: Chunks) -> None:
        self._database, self._chunks = database, chunks

    def put_checkpoint(self, timeline: int, name: str, entries: int, packed: bytes) -> None:
        """Store the compressed bytes of a checkpoint; the caller opens the transaction."""
        self._database.write(
            "INSERT OR REPLACE INTO keyframe",
            timeline=timeline,
            name=name,
            entries=entries,
            body=packed,
        )

    def nearest_checkpoint(
        self, timeline: int, name: str, entries: int
    ) -> tuple[int, bytes] | None:
        """Return the last checkpoint of that name at or before an entry, and its place."""
        found = self._database.sound_rows(
            "timeline, name, entries, body",
            "keyframe WHERE timeline = ? AND name = ? AND entries <= ? "
            "ORDER BY entries DESC LIMIT 1",
            (timeline, name, entries),
            f"a keyframe of timeline {timeline}",
        )
        return next(((place, self._chunks.decompressed(body)) for *_, place, body in found), None)

    def put_body_state(self, timeline: int, entries: int, tick: int, state: bytes) -> None:
        """Store the internal state of a body; the caller opens the transaction."""
        self._database.write(
            "INSERT OR REPLACE INTO body_state",
            timeline=timeline,
            entries=entries,
            tick=tick,
            state=self._chunks.compressed(state),
        )

    def body_state(self, timeline: int, entries: int, tick: int) -> bytes | None:
        """Return the internal state stored for exactly this moment; None if there is none."""
        found = self._database.sound_rows(
            "timeline, entries, tick, state",
            "body_state WHERE timeline = ? AND entries = ? AND tick = ?",
            (timeline, entries, tick),
            f"the state of a body of timeline {timeline}",
        )
        return next((self._chunks.decompressed(state) for *_, state in found), None)

    def forget(self, timeline: int) -> None:
        """Remove the entries, checkpoints and states of a timeline, inside a transaction."""
        for table in ("piece", "keyframe", "body_state"):
            self._database.execute(f"DELETE FROM {table} WHERE timeline = ?", (timeline,))
