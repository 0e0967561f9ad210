"""All nodes below one timeline, folded together: arrays for the kernel, holdings for the rest."""

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from weakref import WeakSet

import numpy as np
import numpy.typing as npt

from beliefnest.belief import kernel
from beliefnest.belief.arrays import Changes, Facts
from beliefnest.belief.columns import Columns, cell_of
from beliefnest.belief.context import BeliefContext
from beliefnest.belief.entries import SOURCES, Basis, PerceivedEvent, Source
from beliefnest.belief.hearing import Hearing
from beliefnest.belief.holdings import (
    NEVER,
    TOUCHES,
    BelievedItem,
    Content,
    Holdings,
    follow_acts,
    learn,
    replaced_block,
    witness,
)
from beliefnest.belief.node_table import NodeTable
from beliefnest.belief.poses import PoseTable
from beliefnest.belief.protocols import EventHistory, Reader
from beliefnest.world.values import Event, Items

__all__ = ["Forest"]

Path = tuple[str, ...]

_BATCH = 4096
_ITEM_HEIGHT = 0.125


class Forest:
    """Nodes below one timeline after its first `position` entries.

    Attributes:
        columns: The stretch of the timeline that it is in.
        table: The nodes' arrays.
        holdings: The nodes' contents, possessions and dropped items.
        position: Entries folded.
        first_vitals: Health and food of agents in node 0 as they were known at a fork.
        facts_tick: Tick at which node 0 was last seen to be as it is; None: not since a fork.
        tick: Tick of the last of them, or of the beginning.
        hearing: Who perceived which event.
        looked: By node, the entry after which its owner last perceived what there is.
        edited_facts: Cells of node 0 that were changed by hand since the last frame.
        edited_cells: Nodes and cells of blocks that were, since somebody last looked there.
        doubtful: Nodes and cells of contents where no container is known, with the block there.
    """

    def __init__(
        self, context: BeliefContext, events: EventHistory, tick: int, extra: Sequence[int] = ()
    ) -> None:
        self.context, self._events = context, events
        self.columns = self._nowhere(0, 0)
        self.table = NodeTable(context, self.columns.poses, extra)
        self.holdings: list[Holdings] = []
        self.position, self.tick = 0, tick
        self.facts_tick: int | None = None
        self.edited_facts: set[int] = set()
        self.doubtful: dict[tuple[int, int], int] = {}
        self.first_vitals: dict[int, tuple[float | None, float | None]] = {}
        self.looked: dict[int, int] = {}
        self.edited_cells: set[tuple[int, int]] = set()
        self.hearing = Hearing()
        self._readers: WeakSet[Reader] = WeakSet()

    @property
    def poses(self) -> PoseTable:
        """The poses that nodes refer to."""
        return self.table.poses

    @property
    def count_of_events(self) -> int:
        """How many events lie before the forest's position."""
        return self.columns.events_until(self.position)

    def enter(self, columns: Columns) -> None:
        """Go over to the stretch of the timeline that the next entries lie in."""
        self.table.enter(columns.poses)
        self.columns = columns

    def leave(self) -> None:
        """Leave the stretch, and keep of its poses only what nodes refer to."""
        self.enter(self._nowhere(self.position, self.count_of_events))

    def leap(self, position: int, events: int) -> None:
        """Take what was folded for the first `position` entries, which have `events` events.

        There is no node but node 0, which perceives all of them.
        """
        self._let_read()
        count = self.count_of_events
        self.hearing.set(0, count, np.ones(events - count, dtype=np.bool_))
        self.enter(self._nowhere(position, events))
        self.position = position
        self.looked = {0: position - 1}

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

    def heard(self, node: int, count: int) -> Iterator[PerceivedEvent]:
        """What a node perceived of the first `count` events, oldest first."""
        yield from self._events.before(self.table.path(node))
        numbers = np.flatnonzero(self.hearing.of(node, count)).tolist()
        events = self._events.events(numbers[-1] + 1) if numbers else ()
        for number in numbers:
            tick, event = events[number]
            yield PerceivedEvent(tick, event.kind, event.actor, event.detail)

    def read_by(self, reader: Reader) -> None:
        """Tell a reader before the forest goes on."""
        self._readers.add(reader)

    def last_look(self, node: int) -> int:
        """Entry after which a node's owner last perceived what there is; -1: at first."""
        return self.looked.get(node, -1)

    def block_is_current(self, node: int, cell: int) -> bool:
        """Whether a node's block is backed by a perception in the last entry (5.4)."""
        while node > 0:
            if not self.table.is_present(node) or (node, cell) in self.edited_cells:
                return False
            if not self._sees_cell(node, cell):
                return False
            node = self.table.parent(node)
        return self.table.block(0, cell) >= 0

    def vitals(self, node: int, agent: int) -> tuple[float | None, float | None]:
        """Health and food of an agent, which only the agent itself perceives."""
        while node > 0 and self.table.owner(node) == agent:
            node = self.table.parent(node)
        condition = self.table.condition_of(0, agent) if node == 0 else None
        if condition is None or not self.poses.is_recorded(self.table.pose(0, agent)):
            return self.first_vitals.get(agent, (None, None)) if node == 0 else (None, None)
        return condition.health, condition.food

    def adopt(self, other: "Forest", paths: Sequence[Path]) -> None:
        """Take over nodes of a forest that is as far on."""
        count = self.count_of_events
        self.table.track()
        other.table.track()
        for path in paths:
            source = other.table.index[path]
            node = self.table.copy_node(other.table, source, is_root=False, recorded=True)
            self.holdings.append(other.holdings[source].copy())
            self.looked[node] = other.last_look(source)
            self.edited_cells |= {(node, c) for n, c in other.edited_cells if n == source}
            self.doubt_contents(node)
            self.hearing.set(node, 0, other.hearing.of(source, count))
        self.table.link()

    def perceive_at_first(self) -> None:
        """Let all nodes but the first perceive what there is, with nothing happening."""
        self._look(self.table.below(0))

    def skip(self, tick: int) -> None:
        """Let an entry pass that is about no node of this forest."""
        self._let_read()
        self.position += 1
        self.tick = tick

    def edit(
        self, node: int, blocks: dict[int, int], contents: dict[int, Items], tick: int
    ) -> None:
        """Change a node by hand, in the entry that comes next; those below it perceive it.

        Args:
            node: Which.
            blocks: New block states by cell; -1: unknown.
            contents: New contents by cell, complete.
            tick: Tick after which it is done.
        """
        self._let_read()
        holdings, basis = self.holdings[node], Basis(tick, Source.EDITED)
        self.context.track(c for c, s in blocks.items() if self.context.container_name(s))
        self.context.track(contents)
        self.table.track()
        for cell, state in blocks.items():
            old = self.context.container_name(self.table.block(node, cell))
            self.table.put(node, cell, state, basis)
            new = self.context.container_name(state)
            if old != new:
                holdings.containers.pop(cell, None)
            if new is not None and cell not in holdings.containers:
                holdings.containers[cell] = Content({}, complete=node == 0, basis=basis)
        for cell, items in contents.items():
            holdings.containers[cell] = Content(dict(items), complete=True, basis=basis)
            self._doubt(node, cell)
        if node == 0:
            self.edited_facts |= {*blocks, *contents}
        self.edited_cells |= {(node, cell) for cell in blocks}
        self.position += 1
        self.tick = tick
        self._look(self.table.below(node))

    def content(self, node: int, cell: int) -> Content:
        """A container's content in a node; in node 0 it is seen to be so all the time."""
        content = self.holdings[node].containers[cell]
        if node > 0:
            return content
        seen = self.facts_tick is not None and cell not in self.edited_facts
        basis = Basis(self.facts_tick or 0, Source.SEEN) if seen else content.basis
        return Content(content.items, content.complete, basis, self.position - 1)

    def inventory(self, node: int, agent: int) -> tuple[Items, bool]:
        """Believed possessions of an agent, and whether these are known to be all.

        An agent's own are what the simulator around holds of them, whatever the depth.
        """
        while node > 0 and self.table.owner(node) == agent:
            node = self.table.parent(node)
        known = self.holdings[node].inventories.get(agent)
        if node == 0:
            pose, condition = self.table.pose(0, agent), self.table.condition_of(0, agent)
            if condition is not None and (known is None or self.poses.is_recorded(pose)):
                return condition.inventory, known is None
        return self.holdings[node].inventories.get(agent, {}), False

    def _nowhere(self, position: int, events: int) -> Columns:
        """An empty stretch, for who waits in between."""
        context = self.context
        return Columns(context.box, context.agents, context.holds, position, events)

    def _let_read(self) -> None:
        readers, self._readers = list(self._readers), WeakSet()
        for reader in readers:
            reader.keep()

    def _batch_end(self, stop: int) -> int:
        """Where the next pass of the kernel has to end, for effects to keep up with it."""
        start = self.position
        if self._has_things():
            return start + 1
        # Effects of deeds and items look at the arrays as they are after the very entry.
        for entries, after in ((self.columns.item_entries, 0), (self.columns.act_entries, 1)):
            number = bisect_left(entries, start)
            if number < len(entries):
                stop = min(stop, max(entries[number] + after, start + 1))
        return min(stop, start + _BATCH)

    def _has_things(self) -> bool:
        """Whether there is something to be looked at that is no block and no agent."""
        transparent = self.context.options.containers == "transparent"
        return transparent or bool(self.doubtful) or any(h.items for h in self.holdings)

    def _changes(self, events: int) -> Changes:
        # In one entry every node can change every tracked cell once; see `kernel.fold`.
        room = 4 * (self.table.count * len(self.context.tracked) + 16)
        return Changes(
            np.zeros((events, self.table.count), dtype=np.bool_),
            np.zeros((room, 7), dtype=np.int32),
            np.zeros(1, dtype=np.int32),
        )

    def _fold(self, start: int, stop: int) -> int:
        context, columns, facts = self.context, self.columns, self.columns.facts()
        first = columns.events_until(start)
        changes = self._changes(columns.events_until(stop) - first)
        poses, nodes = self.poses.arrays(), self.table.nodes()
        everywhere = np.ones(self.table.count, dtype=np.bool_)
        where = start - columns.first, stop - columns.first
        reached = columns.first + kernel.fold(
            context.space, poses, facts, nodes, changes, *where, everywhere
        )
        count = columns.events_until(reached) - first
        self.hearing.note(first, changes.perceived[:count])
        rows = _by_entry(changes, columns.first)
        entries = self.columns.with_effects(start, reached) | rows.keys()
        if self._has_things():
            entries.add(start)
        for entry in sorted(entries):
            perceived = {
                number: changes.perceived[number - first]
                for number in self.columns.acts.get(entry, ())
            }
            self.facts_tick = self.columns.tick(entry)
            self.edited_facts.clear()
            self.looked = dict.fromkeys(range(self.table.count), entry)
            self._happens(entry)
            self._follow(
                entry, self.columns.tick(entry), rows.get(entry, {}), perceived, everywhere
            )
        self.facts_tick = self.columns.tick(reached - 1)
        self.edited_facts.clear()
        self.looked = dict.fromkeys(range(self.table.count), reached - 1)
        self.edited_cells.clear()
        return reached

    def _look(self, below: npt.NDArray[np.bool_]) -> None:
        context, nodes = self.context, self.table.nodes()
        changes = self._changes(0)
        nothing, at = np.zeros(0, dtype=np.int32), np.zeros(2, dtype=np.int32)
        facts = Facts(
            np.array([self.tick], dtype=np.int32),
            *(at, nothing, nothing),
            *(at, nothing, nothing),
            *(at, nothing, nothing, nothing, nothing),
        )
        poses = self.poses.arrays()
        kernel.fold(context.space, poses, facts, nodes, changes, 0, 1, below)
        entry = self.position - 1
        self.looked.update(dict.fromkeys(np.flatnonzero(below).tolist(), entry))
        self.edited_cells = {(node, cell) for node, cell in self.edited_cells if not below[node]}
        self._follow(entry, self.tick, _by_entry(changes, 0).get(0, {}), {}, below)

    def _happens(self, entry: int) -> None:
        """Contents and dropped items of node 0 after an entry."""
        frame = self.columns.frames.get(entry)
        if frame is None:
            return
        holdings, basis = self.holdings[0], Basis(frame.tick, Source.SEEN)
        for place, items in frame.containers.items():
            cell = cell_of(self.context.box, place)
            old = holdings.containers.pop(cell, None)
            if items is not None:
                complete = old is None or old.complete
                holdings.containers[cell] = Content(dict(items), complete, basis, entry)
        for number, item in frame.items.items():
            holdings.items.pop(number, None)
            if item is not None:
                holdings.items[number] = BelievedItem(item, basis, entry)

    def _follow(
        self,
        entry: int,
        tick: int,
        rows: dict[int, list[Sequence[int]]],
        perceived: dict[int, npt.NDArray[np.bool_]],
        which: npt.NDArray[np.bool_],
    ) -> None:
        """What an entry does to contents and possessions, after `_happens`."""
        for _, _, cell, _, new, _, _ in rows.get(0, ()):
            if self.context.container_name(new) is None:
                self.holdings[0].containers.pop(cell, None)
            elif cell not in self.holdings[0].containers:
                basis = Basis(tick, Source.SEEN)
                self.holdings[0].containers[cell] = Content({}, True, basis, entry)
        things = self._has_things()
        for node in range(1, self.table.count):
            for _, _, cell, old, new, observed_at, source in rows.get(node, ()):
                names = self.context.block_name(old), self.context.container_name(new)
                basis = Basis(observed_at, SOURCES[source])
                replaced_block(self.holdings[node], cell, *names, basis)
            acts = [self.columns.event(n) for n, heard in perceived.items() if heard[node]]
            if not which[node] or not (acts or things) or not self.table.is_present(node):
                continue
            self._forget(node)
            into = self._see_into(node, tick, entry)
            if acts:
                self._follow_acts(node, acts, into, tick, entry)
            self._see_items(node, self.table.parent(node), tick, entry)

    def _follow_acts(
        self, node: int, acts: list[Event], into: set[int], tick: int, entry: int
    ) -> None:
        """What perceived acts do to a node that sees into the containers of `into` anyway."""
        holdings, owner = self.holdings[node], self.context.agents[self.table.owner(node)]
        around = self.table.parent(node)
        box, there = self.context.box, self.holdings[around].containers
        touched = [(cell_of(box, a.detail["position"]), a) for a in acts if a.kind in TOUCHES]
        own = {cell for cell, act in touched if act.actor == owner and cell in there}
        for cell, act in touched:
            if cell not in own | into and not self._is_gone(node, cell):
                witness(holdings, cell, act, tick, entry)
                self._doubt(node, cell)
        for cell, act in touched:
            if cell in own and act.actor == owner:
                content = self._there(around, cell, entry)
                # What the simulator around holds by hearsay of its own is no perception now.
                kind = act.kind if content.entry == entry else None
                learn(holdings, cell, content, kind, tick)
                self._doubt(node, cell)
        for name in {act.actor for act in acts if act.actor not in (None, owner)}:
            number = self.context.numbers[str(name)]
            before = holdings.inventories.get(number, {})
            after = follow_acts(before, (act for act in acts if act.actor == name))
            if after is not before:
                holdings.inventories[number] = after

    def doubt_contents(self, node: int) -> None:
        """Note contents of a new node that lie where it knows no container."""
        for cell in self.holdings[node].containers:
            self._doubt(node, cell)

    def _doubt(self, node: int, cell: int) -> None:
        """Note a content at a place where a node knows no container."""
        state = self.table.block(node, cell)
        if node > 0 and cell in self.holdings[node].containers and not self.context.holds[state]:
            self.doubtful[node, cell] = state

    def _forget(self, node: int) -> None:
        """Forget contents at places that are seen to hold no container."""
        for (doubter, cell), before in list(self.doubtful.items()):
            if doubter != node:
                continue
            state = self.table.block(node, cell)
            around = self.table.block(self.table.parent(node), cell)
            if self.context.holds[state] or cell not in self.holdings[node].containers:
                del self.doubtful[node, cell]
            elif self._is_gone(node, cell) or (
                before < 0
                and around >= 0
                and not self.context.holds[around]
                and self._sees_cell(node, cell)
            ):
                del self.holdings[node].containers[cell]
                del self.doubtful[node, cell]
            else:
                self.doubtful[node, cell] = state

    def _is_gone(self, node: int, cell: int) -> bool:
        """Whether the owner of a node perceives now that a cell holds no container."""
        around = self.table.parent(node)
        state = self.table.block(around, cell)
        return (
            state >= 0
            and not self.context.holds[state]
            and self._sees_cell(node, cell)
            and self.block_is_current(around, cell)
        )

    def _sees_cell(self, node: int, cell: int) -> bool:
        """Whether the present owner of a node sees a cell of the simulator around."""
        return bool(self._seen_cells(node, (cell,)))

    def _seen_cells(self, node: int, cells: Iterable[int]) -> set[int]:
        """Those of some cells that the present owner of a node sees in the simulator around."""
        context, around = self.context, self.table.parent(node)
        pose = self.table.pose(around, self.table.owner(node))
        nodes, poses = self.table.nodes(), self.poses.arrays()
        wanted = np.array([*cells], dtype=np.int64)
        seen = kernel.sees_cells(context.space, poses, nodes, around, pose, wanted)
        return set(wanted[seen].tolist())

    def _see_into(self, node: int, tick: int, entry: int) -> set[int]:
        """Look into transparent containers; returns the cells looked into."""
        if self.context.options.containers != "transparent":
            return set()
        around = self.table.parent(node)
        into = self._seen_cells(node, self.holdings[around].containers)
        for cell in into:
            learn(self.holdings[node], cell, self._there(around, cell, entry), None, tick)
            self._doubt(node, cell)
        return into

    def _there(self, node: int, cell: int, entry: int) -> Content:
        """Content of a container around somebody who learns it in an entry (5.4)."""
        content = self.content(node, cell)
        is_current = node == 0 or content.entry == self.last_look(node)
        return replace(content, entry=entry if is_current else NEVER)

    def _see_items(self, node: int, around: int, tick: int, entry: int) -> None:
        """Seen items are taken over; one whose believed place is seen empty is dropped."""
        known = self.holdings[node].items
        if not known and not self.holdings[around].items:
            return
        there = {
            number: BelievedItem(believed.item, Basis(tick, Source.SEEN), entry)
            if around == 0
            else believed
            for number, believed in self.holdings[around].items.items()
        }
        seen = {
            n: believed for n, believed in there.items() if self._sees_item(node, around, believed)
        }
        for number in [n for n in known if n not in seen]:
            if self._sees_item(node, around, known[number]):
                del known[number]
        known.update(seen)

    def _sees_item(self, node: int, around: int, believed: BelievedItem) -> bool:
        context = self.context
        x, y, z = believed.item.position
        pose = self.table.pose(around, self.table.owner(node))
        nodes, poses = self.table.nodes(), self.poses.arrays()
        place = (x, y + _ITEM_HEIGHT, z)
        return kernel.sees_point(context.space, poses, nodes, around, pose, place)


def _by_entry(changes: Changes, first: int) -> dict[int, dict[int, list[Sequence[int]]]]:
    """Rows of changes by entry and node, in order, the pass having counted from `first`."""
    rows: dict[int, dict[int, list[Sequence[int]]]] = {}
    for row in changes.rows[: changes.used[0]].tolist():
        rows.setdefault(first + row[0], {}).setdefault(row[1], []).append(row)
    return rows
