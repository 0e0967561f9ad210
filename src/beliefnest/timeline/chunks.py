"""Entries of timelines in a run file, stored in chunks.

Each call that adds entries writes one uncompressed chunk, so that it is durable when it returns. As
soon as there are enough entries, they are joined into compressed chunks of `CHUNK_ENTRIES`. Reading
a past entry therefore unpacks one chunk. Each chunk has counts of its events and changes, so that a
search skips chunks without a match.
"""

from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

import msgspec

from beliefnest.errors import BranchError, StoreError
from beliefnest.timeline import codec
from beliefnest.timeline.bounds import RunBounds
from beliefnest.timeline.database import Database, damage
from beliefnest.timeline.journal import Entry, EntryFilter, count_of_events, is_found
from beliefnest.world.compression import compressed, decompressed
from beliefnest.world.frames import Frame
from beliefnest.world.values import AgentState

CHUNK_ENTRIES = 128
"""Entries of one compressed chunk; larger chunks hardly compress better and read more slowly."""

_COMPRESSION = 1
"""Compression level. Higher levels gain nothing on poses, whose last digits are noise."""


_LARGEST = 2**26
"""Greatest unpacked size of a chunk in bytes. Damaged or hostile files may declare any size."""

_MOST_EVENTS = 2**26
"""Most events of a timeline: beliefs have a bit for each of them."""


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
    """Chunks of all timelines of a file; timelines are named by their row ids.

    Attributes:
        bounds: Bounds of all entries; None: this process has written them.
    """

    def __init__(self, database: Database) -> None:
        self._database = database
        self.bounds: RunBounds | None = None

    def compressed(self, body: bytes) -> bytes:
        """Compress bytes."""
        return compressed(body, _COMPRESSION)

    def decompressed(self, body: bytes, largest: int = _LARGEST) -> bytes:
        """Decompress bytes; StoreError if they are damaged or would be too large."""
        try:
            return decompressed(body, largest)
        except StoreError as fault:
            raise damage(self._database.path, str(fault)) from fault

    def add(
        self,
        timeline: int,
        count: int,
        packed: int,
        encoded: Sequence[bytes],
        entries: Sequence[Entry],
    ) -> int:
        """Append entries to a timeline; the caller opens the transaction.

        Args:
            timeline: Row id of the timeline.
            count: Number of its entries so far.
            packed: Number of its entries in compressed chunks; these are its first ones.
            encoded: New entries, encoded.
            entries: The same new entries.

        Returns:
            Number of entries in compressed chunks afterwards.
        """
        if count - packed + len(encoded) < CHUNK_ENTRIES:
            self._write(timeline, count, encoded, entries, None)
            return packed
        # The uncompressed tail and the new entries fill at least one compressed chunk: read the
        # tail, delete its chunks, and write all of it again in chunks of CHUNK_ENTRIES. Only the
        # last of these chunks can be shorter and stays uncompressed.
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
            agents_now = agents if full else None
            self._write(timeline, packed + at, loose[part], decoded[part], agents_now)
        return packed + len(loose) - len(loose) % CHUNK_ENTRIES

    def raw(self, timeline: int, start: int, stop: int) -> Iterator[msgspec.Raw]:
        """Yield the encoded entries with indexes start to stop - 1; arguments as for `entries`.

        Raises:
            StoreError: An entry is missing or damaged.
        """
        for _, part in self._parts(timeline, start, stop):
            yield from part

    def entries(
        self,
        timeline: int,
        start: int,
        stop: int,
        gone: Callable[[], BranchError | None] = lambda: None,
    ) -> Iterator[Entry]:
        """Yield the entries with indexes start to stop - 1.

        Args:
            timeline: Row id of the timeline.
            start: Index of the first entry.
            stop: Index after the last entry; the timeline must have that many.
            gone: Returns the error to raise if the timeline was deleted meanwhile, otherwise None.

        Raises:
            StoreError: An entry is missing, damaged, out of bounds, or not as its chunk tells.
        """
        for chunk, part in self._parts(timeline, start, stop, gone):
            yield from self._decoded_all(chunk, part)

    def _parts(
        self,
        timeline: int,
        start: int,
        stop: int,
        gone: Callable[[], BranchError | None] = lambda: None,
    ) -> Iterator[tuple[_Chunk, list[msgspec.Raw]]]:
        """Yield chunks, each with those of its encoded entries that lie from start to stop - 1."""
        # Query anew for each chunk: a writer may join chunks between two reads.
        while start < stop:
            chunk = self._chunk(timeline, "first <= ? ORDER BY first DESC", start)
            missed = gone() if chunk is None else None
            if missed is not None:
                raise missed
            part = []
            if chunk is not None:
                part = self._encoded(chunk)[start - chunk.first : stop - chunk.first]
            if chunk is None or not part:
                missing = f"entry {start} of timeline {timeline} is missing"
                raise damage(self._database.path, missing)
            yield chunk, part
            start += len(part)

    def entries_until(self, timeline: int, tick: int) -> int | None:
        """Return the number of entries at a tick or earlier; None if all are."""
        chunk = self._chunk(timeline, "last_tick > ? ORDER BY last_tick, first", tick)
        if chunk is None:
            return None
        return chunk.first + bisect_right(codec.decode_ticks(self._encoded(chunk)), tick)

    def filtered(
        self, timeline: int, start: int, stop: int, what: EntryFilter
    ) -> Iterator[tuple[int, Entry]]:
        """Yield the entries from start to stop - 1 that match a filter, with their indexes."""
        while start < stop:
            # No chunk has more than CHUNK_ENTRIES entries. The lower bound on `first` therefore
            # loses nothing, and lets SQLite's index lead straight to the first match.
            chunk = self._chunk(
                timeline,
                f"first > ? AND first + count > ? AND first < ? AND {what} > 0 ORDER BY first",
                start - CHUNK_ENTRIES,
                start,
                stop,
            )
            if chunk is None:
                return
            begin, last = max(start, chunk.first), min(stop, chunk.first + chunk.count)
            part = self._encoded(chunk)[begin - chunk.first : last - chunk.first]
            for number, entry in enumerate(self._decoded_all(chunk, part), begin):
                if is_found(entry, what):
                    yield number, entry
            start = last

    def events_until(self, timeline: int, entries: int) -> int:
        """Return the number of events in the first `entries` entries.

        The caller makes sure that all queries see one state of the file.
        """
        whole = self._database.row(
            "SELECT coalesce(sum(events), 0) FROM piece "
            "WHERE timeline = ? AND first < ? AND first + count <= ? AND events > 0",
            (timeline, entries, entries),
        )
        count = 0 if whole is None else whole[0]
        if not isinstance(count, int) or not 0 <= count <= _MOST_EVENTS:
            raise damage(self._database.path, f"it counts {count} events")
        last = self._chunk(timeline, "first < ? ORDER BY first DESC", entries)
        if last is not None and last.first + last.count > entries:
            part = map(codec.decode_entry, self._encoded(last)[: entries - last.first])
            count += sum(map(count_of_events, part))
        return count

    def agents_after(self, timeline: int, entries: int) -> Mapping[str, AgentState | None]:
        """Return the last state of each agent that the first `entries` entries name.

        The caller makes sure that all queries see one state of the file.
        """
        # Start with the agents stored with the last compressed chunk that ends in time, then add
        # the states in the entries after it. These are fewer than CHUNK_ENTRIES.
        last = self._chunk(timeline, "first <= ? AND compressed ORDER BY first DESC", entries - 1)
        first = 0
        agents: dict[str, AgentState | None] = {}
        if last is not None:
            first = last.first
            if first + last.count <= entries:
                first += last.count
            agents = self._agents_before(timeline, first)
        return self._checked(agents | codec.decode_last_agents(self.raw(timeline, first, entries)))

    def _agents_before(self, timeline: int, first: int) -> dict[str, AgentState | None]:
        """Return the agents stored with the compressed chunk before an entry, or none."""
        chunk = self._chunk(timeline, "first < ? ORDER BY first DESC", first)
        return {} if chunk is None else self._agents_of(chunk)

    def _agents_of(self, chunk: _Chunk) -> dict[str, AgentState | None]:
        """Return the agents stored with a compressed chunk."""
        return self._checked(codec.decode_agents(self.decompressed(chunk.agents)))

    def _checked(self, agents: dict[str, AgentState | None]) -> dict[str, AgentState | None]:
        """Return agents; StoreError if they are out of bounds."""
        if self.bounds is not None:
            try:
                self.bounds.check_agents(agents)
            except StoreError as fault:
                raise damage(self._database.path, str(fault)) from fault
        return agents

    def _chunk(self, timeline: int, where: str, *values: int) -> _Chunk | None:
        chosen, what = f"piece WHERE timeline = ? AND {where} LIMIT 1", "entries"
        chunk = next(
            self._database.sound_rows(_COLUMNS, chosen, (timeline, *values), what, _Chunk), None
        )
        if chunk is not None and not 0 < chunk.count <= CHUNK_ENTRIES:
            raise damage(self._database.path, f"a chunk has {chunk.count} entries")
        return chunk

    def _write(
        self,
        timeline: int,
        first: int,
        encoded: Sequence[bytes | msgspec.Raw],
        entries: Sequence[Entry],
        agents: Mapping[str, AgentState | None] | None,
    ) -> None:
        """Write a chunk.

        `agents` holds the last state of each agent up to the end of a chunk that is to be
        compressed; with None the chunk stays uncompressed.
        """
        body, packed_agents = codec.join(encoded), b""
        if agents is not None:
            body, packed_agents = self.compressed(body), self.compressed(codec.encode(agents))
        chunk = _Chunk(
            timeline,
            first,
            len(encoded),
            *_summary(entries),
            packed_agents,
            int(agents is not None),
            body,
        )
        self._database.write("INSERT INTO piece", **chunk._asdict())

    def _decoded_all(self, chunk: _Chunk, part: Sequence[msgspec.Raw]) -> list[Entry]:
        """Return entries of a chunk; StoreError also if they are all, and not as it tells."""
        entries = [self._decoded(chunk, encoded) for encoded in part]
        if self.bounds is None or len(entries) != chunk.count:
            return entries
        summary = (chunk.first_tick, chunk.last_tick, chunk.events, chunk.changes)
        if summary != _summary(entries):
            fault = f"a chunk tells {summary} of entries with {_summary(entries)}"
            raise damage(self._database.path, f"{fault} as ticks, events and changes")
        before = self._agents_before(chunk.timeline, chunk.first) if chunk.compressed else {}
        # None before a later chunk: a writer may have deleted the timeline meanwhile.
        if before or (chunk.compressed and chunk.first == 0):
            agents_stored = self._agents_of(chunk)
            if agents_stored != before | codec.decode_last_agents(part):
                raise damage(self._database.path, "a chunk tells other agents than its entries")
        return entries

    def _decoded(self, chunk: _Chunk, encoded: msgspec.Raw) -> Entry:
        """Return an entry of a chunk; StoreError if it is damaged or out of bounds."""
        if self.bounds is None:
            return codec.decode_entry(encoded)
        # Hot path: a context manager takes longer than many a check.
        try:
            entry = codec.decode_entry(encoded)
            self.bounds.check(entry)
        except StoreError as fault:
            raise damage(self._database.path, str(fault)) from fault
        if not chunk.first_tick <= entry.tick <= chunk.last_tick:
            between = f"stands between ticks {chunk.first_tick} and {chunk.last_tick}"
            raise damage(self._database.path, f"an entry of tick {entry.tick} {between}")
        return entry

    def _encoded(self, chunk: _Chunk) -> list[msgspec.Raw]:
        """Return the encoded entries of a chunk."""
        body = self.decompressed(chunk.body) if chunk.compressed else chunk.body
        encoded = codec.split(body)
        if len(encoded) != chunk.count:
            counts = f"{len(encoded)} of {chunk.count} entries"
            raise damage(self._database.path, f"a chunk has {counts}")
        return encoded


def _summary(entries: Sequence[Entry]) -> tuple[int, int, int, int]:
    """Return first and last tick of entries, and the numbers of events and of changes in them."""
    events = sum(count_of_events(entry) for entry in entries)
    changes = sum(is_found(entry, EntryFilter.CHANGES) for entry in entries)
    return entries[0].tick, entries[-1].tick, events, changes
