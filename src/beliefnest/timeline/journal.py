"""Timelines: the append-only logs of facts of control-mode simulators (semantics, section 6).

A timeline is one branch of one simulator. Its entries are frames and edits; it begins
where its base lies on another timeline, or at the world's first snapshot. Only this is
stored: every follow-mode belief is computed from it.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Protocol

from beliefnest.errors import BranchError, InputError, TickError
from beliefnest.world.frames import Frame
from beliefnest.world.paths import BeliefPath, path_text
from beliefnest.world.values import AgentState, Block, Items, Position

__all__ = [
    "FOLLOW",
    "Edit",
    "Entry",
    "EntryFilter",
    "ForkPoint",
    "Journal",
    "TimelineInfo",
    "TimelineKey",
    "branch_carries",
    "branch_missing",
    "branch_taken",
    "check_append",
    "check_base",
    "check_place",
    "count_of_events",
    "is_found",
    "lineage",
]

FOLLOW = "follow"
"""Reserved name of the timeline a follow-mode simulator is on."""


@dataclass(frozen=True, slots=True)
class Edit:
    """A change made by hand to one simulator's state, between two ticks.

    Attributes:
        tick: The tick after which it was made.
        path: Belief path of the edited simulator, normalised.
        blocks: New blocks; -1 makes one unknown.
        containers: New contents, complete.
    """

    tick: int
    path: BeliefPath
    blocks: Mapping[Position, Block] = field(default_factory=dict)
    containers: Mapping[Position, Items] = field(default_factory=dict)


Entry = Frame | Edit


class EntryFilter(StrEnum):
    """What makes an entry one of those that are looked for."""

    EVENTS = "events"
    """It is a frame with events."""

    CHANGES = "changes"
    """It changes blocks, contents or dropped items, or is an edit."""


@dataclass(frozen=True, slots=True, order=True)
class TimelineKey:
    """One branch of one simulator; path is normalised, the real world's is empty."""

    path: BeliefPath
    branch: str


@dataclass(frozen=True, slots=True)
class ForkPoint:
    """Where a timeline begins: after the first `entries` entries of another one, at `tick`."""

    timeline: TimelineKey
    entries: int
    tick: int


@dataclass(frozen=True, slots=True)
class TimelineInfo:
    """What is known of a timeline besides its entries.

    Attributes:
        key: Simulator and branch.
        base: Where it begins; None: at the world's first snapshot.
        start: Its first tick.
        head: Its latest tick; quiet ticks have no entry.
        entries: Number of its entries.
        description: A user's words about it.
    """

    key: TimelineKey
    base: ForkPoint | None
    start: int
    head: int
    entries: int = 0
    description: str = ""


def is_found(entry: Entry, what: EntryFilter) -> bool:
    """Return True if an entry is one of those that are looked for."""
    if isinstance(entry, Edit):
        return what is EntryFilter.CHANGES
    if what is EntryFilter.EVENTS:
        return bool(entry.events)
    return bool(entry.blocks or entry.containers or entry.items)


def count_of_events(entry: Entry) -> int:
    """How many events an entry has."""
    return 0 if isinstance(entry, Edit) else len(entry.events)


def branch_missing(key: TimelineKey, names: Iterable[str]) -> BranchError:
    """Return the error for a branch that does not exist, `names` being those that do."""
    known = ", ".join(repr(name) for name in sorted(names))
    return BranchError(
        f"{path_text(key.path)} has no branch {key.branch!r}; it has {known or 'none'}"
    )


def branch_taken(key: TimelineKey) -> BranchError:
    """Return the error for a name that is in use."""
    return BranchError(
        f"{path_text(key.path)} already has a branch {key.branch!r}; choose another name"
    )


def branch_carries(key: TimelineKey, others: Iterable[TimelineKey]) -> BranchError:
    """Return the error for removing what `others` are based on."""
    names = ", ".join(f"{path_text(k.path)} {k.branch!r}" for k in others)
    return BranchError(
        f"branch {key.branch!r} of {path_text(key.path)} carries others ({names}); "
        "delete those first, or delete with recursive=True"
    )


def check_base(key: TimelineKey, base: ForkPoint, length: int) -> None:
    """Check that a timeline of `length` entries can carry a new one; BranchError if too short."""
    if not 0 <= base.entries <= length:
        raise BranchError(
            f"branch {key.branch!r} of {path_text(key.path)} cannot begin after entry "
            f"{base.entries} of {base.timeline.branch!r}, which has {length}"
        )


def check_append(info: TimelineInfo, entries: Sequence[Entry], head: int) -> None:
    """Check that time does not run backwards.

    Raises:
        TickError: An entry lies before the one before it or before the timeline's head, or
            after the new head.
    """
    latest = info.head
    for entry in entries:
        if not latest <= entry.tick <= head:
            raise TickError(
                f"an entry of tick {entry.tick} does not fit between ticks {latest} and {head} "
                f"of branch {info.key.branch!r} of {path_text(info.key.path)}; "
                "append in order of ticks"
            )
        latest = entry.tick
    if head < latest:
        raise TickError(
            f"branch {info.key.branch!r} of {path_text(info.key.path)} is at tick {latest}; "
            f"its head cannot go back to {head}"
        )


