"""Contents, possessions and dropped items of one node, and how acts change them.

These are the rules of semantics, section 4, that are not about rays. `HoldingsTable` applies them
after the kernel, entry by entry, shallower nodes first.
"""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

import msgspec
from msgspec.structs import replace

from beliefnest.belief.columns import cell_of
from beliefnest.belief.grounds import Basis, Source
from beliefnest.world.frames import Frame
from beliefnest.world.values import Box, DroppedItem, Event, Items


class Content(msgspec.Struct, frozen=True):
    """Content of a container as a node believes it.

    Attributes:
        items: Known items.
        complete: True if these are known to be all.
        basis: Ground of the content. If the content is no longer current, its tick is the last one
            at which it was.
        in_sight: True if the content is seen, in a transparent container, since the tick of the
            basis.
        by_act: True if an act showed the content in the last entry, at the tick of the basis.
    """

    items: Items
    complete: bool
    basis: Basis
    in_sight: bool = False
    by_act: bool = False

    @property
    def current(self) -> bool:
        """True if a perception in the last entry backs the content."""
        return self.in_sight or self.by_act

    def shows_as(self, other: "Content") -> bool:
        """Return True if two contents in sight look the same."""
        seen = self.items, self.complete, self.in_sight
        return seen == (other.items, other.complete, other.in_sight)

    def at(self, tick: int) -> "Content":
        """Return the content as it is at a later quiet tick.

        A content in sight stays current. One that an act showed is current in that tick only.
        """
        if self.in_sight:
            return replace(self, basis=replace(self.basis, observed_at=tick))
        return replace(self, by_act=self.by_act and self.basis.observed_at == tick)


class Whereabouts(NamedTuple):
    """A place where an item can be.

    Attributes:
        kind: `container`, `agent` (in its hands or possession) or `floor`.
        number: Cell of the container, number of the agent, or number of the dropped item.
    """

    kind: Literal["container", "agent", "floor"]
    number: int


class Sole(msgspec.Struct, frozen=True):
    """Last perception of a unique item.

    Attributes:
        tick: Tick at which the owner perceived the item.
        place: Place of the item; None: the owner saw it moved, but not to which place.
        basis: Ground of that belief.
    """

    tick: int
    place: Whereabouts | None
    basis: Basis


class SignTold(msgspec.Struct, frozen=True):
    """Verdicts of a node on the claims of a sign.

    Attributes:
        tick: Tick at which the owner read the sign.
        speaker: Name of the writer; None: the writer is unknown.
        verdicts: A value of `testimony.Verdict` for each claim.
    """

    tick: int
    speaker: str | None
    verdicts: tuple[str, ...]


