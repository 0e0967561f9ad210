"""Journal in memory, for nests without a run file."""

from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from operator import attrgetter
from weakref import finalize

from beliefnest.timeline.database import Database
from beliefnest.timeline.journal import (
    Entry,
    EntryFilter,
    ForkPoint,
    TimelineInfo,
    TimelineKey,
    branch_carries,
    branch_missing,
    branch_taken,
    check_append,
    check_base,
    check_place,
    count_of_events,
    is_found,
)
from beliefnest.timeline.run_records import Records
from beliefnest.timeline.store_schema import RECORDS
from beliefnest.world.frames import Frame
from beliefnest.world.values import AgentState

__all__ = ["MemoryJournal"]


@dataclass
class _Timeline:
    """A timeline with its entries and indexes over them.

    Attributes:
        info: Key, base, head and other metadata.
        entries: All entries; only `extend` and `cut` change the list.
        found: Indexes of the entries that match each filter, in rising order.
        events: Running total of events, for each entry with events.
        agents: Indexes of the entries in which an agent changes, in rising order, by name.
        checkpoints: Checkpoints by name and number of entries.
        body_states: Internal states of bodies by number of entries and tick.
    """

    info: TimelineInfo
    entries: list[Entry] = field(default_factory=list)
    found: dict[EntryFilter, list[int]] = field(
        default_factory=lambda: {what: [] for what in EntryFilter}
    )
    events: list[int] = field(default_factory=list)
    agents: dict[str, list[int]] = field(default_factory=dict)
    checkpoints: dict[tuple[str, int], bytes] = field(default_factory=dict)
    body_states: dict[tuple[int, int], bytes] = field(default_factory=dict)

    def extend(self, entries: Sequence[Entry], head: int) -> None:
        """Add entries and move the head."""
        for number, entry in enumerate(entries, start=len(self.entries)):
            for what, numbers in self.found.items():
                if is_found(entry, what):
                    numbers.append(number)
            count = count_of_events(entry)
            if count:
                self.events.append(count + (self.events[-1] if self.events else 0))
            if isinstance(entry, Frame):
                for name in entry.agents:
                    self.agents.setdefault(name, []).append(number)
        self.entries.extend(entries)
        self.info = replace(self.info, head=head, entries=len(self.entries))

    def copy(self) -> "_Timeline":
        """Return a copy that shares the entries; call `cut` on it if entries were added since."""
        checkpoints, body_states = self.checkpoints.copy(), self.body_states.copy()
        return replace(self, checkpoints=checkpoints, body_states=body_states)

    def cut(self) -> None:
        """Drop the entries that were added since this copy was made."""
        length = self.info.entries
        del self.entries[length:]
        for numbers in (*self.found.values(), *self.agents.values()):
            del numbers[bisect_left(numbers, length) :]
        del self.events[len(self.found[EntryFilter.EVENTS]) :]


