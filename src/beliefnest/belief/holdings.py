"""Contents, possessions and dropped items of one node, and how acts change them.

The rules of semantics, section 4, that are not about rays. They follow the kernel, entry
by entry, shallower nodes first.
"""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Literal, NamedTuple

from beliefnest.belief.entries import Basis, Source
from beliefnest.world.values import DroppedItem, Event, EventKind, Items

__all__ = [
    "MOVES",
    "TOUCHES",
    "Content",
    "Holdings",
    "SignTold",
    "Sole",
    "Whereabouts",
    "changed_items",
    "follow_acts",
    "replaced_block",
    "witness",
]

MOVES = {EventKind.DEPOSIT_ITEM_INTO_CHEST: 1, EventKind.GET_ITEM_FROM_CHEST: -1}

TOUCHES = frozenset({EventKind.OPEN_CONTAINER, *MOVES})
"""Acts by which an actor learns what a container holds."""

# What was smelted comes out of its furnace, and is counted as that.
_POSSESSION = {
    EventKind.GET_ITEM_FROM_CHEST: 1,
    EventKind.RECEIVE_ITEM_FROM_OTHER: 1,
    EventKind.CRAFT_ITEM: 1,
    EventKind.DEPOSIT_ITEM_INTO_CHEST: -1,
    EventKind.GIVE_ITEM_TO_OTHER: -1,
}


@dataclass(frozen=True, slots=True)
class Content:
    """What is believed to be in a container.

    Attributes:
        items: Known items.
        complete: Whether these are known to be all.
        basis: What this rests on; its tick is the last one at which the content was current, where
            it no longer is.
        in_sight: Whether it is seen, in a transparent container, from the tick of the basis on.
        by_act: Whether an act showed it in the tick of the basis, in the last entry.
    """

    items: Items
    complete: bool
    basis: Basis
    in_sight: bool = False
    by_act: bool = False

    @property
    def current(self) -> bool:
        """True if a perception in the last entry backs it."""
        return self.in_sight or self.by_act

    def shows_as(self, other: "Content") -> bool:
        """Return True if two contents in sight are the same to see."""
        seen = self.items, self.complete, self.in_sight
        return seen == (other.items, other.complete, other.in_sight)

    def at(self, tick: int) -> "Content":
        """The content as it is at a tick: sight lasts, an act is perceived in its tick alone."""
        if self.in_sight:
            return replace(self, basis=replace(self.basis, observed_at=tick))
        return replace(self, by_act=self.by_act and self.basis.observed_at == tick)


class Whereabouts(NamedTuple):
    """A place where an item can be.

    Attributes:
        kind: In a container, in the hands or possession of an agent, or on the floor.
        number: Cell of the container, number of the agent or of the dropped item.
    """

    kind: Literal["container", "agent", "floor"]
    number: int


@dataclass(frozen=True, slots=True)
class Sole:
    """Where a unique item was last perceived.

    Attributes:
        tick: Tick at which the owner perceived it.
        place: Where; None: it was seen to be moved, and not where to.
        basis: What that rests on.
    """

    tick: int
    place: Whereabouts | None
    basis: Basis


@dataclass(frozen=True, slots=True)
class SignTold:
    """What became of the claims on a sign in a node.

    Attributes:
        tick: Tick at which they were perceived.
        speaker: Who is known to have written them; None: nobody is.
        verdicts: By claim, a value of `testimony.Verdict`.
    """

    tick: int
    speaker: str | None
    verdicts: tuple[str, ...]


