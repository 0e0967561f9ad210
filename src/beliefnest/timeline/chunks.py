"""Entries of timelines in a run file, in chunks.

One uncompressed chunk for each call that adds, joined into compressed chunks of
`CHUNK_ENTRIES` as soon as there are enough: every call is durable when it returns, and a past
entry is reached by unpacking one chunk. Each chunk says what its entries hold, so that those
that are looked for are found without reading the others.
"""

from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

import msgspec
import zstandard

from beliefnest.errors import BranchError, StoreError
from beliefnest.timeline import codec
from beliefnest.timeline.database import Database
from beliefnest.timeline.journal import Entry, EntryFilter, count_of_events, is_found
from beliefnest.world.frames import Frame
from beliefnest.world.values import AgentState

__all__ = ["CHUNK_ENTRIES", "Chunks"]

CHUNK_ENTRIES = 128
"""Entries of one compressed chunk: larger ones hardly pack better and are slower to read from."""

_COMPRESSION = 1
"""Level of zstandard; higher ones save nothing on poses, which are noise in their last digits."""


_LARGEST = 2**28
"""Bytes of a chunk, keyframe or body state when it is unpacked; a foreign file may name any."""


class _Chunk(NamedTuple):
    """A row of the table of chunks."""

    timeline: int
    first: int
    count: int  # type: ignore[assignment]  # the column has the name of a method of tuples
    first_tick: int
    last_tick: int
    events: int
    changes: int
    agents: bytes
    compressed: int
    body: bytes


_COLUMNS = ", ".join(_Chunk._fields)


class Chunks:
    """The chunks of all timelines of a file, which are named by their rows' ids."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._packer = zstandard.ZstdCompressor(level=_COMPRESSION)
        self._unpacker = zstandard.ZstdDecompressor()

    def compressed(self, body: bytes) -> bytes:
        """Return the bytes, compressed."""
        return self._packer.compress(body)

    def decompressed(self, body: bytes) -> bytes:
        """What was compressed; StoreError if it is damaged."""
        path = self._database.path
        try:
            if zstandard.frame_content_size(body) <= _LARGEST:
                return self._unpacker.decompress(body)
        except zstandard.ZstdError as fault:
            raise StoreError(f"{path} is damaged; restore it from a copy ({fault})") from fault
        raise StoreError(
            f"{path} is damaged; restore it from a copy (a part would unpack to more than "
            f"{_LARGEST:,} bytes)"
        )

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
            part = []
            if found is not None:
                part = self._encoded(found)[start - found.first : stop - found.first]
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
        return found.first + bisect_right(codec.decode_ticks(self._encoded(found)), tick)

    def filtered(
        self, timeline: int, start: int, stop: int, what: EntryFilter
    ) -> Iterator[tuple[int, Entry]]:
        """Yield those of entries start to stop - 1 that are looked for, with their numbers."""
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
            encoded = self._encoded(found)
            last = min(stop, found.first + found.count)
            for number in range(max(start, found.first), last):
                entry = codec.decode_entry(encoded[number - found.first])
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
        if last is not None and last.first + last.count > entries:
            part = map(codec.decode_entry, self._encoded(last)[: entries - last.first])
            count += sum(map(count_of_events, part))
        return count

    def agents_after(self, timeline: int, entries: int) -> Mapping[str, AgentState | None]:
        """Return the last state of each agent that some entries name; the caller sees one state."""
        last = self._chunk(timeline, "first <= ? AND compressed ORDER BY first DESC", entries - 1)
        first = 0
        agents: dict[str, AgentState | None] = {}
        if last is not None:
            first = last.first
            if first + last.count <= entries:
                first += last.count
            agents = self._agents_before(timeline, first)
        return agents | codec.decode_last_agents(self.raw(timeline, first, entries))

    def _agents_before(self, timeline: int, first: int) -> dict[str, AgentState | None]:
        """What the compressed chunk before an entry, if there is one, knows of agents."""
        found = self._chunk(timeline, "first < ? ORDER BY first DESC", first)
        return {} if found is None else codec.decode_agents(self.decompressed(found.agents))

    def _has(self, timeline: int) -> bool:
        return bool(self._database.rows("SELECT id FROM timeline WHERE id = ?", (timeline,)))

    def _chunk(self, timeline: int, where: str, *values: int) -> _Chunk | None:
        chosen, what = f"piece WHERE timeline = ? AND {where} LIMIT 1", "entries"
        found = self._database.sound_rows(_COLUMNS, chosen, (timeline, *values), what)
        return next(map(_Chunk._make, found), None)

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
            body, known = self.compressed(body), self.compressed(codec.encode(agents))
        chunk = _Chunk(
            timeline,
            first,
            len(encoded),
            entries[0].tick,
            entries[-1].tick,
            sum(count_of_events(entry) for entry in entries),
            sum(is_found(entry, EntryFilter.CHANGES) for entry in entries),
            known,
            int(agents is not None),
            body,
        )
        self._database.write("INSERT INTO piece", **chunk._asdict())

    def _encoded(self, chunk: _Chunk) -> list[msgspec.Raw]:
        """Return the encoded entries of a chunk."""
        body = self.decompressed(chunk.body) if chunk.compressed else chunk.body
        encoded = codec.split(body)
        if len(encoded) != chunk.count:
            raise StoreError(
                f"{self._database.path} is damaged; "
                f"only {len(encoded)} of {chunk.count} entries are in it"
            )
        return encoded
