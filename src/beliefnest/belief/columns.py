"""Columns of a stretch of a timeline, as the belief kernel reads them."""

from bisect import bisect_left
from collections.abc import Iterator

import numpy as np

from beliefnest.belief.arrays import NOBODY, UNKNOWN, EntryFacts
from beliefnest.belief.context import BeliefContext
from beliefnest.belief.poses import Growing, PoseTable
from beliefnest.world.claims import ClaimKind, claims_of, claims_written
from beliefnest.world.event_kinds import Sense
from beliefnest.world.frames import Frame
from beliefnest.world.values import Box, Event, Position, Sign


def cell_of(box: Box, place: Position) -> int:
    """Return the flat cell of a block position of a box."""
    _, ny, nz = box.shape
    i, j, k = box.index(place)
    return (i * ny + j) * nz + k


def place_of(box: Box, cell: int) -> Position:
    """Return the block position of a flat cell of a box."""
    _, ny, nz = box.shape
    x, y, z = box.low
    return (x + cell // (ny * nz), y + cell // nz % ny, z + cell % nz)


def cells_between(box: Box, low: Position, high: Position) -> list[int]:
    """Return the flat cells of a box between two corners, which may lie outside, in order."""
    i, j, k = np.meshgrid(
        *(
            np.arange(max(a, start), min(b, end) + 1) - start
            for a, b, start, end in zip(low, high, box.low, box.high, strict=True)
        ),
        indexing="ij",
        sparse=True,
    )
    _, ny, nz = box.shape
    cells_on_way: list[int] = ((i * ny + j) * nz + k).ravel().tolist()
    return cells_on_way


class Columns:
    """Entries of a stretch of one timeline in columns.

    Entries and events have the numbers that they have in the timeline.

    Args:
        context: The part that all nodes of the nest share.
        first: Number of the first entry of the stretch.
        first_event: Number of events of the timeline before that entry.
        poses: Table that receives the agents' poses; None: a new one.

    Attributes:
        first: Number of the first entry.
        poses: Poses of the agents.
        frames: By entry, the frames with contents or dropped items, which the kernel does not read.
        events: The events of the stretch, in order.
        acts: By entry, the numbers of its events that are acts of agents.
        held: Cells of new containers and cells that claims are about, in order, with repetitions.
        item_entries: Entries with dropped items, rising.
        act_entries: Entries with acts, rising.
        claim_entries: Entries with claims, rising.
    """

    def __init__(
        self,
        context: BeliefContext,
        first: int = 0,
        first_event: int = 0,
        poses: PoseTable | None = None,
    ) -> None:
        self._context = context
        self.first = first
        self._first_event = first_event
        self.poses = PoseTable() if poses is None else poses
        self.held: list[int] = []
        self.item_entries: list[int] = []
        self.act_entries: list[int] = []
        self.claim_entries: list[int] = []
        self._effects: list[int] = []
        self.frames: dict[int, Frame] = {}
        self.events: list[Event] = []
        self.acts: dict[int, list[int]] = {}
        # One column for each field of `EntryFacts`, of the same name.
        self._columns = {name: Growing(np.int32) for name in EntryFacts._fields}
        self._tick, self._event_at = self._columns["tick"], self._columns["event_at"]
        self._pose_at, self._block_at = self._columns["pose_at"], self._columns["block_at"]
        self._count_of_poses = self._count_of_blocks = 0
        self._close_entry()

    @property
    def end(self) -> int:
        """The number of the entry after the last one."""
        return self.first + len(self._tick)

    def add(self, frame: Frame) -> None:
        """Add a frame."""
        entry, context, columns = self.end, self._context, self._columns
        if frame.containers or frame.items:
            self.frames[entry] = frame
        if frame.items:
            self.item_entries.append(entry)
        for name, agent in frame.agents.items():
            pose = UNKNOWN if agent is None else self.poses.add(name, agent)
            columns["pose_agent"].append(context.numbers[name])
            columns["pose_id"].append(pose)
        for place, block in frame.blocks.items():
            state = context.number(block, claims_written(frame, place))
            cell = cell_of(context.box, place)
            if isinstance(block, Sign):
                context.note_signs((cell,))
            columns["block_cell"].append(cell)
            columns["block_state"].append(state)
            if context.shows[state]:
                self.held.append(cell)
        for event in frame.events:
            self._add_event(entry, event)
        if entry in self.frames or entry in self.acts:
            self._effects.append(entry)
        self._tick.append(frame.tick)
        self._count_of_poses += len(frame.agents)
        self._count_of_blocks += len(frame.blocks)
        self._close_entry()

    def add_quiet(self, tick: int) -> None:
        """Add an entry without a frame."""
        self._tick.append(tick)
        self._close_entry()

    def tick(self, entry: int) -> int:
        """Return the tick of an entry."""
        return int(self._tick.view()[entry - self.first])

    def events_until(self, entry: int) -> int:
        """Return the number of events of the timeline before an entry."""
        return self._first_event + int(self._event_at.view()[entry - self.first])

    def event(self, number: int) -> Event:
        """Return an event of the stretch."""
        return self.events[number - self._first_event]

    def events_since(self, entry: int) -> Iterator[tuple[int, Event]]:
        """Yield events from an entry of the stretch on, each with its tick."""
        at, tick = self._event_at.view(), self._tick.view()
        for row in range(entry - self.first, len(tick)):
            for number in range(int(at[row]), int(at[row + 1])):
                yield int(tick[row]), self.events[number]

    def with_effects(self, start: int, stop: int) -> set[int]:
        """Return entries start to stop - 1 that change contents, possessions or dropped items."""
        if stop - start == 1:
            return {start} if start in self.frames or start in self.acts else set()
        low, high = bisect_left(self._effects, start), bisect_left(self._effects, stop)
        return set(self._effects[low:high])

    def has_claims(self, entry: int) -> bool:
        """Return True if an entry has claims."""
        number = bisect_left(self.claim_entries, entry)
        return self.claim_entries[number : number + 1] == [entry]

    def facts(self) -> EntryFacts:
        """Return the columns for the kernel.

        The kernel counts entries and events from the first of the stretch.
        """
        return EntryFacts(*(column.view() for column in self._columns.values()))

    def _add_event(self, entry: int, event: Event) -> None:
        context, columns = self._context, self._columns
        sense, actor = event.kind.traits.sense, event.actor
        place = event.detail.get("position")
        if event.kind.is_act:
            if entry not in self.acts:
                self.act_entries.append(entry)
            number = self._first_event + len(self.events)
            self.acts.setdefault(entry, []).append(number)
        cell = UNKNOWN if place is None or place not in context.box else cell_of(context.box, place)
        to = event.detail.get("to") if sense is Sense.HEARING else None
        columns["event_sense"].append(sense)
        columns["event_actor"].append(NOBODY if actor is None else context.numbers[actor])
        columns["event_cell"].append(cell)
        columns["event_to"].append(NOBODY if to is None else context.numbers[to])
        if event.detail.get("claims"):
            self._add_claims(entry, event)
        self.events.append(event)

    def _add_claims(self, entry: int, event: Event) -> None:
        if self.claim_entries[-1:] != [entry]:
            self.claim_entries.append(entry)
        about = [claim for claim in claims_of(event) if claim.kind is not ClaimKind.POSITION]
        # To weigh a claim the kernel has to know who watches the place (semantics, section 8).
        self.held.extend(cell_of(self._context.box, claim.cell) for claim in about)

    def _close_entry(self) -> None:
        # Hot path: counting rows of the columns takes twice as long.
        self._pose_at.append(self._count_of_poses)
        self._block_at.append(self._count_of_blocks)
        self._event_at.append(len(self.events))
