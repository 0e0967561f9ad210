"""Conditions on facts or beliefs: a container's items, an agent's place, a block.

The language of goals, of `share` and of evidence; `conditions_of` reads it from plain values. Each
kind of fact is a class that reads, judges and describes itself, and tells planners what it takes.
To add a kind, add its keys to `ConditionEntry`, and its class to `KINDS`.
"""

import itertools
import math
from abc import ABC, abstractmethod
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Annotated, ClassVar

import msgspec

from beliefnest.belief.effort import FAR, PER_BLOCK, to_agent, to_block, to_container
from beliefnest.belief.facts import GoalFacts, Look, PlanFacts
from beliefnest.belief.grounds import PerceivedEvent
from beliefnest.errors import InputError
from beliefnest.world.event_kinds import AT_CONTAINERS
from beliefnest.world.forms import note
from beliefnest.world.paths import BeliefPath, parse_path, path_text
from beliefnest.world.registry import Registry, block_name, parse_state
from beliefnest.world.values import EYE_HEIGHT, Box, EventKind, Items, Point, Position

__all__ = [
    "AgentAt",
    "BlockIs",
    "BlocksAlike",
    "ConditionEntry",
    "Fact",
    "GoalCondition",
    "ItemsIn",
    "ItemsWith",
    "LeversHeld",
    "NothingIn",
    "NothingWith",
    "Pursuit",
    "agrees",
    "check_condition",
    "condition_entry",
    "conditions_of",
]

_REACH = 6.0
"""Greatest distance in blocks from the eyes to the middle of a lever that an agent holds."""


