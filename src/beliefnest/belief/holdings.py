"""Contents, possessions and dropped items of one node, and how acts change them.

The rules of semantics, section 4, that are not about rays. They follow the kernel, entry
by entry, shallower nodes first.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from beliefnest.belief.entries import Basis, Source
from beliefnest.world.values import DroppedItem, Event, EventKind, Items

__all__ = [
    "NEVER",
    "TOUCHES",
    "BelievedItem",
    "Content",
    "Holdings",
    "changed_items",
    "follow_acts",
    "learn",
    "replaced_block",
    "witness",
]

NEVER = -2
"""Entry of what no perception backs; -1 is the first perception, before all entries."""

_MOVES = {EventKind.DEPOSIT_ITEM_INTO_CHEST: 1, EventKind.GET_ITEM_FROM_CHEST: -1}

TOUCHES = frozenset({EventKind.OPEN_CONTAINER, *_MOVES})
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
        basis: What this rests on; its tick is that of the perception.
        entry: Entry in which it was last backed by a perception, or `NEVER`.
    """

    items: Items
    complete: bool
    basis: Basis
    entry: int = NEVER


@dataclass(frozen=True, slots=True)
class BelievedItem:
    """What is believed of a dropped item; entry as in `Content`."""

    item: DroppedItem
    basis: Basis
    entry: int = NEVER


@dataclass
class Holdings:
    """What one node holds besides poses and blocks.

    Attributes:
        containers: Known contents by cell.
        inventories: Known possessions by agent number, of agents other than the owner.
        items: Dropped items by number.
    """

    containers: dict[int, Content] = field(default_factory=dict)
    inventories: dict[int, Items] = field(default_factory=dict)
    items: dict[int, BelievedItem] = field(default_factory=dict)

    def copy(self) -> "Holdings":
        """The same holdings, to be changed apart."""
        return Holdings(dict(self.containers), dict(self.inventories), dict(self.items))


def changed_items(items: Items, change: Items, sign: int) -> Mapping[str, int]:
    """Items with a change added (sign 1) or subtracted (sign -1), no count below 0."""
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
        del holdings.containers[cell]
        known = None
    if new is not None and known is None:
        holdings.containers[cell] = Content({}, complete=False, basis=basis)


def witness(holdings: Holdings, cell: int, event: Event, tick: int, entry: int) -> None:
    """Follow items that another agent was seen to move; opening shows nothing to others."""
    if event.kind not in _MOVES:
        return
    old = holdings.containers.get(cell)
    items = changed_items(
        {} if old is None else old.items, event.detail["items"], _MOVES[event.kind]
    )
    holdings.containers[cell] = Content(
        items,
        complete=old is not None and old.complete,
        basis=Basis(tick, Source.WITNESSED, event.kind),
        entry=entry,
    )


def learn(
    holdings: Holdings, cell: int, content: Content, kind: EventKind | None, tick: int
) -> None:
    """Learn what the parent node holds, by touching the container or by seeing into it."""
    basis = content.basis if kind is None else Basis(tick, Source.WITNESSED, kind)
    holdings.containers[cell] = replace(content, basis=basis)


def follow_acts(inventory: Items, acts: Iterable[Event]) -> Items:
    """Believed possessions of an actor after the visible part of what it did."""
    for act in acts:
        sign = _POSSESSION.get(act.kind)
        if sign is not None:
            inventory = changed_items(inventory, act.detail.get("items", {}), sign)
    return inventory
