"""Matters that a plot of beliefs over time can follow: contents, items, blocks and agents."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import groupby, zip_longest
from typing import Protocol, TypeVar

import msgspec
import numpy as np

from beliefnest.belief.grounds import PerceivedEvent
from beliefnest.belief.node_view import NodeView
from beliefnest.nest.explain.comparison import are_elsewhere, are_false
from beliefnest.nest.explain.parts import Contents
from beliefnest.world.claims import Claim, ClaimKind
from beliefnest.world.event_words import EVENT_WORDS, did_to_block
from beliefnest.world.values import Items, Point, Position
from beliefnest.world.words import contents_words, point_words, told_apart, with_the

V = TypeVar("V")
ValueCourse = list[tuple[int, V | None]]
"""Believed values, each with the tick at which the belief began; None: nothing was known."""

Held = tuple[tuple[Position | str, int], ...]
"""Containers and agents that hold an item, with its number."""

_NEAR = 3.0
"""Greatest distance in blocks at which an agent counts as near a named thing."""
_STEP = 1.5
_PAUSE = 10
"""Greatest pause in ticks between two steps (of at most `_STEP` blocks) of one walk."""


class Matter(Protocol[V]):
    """Matter that is followed in some simulators."""

    @property
    def title(self) -> str:
        """The title of the plot."""

    def value(self, view: NodeView) -> V | None:
        """Return the value that a simulator believes; None: nothing is known."""

    def words(self, course: ValueCourse[V]) -> list[str]:
        """Return each value of a course in words; an empty text if nothing is known."""

    def is_false(self, real: V | None, believed: V) -> bool:
        """Return True if reality contradicts the value."""

    def act(self, event: PerceivedEvent) -> str:
        """Return an act on the matter in words, without its actor; empty for other events."""

    def is_claimed(self, claim: Claim) -> bool:
        """Return True if a claim is about the matter."""


class _Amounts:
    """Base of matters whose values are contents, of all items or of one."""

    __slots__ = ()

    item: str | None

    def words(self, course: ValueCourse[Contents]) -> list[str]:
        """Return the contents in words."""
        return [_contents_words(content, self.item) for _, content in course]

    def is_false(self, real: Contents | None, believed: Contents) -> bool:
        """Return True if the value is false by the rules of `false_beliefs`."""
        return are_false(real, believed)


@dataclass(frozen=True, slots=True)
class Contained(_Amounts):
    """Contents of a container: all items, or one of them.

    Attributes:
        container: Position of the container.
        item: The item; None: all items.
        label: Name of the container for people.
    """

    container: Position
    item: str | None
    label: str

    @property
    def title(self) -> str:
        """The title of the plot."""
        item = "" if self.item is None else f" and the {_plain(self.item)}"
        return f"What is believed of {with_the(self.label)}{item}"

    def value(self, view: NodeView) -> Contents | None:
        """Return the contents of the container."""
        there = view.containers.get(self.container)
        return None if there is None else _only(self.item, there.items, complete=there.complete)

    def act(self, event: PerceivedEvent) -> str:
        """Return deposits, withdrawals and looks into the container in words."""
        if tuple(event.detail.get("position", ())) != self.container:
            return ""
        return EVENT_WORDS[event.kind].in_container

    def is_claimed(self, claim: Claim) -> bool:
        """Return True for a claim about the item, or without one about this container.

        A claim that the item is elsewhere counts too, as it removes the item from here.
        """
        if self.item is not None:
            return claim.item == self.item
        return claim.item is not None and claim.cell == self.container


class Carried(msgspec.Struct, frozen=True):
    """Places of an item: containers and agents.

    Attributes:
        item: The item.
        names: Names of containers for people.
    """

    item: str
    names: Mapping[Position, str]

    @property
    def title(self) -> str:
        """The title of the plot."""
        return f"Where the {_plain(self.item)} is believed to be"

    def value(self, view: NodeView) -> Held | None:
        """Return the number of items at each place; None: no place is known."""
        places: list[tuple[Position | str, Items]] = [
            *((place, each.items) for place, each in sorted(view.containers.items())),
            *((name, each.inventory) for name, each in sorted(view.agents.items())),
        ]
        carried = tuple((where, items[self.item]) for where, items in places if self.item in items)
        return carried or None

    def words(self, course: ValueCourse[Held]) -> list[str]:
        """Return the containers by their names, and the agents that have the item."""
        return [", ".join(self._at(*each) for each in carried or ()) for _, carried in course]

    def _at(self, where: Position | str, count: int) -> str:
        many = "" if count == 1 else f"{count} "
        if isinstance(where, str):
            return f"{many}with {where}"
        return f"{many}in {self.names.get(where, f'container {point_words(where)}')}"

    def is_false(self, real: Held | None, believed: Held) -> bool:
        """Return True if one of the places really has fewer of the item."""
        real_counts = dict(real or ())
        return any(count > real_counts.get(where, 0) for where, count in believed)

    def act(self, event: PerceivedEvent) -> str:
        """Return withdrawals, deposits and gifts of the item in words."""
        moved = self.item in event.detail.get("items", {})
        return EVENT_WORDS[event.kind].of_item if moved else ""

    def is_claimed(self, claim: Claim) -> bool:
        """Return True for claims that the item is, or is not, in a container."""
        return claim.item == self.item


class BlockAt(msgspec.Struct, frozen=True):
    """Block at a position, for example a door that is open or shut, or a sign with its text.

    Attributes:
        block: The position.
        index: Index of the position in arrays of the box.
        text: Function from a block number to the block in words; None: unknown.
    """

    block: Position
    index: tuple[int, int, int]
    text: Callable[[int], str | None]

    @property
    def title(self) -> str:
        """The title of the plot."""
        return f"What is believed of the block at {point_words(self.block)}"

    def value(self, view: NodeView) -> str | None:
        """Return the block."""
        return self.text(int(view.numbers[self.index]))

    def words(self, course: ValueCourse[str]) -> list[str]:
        """Return each block, with the properties in which the blocks of the course differ."""
        texts = list(dict.fromkeys(text for _, text in course if text is not None))
        words = dict(zip(texts, told_apart(texts), strict=True))
        return ["" if text is None else words[text] for _, text in course]

    def is_false(self, real: str | None, believed: str) -> bool:
        """Return True if the value is false by the rules of `false_beliefs`."""
        return real != believed

    def act(self, event: PerceivedEvent) -> str:
        """Return acts on the block in words: use, placing, mining, writing."""
        if tuple(event.detail.get("position", ())) != self.block:
            return ""
        return did_to_block(event)

    def is_claimed(self, claim: Claim) -> bool:
        """Return True for claims about the block."""
        return claim.kind is ClaimKind.BLOCK and claim.cell == self.block


@dataclass(frozen=True, slots=True)
class OwnedCount(_Amounts):
    """Number of an item that an agent has.

    Attributes:
        agent: Name of the agent.
        item: The item.
    """

    agent: str
    item: str

    @property
    def title(self) -> str:
        """The title of the plot."""
        return f"What {self.agent} is believed to have: {_plain(self.item)}"

    def value(self, view: NodeView) -> Contents | None:
        """Return the number of the item that the agent has, as contents."""
        agent = view.agents[self.agent]
        return _only(self.item, agent.inventory, complete=agent.inventory_complete)

    def act(self, event: PerceivedEvent) -> str:
        """Return withdrawals, deposits and gifts of the item by the agent in words."""
        mine = event.actor == self.agent and self.item in event.detail.get("items", {})
        return EVENT_WORDS[event.kind].of_item if mine else ""

    def is_claimed(self, claim: Claim) -> bool:
        """Return False: no claim is about an agent's possessions."""
        return False


