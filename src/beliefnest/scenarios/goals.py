"""Goals: conditions on reality and on beliefs, and when they came true."""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
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
    "Goal",
    "GoalCondition",
    "GoalFacts",
    "ItemsIn",
    "ItemsWith",
    "LeversHeld",
    "Look",
    "Progress",
    "StateFacts",
    "agrees",
    "looking_at",
]

_NOWHERE = 80.0
_REACH = 6.0
"""Blocks between eyes and the middle of what is held."""


class GoalFacts(Protocol):
    """What conditions ask of a state: the real one, a believed or an imagined one."""

    def items_in(self, place: Position) -> Items:
        """Return items known to be in a container; none where nothing is known."""

    def items_of(self, agent: str) -> Items:
        """Return items that an agent is known to have."""

    def feet_of(self, agent: str) -> Point | None:
        """Where an agent stands; None: unknown."""

    def block(self, place: Position) -> str | None:
        """Return the block state text; None: unknown."""


Look = Callable[[BeliefPath], GoalFacts]
"""The state at a belief path; `()` is what is taken for real."""


@dataclass(frozen=True, slots=True)
class StateFacts:
    """The facts of a simulator's state."""

    state: State

    def items_in(self, place: Position) -> Items:
        """Return items known to be in a container."""
        known = self.state.containers.get(place)
        return {} if known is None else known.items

    def items_of(self, agent: str) -> Items:
        """Return items that an agent is known to have."""
        return self.state.agents[agent].inventory

    def feet_of(self, agent: str) -> Point | None:
        """Where an agent stands."""
        return self.state.agents[agent].position

    def block(self, place: Position) -> str | None:
        """Return the block state text."""
        return self.state.blocks[place]


@dataclass(frozen=True, slots=True)
class ItemsIn:
    """A container holds at least so many of an item."""

    place: Position
    item: str
    count: int = 1

    def holds(self, facts: GoalFacts) -> bool:
        """Return True if it does."""
        return facts.items_in(self.place).get(self.item, 0) >= self.count

    def __str__(self) -> str:
        return f"{self.count} {self.item} in the container at {self.place}"


@dataclass(frozen=True, slots=True)
class ItemsWith:
    """An agent has at least so many of an item."""

    agent: str
    item: str
    count: int = 1

    def holds(self, facts: GoalFacts) -> bool:
        """Return True if it has."""
        return facts.items_of(self.agent).get(self.item, 0) >= self.count

    def __str__(self) -> str:
        return f"{self.agent} has {self.count} {self.item}"


@dataclass(frozen=True, slots=True)
class AgentAt:
    """An agent stands near a place, `within` so many blocks of the block's middle."""

    agent: str
    place: Position
    within: float = 1.0

    def holds(self, facts: GoalFacts) -> bool:
        """Return True if it stands there."""
        feet = facts.feet_of(self.agent)
        return feet is not None and self.distance(feet) <= self.within

    def distance(self, feet: Point) -> float:
        """How far from the place somebody stands, in blocks."""
        x, y, z = self.place
        return math.dist(feet, (x + 0.5, float(y), z + 0.5))

    def __str__(self) -> str:
        return f"{self.agent} within {self.within:g} of {self.place}"


@dataclass(frozen=True, slots=True)
class BlockIs:
    """A block is in a state; properties that are not named may be any.

    Attributes:
        place: Where it is.
        state: `name` or `name[property=value,...]`.
    """

    place: Position
    state: str

    def holds(self, facts: GoalFacts) -> bool:
        """Return True if it is."""
        there = facts.block(self.place)
        return there is not None and agrees(there, self.state)

    def __str__(self) -> str:
        return f"{self.state} at {self.place}"


@dataclass(frozen=True, slots=True)
class BlocksAlike:
    """A block is as another one, its model; unknown is like nothing.

    Attributes:
        place: Where it is.
        model: Where the other one is.
        property: The property in which they are to agree; empty: in all that it is.
    """

    place: Position
    model: Position
    property: str = ""

    def holds(self, facts: GoalFacts) -> bool:
        """Return True if they agree."""
        wanted = self.wanted(facts)
        return wanted is not None and wanted == self._of(facts.block(self.place))

    def wanted(self, facts: GoalFacts) -> str | None:
        """What the model has: the property's value, or the whole block; None: unknown."""
        return self._of(facts.block(self.model))

    def _of(self, text: str | None) -> str | None:
        return _property(text, self.property) if self.property else text

    def __str__(self) -> str:
        return f"{self.property or 'the block'} at {self.place} as at {self.model}"


@dataclass(frozen=True, slots=True)
class LeversHeld:
    """All the levers of one site are on at once, each with somebody else at it.

    Attributes:
        agents: As many as a site has levers, whoever is at which.
        sites: Block positions of levers, of each site.
    """

    agents: tuple[str, ...]
    sites: tuple[tuple[Position, ...], ...]

    def holds(self, facts: GoalFacts) -> bool:
        """Return True if they are."""
        return any(self.missing(facts, site) == (0, 0.0) for site in self.known(facts))

    def known(self, facts: GoalFacts) -> list[tuple[Position, ...]]:
        """Return the sites whose levers are known."""
        return [
            site
            for site in self.sites
            if all(_is_named(facts.block(place), "lever") for place in site)
        ]

    def missing(self, facts: GoalFacts, site: tuple[Position, ...]) -> tuple[int, float]:
        """How many levers of a site are off, and how far off their holders are, in blocks."""
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