@dataclass
class Holdings:
    """What one node holds besides poses and blocks.

    Attributes:
        containers: Known contents by cell.
        inventories: Known possessions by agent number, of agents other than the owner.
        items: Dropped items by number.
        found: Item to the cell of the container in which the owner last perceived it.
        counts: By cell and item, how many of it were perceived in it.
        sole: Unique item to where the owner last perceived it.
        read: Cell and text of signs that the owner has read, to the tick of the first time.
        writers: Who was perceived to write a text on a sign.
        told: What became of the claims on a sign, by cell and text.
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
        """Return the same holdings, to be changed apart."""
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

    def drop(self, cell: int) -> None:
        """Forget a container, and that anything was perceived in it."""
        self.containers.pop(cell, None)
        self._perceive_none(cell)

    def look_into(self, cell: int, items: Items) -> None:
        """All that is to be found in a container was perceived."""
        self._perceive_none(cell)
        if items:
            self.counts[cell] = items
            self.found.update(dict.fromkeys(items, cell))

    def see_moved(self, cell: int, items: Items, sign: int) -> None:
        """Items were perceived to go into a container (sign 1), or out of it (sign -1)."""
        left = self.counts[cell] = changed_items(self.counts.get(cell, {}), items, sign)
        for name in items:
            if name in left:
                self.found[name] = cell
            else:
                self.found.pop(name, None)

    def remove(self, item: str, kept: Collection[Whereabouts], basis: Basis) -> None:
        """Believe an item to be nowhere but in some places; what is worn the node table knows.

        What is left in a container rests on what it rested on; an empty one on `basis`.
        """
        for cell, content in list(self.containers.items()):
            if item in content.items and Whereabouts("container", cell) not in kept:
                left = {name: count for name, count in content.items.items() if name != item}
                rest = (
                    content if left else replace(content, basis=basis, in_sight=False, by_act=False)
                )
                self.containers[cell] = replace(rest, items=left)
        for agent, held in list(self.inventories.items()):
            if item in held and Whereabouts("agent", agent) not in kept:
                self.inventories[agent] = {name: n for name, n in held.items() if name != item}
        for number, lying in list(self.items.items()):
            if lying.name == item and Whereabouts("floor", number) not in kept:
                del self.items[number]

    def perceive_only(self, item: str, kept: Collection[Whereabouts]) -> None:
        """An item was perceived to be nowhere but in some places."""
        for cell, counts in list(self.counts.items()):
            if item in counts and Whereabouts("container", cell) not in kept:
                self.counts[cell] = {name: n for name, n in counts.items() if name != item}
        if Whereabouts("container", self.found.get(item, -1)) not in kept:
            self.found.pop(item, None)

    def places_of(self, item: str) -> list[Whereabouts]:
        """Where an item is believed to be; what is worn the node table knows."""
        return [
            *(
                Whereabouts("container", cell)
                for cell, content in self.containers.items()
                if item in content.items
            ),
            *(
                Whereabouts("agent", agent)
                for agent, held in self.inventories.items()
                if item in held
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
    """A node's block at a cell came to be another.

    Args:
        holdings: The node's.
        cell: Where.
        old: Name of the block held before; None: unknown.
        new: Name of the container block held now; None: it is none.
        basis: What the new block rests on.
    """
    known = holdings.containers.get(cell)
    if known is not None and (new is None or old not in (None, new)):
        holdings.drop(cell)
        known = None
    if new is not None and known is None:
        holdings.containers[cell] = Content({}, complete=False, basis=basis)


def witness(holdings: Holdings, cell: int, event: Event, tick: int) -> None:
    """Follow items that another agent was seen to move; opening shows nothing to others."""
    if event.kind not in MOVES:
        return
    old = holdings.containers.get(cell)
    items = changed_items(
        {} if old is None else old.items, event.detail["items"], MOVES[event.kind]
    )
    holdings.containers[cell] = Content(
        items,
        complete=old is not None and old.complete,
        basis=Basis(tick, Source.WITNESSED, event.kind),
        by_act=True,
    )
    holdings.see_moved(cell, event.detail["items"], MOVES[event.kind])


def follow_acts(inventory: Items, acts: Iterable[Event]) -> Items:
    """Return believed possessions of an actor after the visible part of what it did."""
    for act in acts:
        sign = _POSSESSION.get(act.kind)
        if sign is not None:
            inventory = changed_items(inventory, act.detail.get("items", {}), sign)
    return inventory
