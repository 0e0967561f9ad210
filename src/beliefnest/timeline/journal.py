"""Timelines: append-only logs of facts of control-mode simulators (semantics, section 6).

A timeline is one branch of one simulator. Its entries are frames and edits. It begins at its base,
which is a point on another timeline, or at the world's first snapshot. No other
facts are stored: every follow-mode belief is computed from timelines.
"""

from collections.abc import Iterable, Mapping, Sequence
from enum import StrEnum

import msgspec

from beliefnest.errors import BranchError, InputError, TickError
from beliefnest.world.frames import Frame
from beliefnest.world.paths import BeliefPath, path_text
from beliefnest.world.texts import quoted
from beliefnest.world.values import Block, Items, Position

FOLLOW = "follow"
"""Reserved branch name: the timeline of a simulator in follow mode."""


class Edit(msgspec.Struct, frozen=True):
    """A manual change of one simulator's state, between two ticks.

    Attributes:
        tick: The tick after which it was made.
        path: Normalised belief path of the edited simulator.
        blocks: New blocks; -1 makes a block unknown.
        containers: New contents, which are complete.
    """

    tick: int
    path: BeliefPath
    blocks: Mapping[Position, Block] = msgspec.field(default_factory=dict)
    containers: Mapping[Position, Items] = msgspec.field(default_factory=dict)


Entry = Frame | Edit


class EntryFilter(StrEnum):
    """Criterion for a search over the entries of a timeline."""

    EVENTS = "events"
    """Frames with events."""

    CHANGES = "changes"
    """Frames that change blocks, contents or dropped items, and all edits."""


class TimelineKey(msgspec.Struct, frozen=True, order=True):
    """Normalised path of a simulator and name of a branch; the real world's path is empty."""

    path: BeliefPath
    branch: str


class ForkPoint(msgspec.Struct, frozen=True):
    """Point at which another timeline begins: at `tick`, after the first `entries` entries."""

    timeline: TimelineKey
    entries: int
    tick: int


class TimelineInfo(msgspec.Struct, frozen=True):
    """Metadata of a timeline.

    Attributes:
        key: Simulator and branch.
        base: Point at which it begins; None for the world's first snapshot.
        start: First tick.
        head: Latest tick. Quiet ticks have no entry, so it can be later than the last entry.
        entries: Number of entries.
        description: Description written by a user.
    """

    key: TimelineKey
    base: ForkPoint | None
    start: int
    head: int
    entries: int = 0
    description: str = ""


def is_found(entry: Entry, what: EntryFilter) -> bool:
    """Return True if an entry matches a filter."""
    if isinstance(entry, Edit):
        return what is EntryFilter.CHANGES
    if what is EntryFilter.EVENTS:
        return bool(entry.events)
    return bool(entry.blocks or entry.containers or entry.items)


def count_of_events(entry: Entry) -> int:
    """Return the number of events of an entry."""
    return 0 if isinstance(entry, Edit) else len(entry.events)


def branch_missing(key: TimelineKey, names: Iterable[str]) -> BranchError:
    """Return the error for an unknown branch; `names` are the existing branches."""
    listed_names = ", ".join(quoted(name) for name in sorted(names))
    return BranchError(
        f"{path_text(key.path)} has no branch {quoted(key.branch)}; it has {listed_names or 'none'}"
    )


def branch_taken(key: TimelineKey) -> BranchError:
    """Return the error for a branch name that is in use."""
    return BranchError(
        f"{path_text(key.path)} already has a branch {quoted(key.branch)}; choose another name"
    )


def branch_carries(key: TimelineKey, others: Iterable[TimelineKey]) -> BranchError:
    """Return the error for the removal of a branch that `others` are based on."""
    names = ", ".join(f"{path_text(k.path)} {quoted(k.branch)}" for k in others)
    return BranchError(
        f"branch {quoted(key.branch)} of {path_text(key.path)} carries others ({names}); "
        "delete those first, or delete with recursive=True"
    )


def check_base(key: TimelineKey, base: ForkPoint, length: int) -> None:
    """Check that a timeline of `length` entries reaches the base; BranchError if it does not."""
    if not 0 <= base.entries <= length:
        raise BranchError(
            f"branch {quoted(key.branch)} of {path_text(key.path)} cannot begin after entry "
            f"{base.entries} of {quoted(base.timeline.branch)}, which has {length}"
        )


def check_append(info: TimelineInfo, entries: Sequence[Entry], head: int) -> None:
    """Check that the ticks of new entries do not decrease.

    Raises:
        TickError: An entry is earlier than the entry before it or than the timeline's head, or it
            is later than the new head.
    """
    latest = info.head
    for entry in entries:
        if not latest <= entry.tick <= head:
            raise TickError(
                f"an entry of tick {entry.tick} does not fit between ticks {latest} and {head} "
                f"of branch {quoted(info.key.branch)} of {path_text(info.key.path)}; "
                "append in order of ticks"
            )
        latest = entry.tick
    if head < latest:
        raise TickError(
            f"branch {quoted(info.key.branch)} of {path_text(info.key.path)} is at tick {latest}; "
            f"its head cannot go back to {head}"
        )


def check_place(info: TimelineInfo, entries: int) -> None:
    """Check that a timeline has at least `entries` entries; InputError if it has fewer."""
    if not 0 <= entries <= info.entries:
        raise InputError(
            f"branch {quoted(info.key.branch)} of {path_text(info.key.path)} has {info.entries} "
            f"entries; nothing can be stored after entry {entries}"
        )
