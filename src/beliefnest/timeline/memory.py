"""Timelines in memory, for nests that are not kept."""

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
from beliefnest.timeline.records import Records
from beliefnest.timeline.schema import RECORDS
from beliefnest.world.frames import Frame
from beliefnest.world.values import AgentState

__all__ = ["MemoryJournal"]


@dataclass
class _Timeline:
    """A timeline with its entries, and which of them are looked for.

    Attributes:
        info: What is known of it besides.
        entries: All of them; only `extend` and `cut` change them.
        found: Numbers of entries, rising, by what is looked for.
        events: How many events there are up to each entry with events.
        agents: Numbers of the entries in which an agent changes, rising, by name.
        checkpoints: By name and number of entries.
        body_states: By number of entries and tick.
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
        """Add entries, and move the head."""
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
        """Return the timeline as it is; once entries were added, `cut` has to follow."""
        checkpoints, body_states = self.checkpoints.copy(), self.body_states.copy()
        return replace(self, checkpoints=checkpoints, body_states=body_states)

    def cut(self) -> None:
        """Forget entries that were added since it was copied."""
        length = self.info.entries
        del self.entries[length:]
        for numbers in (*self.found.values(), *self.agents.values()):
            del numbers[bisect_left(numbers, length) :]
        del self.events[len(self.found[EntryFilter.EVENTS]) :]


class MemoryJournal:
    """A journal that ends with the process."""

    def __init__(self) -> None:
        self._timelines: dict[TimelineKey, _Timeline] = {}
        self._database = Database.in_memory(RECORDS)
        # It need not be closed, and can be read when it was.
        finalize(self, self._database.close)
        self.records = Records(self._database)

    @property
    def writable(self) -> bool:
        """It is."""
        return True

    def timelines(self) -> Sequence[TimelineInfo]:
        """Return all timelines, in order of creation."""
        return tuple(timeline.info for timeline in self._timelines.values())

    def info(self, key: TimelineKey) -> TimelineInfo:
        """Return one timeline; BranchError if there is none of that key."""
        # Who reads states asks for little else: twice for each node.
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
        """Yield entries number start to stop - 1, oldest first."""
        return iter(self._timeline(key).entries[start:stop])

    def entries_until(self, key: TimelineKey, tick: int) -> int:
        """How many entries lie at `tick` or before."""
        return bisect_right(self._timeline(key).entries, tick, key=attrgetter("tick"))

    def filtered(
        self, key: TimelineKey, start: int, stop: int, what: EntryFilter
    ) -> Iterator[tuple[int, Entry]]:
        """Yield those of entries start to stop - 1 that are looked for, with their numbers."""
        timeline = self._timeline(key)
        numbers = timeline.found[what]
        low, high = bisect_left(numbers, start), bisect_left(numbers, stop)
        return iter([(number, timeline.entries[number]) for number in numbers[low:high]])

    def events_until(self, key: TimelineKey, entries: int) -> int:
        """How many events the first `entries` entries have."""
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
        """Give a timeline's branch another name; timelines based on it follow."""
        renamed, new_key = self._timeline(key), TimelineKey(key.path, name)
        if new_key in self._timelines:
            raise branch_taken(new_key)
        renamed.info = replace(renamed.info, key=new_key)
        for timeline in self._based_on(key):
            base = timeline.info.base
            timeline.info = replace(timeline.info, base=base and replace(base, timeline=new_key))
        # They stay in order of creation.
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
        """Keep bytes that stand for the first `entries` entries; InputError if too few."""
        timeline = self._timeline(key)
        check_place(timeline.info, entries)
        timeline.checkpoints[name, entries] = body

    def nearest_checkpoint(
        self, key: TimelineKey, name: str, entries: int
    ) -> tuple[int, bytes] | None:
        """Return the last checkpoint of that name at or before entry `entries`, with its place."""
        kept = self._timeline(key).checkpoints
        places = [at for kind, at in kept if kind == name and at <= entries]
        return (max(places), kept[name, max(places)]) if places else None

    def put_body_state(self, key: TimelineKey, entries: int, tick: int, state: bytes) -> None:
        """Keep the internal state of a timeline's body at a moment; InputError if too few."""
        timeline = self._timeline(key)
        check_place(timeline.info, entries)
        timeline.body_states[entries, tick] = state

    def body_state(self, key: TimelineKey, entries: int, tick: int) -> bytes | None:
        """Return the internal state that was kept for a moment; None if none was."""
        return self._timeline(key).body_states.get((entries, tick))

    @contextmanager
    def together(self) -> Iterator[None]:
        """Do all that is done inside or, if it raises, none of it."""
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
        """Nothing is held open."""

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