@dataclass
class Holdings:
    """Beliefs of one node apart from poses and blocks.

    `found` and `counts` follow perception alone, never hearsay: they give the known place of a
    claimed item (section 8).

    Attributes:
        containers: Known contents by cell.
        inventories: Known possessions by agent number, of agents other than the owner.
        items: Dropped items by number.
        found: Cell of the container in which the owner last perceived an item, by item.
        counts: Perceived number of each item in a container, by cell and item.
        sole: Last perception of each unique item, by item.
        read: Tick at which the owner first read a text on a sign, by cell and text.
        writers: Name of the agent that the owner perceived writing a text, by cell and text.
        told: Verdicts on the claims of a sign, by cell and text.
    """

    containers: dict[int, Content] = field(default_factory=dict)
    inventories: dict[int, Items] = field(default_factory=dict)
    items: dict[int, DroppedItem] = field(default_factory=dict)
    found: dict[str, int] = field(default_factory=dict)
    counts: dict[int, Items] = field(default_factory=dict)
    sole: dict[str, Sole] = field(default_factory=dict)
    read: dict[tuple[int, str], int] = field(default_factory=dict)
    writers: dict[tuple[int, str], str] = field(default_factory=dict)
    told: dict[tuple[int, str], SignTold] = field(default_factory=dict)

    def copy(self) -> "Holdings":
        """Return an independent copy."""
        return Holdings(
            dict(self.containers),
            dict(self.inventories),
            dict(self.items),
            dict(self.found),
            dict(self.counts),
            dict(self.sole),
            dict(self.read),
            dict(self.writers),
            dict(self.told),
        )

    def take(self, frame: Frame, box: Box) -> None:
        """Set the contents and dropped items of a simulator from a frame of its own timeline."""
        basis = Basis(frame.tick, Source.SEEN)
        for place, items in frame.containers.items():
            cell = cell_of(box, place)
            old = self.containers.pop(cell, None)
            if items is not None:
                complete = old is None or old.complete
                self.containers[cell] = Content(dict(items), complete, basis)
        for number, item in frame.items.items():
            self.items.pop(number, None)
            if item is not None:
                self.items[number] = item

    def take_block(self, cell: int, name: str | None, tick: int) -> None:
        """Begin or end a container at a block that changed; None: the block is no container."""
        if name is None:
            self.containers.pop(cell, None)
        elif cell not in self.containers:
            self.containers[cell] = Content({}, True, Basis(tick, Source.SEEN))

    def drop(self, cell: int) -> None:
        """Forget a container and everything that was perceived in it."""
        self.containers.pop(cell, None)
        self._perceive_none(cell)

    def look_into(self, cell: int, items: Items) -> None:
        """Note that the owner perceived all items in a container."""
        self._perceive_none(cell)
        if items:
            self.counts[cell] = items
            self.found.update(dict.fromkeys(items, cell))

    def see_moved(self, cell: int, items: Items, sign: int) -> None:
        """Note that the owner perceived items go into a container (sign 1) or out of it (-1)."""
        left = self.counts[cell] = changed_items(self.counts.get(cell, {}), items, sign)
        for name in items:
            if name in left:
                self.found[name] = cell
            else:
                self.found.pop(name, None)

    def remove(self, item: str, kept: Collection[Whereabouts], basis: Basis) -> None:
        """Remove an item from all containers, possessions and floors that are not `kept`.

        Other items in a container keep their basis; a container that becomes empty gets `basis`.
        Equipment is not touched: the node table holds it.
        """
        for cell, content in list(self.containers.items()):
            if item in content.items and Whereabouts("container", cell) not in kept:
                left = {name: count for name, count in content.items.items() if name != item}
                rest = (
                    content if left else replace(content, basis=basis, in_sight=False, by_act=False)
                )
                self.containers[cell] = replace(rest, items=left)
        for agent, inventory in list(self.inventories.items()):
            if item in inventory and Whereabouts("agent", agent) not in kept:
                self.inventories[agent] = {name: n for name, n in inventory.items() if name != item}
        for number, lying in list(self.items.items()):
            if lying.name == item and Whereabouts("floor", number) not in kept:
                del self.items[number]

    def perceive_only(self, item: str, kept: Collection[Whereabouts]) -> None:
        """Remove perceptions of an item in containers that are not among the places `kept`."""
        for cell, counts in list(self.counts.items()):
            if item in counts and Whereabouts("container", cell) not in kept:
                self.counts[cell] = {name: n for name, n in counts.items() if name != item}
        if Whereabouts("container", self.found.get(item, -1)) not in kept:
            self.found.pop(item, None)

    def places_of(self, item: str) -> list[Whereabouts]:
        """Return the believed places of an item. Equipment is left out: the node table holds it."""
        return [
            *(
                Whereabouts("container", cell)
                for cell, content in self.containers.items()
                if item in content.items
            ),
            *(
                Whereabouts("agent", agent)
                for agent, inventory in self.inventories.items()
                if item in inventory
            ),
            *(
                Whereabouts("floor", number)
                for number, lying in self.items.items()
                if lying.name == item
            ),
        ]

    def _perceive_none(self, cell: int) -> None:
        if self.counts.pop(cell, None):
            self.found = {item: at for item, at in self.found.items() if at != cell}


def changed_items(items: Items, change: Items, sign: int) -> Mapping[str, int]:
    """Return items with a change added (sign 1) or subtracted (sign -1), no count below 0."""
    result = dict(items)
    for name, count in change.items():
        result[name] = result.get(name, 0) + sign * count
    return {name: count for name, count in result.items() if count > 0}


def replaced_block(
    holdings: Holdings, cell: int, old: str | None, new: str | None, basis: Basis
) -> None:
    """Update the content at a cell whose block has changed (semantics, section 4).

    The content of another container is dropped. A container that is new to the node begins with
    nothing known, incomplete.

    Args:
        holdings: Holdings of the node.
        cell: Cell of the block.
        old: Name of the block held before; None: unknown.
        new: Name of the container block held now; None: the block is no container.
        basis: Ground of the new block.
    """
    content = holdings.containers.get(cell)
    if content is not None and (new is None or old not in (None, new)):
        holdings.drop(cell)
        content = None
    if new is not None and content is None:
        holdings.containers[cell] = Content({}, complete=False, basis=basis)


def witness(holdings: Holdings, cell: int, event: Event, tick: int) -> None:
    """Update a content by another agent's act that the owner perceived (semantics, section 4).

    Moved items are added or subtracted. Opening a container shows nothing to others.
    """
    sign = event.kind.traits.stores
    if not sign:
        return
    old = holdings.containers.get(cell)
    items = changed_items({} if old is None else old.items, event.detail["items"], sign)
    holdings.containers[cell] = Content(
        items,
        complete=old is not None and old.complete,
        basis=Basis(tick, Source.WITNESSED, event.kind),
        by_act=True,
    )
    holdings.see_moved(cell, event.detail["items"], sign)


def follow_acts(inventory: Items, acts: Iterable[Event]) -> Items:
    """Return an actor's believed possessions after the visible part of its acts."""
    for act in acts:
        if act.kind.traits.gains:
            inventory = changed_items(inventory, act.detail.get("items", {}), act.kind.traits.gains)
    return inventory
