"""Entries of timelines in a run file, in chunks.

One uncompressed chunk for each call that adds, joined into compressed chunks of
`CHUNK_ENTRIES` as soon as there are enough: every call is durable when it returns, and a past
entry is reached by unpacking one chunk. Each chunk says what its entries hold, so that those
that are looked for are found without reading the others.
"""

from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

import msgspec
import zstandard

from beliefnest.errors import BranchError, StoreError
from beliefnest.timeline import codec
from beliefnest.timeline.database import Database, Row, checked, checksum
from beliefnest.timeline.journal import Entry, EntryFilter, count_of_events, is_found
from beliefnest.world.frames import Frame
from beliefnest.world.values import AgentState

__all__ = ["CHUNK_ENTRIES", "Chunks", "decompressed"]

CHUNK_ENTRIES = 128
"""Entries of one compressed chunk: larger ones hardly pack better and are slower to read from."""

_COLUMNS = (
    "timeline, first, count, first_tick, last_tick, events, changes, agents, compressed, body"
)


def decompressed(unpacker: zstandard.ZstdDecompressor, body: bytes, path: Path) -> bytes:
    """Unpacked bytes of a value of the file `path`; StoreError if they are damaged."""
    try:
        return unpacker.decompress(body)
    except zstandard.ZstdError as fault:
        raise StoreError(f"{path} is damaged; restore it from a copy ({fault})") from fault