class ConditionEntry(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """A condition on a container, an agent, agents at levers, or a block."""

    path: Annotated[str, note("Belief path in which it must hold; / is reality.", "path")] = "/"
    container: Annotated[Position | None, note("A container that holds `items`.", "block")] = None
    agent: Annotated[
        str | None, note("An agent that has `items` or stands `at` a place.", "agent")
    ] = None
    items: Annotated[
        dict[str, Annotated[int, msgspec.Meta(ge=1)]] | None,
        note("Item name to least count; {}: nothing at all.", "items"),
    ] = None
    at: Annotated[Position | None, note("A block position.", "block")] = None
    within: Annotated[float, note("Greatest distance from `at`, in blocks.", "keep")] = 1.0
    block: Annotated[Position | None, note("A block that has a state.", "block")] = None
    state: Annotated[str | None, note("name or name[property=value,...].", "wanted")] = None
    like: Annotated[Position | None, note("A block that it must equal.", "block")] = None
    agents: Annotated[
        tuple[str, ...], note("Agents that hold levers at once, one each.", "[agent]")
    ] = ()
    sites: Annotated[
        tuple[tuple[Position, ...], ...],
        note("Levers of each site; one site is enough.", "[[block]]"),
    ] = ()
    property: Annotated[str, note("Property to compare with `like`; empty: the state.", "keep")] = (
        ""
    )


@dataclass(frozen=True, slots=True)
class Pursuit:
    """Places and items that an agent can go to or take to bring a fact about.

    Attributes:
        at: Cells to stand in.
        near: Blocks to reach.
        items: Names of items to take.
    """

    at: Sequence[Position] = ()
    near: Sequence[Position] = ()
    items: Sequence[str] = ()


class Fact(ABC):
    """Fact that holds in a state or does not.

    Attributes:
        keys: Keys of `ConditionEntry` that select the kind.
        more: Further keys that it reads.
    """

    __slots__ = ()
    keys: ClassVar[tuple[str, str]]
    more: ClassVar[tuple[str, ...]] = ()

    @classmethod
    def read(cls, entry: ConditionEntry) -> Iterable["Fact"]:
        """Return the facts of an entry that has the keys; none if it is of another kind."""
        return [cls(*(getattr(entry, key) for key in (*cls.keys, *cls.more)))]

    @abstractmethod
    def __str__(self) -> str:
        """Return the fact in words."""

    @abstractmethod
    def holds(self, facts: GoalFacts) -> bool:
        """Return True if the fact holds, as far as is known."""

    @abstractmethod
    def effort(self, facts: PlanFacts) -> float:
        """Return the effort to bring about a fact that does not hold."""

    @abstractmethod
    def bringers(self, events: Iterable[PerceivedEvent]) -> set[str | None]:
        """Return the agents that brought the fact about.

        Args:
            events: Events until it came true.
        """

    def pursuit(self, agent: str, mine: Items) -> Pursuit:
        """Return what an agent that has some items can pursue."""
        return Pursuit()

    def task(self, agent: str) -> str | None:
        """Return the fact as a task of an agent, if there is a natural wording."""
        return None

    def sought(self, facts: GoalFacts) -> str | None:
        """Return the block state that a wrong block is to have; empty: unknown; None: any."""
        return None

    def removed(self, agent: str, facts: GoalFacts) -> Iterable[str]:
        """Return the items that an agent can take away to bring the fact about."""
        return ()

    @property
    def items(self) -> tuple[str, ...]:
        """Return the items that an agent must have or put somewhere."""
        return ()

    @property
    def store(self) -> Position | None:
        """Return the container into which the items are to be put; None: none."""
        return None

    @property
    def holder(self) -> str | None:
        """Return the agent that is to have the items; None: none."""
        return None

    @property
    def blocks(self) -> tuple[Position, ...]:
        """Return the blocks that the fact compares; the first is to be changed."""
        return ()

    def levers(self, agent: str, facts: GoalFacts) -> Iterable[Position]:
        """Return the known levers that an agent can turn on to bring the fact about."""
        return ()


@dataclass(frozen=True, slots=True)
class ItemsIn(Fact):
    """Fact: a container holds at least a number of an item."""

    keys = ("container", "items")
    place: Position
    item: str
    count: int = 1

    @classmethod
    def read(cls, entry: ConditionEntry) -> Iterable["ItemsIn"]:
        if entry.container is None or not entry.items:
            return ()
        return [cls(entry.container, item, count) for item, count in entry.items.items()]

    def __str__(self) -> str:
        return f"{self.count} {self.item} in the container at {self.place}"

    def holds(self, facts: GoalFacts) -> bool:
        return facts.items_in(self.place).get(self.item, 0) >= self.count

    def effort(self, facts: PlanFacts) -> float:
        missing = self.count - facts.items_in(self.place).get(self.item, 0)
        return missing * to_container(facts, self.place, self.item)

    def bringers(self, events: Iterable[PerceivedEvent]) -> set[str | None]:
        deposits = _acts_at(self.place, events, EventKind.DEPOSIT_ITEM_INTO_CHEST)
        return {each.actor for each in deposits if self.item in each.detail["items"]}

    def pursuit(self, agent: str, mine: Items) -> Pursuit:
        return Pursuit(near=[self.place]) if mine.get(self.item, 0) else Pursuit(items=[self.item])

    @property
    def items(self) -> tuple[str, ...]:
        return (self.item,)

    @property
    def store(self) -> Position | None:
        return self.place


@dataclass(frozen=True, slots=True)
class NothingIn(Fact):
    """Fact: a container holds nothing; contents that are not known completely do not count."""

    keys = ItemsIn.keys
    place: Position

    @classmethod
    def read(cls, entry: ConditionEntry) -> Iterable["NothingIn"]:
        return [] if entry.container is None or entry.items != {} else [cls(entry.container)]

    def __str__(self) -> str:
        return f"nothing in the container at {self.place}"

    def holds(self, facts: GoalFacts) -> bool:
        return facts.is_empty(self.place)

    def effort(self, facts: PlanFacts) -> float:
        return float(max(1, sum(facts.items_in(self.place).values())))

    def bringers(self, events: Iterable[PerceivedEvent]) -> set[str | None]:
        return {each.actor for each in _acts_at(self.place, events, EventKind.GET_ITEM_FROM_CHEST)}

    def removed(self, agent: str, facts: GoalFacts) -> Iterable[str]:
        return facts.items_in(self.place)


@dataclass(frozen=True, slots=True)
class AgentAt(Fact):
    """Fact: an agent stands within a distance of the middle of a block."""

    keys = ("agent", "at")
    more = ("within",)
    agent: str
    place: Position
    within: float = 1.0

    def __str__(self) -> str:
        return f"{self.agent} within {self.within:g} of {self.place}"

    def holds(self, facts: GoalFacts) -> bool:
        feet = facts.feet_of(self.agent)
        return feet is not None and self._distance(feet) <= self.within

    def effort(self, facts: PlanFacts) -> float:
        feet = facts.feet_of(self.agent)
        return 1.0 + (FAR if feet is None else self._distance(feet)) * PER_BLOCK

    def bringers(self, events: Iterable[PerceivedEvent]) -> set[str | None]:
        return {self.agent}

    def pursuit(self, agent: str, mine: Items) -> Pursuit:
        return Pursuit(at=[self.place]) if agent == self.agent else Pursuit()

    def _distance(self, feet: Point) -> float:
        x, y, z = self.place
        return math.dist(feet, (x + 0.5, float(y), z + 0.5))


@dataclass(frozen=True, slots=True)
class LeversHeld(Fact):
    """Fact: all levers of one site are on at once, each with a different agent at it.

    Attributes:
        agents: Names of the agents, as many as a site has levers; any agent may be at any lever.
        sites: Positions of the levers of each site.
    """

    keys = ("agents", "sites")
    agents: tuple[str, ...]
    sites: tuple[tuple[Position, ...], ...]

    def __str__(self) -> str:
        sites = " or ".join(str(list(site)) for site in self.sites)
        return f"{' and '.join(self.agents)} at once at levers that are on, at {sites}"

    def holds(self, facts: GoalFacts) -> bool:
        return any(self._missing(facts, site) == (0, 0.0) for site in self._known(facts))

    def effort(self, facts: PlanFacts) -> float:
        left = [self._missing(facts, site) for site in self._known(facts)]
        off = [deeds + far * PER_BLOCK for deeds, far in left]
        return 1.0 + min(off, default=2 * FAR * PER_BLOCK)

    def bringers(self, events: Iterable[PerceivedEvent]) -> set[str | None]:
        return set(self.agents)

    def pursuit(self, agent: str, mine: Items) -> Pursuit:
        levers = [lever for site in self.sites for lever in site]
        return Pursuit(near=levers) if agent in self.agents else Pursuit()

    def levers(self, agent: str, facts: GoalFacts) -> Iterable[Position]:
        sites = self._known(facts) if agent in self.agents else ()
        return [place for site in sites for place in site]

    def _known(self, facts: GoalFacts) -> list[tuple[Position, ...]]:
        """Return the sites whose levers are known."""
        return [
            site
            for site in self.sites
            if all(block_name(facts.block(place) or "") == "lever" for place in site)
        ]

    def _missing(self, facts: GoalFacts, site: tuple[Position, ...]) -> tuple[int, float]:
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


@dataclass(frozen=True, slots=True)
class ItemsWith(Fact):
    """Fact: an agent has at least a number of an item."""

    keys = ("agent", "items")
    agent: str
    item: str
    count: int = 1

    @classmethod
    def read(cls, entry: ConditionEntry) -> Iterable["ItemsWith"]:
        if entry.agent is None or not entry.items:
            return ()
        return [cls(entry.agent, item, count) for item, count in entry.items.items()]

    def __str__(self) -> str:
        return f"{self.agent} has {self.count} {self.item}"

    @property
    def holder(self) -> str | None:
        return self.agent

    def holds(self, facts: GoalFacts) -> bool:
        return facts.items_of(self.agent).get(self.item, 0) >= self.count

    def effort(self, facts: PlanFacts) -> float:
        return to_agent(facts, self.agent, self.item)

    def bringers(self, events: Iterable[PerceivedEvent]) -> set[str | None]:
        return {self.agent}

    def pursuit(self, agent: str, mine: Items) -> Pursuit:
        return Pursuit(items=[self.item]) if agent == self.agent else Pursuit()

    def task(self, agent: str) -> str | None:
        if self.agent != agent:
            return f"Help {self.agent}."
        return f"Get {self.count} {self.item} from a chest."

    @property
    def items(self) -> tuple[str, ...]:
        return (self.item,)


@dataclass(frozen=True, slots=True)
class NothingWith(Fact):
    """Fact: an agent has no items."""

    keys = ItemsWith.keys
    agent: str

    @classmethod
    def read(cls, entry: ConditionEntry) -> Iterable["NothingWith"]:
        return [] if entry.agent is None or entry.items != {} else [cls(entry.agent)]

    def __str__(self) -> str:
        return f"{self.agent} has nothing"

    def holds(self, facts: GoalFacts) -> bool:
        return not facts.items_of(self.agent)

    def effort(self, facts: PlanFacts) -> float:
        return float(sum(facts.items_of(self.agent).values()))

    def bringers(self, events: Iterable[PerceivedEvent]) -> set[str | None]:
        return {self.agent}

    def removed(self, agent: str, facts: GoalFacts) -> Iterable[str]:
        return facts.items_of(agent) if agent == self.agent else ()


class _BlockFact(Fact):
    """Fact about a block."""

    __slots__ = ()

    @abstractmethod
    def wanted(self, facts: GoalFacts) -> str | None:
        """Return the state or value that the block is to have; None: unknown."""

    def effort(self, facts: PlanFacts) -> float:
        return to_block(facts, self.blocks[0], self.wanted(facts))

    def bringers(self, events: Iterable[PerceivedEvent]) -> set[str | None]:
        here = _acts_at(self.blocks[0], events)
        changed = [each.actor for each in here if each.kind not in AT_CONTAINERS]
        return set(changed[-1:])

    def pursuit(self, agent: str, mine: Items) -> Pursuit:
        return Pursuit(near=self.blocks[:1])


@dataclass(frozen=True, slots=True)
class BlockIs(_BlockFact):
    """Fact: a block has a state; properties that are not named may have any value.

    Attributes:
        place: Position of the block.
        state: `name` or `name[property=value,...]`.
    """

    keys = ("block", "state")
    place: Position
    state: str

    def __str__(self) -> str:
        return f"{self.state} at {self.place}"

    def holds(self, facts: GoalFacts) -> bool:
        there = facts.block(self.place)
        return there is not None and agrees(there, self.state)

    def wanted(self, facts: GoalFacts) -> str | None:
        return self.state

    def sought(self, facts: GoalFacts) -> str | None:
        return self.state

    @property
    def blocks(self) -> tuple[Position, ...]:
        return (self.place,)


@dataclass(frozen=True, slots=True)
class BlocksAlike(_BlockFact):
    """Fact: a block equals another one, its model; an unknown block equals nothing.

    Attributes:
        place: Position of the block.
        model: Position of the model.
        only: Property in which both must agree; empty: in the whole state.
    """

    keys = ("block", "like")
    more = ("property",)
    place: Position
    model: Position
    only: str = ""

    def __str__(self) -> str:
        return f"{self.only or 'the block'} at {self.place} as at {self.model}"

    def holds(self, facts: GoalFacts) -> bool:
        wanted = self.wanted(facts)
        return wanted is not None and wanted == self._of(facts.block(self.place))

    def wanted(self, facts: GoalFacts) -> str | None:
        return self._of(facts.block(self.model))

    def sought(self, facts: GoalFacts) -> str | None:
        return None if self.only else self.wanted(facts) or ""

    @property
    def blocks(self) -> tuple[Position, ...]:
        return (self.place, self.model)

    def _of(self, text: str | None) -> str | None:
        return _property(text, self.only) if self.only else text


KINDS: tuple[type[Fact], ...] = (
    ItemsIn,
    NothingIn,
    AgentAt,
    LeversHeld,
    ItemsWith,
    NothingWith,
    BlockIs,
    BlocksAlike,
)
"""Kinds of facts that entries can state."""


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

    def bringers(self, events: Iterable[PerceivedEvent]) -> set[str | None]:
        """Return the agents that brought the condition about: by holding, having or doing."""
        return {self.path[0]} if self.path else self.fact.bringers(events)

    def __str__(self) -> str:
        return f"{path_text(self.path)}: {self.fact}" if self.path else str(self.fact)


def condition_entry(given: object, agents: Collection[str], box: Box) -> ConditionEntry:
    """Return a condition that was given as a mapping, checked.

    Raises:
        InputError, PathError, UnknownNameError: As for `check_condition`.
    """
    try:
        entry = msgspec.convert(given, ConditionEntry)
    except msgspec.ValidationError as fault:
        fields = ConditionEntry.__struct_fields__
        if isinstance(given, Mapping) and (others := [key for key in given if key not in fields]):
            raise InputError(
                f"the condition {given!r} has {', '.join(map(repr, others))}; its fields are "
                f"{', '.join(fields)}, and it is about one tick"
            ) from None
        raise InputError(f"the condition {given!r} is malformed: {fault}") from None
    check_condition(entry, agents, box)
    return entry


def check_condition(entry: ConditionEntry, agents: Collection[str], box: Box) -> None:
    """Check that everything that a condition names exists.

    Raises:
        InputError: The condition is not valid, or is about a place outside the box.
        PathError: The belief does not exist.
        UnknownNameError: The item or block does not exist.
    """
    conditions_of(entry, agents)
    registry = Registry.load()
    for name in entry.items or {}:
        registry.item_stack(name)
    if entry.state is not None:
        registry.state_id(entry.state)
    named = (entry.container, entry.at, entry.block, entry.like)
    places = [place for place in named if place is not None]
    for place in (*places, *(lever for site in entry.sites for lever in site)):
        if place not in box:
            raise InputError(
                f"a condition is about {place}, outside the box {box.low} to {box.high}"
            )


def conditions_of(entry: ConditionEntry, agents: Collection[str]) -> list[GoalCondition]:
    """Return the conditions of an entry, one for each fact and belief that it names.

    Raises:
        InputError: The entry is not valid.
        PathError: The belief does not exist.
    """
    path = parse_path(entry.path, agents)
    for name in (*entry.agents, *([] if entry.agent is None else [entry.agent])):
        if name not in agents:
            raise InputError(f"a condition is about {name!r}, who is no agent")
    if any(len(site) != len(entry.agents) for site in entry.sites):
        raise InputError("each site of a condition must have as many levers as there are `agents`")
    # msgspec omits a default by its identity, which a number loses on its way to another process.
    default = msgspec.structs.asdict(ConditionEntry())
    named = msgspec.structs.asdict(entry).items()
    given = {name: value for name, value in named if value != default[name]}
    keys = given.keys() - {"path"}
    kinds = [kind for kind in KINDS if {*kind.keys} <= keys <= {*kind.keys, *kind.more}]
    facts = [fact for kind in kinds for fact in kind.read(entry)]
    if not facts:
        *forms, last = dict.fromkeys(" and ".join(kind.keys) for kind in KINDS)
        raise InputError(
            f"the condition {given} makes no sense; give {', '.join(forms)}, or {last}"
        )
    return [GoalCondition(fact, path) for fact in facts]


@cache
def agrees(there: str, wanted: str) -> bool:
    """Return True if a block has a state; properties that are not named may have any value."""
    name, stated = parse_state(wanted)
    is_named, properties = parse_state(there)
    return is_named == name and stated.items() <= properties.items()


def _acts_at(
    place: Position, events: Iterable[PerceivedEvent], kind: EventKind | None = None
) -> list[PerceivedEvent]:
    here = [each for each in events if each.detail.get("position") == place]
    return [each for each in here if kind in (None, each.kind)]


def _beyond_reach(feet: Point | None, place: Position) -> float:
    """Return by how many blocks a place is out of an agent's reach; 0: within reach."""
    if feet is None:
        return FAR
    middle = tuple(value + 0.5 for value in place)
    return max(0.0, math.dist((feet[0], feet[1] + EYE_HEIGHT, feet[2]), middle) - _REACH)


@cache
def _property(text: str | None, name: str) -> str | None:
    if text is None:
        return None
    registry = Registry.load()
    found = registry.properties(registry.state_id(text)).get(name)
    return None if found is None else str(found)
