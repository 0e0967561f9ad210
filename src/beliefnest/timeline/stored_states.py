"""Checkpoints and internal states of bodies in a database, compressed; timelines have row ids."""

from collections.abc import Callable

from beliefnest.timeline.chunks import Chunks
from beliefnest.timeline.database import Database
from beliefnest.timeline.own_key import Marks

_LARGEST = 2**28
"""Greatest unpacked size of a checkpoint or the state of a body, in bytes."""


class StoredStates:
    """Checkpoints and internal states of the bodies of all timelines of a database.

    Args:
        database: The database.
        chunks: Compressor of the bytes.
        marks: Returns the marks of checkpoints. Those with another mark are not read.
    """

    def __init__(self, database: Database, chunks: Chunks, marks: Callable[[], Marks]) -> None:
        self._database, self._chunks, self._marks = database, chunks, marks

    def put_checkpoint(self, timeline: int, name: str, entries: int, packed: bytes) -> None:
        """Store the compressed bytes of a checkpoint; the caller opens the transaction."""
        self._database.write(
            "INSERT OR REPLACE INTO keyframe",
            timeline=timeline,
            name=name,
            entries=entries,
            # A decompressor ignores what comes after the compressed bytes.
            body=self._marks().marked(name, entries, packed),
        )

    def nearest_checkpoint(
        self, timeline: int, name: str, entries: int
    ) -> tuple[int, bytes] | None:
        """Return the last checkpoint of that name at or before an entry, and its place.

        None also if somebody else wrote it.
        """
        checkpoints = self._database.sound_rows(
            "timeline, name, entries, body",
            "keyframe WHERE timeline = ? AND name = ? AND entries <= ? "
            "ORDER BY entries DESC LIMIT 1",
            (timeline, name, entries),
            f"a keyframe of timeline {timeline}",
            tuple[int, str, int, bytes],
        )
        for *_, place, marked in checkpoints:
            body = self._marks().unmarked(name, place, marked)
            return None if body is None else (place, self._chunks.decompressed(body, _LARGEST))
        return None

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
        states = self._database.sound_rows(
            "timeline, entries, tick, state",
            "body_state WHERE timeline = ? AND entries = ? AND tick = ?",
            (timeline, entries, tick),
            f"the state of a body of timeline {timeline}",
            tuple[int, int, int, bytes],
        )
        return next((self._chunks.decompressed(state, _LARGEST) for *_, state in states), None)

    def forget(self, timeline: int) -> None:
        """Remove the entries, checkpoints and states of a timeline, inside a transaction."""
        for table in ("piece", "keyframe", "body_state"):
            self._database.execute(f"DELETE FROM {table} WHERE timeline = ?", (timeline,))