class AgentPlace(msgspec.Struct, frozen=True):
    """Position of an agent.

    Attributes:
        agent: Name of the agent.
        names: Names of places and containers for people.
    """

    agent: str
    names: Mapping[Position, str]

    @property
    def title(self) -> str:
        """The title of the plot."""
        return f"Where {self.agent} is believed to be"

    def value(self, view: NodeView) -> Point | None:
        """Return the agent's feet position."""
        return view.agents[self.agent].position

    def words(self, course: ValueCourse[Point]) -> list[str]:
        """Return places by the names of near things. An agent that walks is "on the way"."""
        runs = [list(run) for _, run in groupby(_stays(course), key=lambda stay: stay[1])]
        words: list[str] = []
        for run, after in zip_longest(runs, runs[1:]):
            text = self._run_words(run[0], None if after is None else after[0])
            words += [text] * len(run)
        return words

    def _run_words(
        self, here: tuple[int, Point | None], after: tuple[int, Point | None] | None
    ) -> str:
        """Return the place from a tick on in words; `after` is the next place."""
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
        """Return the nearest name; if no name is near, the block in which the feet are."""
        away = {
            name: math.dist(place, (x + 0.5, y, z + 0.5)) for (x, y, z), name in self.names.items()
        }
        if away and min(away.values()) <= _NEAR:
            return f"near {min(away, key=lambda name: (away[name], name))}"
        x, y, z = (math.floor(value + 1e-6) for value in place)
        return f"at {point_words((x, y, z))}"

    def is_false(self, real: Point | None, believed: Point) -> bool:
        """Return True if the value is false by the rules of `false_beliefs`."""
        return real is None or bool(are_elsewhere(np.array(real), np.array(believed)))

    def act(self, event: PerceivedEvent) -> str:
        """Return the arrival at the end of a walk, in words."""
        return EVENT_WORDS[event.kind].of_agent if event.actor == self.agent else ""

    def is_claimed(self, claim: Claim) -> bool:
        """Return True for claims about the agent's position."""
        return claim.kind is ClaimKind.POSITION and claim.agent == self.agent


def _stays(course: ValueCourse[Point]) -> ValueCourse[Point]:
    """Return a course in which a movement that is no real change of place is left out."""
    stays: ValueCourse[Point] = []
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


def _contents_words(contents: Contents | None, item: str | None) -> str:
    """Return contents in words; an empty text if nothing is known."""
    if contents is None or not (contents.items or contents.complete):
        return ""
    if item is not None and not contents.items:
        return f"no {_plain(item)}"
    return contents_words(contents.items, complete=contents.complete)


def _plain(item: str) -> str:
    return item.replace("_", " ")
