"""What a plot of beliefs over time can follow: contents, items, blocks, agents."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import groupby, zip_longest
from typing import Protocol, TypeVar

import numpy as np

from beliefnest.belief.entries import PerceivedEvent
from beliefnest.belief.node_view import NodeView
from beliefnest.nest.explain.comparison import are_elsewhere, are_false
from beliefnest.nest.explain.parts import Contents
from beliefnest.pictures.words import items_words, place_words, told_apart
from beliefnest.world.claims import Claim, ClaimKind
from beliefnest.world.values import EventKind, Items, Point, Position

__all__ = ["BlockAt", "Carried", "Contained", "Course", "Matter", "Owned", "Whereabouts"]

V = TypeVar("V")
Course = list[tuple[int, V | None]]
"""From which tick on what was held; None: nothing was known."""

Held = tuple[tuple[Position | str, int], ...]
"""Containers and agents that hold an item, and how many."""

_NEAR = 3.0
"""Blocks from a thing with a name within which somebody is said to be near it."""
_STEP = 1.5
_PAUSE = 10
"""Who goes on within so many ticks, by a step of so many blocks, does not stay where it is."""

_ACTS = {
    EventKind.DEPOSIT_ITEM_INTO_CHEST: "puts in",
    EventKind.GET_ITEM_FROM_CHEST: "takes out",
    EventKind.OPEN_CONTAINER: "looks in",
}
_DEALS = {
    EventKind.DEPOSIT_ITEM_INTO_CHEST: "puts away",
    EventKind.GET_ITEM_FROM_CHEST: "takes",
    EventKind.GIVE_ITEM_TO_OTHER: "gives",
    EventKind.RECEIVE_ITEM_FROM_OTHER: "gets",
}


_USES = {
    EventKind.USE_LEVER: "turns it",
    EventKind.PRESS_BUTTON: "presses it",
    EventKind.PLACE_BLOCK: "places it",
    EventKind.MINE_BLOCK: "mines it",
}


class Matter(Protocol[V]):
    """What is followed in some simulators."""

    @property
    def title(self) -> str:
        """What the plot is about."""

    def value(self, held: NodeView) -> V | None:
        """What a simulator holds of it; None: nothing."""

    def words(self, course: Course[V]) -> list[str]:
        """Return each value of a course in words; empty: nothing is known."""

    def is_false(self, real: V | None, held: V) -> bool:
        """Return True if reality is otherwise."""

    def act(self, event: PerceivedEvent) -> str:
        """What somebody did that mattered to it, without who; empty: something else."""

    def is_claimed(self, claim: Claim) -> bool:
        """Return True if a claim is about it."""


class _Amounts:
    """Contents, of which all or one item is followed."""

    __slots__ = ()

    item: str | None

    def words(self, course: Course[Contents]) -> list[str]:
        """What there is, in words."""
        return [_contents_words(held, self.item) for _, held in course]

    def is_false(self, real: Contents | None, held: Contents) -> bool:
        """As for `false_beliefs`."""
        return are_false(real, held)


@dataclass(frozen=True, slots=True)
class Contained(_Amounts):
    """What is in a container: all of it, or one item.

    Attributes:
        container: Where it is.
        item: The item; None: all.
        label: What people call the container.
    """

    container: Position
    item: str | None
    label: str

    @property
    def title(self) -> str:
        """What the plot is about."""
        item = "" if self.item is None else f" and the {_plain(self.item)}"
        return f"What is believed of the {self.label}{item}"

    def value(self, held: NodeView) -> Contents | None:
        """What is in it."""
        found = held.containers.get(self.container)
        return None if found is None else _only(self.item, found.items, complete=found.complete)

    def act(self, event: PerceivedEvent) -> str:
        """Putting in, taking out, looking in."""
        if tuple(event.detail.get("position", ())) != self.container:
            return ""
        return _ACTS.get(event.kind, "")

    def is_claimed(self, claim: Claim) -> bool:
        """What is said of the item, which may move it out of here, or of all that is in here."""
        if self.item is not None:
            return claim.item == self.item
        return claim.item is not None and claim.cell == self.container


@dataclass(frozen=True, slots=True)
class Carried:
    """Where an item is: in which containers, with whom.

    Attributes:
        item: The item.
        names: What people call containers.
    """

    item: str
    names: Mapping[Position, str]

    @property
    def title(self) -> str:
        """What the plot is about."""
        return f"Where the {_plain(self.item)} is believed to be"

    def value(self, held: NodeView) -> Held | None:
        """How many are where; None: it is not known to be anywhere."""
        places: list[tuple[Position | str, Items]] = [
            *((place, each.items) for place, each in sorted(held.containers.items())),
            *((name, each.inventory) for name, each in sorted(held.agents.items())),
        ]
        found = tuple((where, items[self.item]) for where, items in places if self.item in items)
        return found or None

    def words(self, course: Course[Held]) -> list[str]:
        """Return the containers by their names, and who has it."""
        return [", ".join(self._at(*each) for each in held or ()) for _, held in course]

    def _at(self, where: Position | str, count: int) -> str:
        many = "" if count == 1 else f"{count} "
        if isinstance(where, str):
            return f"{many}with {where}"
        return f"{many}in {self.names.get(where, f'container {place_words(where)}')}"

    def is_false(self, real: Held | None, held: Held) -> bool:
        """Return True if there are less in one of the places."""
        real_counts = dict(real or ())
        return any(count > real_counts.get(where, 0) for where, count in held)

    def act(self, event: PerceivedEvent) -> str:
        """Taking, putting away, giving, getting it."""
        moved = self.item in event.detail.get("items", {})
        return _DEALS.get(event.kind, "") if moved else ""

    def is_claimed(self, claim: Claim) -> bool:
        """What is said of where it is, and where it is not."""
        return claim.item == self.item


@dataclass(frozen=True, slots=True)
class BlockAt:
    """Which block is at a place: a door that is open or shut, a sign and what it says.

    Attributes:
        block: The place.
        index: Of it in blocks of the box.
        text: A block of a number as people read it; None: unknown.
    """

    block: Position
    index: tuple[int, int, int]
    text: Callable[[int], str | None]

    @property
    def title(self) -> str:
        """What the plot is about."""
        return f"What is believed of the block at {place_words(self.block)}"

    def value(self, held: NodeView) -> str | None:
        """Return the block."""
        return self.text(int(held.numbers[self.index]))

    def words(self, course: Course[str]) -> list[str]:
        """Return the block, with what differs from those that were at the place as well."""
        known = list(dict.fromkeys(text for _, text in course if text is not None))
        words = dict(zip(known, told_apart(known), strict=True))
        return ["" if text is None else words[text] for _, text in course]

    def is_false(self, real: str | None, held: str) -> bool:
        """As for `false_beliefs`."""
        return real != held

    def act(self, event: PerceivedEvent) -> str:
        """Opening, shutting, switching, placing, mining it, writing on it."""
        detail = event.detail
        if tuple(detail.get("position", ())) != self.block:
            return ""
        if event.kind is EventKind.USE_DOOR:
            return "opens it" if detail.get("open") else "shuts it"
        if event.kind is EventKind.BLOCK_UPDATE and event.actor and "text" in detail:
            return "writes on it"
        return _USES.get(event.kind, "")

    def is_claimed(self, claim: Claim) -> bool:
        """What is said of the block."""
        return claim.kind is ClaimKind.BLOCK and claim.cell == self.block


@dataclass(frozen=True, slots=True)
class Owned(_Amounts):
    """How much of an item an agent has with it.

    Attributes:
        agent: Who.
        item: The item.
    """

    agent: str
    item: str

    @property
    def title(self) -> str:
        """What the plot is about."""
        return f"What {self.agent} is believed to have: {_plain(self.item)}"

    def value(self, held: NodeView) -> Contents | None:
        """What the agent has of it."""
        agent = held.agents[self.agent]
        return _only(self.item, agent.inventory, complete=agent.inventory_complete)

    def act(self, event: PerceivedEvent) -> str:
        """Taking, putting away, giving, getting the item."""
        mine = event.actor == self.agent and self.item in event.detail.get("items", {})
        return _DEALS.get(event.kind, "") if mine else ""

    def is_claimed(self, claim: Claim) -> bool:
        """No claim is about what somebody has."""
        return False


@dataclass(frozen=True, slots=True)
class Whereabouts:
    """Where an agent is.

    Attributes:
        agent: Who.
        names: What people call places and containers.
    """

    agent: str
    names: Mapping[Position, str]

    @property
    def title(self) -> str:
        """What the plot is about."""
        return f"Where {self.agent} is believed to be"

    def value(self, held: NodeView) -> Point | None:
        """Its feet."""
        return held.agents[self.agent].position

    def words(self, course: Course[Point]) -> list[str]:
        """Return places by the names of what is near; who walks is on the way."""
        runs = [list(run) for _, run in groupby(_stays(course), key=lambda stay: stay[1])]
        words: list[str] = []
        for run, after in zip_longest(runs, runs[1:]):
            text = self._run_words(run[0], None if after is None else after[0])
            words += [text] * len(run)
        return words

    def _run_words(
        self, here: tuple[int, Point | None], after: tuple[int, Point | None] | None
    ) -> str:
        """Where it is from a tick on; `after`: where it is next."""
        tick, place = here
        if place is None:
            return ""
        if (
            after is not None
            and after[1] is not None
            and after[0] - tick < _PAUSE
            and math.dist(place, after[1]) <= _STEP
        ):
            return "on the way"
        return self._place_words(place)

    def _place_words(self, place: Point) -> str:
        """Return the nearest name; without one the block in which the feet are."""
        away = {
            name: math.dist(place, (x + 0.5, y, z + 0.5)) for (x, y, z), name in self.names.items()
        }
        if away and min(away.values()) <= _NEAR:
            return f"near {min(away, key=lambda name: (away[name], name))}"
        x, y, z = (math.floor(value + 1e-6) for value in place)
        return f"at {place_words((x, y, z))}"

    def is_false(self, real: Point | None, held: Point) -> bool:
        """As for `false_beliefs`."""
        return real is None or bool(are_elsewhere(np.array(real), np.array(held)))

    def act(self, event: PerceivedEvent) -> str:
        """Coming to where it was bound for; a walk is an event when it has ended."""
        return "arrives" if event.kind is EventKind.MOVE_TO and event.actor == self.agent else ""

    def is_claimed(self, claim: Claim) -> bool:
        """What is said of where it is."""
        return claim.kind is ClaimKind.POSITION and claim.agent == self.agent


def _stays(course: Course[Point]) -> Course[Point]:
    """Return each place, or the one before from which it is no more than a shuffle."""
    stays: Course[Point] = []
    for tick, place in course:
        last = stays[-1][1] if stays else None
        stayed = (
            place is not None
            and last is not None
            and not are_elsewhere(np.array(last), np.array(place))
        )
        stays.append((tick, last if stayed else place))
    return stays


def _only(item: str | None, items: Items, *, complete: bool) -> Contents:
    if item is None:
        return Contents(dict(items), complete)
    count = items.get(item, 0)
    return Contents({item: count} if count else {}, complete)


def _contents_words(held: Contents | None, item: str | None) -> str:
    """Return the value; empty where nothing is known."""
    if held is None or not (held.items or held.complete):
        return ""
    if item is not None and not held.items:
        return f"no {_plain(item)}"
    return items_words(held.items, complete=held.complete)


def _plain(item: str) -> str:
    return item.replace("_", " ")
