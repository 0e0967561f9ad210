"""Timelines in memory, for nests that are not kept."""

from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace

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
from beliefnest.timeline.memory_records import MemoryRecords
from beliefnest.world.frames import Frame
from beliefnest.world.values import AgentState

__all__ = ["MemoryJournal"]


class MemoryJournal:
    """A journal that ends with the process."""

    def __init__(self) -> None:
        self._infos: dict[TimelineKey, TimelineInfo] = {}
        self._entries: dict[TimelineKey, list[Entry]] = {}
        self._found: dict[TimelineKey, _Found] = {}
        self._checkpoints: dict[TimelineKey, dict[tuple[str, int], bytes]] = {}
        self._body_states: dict[TimelineKey, dict[tuple[int, int], bytes]] = {}
        self.records = MemoryRecords()

    @property
    def writable(self) -> bool:
        """It is."""
        return True

    def timelines(self) -> Sequence[TimelineInfo]:
        """All timelines, in order of creation."""
        return tuple(self._infos.values())

    def info(self, key: TimelineKey) -> TimelineInfo:
        """One timeline; BranchError if there is none of that key."""
        info = self._infos.get(key)
        if info is None:
            raise branch_missing(key, (k.branch for k in self._infos if k.path == key.path))
        return info

    def create(self, key: TimelineKey, base: ForkPoint | None, start: int) -> None:
        """Begin an empty timeline; BranchError if it is there or its base is not."""
        if key in self._infos:
            raise branch_taken(key)
        if base is not None:
            check_base(key, base, self.info(base.timeline).entries)
        self._infos[key] = TimelineInfo(key, base, start, start)
        self._entries[key] = []
        self._found[key] = _Found()
        self._checkpoints[key] = {}
        self._body_states[key] = {}

    def append(self, key: TimelineKey, entries: Sequence[Entry], head: int) -> None:
        """Add entries and move the head."""
        info = self.info(key)
        check_append(info, entries, head)
        self._entries[key].extend(entries)
        self._found[key].extend(entries, info.entries)
        self._infos[key] = replace(info, head=head, entries=info.entries + len(entries))

    def entries(self, key: TimelineKey, start: int, stop: int) -> Iterator[Entry]:
        """Entries number start to stop - 1, oldest first."""
        return iter(self._entries[self.info(key).key][start:stop])

    def entries_until(self, key: TimelineKey, tick: int) -> int:
        """How many entries lie at `tick` or before."""
        entries = self._entries[self.info(key).key]
        low, high = 0, len(entries)
        while low < high:
            middle = (low + high) // 2
            if entries[middle].tick <= tick:
                low = middle + 1
            else:
                high = middle
        return low

    def filtered(
        self, key: TimelineKey, start: int, stop: int, what: EntryFilter
    ) -> Iterator[tuple[int, Entry]]:
        """Those of entries start to stop - 1 that are looked for, with their numbers."""
        entries, numbers = self._entries[self.info(key).key], self._found[key].numbers[what]
        low, high = bisect_left(numbers, start), bisect_left(numbers, stop)
        return iter([(number, entries[number]) for number in numbers[low:high]])

    def events_until(self, key: TimelineKey, entries: int) -> int:
        """How many events the first `entries` entries have."""
        found = self._found[self.info(key).key]
        before = bisect_left(found.numbers[EntryFilter.EVENTS], entries)
        return found.events[before - 1] if before else 0

    def agents_after(self, key: TimelineKey, entries: int) -> Mapping[str, AgentState | None]:
        """The last state of each agent that the first `entries` entries name."""
        there, agents = self._entries[self.info(key).key], {}
        for name, numbers in self._found[key].agents.items():
            before = bisect_left(numbers, entries)
            entry = there[numbers[before - 1]] if before else None
            if isinstance(entry, Frame):
                agents[name] = entry.agents[name]
        return agents

    def rename(self, key: TimelineKey, name: str) -> None:
        """Give a timeline's branch another name; timelines based on it follow."""
        old = self.info(key)
        new_key = TimelineKey(key.path, name)
        if new_key in self._infos:
            raise branch_taken(new_key)
        infos = {}
        for info in self._infos.values():
            changed = replace(old, key=new_key) if info is old else info
            if changed.base is not None and changed.base.timeline == key:
                changed = replace(changed, base=replace(changed.base, timeline=new_key))
            infos[changed.key] = changed
        self._infos = infos
        self._entries[new_key] = self._entries.pop(key)
        self._found[new_key] = self._found.pop(key)
        self._checkpoints[new_key] = self._checkpoints.pop(key)
        self._body_states[new_key] = self._body_states.pop(key)
        self.records.follow_rename(key.path, key.branch, name)

    def delete(self, key: TimelineKey) -> None:
        """Remove a timeline; BranchError if another is based on it."""
        self.info(key)
        based = [
            i.key for i in self._infos.values() if i.base is not None and i.base.timeline == key
        ]
        if based:
            raise branch_carries(key, based)
        del self._infos[key], self._entries[key], self._found[key]
        del self._checkpoints[key], self._body_states[key]
        self.records.forget_branch(key.path, key.branch)

    def describe(self, key: TimelineKey, description: str) -> None:
        """Set a timeline's description."""
        self._infos[key] = replace(self.info(key), description=description)

    def put_checkpoint(self, key: TimelineKey, name: str, entries: int, body: bytes) -> None:
        """Keep bytes that stand for the first `entries` entries; InputError if too few."""
        check_place(self.info(key), entries)
        self._checkpoints[key][name, entries] = body

    def nearest_checkpoint(
        self, key: TimelineKey, name: str, entries: int
    ) -> tuple[int, bytes] | None:
        """The last checkpoint of that name at or before entry `entries`, with its place."""
        there = self._checkpoints[self.info(key).key]
        places = [at for kind, at in there if kind == name and at <= entries]
        return (max(places), there[name, max(places)]) if places else None

    def put_body_state(self, key: TimelineKey, entries: int, tick: int, state: bytes) -> None:
        """Keep the internal state of a timeline's body at a moment; InputError if too few."""
        check_place(self.info(key), entries)
        self._body_states[key][entries, tick] = state

    def body_state(self, key: TimelineKey, entries: int, tick: int) -> bytes | None:
        """The internal state that was kept for a moment; None if none was."""
        return self._body_states[self.info(key).key].get((entries, tick))

    @contextmanager
    def together(self) -> Iterator[None]:
        """Do all that is done inside or, if it raises, none of it."""
        infos, entries, found = self._infos.copy(), self._entries.copy(), self._found.copy()
        checkpoints = {key: there.copy() for key, there in self._checkpoints.items()}
        body_states = {key: there.copy() for key, there in self._body_states.items()}
        try:
            with self.records.together():
                yield
        except BaseException:
            for key, info in infos.items():
                del entries[key][info.entries :]
                found[key].cut(info.entries)
            self._infos, self._entries, self._found = infos, entries, found
            self._checkpoints, self._body_states = checkpoints, body_states
            raise

    def close(self) -> None:
        """Nothing is held open."""


class _Found:
    """Which entries of a timeline in memory are looked for, rising.

    Attributes:
        numbers: Of entries, by what is looked for.
        events: How many events there are up to each entry with events.
        agents: Entries that tell of an agent, by name.
    """

    def __init__(self) -> None:
        self.numbers: dict[EntryFilter, list[int]] = {what: [] for what in EntryFilter}
        self.events: list[int] = []
        self.agents: dict[str, list[int]] = {}

    def extend(self, entries: Sequence[Entry], first: int) -> None:
        """Take in entries, from number `first` on."""
        for number, entry in enumerate(entries, start=first):
            for what, numbers in self.numbers.items():
                if is_found(entry, what):
                    numbers.append(number)
            count = count_of_events(entry)
            if count:
                self.events.append(count + (self.events[-1] if self.events else 0))
            if isinstance(entry, Frame):
                for name in entry.agents:
                    self.agents.setdefault(name, []).append(number)

    def cut(self, length: int) -> None:
        """Forget the entries from number `length` on."""
        for numbers in (*self.numbers.values(), *self.agents.values()):
            del numbers[bisect_left(numbers, length) :]
        del self.events[len(self.numbers[EntryFilter.EVENTS]) :]
