"""Forest of all nodes below one timeline, folded together.

The compiled kernel folds poses, blocks and perceived events in arrays. `HoldingsTable` follows with
contents, possessions and dropped items, `EntryTestimony` with claims.
"""

from bisect import bisect_left
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Protocol
from weakref import ref

import msgspec
import numpy as np
import numpy.typing as npt

from beliefnest.belief.arrays import Changes, EntryFacts, Span
from beliefnest.belief.columns import Columns, place_of
from beliefnest.belief.context import BeliefContext, SavedWriting
from beliefnest.belief.first_perceptions import FirstPerceptions
from beliefnest.belief.grounds import Basis, PerceivedEvent
from beliefnest.belief.holdings import Whereabouts
from beliefnest.belief.holdings_table import HoldingsTable, RootFacts, SavedHoldings
from beliefnest.belief.node_table import NodeTable, SavedNode
from beliefnest.belief.perceived_table import PerceivedEventTable
from beliefnest.belief.poses import PoseTable, SavedPoses
from beliefnest.belief.testimony import EntryTestimony, Verdict
from beliefnest.world.paths import BeliefPath
from beliefnest.world.values import Event, Items, Point

_BATCH = 4096
_OBJECTS = 40_000
"""Bytes of a forest besides the arrays of its nodes, measured with few nodes."""


class EventHistory(Protocol):
    """Events of a timeline and of the time before it. Folding does not need them."""

    def events(self, count: int) -> Sequence[tuple[int, Event]]:
        """Return at least the first `count` events of the timeline, each with its tick."""

    def before(self, path: BeliefPath) -> Sequence[PerceivedEvent]:
        """Return the events that a node perceived before the timeline began, oldest first."""


class StateReader(Protocol):
    """View of a state that reads parts of it when they are asked for."""

    def keep(self) -> None:
        """Read all parts now that the forest will overwrite."""


class ForestState(msgspec.Struct, frozen=True):
    """Plain data of a forest apart from its nodes.

    Attributes:
        position: Number of entries folded.
        events: Number of events in these entries.
        tick: Tick of the last folded entry, or of the beginning.
        root: Facts about node 0 that are not in its holdings.
        tracked: int32, cells whose basis is tracked, as native bytes.
        since: The tracked cells that have been tracked since the beginning.
        poses: The poses that nodes refer to.
        signs: The signs with texts, in order of their block numbers.
        sign_cells: Cells of signs that ever carried text.
    """

    position: int
    events: int
    tick: int
    root: RootFacts
    tracked: bytes
    since: tuple[int, ...]
    poses: SavedPoses
    signs: tuple[SavedWriting, ...] = ()
    sign_cells: tuple[int, ...] = ()


class NodeState(msgspec.Struct, frozen=True):
    """One node of a forest as plain data; `heard` has a bit for each event of the timeline."""

    row: SavedNode
    holdings: SavedHoldings
    heard: bytes


