"""Goals: conditions on reality and on beliefs, and when they came true."""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Protocol

from beliefnest.world.paths import path_text
from beliefnest.world.registry import Registry, parse_state
from beliefnest.world.values import Items, Point, Position

if TYPE_CHECKING:
    from beliefnest.belief.view import State

__all__ = [
    "AgentAt",
    "AgentsAt",
    "BlockIs",
    "BlocksAlike",
    "Condition",
    "Fact",
    "Facts",
    "Goal",
    "ItemsIn",
    "ItemsWith",
    "Look",
    "Progress",
    "StateFacts",
    "looking_at",
]

Path = tuple[str, ...]

_NOWHERE = 80.0


class Facts(Protocol):
    """What conditions ask of a state: the real one, a believed or an imagined one."""

    def items_in(self, place: Position) -> Items:
        """Items known to be in a container; none where nothing is known."""

    def items_of(self, agent: str) -> Items:
        """Items that an agent is known to have."""

    def feet_of(self, agent: str) -> Point | None:
        """Where an agent stands; None: unknown."""

    def block(self, place: Position) -> str | None:
        """Block state text; None: unknown."""


Look = Callable[[Path], Facts]
"""The state at a belief path; `()` is what is taken for real."""


@dataclass(frozen=True, slots=True)
class StateFacts:
    """The facts of a simulator's state."""

    state: "State"

    def items_in(self, place: Position) -> Items:
        """Items known to be in a container."""
        known = self.state.containers.get(place)
        return {} if known is None else known.items

    def items_of(self, agent: str) -> Items:
        """Items that an agent is known to have."""
        return self.state.agents[agent].inventory

    def feet_of(self, agent: str) -> Point | None:
        """Where an agent stands."""
        return self.state.agents[agent].position

    def block(self, place: Position) -> str | None:
        """Block state text."""
        return self.state.blocks[place]


@dataclass(frozen=True, slots=True)
class ItemsIn:
    """A container holds at least so many of an item."""

    place: Position
    item: str
    count: int = 1

    def holds(self, facts: Facts) -> bool:
        """Whether it does."""
        return facts.items_in(self.place).get(self.item, 0) >= self.count

    def __str__(self) -> str:
        return f"{self.count} {self.item} in the container at {self.place}"


@dataclass(frozen=True, slots=True)
class ItemsWith:
    """An agent has at least so many of an item."""

    agent: str
    item: str
    count: int = 1

    def holds(self, facts: Facts) -> bool:
        """Whether it has."""
        return facts.items_of(self.agent).get(self.item, 0) >= self.count

    def __str__(self) -> str:
        return f"{self.agent} has {self.count} {self.item}"


@dataclass(frozen=True, slots=True)
class AgentAt:
    """An agent stands near a place, `within` so many blocks of the block's middle."""

    agent: str
    place: Position
    within: float = 1.0

    def holds(self, facts: Facts) -> bool:
        """Whether it stands there."""
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

    def holds(self, facts: Facts) -> bool:
        """Whether it is."""
        there = facts.block(self.place)
        return there is not None and _agrees(there, self.state)

    def __str__(self) -> str:
        return f"{self.state} at {self.place}"


@dataclass(frozen=True, slots=True)
class BlocksAlike:
    """A block is as another one, its model; unknown is like nothing.

    Attributes:
        place: Where it is.
        model: Where the other one is.
        property: The property in which they are to agree.
    """

    place: Position
    model: Position
    property: str = "open"

    def holds(self, facts: Facts) -> bool:
        """Whether they agree."""
        wanted = self.wanted(facts)
        return wanted is not None and wanted == _property(facts.block(self.place), self.property)

    def wanted(self, facts: Facts) -> str | None:
        """The value that the model has; None: unknown."""
        return _property(facts.block(self.model), self.property)

    def __str__(self) -> str:
        return f"{self.property} at {self.place} as at {self.model}"