Fact = ItemsIn | ItemsWith | AgentAt | LeversHeld | BlockIs | BlocksAlike


@dataclass(frozen=True, slots=True)
class GoalCondition:
    """A fact that is to be the case somewhere.

    Attributes:
        fact: What.
        path: Where: `()` in reality, else in that belief.
    """

    fact: Fact
    path: BeliefPath = ()

    def holds(self, look: Look) -> bool:
        """Return True if it is the case there."""
        return self.fact.holds(look(self.path))

    def __str__(self) -> str:
        return f"{path_text(self.path)}: {self.fact}" if self.path else str(self.fact)


@dataclass(frozen=True, slots=True)
class Goal:
    """What an agent, or a task, is after.

    Attributes:
        reach: What is to be the case at one and the same tick. If there is nothing to reach, the
            end of the episode is reached.
        never: What must not be the case at any tick until then.
        messages: Most utterances of all players until then; None: any number.
        ticks: Most ticks until then, from where the first round begins; None: any number.
    """

    reach: tuple[GoalCondition, ...] = ()
    never: tuple[GoalCondition, ...] = ()
    messages: int | None = None
    ticks: int | None = None

    @property
    def conditions(self) -> tuple[GoalCondition, ...]:
        """All of them."""
        return (*self.reach, *self.never)

    def differs(self, other: "Goal") -> bool:
        """Whether each of two who are after these wants something that the other does not."""
        mine, theirs = self._wanted, other._wanted
        return not (mine <= theirs or theirs <= mine)

    @property
    def _wanted(self) -> frozenset[tuple[bool, GoalCondition]]:
        wanted = [(True, each) for each in self.reach] + [(False, each) for each in self.never]
        return frozenset(wanted)

    @property
    def paths(self) -> frozenset[BeliefPath]:
        """The simulators that it is about."""
        return frozenset(each.path for each in self.conditions)

    def __str__(self) -> str:
        parts = [str(each) for each in self.reach]
        parts += [f"never: {each}" for each in self.never]
        if self.messages is not None:
            parts.append(f"at most {self.messages} messages")
        if self.ticks is not None:
            parts.append(f"within {self.ticks} ticks")
        return "; ".join(parts) or "nothing"


@dataclass(slots=True)
class Progress:
    """How far a goal has come; fed tick by tick.

    Attributes:
        goal: The goal.
        start: The tick at which the first round begins.
        first: By number of a condition, the tick at which it came true first.
        reached: The tick at which all was reached; None: not yet.
        violated: The tick at which something happened that must not; None: nothing has.
        messages: How many utterances of players there were.
    """

    goal: Goal
    start: int
    first: dict[int, int]
    reached: int | None = None
    violated: int | None = None
    messages: int = 0

    @classmethod
    def begun(cls, goal: Goal, start: int) -> "Progress":
        """Nothing yet."""
        return cls(goal, start, {})

    def feed(self, tick: int, look: Look, messages: int) -> None:
        """Take what is the case at a tick; after the goal is lost, for `first` alone.

        Args:
            tick: The tick.
            look: The states at it.
            messages: How many utterances of players there were in it.
        """
        if self.reached is not None:
            return
        held = [condition.holds(look) for condition in self.goal.conditions]
        for number, holds in enumerate(held):
            if holds:
                self.first.setdefault(number, tick)
        if self.violated is not None:
            return
        self.messages += messages
        count = len(self.goal.reach)
        if (
            any(held[count:])
            or (self.goal.messages is not None and self.messages > self.goal.messages)
            or (self.goal.ticks is not None and tick - self.start > self.goal.ticks)
        ):
            self.violated = tick
        elif count and all(held[:count]):
            self.reached = tick

    def succeeded(self, *, over: bool) -> bool:
        """Return True if the goal is reached, given whether the episode has come to its end."""
        if self.violated is not None:
            return False
        return self.reached is not None or (over and not self.goal.reach)

    def came_true(self) -> Sequence[tuple[str, int | None]]:
        """Return all conditions in words, each with the tick at which it came true first."""
        return [
            (str(each), self.first.get(number)) for number, each in enumerate(self.goal.conditions)
        ]


def looking_at(states: Mapping[BeliefPath, State]) -> Look:
    """Look at states by path."""
    return lambda path: StateFacts(states[path])


@cache
def agrees(there: str, wanted: str) -> bool:
    """Return True if a block is in a state; properties that are not named may be any."""
    name, stated = parse_state(wanted)
    is_named, properties = parse_state(there)
    return is_named == name and stated.items() <= properties.items()


def _is_named(text: str | None, name: str) -> bool:
    return text is not None and text.partition("[")[0] == name


def _beyond_reach(feet: Point | None, place: Position) -> float:
    """Blocks between somebody and where a hand reaches a place; 0 for who is within reach."""
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
