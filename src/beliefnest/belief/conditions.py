"""Conditions on what is the case or believed: a container's items, an agent's place, a block.

The language of goals, of `share` and of evidence; `conditions_of` reads it from plain values.
"""

import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Protocol

from beliefnest.belief.view import State
from beliefnest.world.paths import BeliefPath, path_text
from beliefnest.world.registry import Registry, parse_state
from beliefnest.world.values import EYE_HEIGHT, Items, Point, Position

__all__ = [
    "AgentAt",
    "BlockIs",
    "BlocksAlike",
    "Fact",
    "GoalCondition",
    "GoalFacts",
    "ItemsIn",
    "ItemsWith",
    "LeversHeld",
    "Look",
    "NothingIn",
    "NothingWith",
    "StateFacts",
    "agrees",
    "looking_at",
]

_NOWHERE = 80.0
_REACH = 6.0
"""Greatest distance in blocks from the eyes to the middle of a lever that an agent holds."""


class GoalFacts(Protocol):
    """Protocol of a state that conditions read: real, believed or imagined."""

    def items_in(self, place: Position) -> Items:
        """Return the items known to be in a container; empty if nothing is known."""

    def is_empty(self, place: Position) -> bool:
        """Return True if a container is known to hold nothing."""

    def items_of(self, agent: str) -> Items:
        """Return the items that an agent is known to have."""

    def feet_of(self, agent: str) -> Point | None:
        """Return the position of an agent's feet; None: unknown."""

    def block(self, place: Position) -> str | None:
        """Return the text of a block state; None: unknown."""


Look = Callable[[BeliefPath], GoalFacts]
"""Function from a belief path to the state there; `()` is reality, as the caller takes it."""


@dataclass(frozen=True, slots=True)
class StateFacts:
    """Facts of a simulator's state."""

    state: State

    def items_in(self, place: Position) -> Items:
        """Return items known to be in a container."""
        known = self.state.containers.get(place)
        return {} if known is None else known.items

    def is_empty(self, place: Position) -> bool:
        """Return True if a container is known to hold nothing."""
        known = self.state.containers.get(place)
        return known is not None and known.complete and not known.items

    def items_of(self, agent: str) -> Items:
        """Return items that an agent is known to have."""
        return self.state.agents[agent].inventory

    def feet_of(self, agent: str) -> Point | None:
        """Return the position of an agent's feet; None: unknown."""
        return self.state.agents[agent].position

    def block(self, place: Position) -> str | None:
        """Return the text of a block state; None: unknown."""
        return self.state.blocks[place]


@dataclass(frozen=True, slots=True)
class ItemsIn:
    """Fact: a container holds at least a number of an item."""

    place: Position
    item: str
    count: int = 1

    def holds(self, facts: GoalFacts) -> bool:
        """Return True if the container holds the items."""
        return facts.items_in(self.place).get(self.item, 0) >= self.count

    def __str__(self) -> str:
        return f"{self.count} {self.item} in the container at {self.place}"


@dataclass(frozen=True, slots=True)
class ItemsWith:
    """Fact: an agent has at least a number of an item."""

    agent: str
    item: str
    count: int = 1

    def holds(self, facts: GoalFacts) -> bool:
        """Return True if the agent has the items."""
        return facts.items_of(self.agent).get(self.item, 0) >= self.count

    def __str__(self) -> str:
        return f"{self.agent} has {self.count} {self.item}"


@dataclass(frozen=True, slots=True)
class NothingIn:
    """Fact: a container holds nothing; contents that are not known completely do not count."""

    place: Position

    def holds(self, facts: GoalFacts) -> bool:
        """Return True if the container is known to hold nothing."""
        return facts.is_empty(self.place)

    def __str__(self) -> str:
        return f"nothing in the container at {self.place}"


@dataclass(frozen=True, slots=True)
class NothingWith:
    """Fact: an agent has no items."""

    agent: str

    def holds(self, facts: GoalFacts) -> bool:
        """Return True if the agent is not known to have any item."""
        return not facts.items_of(self.agent)

    def __str__(self) -> str:
        return f"{self.agent} has nothing"


@dataclass(frozen=True, slots=True)
class AgentAt:
    """Fact: an agent stands within a distance of the middle of a block."""

    agent: str
    place: Position
    within: float = 1.0

    def holds(self, facts: GoalFacts) -> bool:
        """Return True if the agent stands there."""
        feet = facts.feet_of(self.agent)
        return feet is not None and self.distance(feet) <= self.within

    def distance(self, feet: Point) -> float:
        """Return the distance of feet from the place, in blocks."""
        x, y, z = self.place
        return math.dist(feet, (x + 0.5, float(y), z + 0.5))

    def __str__(self) -> str:
        return f"{self.agent} within {self.within:g} of {self.place}"