class Chunks:
    """The chunks of all timelines of a file, which are named by their rows' ids."""

    def __init__(
        self,
        database: Database,
        packer: zstandard.ZstdCompressor,
        unpacker: zstandard.ZstdDecompressor,
    ) -> None:
        self._database = database
        self._packer = packer
        self._unpacker = unpacker

    def add(
        self,
        timeline: int,
        count: int,
        packed: int,
        encoded: Sequence[bytes],
        entries: Sequence[Entry],
    ) -> int:
        """Write entries behind the `count` ones of a timeline, `packed` of which are compressed.

        Returns how many are compressed then; the caller opens the transaction.
        """
        if count - packed + len(encoded) < CHUNK_ENTRIES:
            self._write(timeline, count, encoded, entries, None)
            return packed
        tail = list(self.raw(timeline, packed, count))
        loose = [*tail, *encoded]
        decoded = [*(codec.decode_entry(entry) for entry in tail), *entries]
        agents = self._agents_before(timeline, packed)
        self._database.execute(
            "DELETE FROM piece WHERE timeline = ? AND first >= ?", (timeline, packed)
        )
        for at in range(0, len(loose), CHUNK_ENTRIES):
            part = slice(at, at + CHUNK_ENTRIES)
            full = len(loose) - at >= CHUNK_ENTRIES
            if full:
                for entry in decoded[part]:
                    if isinstance(entry, Frame):
                        agents.update(entry.agents)
            known = agents if full else None
            self._write(timeline, packed + at, loose[part], decoded[part], known)
        return packed + len(loose) - len(loose) % CHUNK_ENTRIES

    def raw(
        self,
        timeline: int,
        start: int,
        stop: int,
        gone: Callable[[], BranchError] | None = None,
    ) -> Iterator[msgspec.Raw]:
        """Encoded entries start to stop - 1; `gone` makes the error for a deleted timeline."""
        # One query for each chunk: a writer may join chunks while a reader is between two.
        while start < stop:
            found = self._chunk(timeline, "first <= ? ORDER BY first DESC", start)
            if found is None and gone is not None and not self._has(timeline):
                raise gone()
            first, encoded = (0, []) if found is None else self._unpacked(found)
            part = encoded[start - first : stop - first]
            if not part:
                raise StoreError(
                    f"{self._database.path} is damaged; restore it from a copy "
                    f"(entry {start} of timeline {timeline} is not there)"
                )
            yield from part
            start += len(part)

    def entries_until(self, timeline: int, tick: int) -> int | None:
        """How many entries lie at a tick or before; None: all."""
        found = self._chunk(timeline, "last_tick > ? ORDER BY last_tick, first", tick)
        if found is None:
            return None
        first, encoded = self._unpacked(found)
        return first + bisect_right(codec.decode_ticks(encoded), tick)

    def filtered(
        self, timeline: int, start: int, stop: int, what: EntryFilter
    ) -> Iterator[tuple[int, Entry]]:
        """Those of entries start to stop - 1 that are looked for, with their numbers."""
        while start < stop:
            # No chunk has more entries than that, so that the index leads to the first one.
            found = self._chunk(
                timeline,
                f"first > ? AND first + count > ? AND first < ? AND {what} > 0 ORDER BY first",
                start - CHUNK_ENTRIES,
                start,
                stop,
            )
            if found is None:
                return
            first, encoded = self._unpacked(found)
            last = min(stop, first + len(encoded))
            for number in range(max(start, first), last):
                entry = codec.decode_entry(encoded[number - first])
                if is_found(entry, what):
                    yield number, entry
            start = last

    def events_until(self, timeline: int, entries: int) -> int:
        """How many events the first `entries` entries have; the caller sees one state."""
        whole = self._database.row(
            "SELECT coalesce(sum(events), 0) FROM piece "
            "WHERE timeline = ? AND first < ? AND first + count <= ? AND events > 0",
            (timeline, entries, entries),
        )
        count = 0 if whole is None else int(whole[0])
        last = self._chunk(timeline, "first < ? ORDER BY first DESC", entries)
        first, encoded = (0, []) if last is None else self._unpacked(last)
        if first + len(encoded) > entries:
            part = (codec.decode_entry(entry) for entry in encoded[: entries - first])
            count += sum(map(count_of_events, part))
        return count

    def agents_after(self, timeline: int, entries: int) -> Mapping[str, AgentState | None]:
        """The last state of each agent that some entries name; the caller sees one state."""
        last = self._chunk(timeline, "first <= ? AND compressed ORDER BY first DESC", entries - 1)
        first = 0
        agents: dict[str, AgentState | None] = {}
        if last is not None:
            first, count = last[1], last[2]
            if first + count <= entries:
                first += count
            agents = self._agents_before(timeline, first)
        return agents | codec.decode_last_agents(self.raw(timeline, first, entries))

    def _agents_before(self, timeline: int, first: int) -> dict[str, AgentState | None]:
        """What the compressed chunk before an entry, if there is one, knows of agents."""
        found = self._chunk(timeline, "first < ? ORDER BY first DESC", first)
        if found is None:
            return {}
        known = checked(found, self._database.path, "entries")[7]
        return codec.decode_agents(self._decompressed(known))

    def _has(self, timeline: int) -> bool:
        return bool(self._database.rows("SELECT id FROM timeline WHERE id = ?", (timeline,)))

    def _chunk(self, timeline: int, where: str, *values: int) -> Row | None:
        return self._database.row(
            f"SELECT {_COLUMNS}, seal FROM piece WHERE timeline = ? AND {where} LIMIT 1",
            (timeline, *values),
        )

    def _write(
        self,
        timeline: int,
        first: int,
        encoded: Sequence[bytes | msgspec.Raw],
        entries: Sequence[Entry],
        agents: Mapping[str, AgentState | None] | None,
    ) -> None:
        """Write a chunk; compressed, with what is known of agents after it, unless that is None."""
        body, known = codec.join(encoded), b""
        if agents is not None:
            body = self._packer.compress(body)
            known = self._packer.compress(codec.encode(agents))
        counts = (
            sum(count_of_events(entry) for entry in entries),
            sum(is_found(entry, EntryFilter.CHANGES) for entry in entries),
        )
        ticks = (entries[0].tick, entries[-1].tick)
        packed = int(agents is not None)
        values = (timeline, first, len(encoded), *ticks, *counts, known, packed, body)
        self._database.execute(
            f"INSERT INTO piece ({_COLUMNS}, seal) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
            (*values, checksum(*values)),
        )

    def _unpacked(self, row: Row) -> tuple[int, list[msgspec.Raw]]:
        """Number of a chunk's first entry, and its encoded entries."""
        path = self._database.path
        _, first, count, *_, compressed, body = checked(row, path, "entries")
        encoded = codec.split(self._decompressed(body) if compressed else body)
        if len(encoded) != count:
            raise StoreError(f"{path} is damaged; only {len(encoded)} of {count} entries are in it")
        return first, encoded

    def _decompressed(self, body: bytes) -> bytes:
        return decompressed(self._unpacker, body, self._database.path)