def check_place(info: TimelineInfo, entries: int) -> None:
    """Check that a timeline has so many entries; InputError if it has fewer."""
    if not 0 <= entries <= info.entries:
        raise InputError(
            f"branch {info.key.branch!r} of {path_text(info.key.path)} has {info.entries} "
            f"entries; no checkpoint lies after {entries}"
        )


class Journal(Protocol):
    """Where timelines are kept. One writer; what a call did is kept once it returns."""

    @property
    def writable(self) -> bool:
        """True if it takes anything; who only looks at it leaves no checkpoints either."""

    def timelines(self) -> Sequence[TimelineInfo]:
        """Return all timelines, in order of creation."""

    def info(self, key: TimelineKey) -> TimelineInfo:
        """Return one timeline; BranchError if there is none of that key."""

    def create(self, key: TimelineKey, base: ForkPoint | None, start: int) -> None:
        """Begin an empty timeline; costs the same however long its base is.

        BranchError if there is one of that key already, or the base is not there.
        """

    def append(self, key: TimelineKey, entries: Sequence[Entry], head: int) -> None:
        """Add entries, all or none, and move the head to tick `head`.

        Raises:
            BranchError: There is no timeline of that key.
            TickError: The ticks do not rise from the old head to the new one.
        """

    def entries(self, key: TimelineKey, start: int, stop: int) -> Iterator[Entry]:
        """Yield entries number start (included, not negative) to stop (excluded), oldest first.

        Fewer where the timeline ends before. Entries appended later are not returned. BranchError
        as above.
        """

    def entries_until(self, key: TimelineKey, tick: int) -> int:
        """How many entries lie at `tick` or before; BranchError as above."""

    def filtered(
        self, key: TimelineKey, start: int, stop: int, what: EntryFilter
    ) -> Iterator[tuple[int, Entry]]:
        """Yield those of entries start to stop - 1 that are looked for, with their numbers.

        Takes time in proportion to what is found, hardly to what is passed over. BranchError
        as above.
        """

    def events_until(self, key: TimelineKey, entries: int) -> int:
        """How many events the first `entries` entries have; BranchError as above."""

    def agents_after(self, key: TimelineKey, entries: int) -> Mapping[str, AgentState | None]:
        """Return the last state of each agent that the first `entries` entries name.

        Takes the same time however many entries these are. BranchError as above.
        """

    def rename(self, key: TimelineKey, name: str) -> None:
        """Give a timeline's branch another name; timelines based on it follow.

        BranchError as above, or if there is one of that name.
        """

    def delete(self, key: TimelineKey) -> None:
        """Remove a timeline; BranchError as above, or if another one is based on it."""

    def describe(self, key: TimelineKey, description: str) -> None:
        """Set a timeline's description; BranchError if there is none of that key."""

    def put_checkpoint(self, key: TimelineKey, name: str, entries: int, body: bytes) -> None:
        """Keep bytes that stand for the first `entries` entries of a timeline.

        They spare a reader those entries, replace those of the same place and name, and go with the
        timeline. BranchError as above, InputError if it does not have that many entries.
        """

    def nearest_checkpoint(
        self, key: TimelineKey, name: str, entries: int
    ) -> tuple[int, bytes] | None:
        """Return the last checkpoint of that name at or before entry `entries`, with its place.

        None if the timeline itself has none there; its base may. BranchError as above.
        """

    def put_body_state(self, key: TimelineKey, entries: int, tick: int, state: bytes) -> None:
        """Keep what goes on in a timeline's body and cannot be perceived; it is in no entry.

        Args:
            key: The timeline.
            entries: How many of its entries lie before.
            tick: The body's tick; several calls may end after the same entry.
            state: Bytes that only the world reads.

        Raises:
            BranchError, InputError: As of `put_checkpoint`.
        """

    def body_state(self, key: TimelineKey, entries: int, tick: int) -> bytes | None:
        """Return the internal state that was kept for just that moment; None if none was.

        BranchError as above.
        """

    def together(self) -> AbstractContextManager[None]:
        """Do all that is done inside or, if it raises, none of it. May be nested."""

    def close(self) -> None:
        """Give up what the journal holds open."""


def lineage(journal: Journal, key: TimelineKey) -> Iterator[tuple[TimelineKey, int]]:
    """A timeline and those it goes on from, each with its last tick that lies in the past of it.

    BranchError as of `Journal.info`.
    """
    info = journal.info(key)
    yield key, info.head
    while info.base is not None:
        yield info.base.timeline, info.base.tick
        info = journal.info(info.base.timeline)
