"""Contents, possessions and dropped items of all nodes of a forest, entry by entry.

When the kernel has folded poses and blocks of an entry, this module applies the consequences of
changed blocks, of frames and of perceived acts, shallower nodes first. `holdings` has the rules for
one node.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, field

import msgspec
import numpy as np
import numpy.typing as npt
from msgspec.structs import replace

from beliefnest.belief.arrays import UNKNOWN
from beliefnest.belief.columns import cell_of, place_of
from beliefnest.belief.context import SavedWriting
from beliefnest.belief.grounds import Basis, Source
from beliefnest.belief.holdings import (
    Content,
    Holdings,
    Sole,
    Whereabouts,
    follow_acts,
    replaced_block,
    witness,
)
from beliefnest.belief.node_table import NodeTable
from beliefnest.perception.percept import middle_of
from beliefnest.world.double_chests import left_half_of, other_half
from beliefnest.world.event_kinds import AT_CONTAINERS
from beliefnest.world.frames import Frame
from beliefnest.world.values import DroppedItem, Event, Items, Position

Vitals = tuple[float | None, float | None]


@dataclass(slots=True)
class RootFacts:
    """Facts about node 0 that are not in its holdings.

    Attributes:
        seen_at: Tick up to which the state of node 0 is confirmed; None: not yet since a fork.
        edited: Cells changed by hand since the last frame.
        vitals: Health and food of agents as they were known at a fork.
    """

    seen_at: int | None = None
    edited: set[int] = field(default_factory=set)
    vitals: dict[int, Vitals] = field(default_factory=dict)

    def copy(self) -> "RootFacts":
        """Return an independent copy."""
        return RootFacts(self.seen_at, set(self.edited), dict(self.vitals))


class SavedHoldings(msgspec.Struct, frozen=True):
    """Holdings of one node as plain data.

    Attributes:
        holdings: Contents, possessions and dropped items.
        doubtful: Blocks by cell, for cells with contents where the node knows no container.
    """

    holdings: Holdings
    doubtful: dict[int, int]


class HoldingsTable:
    """Contents, possessions and dropped items of all nodes.

    Attributes:
        root: Facts about node 0 that are not in its holdings.
    """

    def __init__(self, table: NodeTable, root: RootFacts) -> None:
        self.root = root
        self._table, self._context = table, table.context
        self._holdings: list[Holdings] = []
        # By node below node 0, cells whose contents are seen, and cells whose contents an act of
        # the last entry showed.
        self._in_sight: dict[int, set[int]] = {}
        self._shown_by_acts: dict[int, set[int]] = {}
        # For this entry: pairs of node and cell where the owner looked into a container, and
        # triples of node, cell and item where it saw the item go in or out.
        self._looked_into: set[tuple[int, int]] = set()
        self._seen_moved: set[tuple[int, int, str]] = set()
        # For this entry: places where the owner perceived a unique item, by node and item.
        self._found_now: dict[tuple[int, str], Collection[Whereabouts]] = {}
        # By node, blocks of the cells with contents where the node knows no container. Such
        # contents come from priors, claims and edits, and are dropped once the cell is seen to hold
        # no container.
        self._doubtful: dict[int, dict[int, int]] = {}

    def add(self, holdings: Holdings) -> None:
        """Add holdings for the node that was added to the node table last."""
        node = self._append(holdings)
        for cell in holdings.containers:
            self.doubt(node, cell)

    def of(self, node: int) -> Holdings:
        """Return the holdings of a node."""
        return self._holdings[node]

    def saved(self, node: int) -> SavedHoldings:
        """Return the holdings of a node as plain data."""
        doubtful = dict(sorted(self._doubtful.get(node, {}).items()))
        return SavedHoldings(self._holdings[node], doubtful)

    def restore(self, saved: SavedHoldings, signs: Sequence[SavedWriting]) -> None:
        """Add saved holdings. `signs` were the written signs then, in order of their numbers."""
        node = self._append(saved.holdings)
        if saved.doubtful:
            blocks = np.array([*saved.doubtful.values()], dtype=np.int16)
            numbers = self._context.renumbered(blocks, signs).tolist()
            self._doubtful[node] = dict(zip(saved.doubtful, numbers, strict=True))

    def content(self, node: int, cell: int) -> Content:
        """Return a container's content in a node; in node 0 it is always in sight."""
        content = self._holdings[node].containers[cell]
        if node > 0:
            return content
        seen = self.root.seen_at is not None and cell not in self.root.edited
        basis = Basis(self.root.seen_at or 0, Source.SEEN) if seen else content.basis
        return Content(content.items, content.complete, basis, in_sight=True)

    def inventory(self, node: int, agent: int) -> tuple[Items, bool]:
        """Return believed possessions of an agent, and True if they are known to be complete."""
        node = self._knowing(node, agent)
        inventory = self._holdings[node].inventories.get(agent)
        if node == 0:
            pose, details = self._table.pose(0, agent), self._table.details_of(0, agent)
            if details is not None and (inventory is None or self._table.poses.is_recorded(pose)):
                return details.inventory, inventory is None
        return self._holdings[node].inventories.get(agent, {}), False

    def vitals(self, node: int, agent: int) -> Vitals:
        """Return health and food of an agent, which only the agent itself perceives."""
        node = self._knowing(node, agent)
        details = self._table.details_of(0, agent) if node == 0 else None
        if details is None or not self._table.poses.is_recorded(self._table.pose(0, agent)):
            return self.root.vitals.get(agent, (None, None)) if node == 0 else (None, None)
        return details.health, details.food

    def _knowing(self, node: int, agent: int) -> int:
        """Return the node that holds the possessions of an agent.

        An agent knows its own possessions, so its own node defers to the parent at any depth.
        """
        while node > 0 and self._table.owner(node) == agent:
            node = self._table.parent(node)
        return node

    def needs_looks(self) -> bool:
        """Return True if owners have to look at more than blocks and agents in every entry.

        That is so with transparent containers, unique items, doubtful contents or dropped items.
        """
        transparent = self._context.options.containers == "transparent"
        if self._context.unique:
            return True
        return transparent or bool(self._doubtful) or any(h.items for h in self._holdings)

    def perceives(self, node: int, cell: int, item: str) -> bool:
        """Return True if the owner perceives in this entry whether an item is in a container."""
        content = self._holdings[node].containers.get(cell)
        if content is not None and content.current and (content.complete or item in content.items):
            return True
        return (node, cell) in self._looked_into or (node, cell, item) in self._seen_moved

    def perceives_elsewhere(self, node: int, cell: int, item: str) -> bool:
        """Return True if the owner perceives in this entry that an item is in another place."""
        if item in self._context.unique:
            here = Whereabouts("container", cell)
            if any(place != here for place in self._found_now.get((node, item), ())):
                return True
            if item in self._own(node):
                return True
        for at, content in self._holdings[node].containers.items():
            if item in content.items and at != cell and self.perceives(node, at, item):
                return True
        return False

    def end_acts(self, which: npt.NDArray[np.bool_]) -> None:
        """End the currency of contents that acts showed in the last entry.

        Args:
            which: bool (N,), nodes to update.
        """
        for node in [node for node in self._shown_by_acts if which[node]]:
            containers = self._holdings[node].containers
            for cell in self._shown_by_acts.pop(node) & containers.keys():
                containers[cell] = replace(containers[cell], by_act=False)

    def _lose_sight(self, node: int, seen: Set[int], last: int) -> None:
        """Date contents that were in sight and are not among those `seen` now to tick `last`."""
        containers, in_sight = self._holdings[node].containers, self._in_sight.get(node, set())
        for cell in (in_sight - seen) & containers.keys():
            if containers[cell].in_sight:
                containers[cell] = replace(containers[cell].at(last), in_sight=False)
        in_sight &= seen
        if not in_sight:
            self._in_sight.pop(node, None)

    def see_root(self, tick: int) -> None:
        """Confirm the state of node 0 for a tick, and forget the percepts of the last entry."""
        self.root.seen_at = tick
        self.root.edited.clear()
        self._looked_into.clear()
        self._seen_moved.clear()
        self._found_now.clear()

    def apply_frame(self, frame: Frame | None) -> None:
        """Set contents and dropped items of node 0 from a frame."""
        if frame is not None:
            self._holdings[0].take(frame, self._context.box)

    def follow(
        self,
        tick: int,
        last: int,
        rows: dict[int, list[Sequence[int]]],
        acts: Mapping[int, list[Event]],
        which: npt.NDArray[np.bool_],
    ) -> None:
        """Apply the effects of an entry on contents, possessions and items, after `apply_frame`.

        Nodes are updated in rising order, so parents come first: an owner that looks into a
        container learns the content that its parent holds after this entry.

        Args:
            tick: Tick of the entry.
            last: Last tick at which lost sights were still current: the one before `tick`, or
                `tick` itself if nothing happens.
            rows: Changes of blocks by node, as in `arrays.Changes`.
            acts: Perceived acts by node.
            which: bool (N,), nodes to update.
        """
        for _, _, cell, _, new, _, _ in rows.get(0, ()):
            self._holdings[0].take_block(cell, self._context.container_name(new), tick)
        looking = self._looking(acts, which)
        seeing = {node for node in self._in_sight if which[node]}
        for node in sorted(looking | rows.keys() | seeing):
            if node == 0:
                continue
            for _, _, cell, old, new, observed_at, source in rows.get(node, ()):
                names = self._context.block_name(old), self._context.container_name(new)
                basis = self._context.basis(observed_at, source)
                replaced_block(self._holdings[node], cell, *names, basis)
                before, after = (self._right_half(state, cell) for state in (old, new))
                self._follow_half(node, before, after, basis)
            if node not in looking:
                self._lose_sight(node, set(), last)
                continue
            perceived = acts.get(node, [])
            self._forget(node)
            moved = [item for item in self._context.unique if self._is_moved(item, perceived)]
            for item in moved:
                self._lose(node, item, perceived, tick)
            into = self._see_into(node, tick)
            self._lose_sight(node, into, last)
            if perceived:
                self._follow_acts(node, perceived, into, tick)
            self._see_items(node)
            for item in self._context.unique:
                self._find(node, item, tick, is_moved=item in moved)

    def _right_half(self, state: int, cell: int) -> int | None:
        """Return the cell of the chest to which a left half at a cell belongs; None: it is none."""
        context = self._context
        if context.holds[state] or not context.shows[state]:
            return None
        other = other_half(context.registry, state, place_of(context.box, cell))
        return (
            None if other is None or other[0] not in context.box else cell_of(context.box, other[0])
        )

    def _follow_half(self, node: int, before: int | None, after: int | None, basis: Basis) -> None:
        """Let a node that learns the left half of a chest hold the chest, unless it knows better.

        Args:
            node: Number of the node.
            before: Cell of the chest to which the left half at a cell belonged; None: none did.
            after: The same for the block that is there now.
            basis: Ground of the new block.
        """
        holdings = self._holdings[node]
        for cell in {before, after} if before != after else ():
            if cell is None or self._table.block(node, cell) >= 0:
                continue
            if cell == before:
                holdings.drop(cell)
            elif cell not in holdings.containers:
                holdings.containers[cell] = Content({}, complete=False, basis=basis)
                self.doubt(node, cell)

    def _looking(self, acts: Mapping[int, list[Event]], which: npt.NDArray[np.bool_]) -> set[int]:
        """Return the nodes whose present owners have acts or things to look at."""
        present = which & self._table.present()
        if self.needs_looks():
            return set(np.flatnonzero(present).tolist())
        return {node for node in acts if present[node]}

    def edit(
        self, node: int, blocks: Mapping[int, int], contents: Mapping[int, Items], tick: int
    ) -> None:
        """Change blocks and contents of a node by hand; see `Forest.edit`."""
        holdings, basis = self._holdings[node], Basis(tick, Source.EDITED)
        self._context.track(c for c, s in blocks.items() if self._context.container_name(s))
        self._context.track(contents)
        self._table.track()
        for cell, state in blocks.items():
            old = self._context.container_name(self._table.block(node, cell))
            self._table.put(node, cell, state, basis)
            new = self._context.container_name(state)
            if old != new:
                holdings.drop(cell)
            if new is not None and cell not in holdings.containers:
                holdings.containers[cell] = Content({}, complete=node == 0, basis=basis)
        for cell, items in contents.items():
            holdings.containers[cell] = Content(dict(items), complete=True, basis=basis)
            self.doubt(node, cell)
            for item in items if node > 0 else ():
                self.believe_only(node, item, cell, basis)
        if node == 0:
            self.root.edited |= {*blocks, *contents}

    def _follow_acts(self, node: int, acts: list[Event], into: set[int], tick: int) -> None:
        """Apply perceived acts to a node.

        The visible part of other agents' acts changes contents (`witness`). The exceptions are
        cells of `into`, where the owner sees the result anyway, and containers that the owner used
        itself: it learns what the parent holds there after all acts of the tick (section 4).
        """
        holdings, owner = self._holdings[node], self._context.agents[self._table.owner(node)]
        parent = self._table.parent(node)
        box, containers = self._context.box, self._holdings[parent].containers
        touched = [(cell_of(box, a.detail["position"]), a) for a in acts if a.kind in AT_CONTAINERS]
        own = {cell for cell, act in touched if act.actor == owner and cell in containers}
        for cell, act in touched:
            if cell not in own | into and not self.sees_no_container(node, cell):
                witness(holdings, cell, act, tick)
                moved = act.detail["items"] if act.kind.traits.stores else ()
                self._seen_moved.update((node, cell, item) for item in moved)
                self._note(node, cell)
        for cell, act in touched:
            if cell in own and act.actor == owner:
                content = self.content(parent, cell)
                if content.current:
                    basis = Basis(tick, Source.WITNESSED, act.kind)
                    is_seen = content.in_sight and cell in into
                    content = replace(content, basis=basis, in_sight=is_seen, by_act=True)
                # A content that is not current in the parent keeps its basis: the owner cannot
                # learn more than the parent holds (section 5.4).
                self._learn(node, cell, content)
        for name in {act.actor for act in acts if act.actor not in (None, owner)}:
            number = self._context.numbers[str(name)]
            before = holdings.inventories.get(number, {})
            after = follow_acts(before, (act for act in acts if act.actor == name))
            if after is not before:
                holdings.inventories[number] = after

    @staticmethod
    def _is_moved(item: str, acts: Sequence[Event]) -> bool:
        return any(item in act.detail.get("items", {}) for act in acts)

    def _lose(self, node: int, item: str, acts: Sequence[Event], tick: int) -> None:
        """Remove a unique item from everywhere, before perceived acts bring it to its new place."""
        kind = next(act.kind for act in reversed(acts) if self._is_moved(item, (act,)))
        # Equipment is perceived as it is at the end of the tick, so what is worn now stays.
        worn = [Whereabouts("agent", agent) for agent in self._table.sees_worn(node)]
        basis = Basis(tick, Source.WITNESSED, kind)
        self._holdings[node].remove(item, (), basis)
        self._take_off(node, item, worn)
        self._holdings[node].perceive_only(item, ())

    def _find(self, node: int, item: str, tick: int, *, is_moved: bool) -> None:
        """Let a node whose owner perceives a unique item believe that it is nowhere else.

        Args:
            node: Number of the node; its contents, possessions and items are those after the tick.
            item: Name of the item.
            tick: The tick.
            is_moved: True if the owner perceives acts with the item.
        """
        holdings, seen = self._holdings[node], self._perceived_places(node, item, tick)
        if seen:
            *_, (place, basis) = seen.items()
            self._keep_only(node, item, seen, basis)
            holdings.perceive_only(item, seen)
            holdings.sole[item] = Sole(tick, place, basis)
            self._found_now[node, item] = seen.keys()
        elif is_moved:
            places = self._found_now[node, item] = holdings.places_of(item)
            moved_to = next(iter(places), None)
            holdings.sole[item] = Sole(tick, moved_to, Basis(tick, Source.WITNESSED))

    def _perceived_places(self, node: int, item: str, tick: int) -> Mapping[Whereabouts, Basis]:
        """Return the places where the owner of a node perceives an item at the end of a tick."""
        holdings, table = self._holdings[node], self._table
        parent, owner = table.parent(node), table.owner(node)
        seen: dict[Whereabouts, Basis] = {}
        for cell in sorted(cell for other, cell in self._looked_into if other == node):
            content = holdings.containers.get(cell)
            if content is not None and item in content.items:
                seen[Whereabouts("container", cell)] = content.at(tick).basis
        present = table.is_present(node)
        for number, lying in self._holdings[parent].items.items() if present else ():
            if lying.name == item and self._sees_item(node, lying):
                seen[Whereabouts("floor", number)] = Basis(tick, Source.SEEN)
        for agent in table.sees_worn(node) if present else ():
            if item in table.worn(parent, agent):
                at = tick if table.is_current(node, agent) else table.seen_at(node, agent)
                seen[Whereabouts("agent", agent)] = Basis(at, Source.SEEN)
        if item in self._own(node):
            seen[Whereabouts("agent", owner)] = Basis(tick, Source.SEEN)
        return seen

    def _own(self, node: int) -> Items:
        """Return the possessions of the owner of a node, as its parent node holds them."""
        return self.inventory(self._table.parent(node), self._table.owner(node))[0]

    def believe_only(self, node: int, item: str, cell: int, basis: Basis) -> None:
        """Let a node believe that an item, if it is unique, is nowhere but in a container."""
        if item in self._context.unique:
            self._keep_only(node, item, (Whereabouts("container", cell),), basis)

    def _keep_only(self, node: int, item: str, kept: Collection[Whereabouts], basis: Basis) -> None:
        self._holdings[node].remove(item, kept, basis)
        self._take_off(node, item, kept)

    def _take_off(self, node: int, item: str, kept: Collection[Whereabouts]) -> None:
        for agent in range(len(self._context.agents)):
            if Whereabouts("agent", agent) not in kept:
                self._table.take_off(node, agent, item)

    def doubt(self, node: int, cell: int) -> None:
        """Mark a content as doubtful if the node knows no container at its cell."""
        state = self._table.block(node, cell)
        if node > 0 and cell in self._holdings[node].containers and not self._context.holds[state]:
            self._doubtful.setdefault(node, {})[cell] = state

    def doubt_all(self, which: npt.NDArray[np.int64], cell: int) -> None:
        """Call `doubt` for several nodes."""
        knowing = self._context.holds[self._table.blocks_at(which, cell)]
        for node in which[~knowing].tolist():
            self.doubt(node, cell)

    def _forget(self, node: int) -> None:
        """Drop doubtful contents at cells that the owner sees to hold no container.

        The node's block tells if it was known when the content came. If it was unknown, seeing a
        block for the first time decides, even one that is not current in the parent.
        """
        doubtful = self._doubtful.get(node)
        if doubtful is None:
            return
        for cell, before in list(doubtful.items()):
            state = self._table.block(node, cell)
            parent = self._table.block(self._table.parent(node), cell)
            if self._context.holds[state] or cell not in self._holdings[node].containers:
                del doubtful[cell]
            elif self.sees_no_container(node, cell) or (
                before < 0
                and parent >= 0
                and not self._context.holds[parent]
                and self._table.sees_cells(node, (cell,))
            ):
                self._holdings[node].drop(cell)
                del doubtful[cell]
            else:
                doubtful[cell] = state
        if not doubtful:
            del self._doubtful[node]

    def sees_no_container(self, node: int, cell: int) -> bool:
        """Return True if the owner of a node perceives now that a cell holds no container."""
        parent = self._table.parent(node)
        state = self._table.block(parent, cell)
        return (
            state >= 0
            and not self._context.holds[state]
            and bool(self._table.sees_cells(node, (cell,)))
            and cell in self._table.current_blocks(parent, (cell,))
        )

    def _see_into(self, node: int, tick: int) -> set[int]:
        """Look into the transparent containers in sight, and return their cells."""
        if self._context.options.containers != "transparent":
            return set()
        parent = self._table.parent(node)
        shown = {cell: cell for cell in self._holdings[parent].containers}
        shown |= self._left_halves(parent, [*shown])
        into = {shown[cell] for cell in self._table.sees_cells(node, shown)}
        for cell in sorted(into):
            content, old = self.content(parent, cell), self._holdings[node].containers.get(cell)
            basis = Basis(tick, Source.SEEN) if parent == 0 else content.basis
            if old is not None and old.in_sight and old.shows_as(content):
                # An unchanged content in sight is one perception that lasts: keep its basis.
                basis = old.basis
            self._learn(node, cell, replace(content, basis=basis))
        return into

    def _left_halves(self, node: int, cells: Iterable[int]) -> dict[int, int]:
        """Return the containers among some cells that are double chests, by cell of left half."""
        box, registry, shows = self._context.box, self._context.registry, self._context.shows

        def state_at(place: Position) -> int:
            state = self._table.block(node, cell_of(box, place)) if place in box else UNKNOWN
            return state if shows[state] else UNKNOWN

        lefts = {left_half_of(registry, state_at, place_of(box, cell)): cell for cell in cells}
        return {cell_of(box, left): cell for left, cell in lefts.items() if left is not None}

    def _learn(self, node: int, cell: int, content: Content) -> None:
        """Set the content of a container to one that the owner finds when it looks in."""
        holdings = self._holdings[node]
        holdings.containers[cell] = content
        holdings.look_into(cell, content.items)
        self._looked_into.add((node, cell))
        self._note(node, cell)

    def _note(self, node: int, cell: int) -> None:
        """Update the indexes of current and doubtful contents for one just perceived."""
        self._note_current(node, cell)
        self.doubt(node, cell)

    def _note_current(self, node: int, cell: int) -> None:
        content = self._holdings[node].containers.get(cell)
        if node > 0 and content is not None and content.in_sight:
            self._in_sight.setdefault(node, set()).add(cell)
        if node > 0 and content is not None and content.by_act:
            self._shown_by_acts.setdefault(node, set()).add(cell)

    def _append(self, holdings: Holdings) -> int:
        node = len(self._holdings)
        self._holdings.append(holdings)
        for cell in holdings.containers:
            self._note_current(node, cell)
        return node

    def _see_items(self, node: int) -> None:
        """Take over dropped items in sight. Forget items whose believed place is seen empty."""
        lying, items = self._holdings[self._table.parent(node)].items, self._holdings[node].items
        if not items and not lying:
            return
        seen = {number: item for number, item in lying.items() if self._sees_item(node, item)}
        for number in [n for n in items if n not in seen]:
            if self._sees_item(node, items[number]):
                del items[number]
        items.update(seen)

    def _sees_item(self, node: int, item: DroppedItem) -> bool:
        return self._table.sees_point(node, middle_of(item))