class MemoryJournal:
    """A journal that is lost when the process ends."""

    writable = True

    def __init__(self) -> None:
        self._timelines: dict[TimelineKey, _Timeline] = {}
        self._database = Database.in_memory(RECORDS)
        # Users need not close this journal, and can read it after `close`.
        finalize(self, self._database.close)
        self.records = Records(self._database)

    def timelines(self) -> Sequence[TimelineInfo]:
        """Return all timelines, in order of creation."""
        return tuple(timeline.info for timeline in self._timelines.values())

    def info(self, key: TimelineKey) -> TimelineInfo:
        """Return one timeline; BranchError if there is none of that key."""
        # Hot path: reading states calls this twice for each node.
        timeline = self._timelines.get(key)
        return self._timeline(key).info if timeline is None else timeline.info

    def create(self, key: TimelineKey, base: ForkPoint | None, start: int) -> None:
        """Begin an empty timeline; BranchError if it exists or its base does not."""
        if key in self._timelines:
            raise branch_taken(key)
        if base is not None:
            check_base(key, base, self.info(base.timeline).entries)
        self._timelines[key] = _Timeline(TimelineInfo(key, base, start, start))

    def append(self, key: TimelineKey, entries: Sequence[Entry], head: int) -> None:
        """Add entries and move the head."""
        timeline = self._timeline(key)
        check_append(timeline.info, entries, head)
        timeline.extend(entries, head)

    def entries(self, key: TimelineKey, start: int, stop: int) -> Iterator[Entry]:
        """Yield the entries with indexes start to stop - 1, oldest first."""
        return iter(self._timeline(key).entries[start:stop])

    def entries_until(self, key: TimelineKey, tick: int) -> int:
        """Return the number of entries at `tick` or earlier."""
        return bisect_right(self._timeline(key).entries, tick, key=attrgetter("tick"))

    def filtered(
        self, key: TimelineKey, start: int, stop: int, what: EntryFilter
    ) -> Iterator[tuple[int, Entry]]:
        """Yield the entries from start to stop - 1 that match a filter, with their indexes."""
        timeline = self._timeline(key)
        numbers = timeline.found[what]
        low, high = bisect_left(numbers, start), bisect_left(numbers, stop)
        return iter([(number, timeline.entries[number]) for number in numbers[low:high]])

    def events_until(self, key: TimelineKey, entries: int) -> int:
        """Return the number of events in the first `entries` entries."""
        timeline = self._timeline(key)
        before = bisect_left(timeline.found[EntryFilter.EVENTS], entries)
        return timeline.events[before - 1] if before else 0

    def agents_after(self, key: TimelineKey, entries: int) -> Mapping[str, AgentState | None]:
        """Return the last state of each agent that the first `entries` entries name."""
        timeline, agents = self._timeline(key), {}
        for name, numbers in timeline.agents.items():
            before = bisect_left(numbers, entries)
            entry = timeline.entries[numbers[before - 1]] if before else None
            if isinstance(entry, Frame):
                agents[name] = entry.agents[name]
        return agents

    def rename(self, key: TimelineKey, name: str) -> None:
        """Rename a timeline's branch; timelines based on it refer to the new name."""
        renamed, new_key = self._timeline(key), TimelineKey(key.path, name)
        if new_key in self._timelines:
            raise branch_taken(new_key)
        renamed.info = replace(renamed.info, key=new_key)
        for timeline in self._based_on(key):
            base = timeline.info.base
            timeline.info = replace(timeline.info, base=base and replace(base, timeline=new_key))
        # The mapping is built again, so that timelines stay in order of creation.
        self._timelines = {each.info.key: each for each in self._timelines.values()}
        self.records.follow_rename(key.path, key.branch, name)

    def delete(self, key: TimelineKey) -> None:
        """Remove a timeline; BranchError if another is based on it."""
        self._timeline(key)
        based = [timeline.info.key for timeline in self._based_on(key)]
        if based:
            raise branch_carries(key, based)
        del self._timelines[key]
        self.records.forget_branch(key.path, key.branch)

    def describe(self, key: TimelineKey, description: str) -> None:
        """Set a timeline's description."""
        timeline = self._timeline(key)
        timeline.info = replace(timeline.info, description=description)

    def put_checkpoint(self, key: TimelineKey, name: str, entries: int, body: bytes) -> None:
        """Store a checkpoint for the first `entries` entries; InputError if there are fewer."""
        timeline = self._timeline(key)
        check_place(timeline.info, entries)
        timeline.checkpoints[name, entries] = body

    def nearest_checkpoint(
        self, key: TimelineKey, name: str, entries: int
    ) -> tuple[int, bytes] | None:
        """Return the last checkpoint of that name at or before entry `entries`, and its place."""
        kept = self._timeline(key).checkpoints
        places = [at for kind, at in kept if kind == name and at <= entries]
        return (max(places), kept[name, max(places)]) if places else None

    def put_body_state(self, key: TimelineKey, entries: int, tick: int, state: bytes) -> None:
        """Store the internal state of a timeline's body; InputError if there are fewer entries."""
        timeline = self._timeline(key)
        check_place(timeline.info, entries)
        timeline.body_states[entries, tick] = state

    def body_state(self, key: TimelineKey, entries: int, tick: int) -> bytes | None:
        """Return the internal state stored for exactly this moment; None if there is none."""
        return self._timeline(key).body_states.get((entries, tick))

    @contextmanager
    def together(self) -> Iterator[None]:
        """Make the calls inside the block atomic: if the block raises, undo all of them."""
        before = {key: timeline.copy() for key, timeline in self._timelines.items()}
        try:
            with self._database.transaction():
                yield
        except BaseException:
            for timeline in before.values():
                timeline.cut()
            self._timelines = before
            raise

    def close(self) -> None:
        """Do nothing: the journal holds no open file."""

    def _timeline(self, key: TimelineKey) -> _Timeline:
        timeline = self._timelines.get(key)
        if timeline is None:
            raise branch_missing(key, (k.branch for k in self._timelines if k.path == key.path))
        return timeline

    def _based_on(self, key: TimelineKey) -> list[_Timeline]:
        return [
            timeline
            for timeline in self._timelines.values()
            if timeline.info.base is not None and timeline.info.base.timeline == key
        ]
