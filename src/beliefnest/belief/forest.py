"""All nodes below one timeline, folded together: arrays for the kernel, holdings for the rest."""

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Protocol
from weakref import WeakSet

import numpy as np
import numpy.typing as npt

from beliefnest.belief import kernel
from beliefnest.belief.arrays import Changes, Facts
from beliefnest.belief.columns import Columns, cell_of
from beliefnest.belief.entries import SOURCES, Basis, PerceivedEvent, Source
from beliefnest.belief.ground import Ground
from beliefnest.belief.holdings import (
    NEVER,
    TOUCHES,
    Content,
    Holdings,
    Lying,
    follow_acts,
    learn,
    replaced_block,
    witness,
)
from beliefnest.belief.plots import Plots
from beliefnest.world.values import Event, Items

__all__ = ["Forest"]

Path = tuple[str, ...]

_BATCH = 4096
_ITEM_HEIGHT = 0.125


class Reader(Protocol):
    """Somebody who read a state and may read more of it."""

    def keep(self) -> None:
        """Read now what the forest will not know any more."""


class Forest:
    """Nodes below one timeline after the first `position` entries of its columns.

    Attributes:
        columns: The timeline's entries.
        plots: The nodes' arrays.
        holdings: The nodes' contents, possessions and dropped items.
        before: What each node perceived before the timeline began.
        position: Entries folded.
        first_vitals: Health and food of agents in node 0 as they were known at a fork.
        facts_tick: Tick at which node 0 was last seen to be as it is; None: not since a fork.
        tick: Tick of the last of them, or of the beginning.
    """

    def __init__(
        self, ground: Ground, columns: Columns, tick: int, extra: Sequence[int] = ()
    ) -> None:
        self.ground = ground
        self.columns = columns
        self.plots = Plots(ground, extra)
        self.holdings: list[Holdings] = []
        self.before: list[tuple[PerceivedEvent, ...]] = []
        self.position = 0
        self.tick = tick
        self.facts_tick: int | None = None
        self._edited: set[int] = set()
        self._doubtful: dict[tuple[int, int], int] = {}
        self.first_vitals: dict[int, tuple[float | None, float | None]] = {}
        self._looked: dict[int, int] = {}
        self._put_by_hand: set[tuple[int, int]] = set()
        self._heard = np.zeros((64, 1), dtype=np.uint8)
        self._readers: WeakSet[Reader] = WeakSet()

    def advance(self, stop: int) -> None:
        """Fold entries up to number `stop` (excluded)."""
        self.plots.track()
        if self.position < stop:
            self._let_read()
        while self.position < stop:
            end = self._batch_end(stop)
            reached = self._fold(self.position, end)
            self.tick = self.columns.tick(reached - 1)
            self.position = reached

    def heard(self, node: int, count: int) -> Iterator[PerceivedEvent]:
        """What a node perceived of the first `count` events, oldest first."""
        yield from self.before[node]
        bits = self._heard[:count, node >> 3] >> np.uint8(7 - (node & 7)) & 1
        ticks = self.columns.facts()
        for number in np.flatnonzero(bits).tolist():
            event = self.columns.events[number]
            entry = int(np.searchsorted(ticks.event_at, number, side="right")) - 1
            yield PerceivedEvent(int(ticks.tick[entry]), event.kind, event.actor, event.detail)

    def read_by(self, reader: "Reader") -> None:
        """Tell a reader before the forest goes on."""
        self._readers.add(reader)

    def last_look(self, node: int) -> int:
        """Entry after which a node's owner last perceived what there is; -1: at first."""
        return self._looked.get(node, -1)

    def block_is_current(self, node: int, cell: int) -> bool:
        """Whether a node's block is backed by a perception in the last entry (5.4)."""
        ground, nodes, poses = self.ground, self.plots.nodes(), self.ground.versions.poses()
        while node > 0:
            around = self.plots.parent(node)
            if not self.plots.is_present(node) or (node, cell) in self._put_by_hand:
                return False
            version = self.plots.version(around, self.plots.owner(node))
            if not kernel.sees_cell(
                ground.space, ground.senses, poses, nodes, around, version, cell
            ):
                return False
            node = around
        return self.plots.block(0, cell) >= 0

    def vitals(self, node: int, agent: int) -> tuple[float | None, float | None]:
        """Health and food of an agent, which only the agent itself perceives."""
        while node > 0 and self.plots.owner(node) == agent:
            node = self.plots.parent(node)
        looks = self.plots.looks_of(0, agent) if node == 0 else None
        if looks is None or self.plots.version(0, agent) < self.columns.floor:
            return self.first_vitals.get(agent, (None, None)) if node == 0 else (None, None)
        return looks.health, looks.food

    def adopt(self, other: "Forest", paths: Sequence[Path]) -> None:
        """Take over nodes of a forest that is as far on."""
        count = self.columns.events_until(self.position)
        self.plots.track()
        other.plots.track()
        for path in paths:
            source = other.plots.index[path]
            node = self.plots.copy_node(other.plots, source, is_root=False)
            self.holdings.append(other.holdings[source].copy())
            self.before.append(other.before[source])
            self._looked[node] = other.last_look(source)
            self._put_by_hand |= {(node, c) for n, c in other._put_by_hand if n == source}
            self.doubt_contents(node)
            self._widen(count)
            bits = other._heard[:count, source >> 3] >> np.uint8(7 - (source & 7)) & 1
            self._heard[:count, node >> 3] |= bits << np.uint8(7 - (node & 7))
        self.plots.link()

    def perceive_at_first(self) -> None:
        """Let all nodes but the first perceive what there is, with nothing happening."""
        self._look(self.plots.below(0))

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
        self.ground.track(c for c, s in blocks.items() if self.ground.container_name(s))
        self.ground.track(contents)
        self.plots.track()
        for cell, state in blocks.items():
            old = self.ground.container_name(self.plots.block(node, cell))
            self.plots.put(node, cell, state, basis)
            new = self.ground.container_name(state)
            if old != new:
                holdings.containers.pop(cell, None)
            if new is not None and cell not in holdings.containers:
                holdings.containers[cell] = Content({}, complete=node == 0, basis=basis)
        for cell, items in contents.items():
            holdings.containers[cell] = Content(dict(items), complete=True, basis=basis)
            self._doubt(node, cell)
        if node == 0:
            self._edited |= {*blocks, *contents}
        self._put_by_hand |= {(node, cell) for cell in blocks}
        self.position += 1
        self.tick = tick
        self._look(self.plots.below(node))

    def content(self, node: int, cell: int) -> Content:
        """A container's content in a node; in node 0 it is seen to be so all the time."""
        content = self.holdings[node].containers[cell]
        if node > 0:
            return content
        seen = self.facts_tick is not None and cell not in self._edited
        basis = Basis(self.facts_tick or 0, Source.SEEN) if seen else content.basis
        return Content(content.items, content.complete, basis, self.position - 1)

    def inventory(self, node: int, agent: int) -> tuple[Items, bool]:
        """Believed possessions of an agent, and whether these are known to be all.

        An agent's own are what the simulator around holds of them, whatever the depth.
        """
        while node > 0 and self.plots.owner(node) == agent:
            node = self.plots.parent(node)
        known = self.holdings[node].inventories.get(agent)
        if node == 0:
            version, looks = self.plots.version(0, agent), self.plots.looks_of(0, agent)
            if looks is not None and (known is None or version >= self.columns.floor):
                return looks.inventory, known is None
        return self.holdings[node].inventories.get(agent, {}), False

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
        transparent = self.ground.options.containers == "transparent"
        return transparent or bool(self._doubtful) or any(h.items for h in self.holdings)

    def _changes(self, events: int) -> Changes:
        # In one entry every node can change every tracked cell once; see `kernel.fold`.
        room = 4 * (self.plots.count * len(self.ground.tracked) + 16)
        return Changes(
            np.zeros((events, self.plots.count), dtype=np.bool_),
            np.zeros((room, 7), dtype=np.int32),
            np.zeros(1, dtype=np.int32),
        )

    def _fold(self, start: int, stop: int) -> int:
        ground, facts = self.ground, self.columns.facts()
        first = int(facts.event_at[start])
        changes = self._changes(int(facts.event_at[stop]) - first)
        poses = ground.versions.poses()
        nodes = self.plots.nodes()
        everywhere = np.ones(self.plots.count, dtype=np.bool_)
        reached = kernel.fold(
            ground.space, ground.senses, poses, facts, nodes, changes, start, stop, everywhere
        )
        count = int(facts.event_at[reached]) - first
        self._hear(first, changes.perceived[:count])
        rows = _by_entry(changes)
        entries = self.columns.with_effects(start, reached) | rows.keys()
        if self._has_things():
            entries.add(start)
        for entry in sorted(entries):
            perceived = {
                number: changes.perceived[number - first]
                for number in self.columns.acts.get(entry, ())
            }
            self.facts_tick = self.columns.tick(entry)
            self._edited.clear()
            self._looked = dict.fromkeys(range(self.plots.count), entry)
            self._happens(entry)
            self._follow(
                entry, self.columns.tick(entry), rows.get(entry, {}), perceived, everywhere
            )
        self.facts_tick = self.columns.tick(reached - 1)
        self._edited.clear()
        self._looked = dict.fromkeys(range(self.plots.count), reached - 1)
        self._put_by_hand.clear()
        return reached

    def _look(self, below: npt.NDArray[np.bool_]) -> None:
        ground, nodes = self.ground, self.plots.nodes()
        changes = self._changes(0)
        nothing = np.zeros(0, dtype=np.int32)
        at = np.zeros(2, dtype=np.int32)
        facts = Facts(
            np.array([self.tick], dtype=np.int32),
            *(at, nothing, nothing),
            *(at, nothing, nothing),
            *(at, nothing, nothing, nothing, nothing),
        )
        poses = ground.versions.poses()
        kernel.fold(ground.space, ground.senses, poses, facts, nodes, changes, 0, 1, below)
        entry = self.position - 1
        self._looked.update(dict.fromkeys(np.flatnonzero(below).tolist(), entry))
        self._put_by_hand = {(node, cell) for node, cell in self._put_by_hand if not below[node]}
        self._follow(entry, self.tick, _by_entry(changes).get(0, {}), {}, below)

    def _hear(self, first: int, perceived: npt.NDArray[np.bool_]) -> None:
        self._widen(first + len(perceived))
        packed = np.packbits(perceived, axis=1)
        self._heard[first : first + len(perceived), : packed.shape[1]] = packed

    def _widen(self, events: int) -> None:
        """Make room in `_heard` for events and for all nodes."""
        height, width = self._heard.shape
        bytes_needed = -(-self.plots.count // 8)
        if events > height or bytes_needed > width:
            size = (max(height, 2 * events if events > height else 0), max(width, bytes_needed))
            grown = np.zeros(size, dtype=np.uint8)
            grown[:height, :width] = self._heard
            self._heard = grown

    def _happens(self, entry: int) -> None:
        """Contents and dropped items of node 0 after an entry."""
        frame = self.columns.frames.get(entry)
        if frame is None:
            return
        holdings, basis = self.holdings[0], Basis(frame.tick, Source.SEEN)
        for place, items in frame.containers.items():
            cell = cell_of(self.ground.box, place)
            old = holdings.containers.pop(cell, None)
            if items is not None:
                complete = old is None or old.complete
                holdings.containers[cell] = Content(dict(items), complete, basis, entry)
        for number, item in frame.items.items():
            holdings.items.pop(number, None)
            if item is not None:
                holdings.items[number] = Lying(item, basis, entry)

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
            if self.ground.container_name(new) is None:
                self.holdings[0].containers.pop(cell, None)
            elif cell not in self.holdings[0].containers:
                basis = Basis(tick, Source.SEEN)
                self.holdings[0].containers[cell] = Content({}, True, basis, entry)
        things = self._has_things()
        for node in range(1, self.plots.count):
            for _, _, cell, old, new, observed_at, source in rows.get(node, ()):
                names = self.ground.block_name(old), self.ground.container_name(new)
                basis = Basis(observed_at, SOURCES[source])
                replaced_block(self.holdings[node], cell, *names, basis)
            acts = [self.columns.events[n] for n, heard in perceived.items() if heard[node]]
            if not which[node] or not (acts or things) or not self.plots.is_present(node):
                continue
            self._forget(node)
            into = self._see_into(node, tick, entry)
            if acts:
                self._follow_acts(node, acts, into, tick, entry)
            self._see_items(node, self.plots.parent(node), tick, entry)

    def _follow_acts(
        self, node: int, acts: list[Event], into: set[int], tick: int, entry: int
    ) -> None:
        """What perceived acts do to a node that sees into the containers of `into` anyway."""
        holdings, owner = self.holdings[node], self.ground.agents[self.plots.owner(node)]
        around = self.plots.parent(node)
        box, there = self.ground.box, self.holdings[around].containers
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
            number = self.ground.numbers[str(name)]
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
        state = self.plots.block(node, cell)
        if node > 0 and cell in self.holdings[node].containers and not self.ground.holds[state]:
            self._doubtful[node, cell] = state

    def _forget(self, node: int) -> None:
        """Forget contents at places that are seen to hold no container."""
        for (doubter, cell), before in list(self._doubtful.items()):
            if doubter != node:
                continue
            state = self.plots.block(node, cell)
            around = self.plots.block(self.plots.parent(node), cell)
            if self.ground.holds[state] or cell not in self.holdings[node].containers:
                del self._doubtful[node, cell]
            elif self._is_gone(node, cell) or (
                before < 0
                and around >= 0
                and not self.ground.holds[around]
                and self._sees_cell(node, cell)
            ):
                del self.holdings[node].containers[cell]
                del self._doubtful[node, cell]
            else:
                self._doubtful[node, cell] = state

    def _is_gone(self, node: int, cell: int) -> bool:
        """Whether the owner of a node perceives now that a cell holds no container."""
        around = self.plots.parent(node)
        state = self.plots.block(around, cell)
        return (
            state >= 0
            and not self.ground.holds[state]
            and self._sees_cell(node, cell)
            and self.block_is_current(around, cell)
        )

    def _sees_cell(self, node: int, cell: int) -> bool:
        """Whether the present owner of a node sees a cell of the simulator around."""
        return bool(self._seen_cells(node, (cell,)))

    def _seen_cells(self, node: int, cells: Iterable[int]) -> set[int]:
        """Those of some cells that the present owner of a node sees in the simulator around."""
        ground, around = self.ground, self.plots.parent(node)
        version = self.plots.version(around, self.plots.owner(node))
        nodes, poses = self.plots.nodes(), ground.versions.poses()
        wanted = np.array([*cells], dtype=np.int64)
        seen = kernel.sees_cells(ground.space, ground.senses, poses, nodes, around, version, wanted)
        return set(wanted[seen].tolist())

    def _see_into(self, node: int, tick: int, entry: int) -> set[int]:
        """Look into transparent containers; returns the cells looked into."""
        if self.ground.options.containers != "transparent":
            return set()
        around = self.plots.parent(node)
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
            number: Lying(lying.item, Basis(tick, Source.SEEN), entry) if around == 0 else lying
            for number, lying in self.holdings[around].items.items()
        }
        seen = {n: lying for n, lying in there.items() if self._sees_item(node, around, lying)}
        for number in [n for n in known if n not in seen]:
            if self._sees_item(node, around, known[number]):
                del known[number]
        known.update(seen)

    def _sees_item(self, node: int, around: int, lying: Lying) -> bool:
        ground = self.ground
        x, y, z = lying.item.position
        version = self.plots.version(around, self.plots.owner(node))
        nodes, poses = self.plots.nodes(), ground.versions.poses()
        place = (x, y + _ITEM_HEIGHT, z)
        return kernel.sees_point(ground.space, ground.senses, poses, nodes, around, version, place)


def _by_entry(changes: Changes) -> dict[int, dict[int, list[Sequence[int]]]]:
    """Rows of changes by entry and node, in order."""
    rows: dict[int, dict[int, list[Sequence[int]]]] = {}
    for row in changes.rows[: changes.used[0]].tolist():
        rows.setdefault(row[0], {}).setdefault(row[1], []).append(row)
    return rows