class Forest:
    """Nodes below one timeline after its first `position` entries.

    Attributes:
        context: The part that all nodes of the nest share.
        columns: The stretch of the timeline that holds the next entries.
        table: The nodes' arrays.
        holdings: The nodes' contents, possessions and dropped items.
        perceived_events: Table of the events that each node perceived.
        position: Number of entries folded.
        tick: Tick of the last folded entry, or of the beginning.
        since: Cells that have been tracked since the beginning.
        verdicts: Verdicts of all nodes on the claims of the last entry with claims. The key is the
            number of the event in the entry and of the claim in the event.
    """

    def __init__(
        self,
        events: EventHistory,
        table: NodeTable,
        holdings: HoldingsTable,
        tick: int,
        since: frozenset[int] | None = None,
    ) -> None:
        self.context, self._events = table.context, events
        self.table, self.holdings = table, holdings
        self.position, self.tick = 0, tick
        self.columns = Columns(self.context, 0, 0, table.poses)
        self.perceived_events = PerceivedEventTable()
        tracked = frozenset(table.tracked.tolist())
        self.since = tracked if since is None else tracked & since
        self.verdicts: Mapping[tuple[int, int], Sequence[Verdict]] = {}
        # A WeakSet would need readers with a hash. States are compared by value, and have none.
        self._readers: dict[int, ref[StateReader]] = {}

    def saved(self) -> tuple[ForestState, Iterator[NodeState]]:
        """Return the forest as plain data: all that folding the next entries depends on.

        The kernel's caches (`eye`, `sees`, `pending` ...) are left out: the first look after
        `restored`, which is the inverse, computes them again with the same result. The forest
        leaves its stretch by this.
        """
        count = self.count_of_events
        # Entering a stretch with an empty pose table keeps only the poses that nodes refer to.
        self.enter(Columns(self.context, self.position, count, PoseTable()))
        nodes = (
            NodeState(
                self.table.saved(node),
                self.holdings.saved(node),
                np.packbits(self.perceived_events.of(node, count)).tobytes(),
            )
            for node in range(self.table.count)
        )
        tracked = self.table.tracked.tobytes()
        root, poses = self.holdings.root.copy(), self.poses.saved()
        since = tuple(sorted(self.since))
        signs, cells = self.context.saved_signs, tuple(self.context.sign_cells)
        facts = (self.position, count, self.tick, root, tracked, since, poses, signs, cells)
        return ForestState(*facts), nodes

    @classmethod
    def restored(
        cls,
        context: BeliefContext,
        events: EventHistory,
        state: ForestState,
        nodes: Iterable[NodeState],
    ) -> "Forest":
        """Return a saved forest with some or all of its nodes, each after its parent."""
        tracked = np.frombuffer(state.tracked, dtype=np.int32)
        context.track(tracked.tolist())
        context.note_signs(state.sign_cells)
        table = NodeTable(context, PoseTable.restored(state.poses))
        forest = cls(events, table, HoldingsTable(table, state.root), state.tick)
        forest.position, forest.since = state.position, frozenset(state.since)
        forest.columns = Columns(context, state.position, state.events, table.poses)
        for number, node in enumerate(nodes):
            table.restore(node.row, tracked, state.signs)
            forest.holdings.restore(node.holdings, state.signs)
            heard = np.unpackbits(np.frombuffer(node.heard, dtype=np.uint8), count=state.events)
            forest.perceived_events.set(number, 0, heard.astype(np.bool_))
        table.link()
        return forest

    @property
    def poses(self) -> PoseTable:
        """The poses that nodes refer to."""
        return self.table.poses

    @property
    def paths(self) -> Collection[BeliefPath]:
        """The nodes, each after its parent."""
        return self.table.index.keys()

    @property
    def count_of_nodes(self) -> int:
        """The number of nodes."""
        return self.table.count

    @property
    def bytes(self) -> int:
        """Memory of the nodes, estimated."""
        return _OBJECTS + self.table.bytes

    @property
    def has_beliefs(self) -> bool:
        """True if there are nodes below node 0."""
        return self.table.count > 1

    def __contains__(self, path: BeliefPath) -> bool:
        return path in self.table.index

    def node(self, path: BeliefPath) -> int:
        """Return the number of a node."""
        return self.table.index[path]

    def block(self, path: BeliefPath, cell: int) -> int:
        """Return the number of the block that a node holds at a cell; -1: unknown."""
        return self.table.block(self.node(path), cell)

    def bases(self, path: BeliefPath, cells: Sequence[int]) -> dict[int, Basis | None]:
        """Return the bases of a node's blocks at some tracked cells; None for unknown blocks."""
        return self.table.bases(self.node(path), cells, self.tick)

    def current_blocks(self, path: BeliefPath, cells: Iterable[int]) -> set[int]:
        """Return the cells whose block in a node is current in the last entry."""
        return self.table.current_blocks(self.node(path), cells)

    def feet(self, path: BeliefPath, agent: str) -> Point | None:
        """Return the feet position that a node believes of an agent; None: unknown."""
        pose = self.table.pose(self.node(path), self.context.numbers[agent])
        return None if pose < 0 else self.poses.position(pose)

    def seen_at(self, path: BeliefPath, agent: str) -> int | None:
        """Return the last tick at which a node's pose of an agent was current.

        None: the pose is unknown.
        """
        node, number = self.node(path), self.context.numbers[agent]
        if self.table.pose(node, number) < 0:
            return None
        return self.tick if self.is_current(path, agent) else self.table.seen_at(node, number)

    def is_current(self, path: BeliefPath, agent: str) -> bool:
        """Return True if a node's pose of an agent is backed by a perception in the last entry."""
        return self.table.is_current(self.node(path), self.context.numbers[agent])

    def place_of(self, path: BeliefPath, place: Whereabouts | None) -> Point | str | None:
        """Return a place in a node as users name it: a block, an agent, a point of the floor."""
        if place is None:
            return None
        if place.kind == "agent":
            return self.context.agents[place.number]
        if place.kind == "container":
            return place_of(self.context.box, place.number)
        lying = self.holdings.of(self.node(path)).items.get(place.number)
        return None if lying is None else lying.position

    def is_present(self, path: BeliefPath) -> bool:
        """Return True if a node's owner is present in the parent node (semantics, section 5)."""
        return self.table.is_present(self.node(path))

    @property
    def count_of_events(self) -> int:
        """The number of events before the forest's position."""
        return self.columns.events_until(self.position)

    def enter(self, columns: Columns) -> None:
        """Move to the stretch of the timeline that holds the next entries."""
        self.table.enter(columns.poses)
        self.columns = columns

    def leap(self, position: int, events: int) -> None:
        """Set the position after a shortened stretch was folded; see `History._leap`.

        The forest has only node 0, which perceives all events.

        Args:
            position: Number of entries that the state now stands for.
            events: Number of events in these entries.
        """
        self._let_read()
        count = self.count_of_events
        self.perceived_events.set(0, count, np.ones(events - count, dtype=np.bool_))
        self.enter(Columns(self.context, position, events, PoseTable()))
        self.position = position

    def advance(self, stop: int) -> None:
        """Fold entries of the stretch up to number `stop` (excluded)."""
        self.table.track()
        if self.position < stop:
            self._let_read()
        while self.position < stop:
            end = self._batch_end(stop)
            reached = self._fold(self.position, end)
            self.tick = self.columns.tick(reached - 1)
            self.position = reached

    def heard(self, node: int, count: int, first: int | None = None) -> Iterator[PerceivedEvent]:
        """Yield the events that a node perceived among the first `count` ones, oldest first.

        Args:
            node: Number of the node.
            count: Number of events of the timeline to consider.
            first: Number of the first event to yield; None: yield also those that the node
                perceived before the timeline began.
        """
        if first is None:
            yield from self._events.before(self.table.path(node))
        since = first or 0
        numbers = (np.flatnonzero(self.perceived_events.of(node, count, since)) + since).tolist()
        events = self._events.events(numbers[-1] + 1) if numbers else ()
        for number in numbers:
            tick, event = events[number]
            yield PerceivedEvent(tick, event.kind, event.actor, event.detail)

    def read_by(self, reader: StateReader) -> None:
        """Call `reader.keep` before the forest changes the next time."""
        reference = ref(reader, self._forget)
        self._readers[id(reference)] = reference

    def adopt(self, other: "Forest", paths: Sequence[BeliefPath]) -> None:
        """Copy nodes of another forest of this timeline that has folded the same entries."""
        count = self.count_of_events
        self.table.track()
        other.table.track()
        for path in paths:
            source = other.node(path)
            node = self.table.copy_node(other.table, source, is_root=False, recorded=True)
            self.holdings.add(other.holdings.of(source).copy())
            self.perceived_events.set(node, 0, other.perceived_events.of(source, count))
        self.table.link()

    def skip(self, tick: int) -> None:
        """Count an entry that concerns no node of this forest."""
        self._let_read()
        self.position += 1
        self.tick = tick

    def edit(
        self, node: int, blocks: dict[int, int], contents: dict[int, Items], tick: int
    ) -> None:
        """Change a node by hand in the next entry, and let the nodes below it perceive the change.

        Args:
            node: Number of the node.
            blocks: Numbers of new blocks by cell; -1: unknown.
            contents: New contents by cell, complete.
            tick: Tick after which the change is made.
        """
        self._let_read()
        self.holdings.edit(node, blocks, contents, tick)
        self.position += 1
        self.tick = tick
        self.perceive(node)

    def _let_read(self) -> None:
        readers, self._readers = self._readers, {}
        for reference in readers.values():
            reader = reference()
            if reader is not None:
                reader.keep()

    def _forget(self, gone: "ref[StateReader]") -> None:
        self._readers.pop(id(gone), None)

    def _batch_end(self, stop: int) -> int:
        """Return the number of the entry before which the next pass of the kernel must end.

        The rules for contents and items read the arrays as they are after the very entry that they
        follow. So a pass ends with an entry with acts, and an entry with dropped items or claims is
        a pass of its own. Between these a pass may be long: nothing reads the arrays.
        """
        start = self.position
        if self.holdings.needs_looks():
            return start + 1
        columns = self.columns
        # Entries that bound a pass, and 1 if the pass may include the entry after others.
        apart = [(columns.item_entries, 0), (columns.act_entries, 1)]
        if self._weighs:
            apart.append((columns.claim_entries, 0))
        for entries, after in apart:
            number = bisect_left(entries, start)
            if number < len(entries):
                stop = min(stop, max(entries[number] + after, start + 1))
        return min(stop, start + _BATCH)

    @property
    def _weighs(self) -> bool:
        """True if claims change beliefs."""
        return self.context.options.testimony != "none"

    @property
    def _reads(self) -> bool:
        """True if there are signs on which something may be claimed that changes beliefs."""
        return self._weighs and bool(self.context.sign_cells)

    def _changes(self, events: int) -> Changes:
        # In one entry each node can change each tracked cell once; `kernel.fold` stops early if
        # less than half of these rows is free.
        room = 4 * (self.table.count * len(self.context.tracked) + 16)
        return Changes(
            np.zeros((events, self.table.count), dtype=np.bool_),
            np.zeros((room, 7), dtype=np.int32),
            np.zeros(2, dtype=np.int32),
        )

    def _pass(
        self, facts: EntryFacts, changes: Changes, span: Span, which: npt.NDArray[np.bool_]
    ) -> int:
        """Run the kernel, with room for new chunks as often as it needs it; see `kernel.fold`."""
        from beliefnest.belief import kernel

        space, poses = self.context.space, self.poses.arrays()
        while True:
            self.table.reserve()
            nodes, weighing = self.table.nodes(), self.table.weighing()
            reached = kernel.fold(
                space, poses, facts, nodes, weighing, changes, span, which, space.chunks
            )
            lacking = int(changes.used[1])
            if lacking == 0:
                return reached
            changes.used[1] = 0
            span = span._replace(entry=reached, node=lacking)

    def _fold(self, start: int, stop: int) -> int:
        """Fold entries from number `start` up to `stop` (excluded), or fewer.

        Without claims and unique items, poses and blocks do not depend on contents. So the kernel
        folds all entries at all depths first. The holdings then follow, entry by entry, from the
        rows that the kernel left and the acts that nodes perceived.

        Returns:
            Number of the first entry that was not folded.
        """
        claims = self._weighs and self.columns.has_claims(start)
        if claims or self._reads or self.context.unique:
            return self._fold_by_level(start)
        columns = self.columns
        first = columns.events_until(start)
        changes = self._changes(columns.events_until(stop) - first)
        everywhere = np.ones(self.table.count, dtype=np.bool_)
        span = Span(start - columns.first, stop - columns.first, True, start - columns.first)
        self.holdings.end_acts(everywhere)
        reached = columns.first + self._pass(columns.facts(), changes, span, everywhere)
        count = columns.events_until(reached) - first
        self.perceived_events.note(first, changes.perceived[:count])
        rows = _by_entry(changes, columns.first)
        entries = columns.with_effects(start, reached) | rows.keys()
        if self.holdings.needs_looks():
            entries.add(start)
        for entry in sorted(entries):
            acts, tick = _acts(columns, entry, changes.perceived, first), columns.tick(entry)
            self.holdings.see_root(tick)
            self.holdings.apply_frame(columns.frames.get(entry))
            self.holdings.follow(tick, tick - 1, rows.get(entry, {}), acts, everywhere)
        self.holdings.see_root(columns.tick(reached - 1))
        self.table.edited_cells.clear()
        return reached

    def _fold_by_level(self, entry: int) -> int:
        """Fold one entry level by level, all nodes of one depth before the next depth.

        Percepts of a node are computed inside its parent's state (semantics, section 5.3). Usually
        the kernel alone decides that state, so it can fold all depths before the holdings follow.
        Claims (section 8) and unique items (section 3) break this: they change blocks, poses and
        equipment after the kernel, and children must look at the result. So each level runs kernel,
        holdings and claims in turn, before the next level begins. Nodes of one level do not read
        each other, so their order is free.
        """
        columns, tick = self.columns, self.columns.tick(entry)
        first, at = columns.events_until(entry), entry - columns.first
        count = columns.events_until(entry + 1) - first
        perceived = np.zeros((count, self.table.count), dtype=np.bool_)
        events = [columns.event(first + row) for row in range(count)]
        testimony = EntryTestimony(self.table, self.holdings, tick, events, perceived)
        self.holdings.see_root(tick)
        for level in self.table.levels():
            changes = self._changes(0)._replace(perceived=perceived)
            self._pass(columns.facts(), changes, Span(at, at + 1, True, at), level)
            self.holdings.end_acts(level)
            if level[0]:
                self.holdings.apply_frame(columns.frames.get(entry))
            rows = _by_entry(changes, columns.first).get(entry, {})
            acts = _acts(columns, entry, perceived, first)
            self.holdings.follow(tick, tick - 1, rows, acts, level)
            if self._weighs:
                testimony.hear(level)
        self.perceived_events.note(first, perceived)
        self.table.edited_cells.clear()
        if self._weighs and columns.has_claims(entry):
            self.verdicts = testimony.verdicts()
        return entry + 1

    def perceive(self, node: int, first: FirstPerceptions | None = None) -> None:
        """Let the nodes below a node perceive the present state, with nothing happening.

        `first` is a cache for nodes that have perceived nothing yet; None: they have.
        """
        context, below = self.context, self.table.below(node)
        nothing, at = np.zeros(0, dtype=np.int32), np.zeros(2, dtype=np.int32)
        facts = EntryFacts(
            np.array([self.tick], dtype=np.int32),
            *(at, nothing, nothing),
            *(at, nothing, nothing),
            *(at, nothing, nothing, nothing, nothing),
        )
        edited = self.table.edited_cells
        self.holdings.end_acts(below)
        edited.difference_update([(node, cell) for node, cell in edited if below[node]])
        perceived = np.zeros((0, self.table.count), dtype=np.bool_)
        testimony = EntryTestimony(self.table, self.holdings, self.tick, (), perceived)
        by_level = bool(context.unique) or self._reads
        parts = (level & below for level in self.table.levels()) if by_level else (below,)
        for part in parts:
            nodes, weighing, changes = self.table.nodes(), self.table.weighing(), self._changes(0)
            # A cached result of another nest does not fit where numbers of signs and unique items
            # differ between nests, and where rows of chunks do.
            is_own = context.signs or by_level or context.space.chunks is not None
            if first is None or is_own or not first.keeps(nodes, weighing):
                self._pass(facts, changes, Span(0, 1, False, 0), part)
            else:
                poses = self.poses.arrays()
                first.perceive(context.space, poses, facts, nodes, weighing, changes, part)
            rows = _by_entry(changes, 0).get(0, {})
            self.holdings.follow(self.tick, self.tick, rows, {}, part)
            if self._reads:
                testimony.hear(part)


def _acts(
    columns: Columns, entry: int, perceived: npt.NDArray[np.bool_], first: int
) -> dict[int, list[Event]]:
    """Return the acts of an entry that each node perceived, by node.

    Rows of `perceived` count events from number `first` of the timeline.
    """
    acts: dict[int, list[Event]] = {}
    for number in columns.acts.get(entry, ()):
        for node in np.flatnonzero(perceived[number - first]).tolist():
            acts.setdefault(node, []).append(columns.event(number))
    return acts


def _by_entry(changes: Changes, first: int) -> dict[int, dict[int, list[Sequence[int]]]]:
    """Return rows of changes by entry and node, in order.

    Rows count entries from number `first` of the timeline.
    """
    rows: dict[int, dict[int, list[Sequence[int]]]] = {}
    for row in changes.rows[: changes.used[0]].tolist():
        rows.setdefault(first + row[0], {}).setdefault(row[1], []).append(row)
    for rows_of_node in rows.values():
        for node, each in rows_of_node.items():
            if node > 0:
                # The order of chunks must not show: a node's rows are in the order of cells.
                each.sort(key=lambda row: row[2])
    return rows