@dataclass(frozen=True, slots=True)
class BlockIs:
    """Fact: a block has a state; properties that are not named may have any value.

    Attributes:
        place: Position of the block.
        state: `name` or `name[property=value,...]`.
    """

    place: Position
    state: str

    def holds(self, facts: GoalFacts) -> bool:
        """Return True if the block has the state."""
        there = facts.block(self.place)
        return there is not None and agrees(there, self.state)

    def wanted(self, facts: GoalFacts) -> str:
        """Return the state."""
        return self.state

    def __str__(self) -> str:
        return f"{self.state} at {self.place}"


@dataclass(frozen=True, slots=True)
class BlocksAlike:
    """Fact: a block equals another one, its model; an unknown block equals nothing.

    Attributes:
        place: Position of the block.
        model: Position of the model.
        property: Property in which both must agree; empty: in the whole state.
    """

    place: Position
    model: Position
    property: str = ""

    def holds(self, facts: GoalFacts) -> bool:
        """Return True if the two blocks agree."""
        wanted = self.wanted(facts)
        return wanted is not None and wanted == self._of(facts.block(self.place))

    def wanted(self, facts: GoalFacts) -> str | None:
        """Return the model's value of the property, or its whole state; None: unknown."""
        return self._of(facts.block(self.model))

    def _of(self, text: str | None) -> str | None:
        return _property(text, self.property) if self.property else text

    def __str__(self) -> str:
        return f"{self.property or 'the block'} at {self.place} as at {self.model}"


@dataclass(frozen=True, slots=True)
class LeversHeld:
    """Fact: all levers of one site are on at once, each with a different agent at it.

    Attributes:
        agents: Names of the agents, as many as a site has levers; any agent may be at any lever.
        sites: Positions of the levers of each site.
    """

    agents: tuple[str, ...]
    sites: tuple[tuple[Position, ...], ...]

    def holds(self, facts: GoalFacts) -> bool:
        """Return True if the levers of a site are on, each with a different agent at it."""
        return any(self.missing(facts, site) == (0, 0.0) for site in self.known(facts))

    def known(self, facts: GoalFacts) -> list[tuple[Position, ...]]:
        """Return the sites whose levers are known."""
        return [
            site
            for site in self.sites
            if all(_is_named(facts.block(place), "lever") for place in site)
        ]

    def missing(self, facts: GoalFacts, site: tuple[Position, ...]) -> tuple[int, float]:
        """Return the number of levers that are off, and the distance of their holders in blocks."""
        is_off = sum(_property(facts.block(place), "powered") != "true" for place in site)
        far = min(
            sum(
                _beyond_reach(facts.feet_of(agent), place)
                for agent, place in zip(self.agents, places, strict=True)
            )
            for places in itertools.permutations(site)
        )
        return is_off, far

    def __str__(self) -> str:
        sites = " or ".join(str(list(site)) for site in self.sites)
        return f"{' and '.join(self.agents)} at once at levers that are on, at {sites}"


Fact = ItemsIn | ItemsWith | NothingIn | NothingWith | AgentAt | LeversHeld | BlockIs | BlocksAlike


@dataclass(frozen=True, slots=True)
class GoalCondition:
    """Condition that a fact holds in reality or in a belief.

    Attributes:
        fact: The fact.
        path: Belief path; `()` is reality.
    """

    fact: Fact
    path: BeliefPath = ()

    def holds(self, look: Look) -> bool:
        """Return True if the fact holds there."""
        return self.fact.holds(look(self.path))

    def __str__(self) -> str:
        return f"{path_text(self.path)}: {self.fact}" if self.path else str(self.fact)


def looking_at(states: Mapping[BeliefPath, State]) -> Look:
    """Return a function that looks up facts in states by path."""
    return lambda path: StateFacts(states[path])


@cache
def agrees(there: str, wanted: str) -> bool:
    """Return True if a block has a state; properties that are not named may have any value."""
    name, stated = parse_state(wanted)
    is_named, properties = parse_state(there)
    return is_named == name and stated.items() <= properties.items()


def _is_named(text: str | None, name: str) -> bool:
    return text is not None and text.partition("[")[0] == name


def _beyond_reach(feet: Point | None, place: Position) -> float:
    """Return how many blocks an agent is beyond reach of a place; 0: within reach."""
    if feet is None:
        return _NOWHERE
    middle = tuple(value + 0.5 for value in place)
    return max(0.0, math.dist((feet[0], feet[1] + EYE_HEIGHT, feet[2]), middle) - _REACH)


@cache
def _property(text: str | None, name: str) -> str | None:
    if text is None:
        return None
    registry = Registry.load()
    found = registry.properties(registry.state_id(text)).get(name)
    return None if found is None else str(found)