@dataclass(frozen=True, slots=True)
class AgentsAt:
    """Agents stand on all the plates of one site at once, whoever on which.

    A site is one where the block below each of its places is known to be a plate.

    Attributes:
        agents: As many as a site has places.
        sites: Block positions in which to stand, of each site.
        plate: Name of the block.
    """

    agents: tuple[str, ...]
    sites: tuple[tuple[Position, ...], ...]
    plate: str

    def holds(self, facts: Facts) -> bool:
        """Whether they do."""
        return any(self.off(facts, site) == 0 for site in self.known(facts))

    def known(self, facts: Facts) -> list[tuple[Position, ...]]:
        """The sites whose plates are known."""
        return [
            site
            for site in self.sites
            if all(_is_named(facts.block((x, y - 1, z)), self.plate) for x, y, z in site)
        ]

    def off(self, facts: Facts, site: tuple[Position, ...]) -> float:
        """How far the agents are from the places of a site, all together, in blocks."""
        return min(
            sum(
                _from_place(facts.feet_of(agent), place)
                for agent, place in zip(self.agents, places, strict=True)
            )
            for places in itertools.permutations(site)
        )

    def __str__(self) -> str:
        sites = " or ".join(str(list(site)) for site in self.sites)
        return f"{' and '.join(self.agents)} at once on the plates at {sites}"


Fact = ItemsIn | ItemsWith | AgentAt | AgentsAt | BlockIs | BlocksAlike


@dataclass(frozen=True, slots=True)
class Condition:
    """A fact that is to be the case somewhere.

    Attributes:
        fact: What.
        path: Where: `()` in reality, else in that belief.
    """

    fact: Fact
    path: Path = ()

    def holds(self, look: Look) -> bool:
        """Whether it is the case there."""
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
    """

    reach: tuple[Condition, ...] = ()
    never: tuple[Condition, ...] = ()
    messages: int | None = None

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """All of them."""
        return (*self.reach, *self.never)

    @property
    def paths(self) -> frozenset[Path]:
        """The simulators that it is about."""
        return frozenset(each.path for each in self.conditions)

    def __str__(self) -> str:
        parts = [str(each) for each in self.reach]
        parts += [f"never: {each}" for each in self.never]
        if self.messages is not None:
            parts.append(f"at most {self.messages} messages")
        return "; ".join(parts) or "nothing"


@dataclass(slots=True)
class Progress:
    """How far a goal has come; fed tick by tick.

    Attributes:
        goal: The goal.
        first: By number of a condition, the tick at which it came true first.
        reached: The tick at which all was reached; None: not yet.
        violated: The tick at which something happened that must not; None: nothing has.
        messages: How many utterances of players there were.
    """

    goal: Goal
    first: dict[int, int]
    reached: int | None = None
    violated: int | None = None
    messages: int = 0

    @classmethod
    def begun(cls, goal: Goal) -> "Progress":
        """Nothing yet."""
        return cls(goal, {})

    def feed(self, tick: int, look: Look, messages: int) -> None:
        """Take what is the case at a tick.

        Args:
            tick: The tick.
            look: The states at it.
            messages: How many utterances of players there were in it.
        """
        if self.reached is not None or self.violated is not None:
            return
        self.messages += messages
        held = [condition.holds(look) for condition in self.goal.conditions]
        for number, holds in enumerate(held):
            if holds:
                self.first.setdefault(number, tick)
        count = len(self.goal.reach)
        if any(held[count:]) or (
            self.goal.messages is not None and self.messages > self.goal.messages
        ):
            self.violated = tick
        elif count and all(held[:count]):
            self.reached = tick

    def succeeded(self, *, over: bool) -> bool:
        """Whether the goal is reached, given whether the episode has come to its end."""
        if self.violated is not None:
            return False
        return self.reached is not None or (over and not self.goal.reach)

    def came_true(self) -> Sequence[tuple[str, int | None]]:
        """All conditions in words, each with the tick at which it came true first."""
        return [
            (str(each), self.first.get(number)) for number, each in enumerate(self.goal.conditions)
        ]


def looking_at(states: "Mapping[Path, State]") -> Look:
    """Look at states by path."""
    return lambda path: StateFacts(states[path])


@cache
def _agrees(there: str, wanted: str) -> bool:
    name, stated = parse_state(wanted)
    is_named, properties = parse_state(there)
    return is_named == name and stated.items() <= properties.items()


def _is_named(text: str | None, name: str) -> bool:
    return text is not None and text.partition("[")[0] == name


def _from_place(feet: Point | None, place: Position) -> float:
    """Blocks between somebody and a place; 0 for who stands in it."""
    if feet is None:
        return _NOWHERE
    if tuple(math.floor(value) for value in feet) == place:
        return 0.0
    x, y, z = place
    return max(1.0, math.dist(feet, (x + 0.5, float(y), z + 0.5)))


@cache
def _property(text: str | None, name: str) -> str | None:
    if text is None:
        return None
    registry = Registry.load()
    found = registry.properties(registry.state_id(text)).get(name)
    return None if found is None else str(found)
