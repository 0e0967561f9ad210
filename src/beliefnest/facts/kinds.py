"""Facts: how something is. A container's items, an agent's place, a block's state, a sign's text.

The one language of goals, expectations, `share`, evidence and claims; docs/facts.md describes it
for users. Each kind of fact is a class that reads, writes, judges and words itself, and says what
it takes to bring it about. To add a kind, add its keys to `FactEntry`, and its class to `KINDS`.
"""

import itertools
import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from dataclasses import astuple, dataclass
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import msgspec

from beliefnest.errors import InputError
from beliefnest.facts.effort import FAR, PER_BLOCK, to_agent, to_block, to_container
from beliefnest.facts.states import Facts, Look, PlanFacts, StateFacts
from beliefnest.world import forms
from beliefnest.world.claims import Claim
from beliefnest.world.event_kinds import AT_CONTAINERS, EventKind
from beliefnest.world.forms import note
from beliefnest.world.paths import BeliefPath, path_text
from beliefnest.world.registry import Registry, block_name, parse_state
from beliefnest.world.signs import sign_words
from beliefnest.world.texts import quoted
from beliefnest.world.values import EYE_HEIGHT, Items, Point, Position, block_at
from beliefnest.world.words import items_words, point_text, point_words

if TYPE_CHECKING:
    from beliefnest.belief.grounds import PerceivedEvent

WITHIN = 1.0
"""Distance in blocks within which an agent counts as being at a place, if no other is given."""

_REACH = 6.0
"""Greatest distance in blocks from the eyes to the middle of a lever that an agent holds."""

Named = Callable[[Position], str]
"""Function from the position of a container to its name for people."""


class FactEntry(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """A fact about a container, an agent, agents at levers, a block, a sign, or an utterance."""

    path: Annotated[str, note("Belief path of the fact; / is reality.", "path")] = "/"
    container: Annotated[
        forms.WrittenPosition | None, note("A container that holds `items`.", "block")
    ] = None
    agent: Annotated[
        str | None, note("An agent that has `items` or stands `at` a place.", "agent")
    ] = None
    items: Annotated[
        dict[str, int] | None, note("Item name to count; {}: nothing at all.", "items")
    ] = None
    at: Annotated[
        forms.WrittenPoint | msgspec.UnsetType | None,
        note("A block position, or the middle of the feet; null: unknown.", "place"),
    ] = msgspec.UNSET
    within: Annotated[forms.Within, note("Greatest distance from `at`, in blocks.", "keep")] = (
        WITHIN
    )
    block: Annotated[forms.WrittenPosition | None, note("A block that has a state.", "block")] = (
        None
    )
    state: Annotated[
        str | msgspec.UnsetType | None,
        note("name or name[property=value,...]; null: unknown.", "wanted"),
    ] = msgspec.UNSET
    lacks: Annotated[str | None, note("An item that a container does not hold.", "item")] = None
    like: Annotated[forms.WrittenPosition | None, note("A block that it must equal.", "block")] = (
        None
    )
    property: Annotated[str, note("Property to compare with `like`; empty: the state.", "keep")] = (
        ""
    )
    sign: Annotated[forms.WrittenPosition | None, note("A sign that says `text`.", "block")] = None
    text: Annotated[
        str | msgspec.UnsetType | None, note("Exact text of the sign; null: unknown.", "text")
    ] = msgspec.UNSET
    heard: Annotated[str | None, note("Part of a known utterance.", "text")] = None
    not_heard: Annotated[str | None, note("Text that no known utterance contains.", "text")] = None
    agents: Annotated[
        tuple[str, ...], note("Agents that hold levers at once, one each.", "[agent]")
    ] = ()
    sites: Annotated[
        tuple[tuple[forms.WrittenPosition, ...], ...],
        note("Levers of each site; one site is enough.", "[[block]]"),
    ] = ()

    def __reduce__(self) -> tuple[Any, ...]:
        # Learners copy environments by cloudpickle, which looks for a value that pickles as a bare
        # name, as msgspec's UNSET does, in every module.
        return msgspec.convert, (msgspec.to_builtins(self), FactEntry)


class Pursuit(msgspec.Struct, frozen=True):
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
        keys: Keys of `FactEntry` that select the kind, in the order of the fields of the class.
        more: Further keys that it reads.
        noted: True if pictures show what was found as a line of its own.
    """

    __slots__ = ()
    keys: ClassVar[tuple[str, ...]]
    more: ClassVar[tuple[str, ...]] = ()
    noted: ClassVar[bool] = False

    @classmethod
    def read(cls, entry: FactEntry) -> "Fact | None":
        """Return the fact of an entry that has the keys; None if it is of another kind."""
        return cls(*(getattr(entry, key) for key in (*cls.keys, *cls.more)))

    def written(self) -> dict[str, Any]:
        """Return plain values with the keys of files."""
        # Subclasses are dataclasses; their base is none.
        values = zip((*self.keys, *self.more), astuple(self), strict=True)  # type: ignore[call-overload]
        usual = {"within": WITHIN, "property": ""}
        return {
            key: list(value) if isinstance(value, tuple) else value
            for key, value in values
            if key not in usual or value != usual[key]
        }

    @property
    def parts(self) -> "Sequence[Fact]":
        """Return the smallest facts that it consists of, which goals count one by one."""
        return (self,)

    @abstractmethod
    def __str__(self) -> str:
        """Return the fact in words."""

    @abstractmethod
    def holds(self, facts: Facts) -> bool:
        """Return True if the fact holds, as far as is known."""

    def instead(self, facts: Facts) -> str | None:
        """Return what a state holds instead of what is expected; None: it is as expected."""
        return None if self.holds(facts) else f"not so: {self}"

    def found(self, facts: StateFacts, named: Named) -> tuple[str, str]:
        """Return what was looked for, and what a state holds, for a table."""
        return str(self), "yes" if self.holds(facts) else "no"

    @property
    def claims(self) -> Sequence[Claim]:
        """Return the claims that state the fact; none if it cannot be claimed."""
        return ()

    @property
    def edit(self) -> tuple[str, Any, Any] | None:
        """Return an argument of `edit` with key and value that make it so; None: none does."""
        return None

    def effort(self, facts: PlanFacts) -> float:
        """Return the effort to bring about a fact that does not hold."""
        return 1.0

    @abstractmethod
    def bringers(self, events: Iterable["PerceivedEvent"]) -> set[str | None]:
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

    def sought(self, facts: Facts) -> str | None:
        """Return the block state that a wrong block is to have; empty: unknown; None: any."""
        return None

    def removed(self, agent: str, facts: Facts) -> Iterable[str]:
        """Return the items that an agent can take away to bring the fact about."""
        return ()

    @property
    def items(self) -> tuple[str, ...]:
        """Return the items that an agent must have or put somewhere."""
        return ()

    @property
    def store(self) -> Position | None:
        """Return the container that the fact is about; None: none."""
        return None

    @property
    def holder(self) -> str | None:
        """Return the agent whose items the fact is about; None: none."""
        return None

    @property
    def placed(self) -> str | None:
        """Return the agent whose place the fact is about; None: none."""
        return None

    @property
    def blocks(self) -> tuple[Position, ...]:
        """Return the blocks that the fact compares; the first is to be changed."""
        return ()

    def levers(self, agent: str, facts: Facts) -> Iterable[Position]:
        """Return the known levers that an agent can turn on to bring the fact about."""
        return ()


@dataclass(frozen=True, slots=True)
class _Items(Fact):
    """Fact about the items of a container or an agent; without items: it has nothing.

    As a condition it holds if there are at least the items. As an expectation it must name exactly
    the known items.

    Attributes:
        owner: Position of the container, or name of the agent.
        wanted: Names and counts of the items.
    """

    owner: Any
    wanted: tuple[tuple[str, int], ...] = ()

    @classmethod
    def read(cls, entry: FactEntry) -> "Fact":
        return cls(getattr(entry, cls.keys[0]), tuple((entry.items or {}).items()))

    def written(self) -> dict[str, Any]:
        return {**Fact.written(self), "items": self.counts}

    @property
    def counts(self) -> dict[str, int]:
        """Return the items by name."""
        return dict(self.wanted)

    @property
    def parts(self) -> Sequence[Fact]:
        return [type(self)(self.owner, (each,)) for each in self.wanted] or [self]

    @abstractmethod
    def known(self, facts: Facts) -> Items:
        """Return the items that are known to be there."""

    @property
    @abstractmethod
    def has(self) -> str:
        """Return the container or agent with a verb, such as `ann has`."""

    def holds(self, facts: Facts) -> bool:
        items = self.known(facts)
        return all(items.get(item, 0) >= count for item, count in self.wanted)

    def instead(self, facts: Facts) -> str | None:
        items = dict(self.known(facts))
        if items == self.counts:
            return None
        actual, wanted = (_named(each) for each in (items, self.counts))
        return f"{self.has} {actual}, not {wanted}"

    @property
    def items(self) -> tuple[str, ...]:
        return tuple(self.counts)


@dataclass(frozen=True, slots=True)
class ItemsIn(_Items):
    """Fact: a container holds items.

    Contents that are not known completely do not count as nothing.
    """

    keys = ("container", "items")

    def __str__(self) -> str:
        return f"{_named(self.counts)} in the container at {self.owner}"

    @property
    def has(self) -> str:
        return f"{point_words(self.owner)} holds"

    def known(self, facts: Facts) -> Items:
        return facts.items_in(self.owner)

    def holds(self, facts: Facts) -> bool:
        return _Items.holds(self, facts) and bool(
            self.wanted or (facts.is_complete(self.owner) and not self.known(facts))
        )

    def found(self, facts: StateFacts, named: Named) -> tuple[str, str]:
        if not self.wanted:
            return named(self.owner), _named(self.known(facts))
        places = [named(place) for place in facts.containers_with(self.counts)]
        return ", ".join(self.counts), " and ".join(places) or "nowhere"

    def effort(self, facts: PlanFacts) -> float:
        items = self.known(facts)
        if not self.wanted:
            return float(max(1, sum(items.values())))
        return sum(
            max(0, count - items.get(item, 0)) * to_container(facts, self.owner, item)
            for item, count in self.wanted
        )

    def bringers(self, events: Iterable["PerceivedEvent"]) -> set[str | None]:
        if not self.wanted:
            takings = _acts_at(self.owner, events, EventKind.GET_ITEM_FROM_CHEST)
            return {each.actor for each in takings}
        deposits = _acts_at(self.owner, events, EventKind.DEPOSIT_ITEM_INTO_CHEST)
        return {each.actor for each in deposits if self.counts.keys() & each.detail["items"].keys()}

    def pursuit(self, agent: str, mine: Items) -> Pursuit:
        has_some = any(mine.get(item, 0) for item in self.counts)
        return Pursuit(near=[self.owner]) if has_some else Pursuit(items=self.items)

    def removed(self, agent: str, facts: Facts) -> Iterable[str]:
        return () if self.wanted else self.known(facts)

    @property
    def claims(self) -> Sequence[Claim]:
        return [Claim.located(item, self.owner) for item in self.items]

    @property
    def edit(self) -> tuple[str, Any, Any] | None:
        return "containers", self.owner, self.counts

    @property
    def store(self) -> Position | None:
        place: Position = self.owner
        return place


@dataclass(frozen=True, slots=True)
class Lacks(Fact):
    """Fact: a container does not hold an item; contents must be known completely.

    Attributes:
        place: Position of the container.
        item: Name of the item.
    """

    keys = ("container", "lacks")
    place: Position
    item: str

    def __str__(self) -> str:
        return f"no {self.item} in the container at {self.place}"

    def holds(self, facts: Facts) -> bool:
        return facts.is_complete(self.place) and not facts.items_in(self.place).get(self.item, 0)

    def effort(self, facts: PlanFacts) -> float:
        return float(max(1, facts.items_in(self.place).get(self.item, 0)))

    def bringers(self, events: Iterable["PerceivedEvent"]) -> set[str | None]:
        takings = _acts_at(self.place, events, EventKind.GET_ITEM_FROM_CHEST)
        return {each.actor for each in takings if self.item in each.detail["items"]}

    def removed(self, agent: str, facts: Facts) -> Iterable[str]:
        return (self.item,)

    @property
    def claims(self) -> Sequence[Claim]:
        return [Claim.absent(self.item, self.place)]

    @property
    def store(self) -> Position | None:
        return self.place


@dataclass(frozen=True, slots=True)
class AgentAt(Fact):
    """Fact: an agent stands within a distance of a place.

    Attributes:
        agent: Name of the agent.
        place: Block position, whose middle counts, or middle of the feet; None: unknown.
        within: Greatest distance from there, in blocks.
    """

    keys = ("agent", "at")
    more = ("within",)
    agent: str
    place: Position | Point | None
    within: float = WITHIN

    @classmethod
    def read(cls, entry: FactEntry) -> "AgentAt | None":
        if entry.agent is None or isinstance(entry.at, msgspec.UnsetType):
            return None
        place = entry.at
        is_block = place is not None and all(value.is_integer() for value in map(float, place))
        return cls(entry.agent, block_at(place) if place and is_block else place, entry.within)

    def __str__(self) -> str:
        if self.place is None:
            return f"{self.agent} at an unknown place"
        return f"{self.agent} within {self.within:g} of {point_words(self.place)}"

    @property
    def claims(self) -> Sequence[Claim]:
        return () if self.place is None else [Claim.position(self.agent, middle_of(self.place))]

    @property
    def edit(self) -> tuple[str, Any, Any] | None:
        return None if self.place is None else ("agents", self.agent, middle_of(self.place))

    @property
    def placed(self) -> str | None:
        return self.agent

    def holds(self, facts: Facts) -> bool:
        feet = facts.feet_of(self.agent)
        if self.place is None or feet is None:
            return self.place is feet
        return math.dist(feet, middle_of(self.place)) <= self.within

    def instead(self, facts: Facts) -> str | None:
        actual, wanted = (
            "nowhere" if each is None else f"at {point_words(each)}"
            for each in (facts.feet_of(self.agent), self.place)
        )
        return None if self.holds(facts) else f"{self.agent} is {actual}, not {wanted}"

    def found(self, facts: StateFacts, named: Named) -> tuple[str, str]:
        feet = facts.feet_of(self.agent)
        return self.agent, "unknown" if feet is None else point_text(feet)

    def effort(self, facts: PlanFacts) -> float:
        feet, place = facts.feet_of(self.agent), self.place
        far = FAR if feet is None or place is None else math.dist(feet, middle_of(place))
        return 1.0 + far * PER_BLOCK

    def bringers(self, events: Iterable["PerceivedEvent"]) -> set[str | None]:
        return {self.agent}

    def pursuit(self, agent: str, mine: Items) -> Pursuit:
        if agent != self.agent or self.place is None:
            return Pursuit()
        return Pursuit(at=[block_at(self.place)])


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

    def holds(self, facts: Facts) -> bool:
        sites = self._known(facts)
        return any(not _is_off(facts, site) and not self._far(facts, site) for site in sites)

    def effort(self, facts: PlanFacts) -> float:
        sites = self._known(facts)
        off = [_is_off(facts, site) + self._far(facts, site) * PER_BLOCK for site in sites]
        return 1.0 + min(off, default=2 * FAR * PER_BLOCK)

    def bringers(self, events: Iterable["PerceivedEvent"]) -> set[str | None]:
        return set(self.agents)

    def pursuit(self, agent: str, mine: Items) -> Pursuit:
        levers = [lever for site in self.sites for lever in site]
        return Pursuit(near=levers) if agent in self.agents else Pursuit()

    def levers(self, agent: str, facts: Facts) -> Iterable[Position]:
        sites = self._known(facts) if agent in self.agents else ()
        return [place for site in sites for place in site]

    def _known(self, facts: Facts) -> list[tuple[Position, ...]]:
        """Return the sites whose levers are known."""
        return [
            site
            for site in self.sites
            if all(block_name(facts.block(place) or "") == "lever" for place in site)
        ]

    def _far(self, facts: Facts, site: tuple[Position, ...]) -> float:
        """Return how far the holders of levers are from them, in blocks."""
        return min(
            sum(
                _beyond_reach(facts.feet_of(agent), place)
                for agent, place in zip(self.agents, places, strict=True)
            )
            for places in itertools.permutations(site)
        )


def _is_off(facts: Facts, levers: Iterable[Position]) -> int:
    """Return the number of levers that are off."""
    return sum(_property(facts.block(place), "powered") != "true" for place in levers)


@dataclass(frozen=True, slots=True)
class ItemsWith(_Items):
    """Fact: an agent has items."""

    keys = ("agent", "items")

    def __str__(self) -> str:
        return f"{self.has} {_named(self.counts)}"

    @property
    def has(self) -> str:
        return f"{self.owner} has"

    def known(self, facts: Facts) -> Items:
        return facts.items_of(self.owner)

    def holds(self, facts: Facts) -> bool:
        return _Items.holds(self, facts) and bool(self.wanted or not self.known(facts))

    def found(self, facts: StateFacts, named: Named) -> tuple[str, str]:
        return f"items of {self.owner}", _named(self.known(facts))

    def effort(self, facts: PlanFacts) -> float:
        if not self.wanted:
            return float(sum(self.known(facts).values()))
        return sum(to_agent(facts, self.owner, item) for item in self.items)

    def bringers(self, events: Iterable["PerceivedEvent"]) -> set[str | None]:
        return {self.owner}

    def pursuit(self, agent: str, mine: Items) -> Pursuit:
        return Pursuit(items=self.items) if agent == self.owner else Pursuit()

    def task(self, agent: str) -> str | None:
        if not self.wanted:
            return None
        return (
            f"Get {_named(self.counts)} from a chest."
            if self.owner == agent
            else f"Help {self.owner}."
        )

    def removed(self, agent: str, facts: Facts) -> Iterable[str]:
        return () if self.wanted or agent != self.owner else self.known(facts)

    @property
    def holder(self) -> str | None:
        name: str = self.owner
        return name


class _BlockFact(Fact):
    """Fact about a block."""

    __slots__ = ()

    @abstractmethod
    def wanted(self, facts: Facts) -> str | None:
        """Return the state or value that the block is to have; None: unknown."""

    def effort(self, facts: PlanFacts) -> float:
        return to_block(facts, self.blocks[0], self.wanted(facts))

    def bringers(self, events: Iterable["PerceivedEvent"]) -> set[str | None]:
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
        state: `name` or `name[property=value,...]`; None: the block is unknown.
    """

    keys = ("block", "state")
    place: Position
    state: str | None

    def __str__(self) -> str:
        return f"{self.state or 'an unknown block'} at {self.place}"

    def holds(self, facts: Facts) -> bool:
        there = facts.block(self.place)
        if self.state is None or there is None:
            return self.state is there
        return agrees(there, self.state)

    def instead(self, facts: Facts) -> str | None:
        if self.holds(facts):
            return None
        there = facts.block(self.place)
        return f"{point_words(self.place)} is {there or 'unknown'}, not {self.state or 'unknown'}"

    def found(self, facts: StateFacts, named: Named) -> tuple[str, str]:
        return f"block {point_words(self.place)}", facts.block(self.place) or "unknown"

    def wanted(self, facts: Facts) -> str | None:
        return self.state

    def sought(self, facts: Facts) -> str | None:
        return self.state

    @property
    def claims(self) -> Sequence[Claim]:
        return () if self.state is None else [Claim.block(self.place, self.state)]

    @property
    def edit(self) -> tuple[str, Any, Any] | None:
        return None if self.state is None else ("blocks", self.place, self.state)

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

    def __post_init__(self) -> None:
        if self.only:
            Registry.load().check_property(self.only)

    def __str__(self) -> str:
        return f"{self.only or 'the block'} at {self.place} as at {self.model}"

    def holds(self, facts: Facts) -> bool:
        wanted = self.wanted(facts)
        return wanted is not None and wanted == self._of(facts.block(self.place))

    def wanted(self, facts: Facts) -> str | None:
        return self._of(facts.block(self.model))

    def sought(self, facts: Facts) -> str | None:
        return None if self.only else self.wanted(facts) or ""

    @property
    def blocks(self) -> tuple[Position, ...]:
        return (self.place, self.model)

    def _of(self, text: str | None) -> str | None:
        return _property(text, self.only) if self.only else text


@dataclass(frozen=True, slots=True)
class SignSays(Fact):
    """Fact: a sign has a text.

    Attributes:
        place: Position of the sign.
        text: Its text; None: the text is unknown.
    """

    keys = ("sign", "text")
    place: Position
    text: str | None

    def __str__(self) -> str:
        if self.text is None:
            return f"an unknown text on the sign at {self.place}"
        return f"{sign_words(self.text)!r} on the sign at {self.place}"

    def holds(self, facts: Facts) -> bool:
        return facts.sign(self.place) == self.text

    def instead(self, facts: Facts) -> str | None:
        there, where = facts.sign(self.place), point_words(self.place)
        if there == self.text:
            return None
        actual = f"of a sign at {where} nothing is known"
        if there is not None:
            actual = f"the sign at {where} says {sign_words(there)!r}"
        return f"{actual}, not {'unknown' if self.text is None else repr(sign_words(self.text))}"

    def found(self, facts: StateFacts, named: Named) -> tuple[str, str]:
        there = facts.sign(self.place)
        words = "unknown" if there is None else sign_words(there) or "nothing"
        return f"sign {point_words(self.place)}", words

    def bringers(self, events: Iterable["PerceivedEvent"]) -> set[str | None]:
        writings = _acts_at(self.place, events, EventKind.BLOCK_UPDATE)
        return {each.actor for each in writings if each.detail.get("text") == self.text}


@dataclass(frozen=True, slots=True)
class Heard(Fact):
    """Fact: an utterance is known.

    Attributes:
        text: Part of the utterance.
        ever: False for the opposite, that no utterance with this part is known.
    """

    keys = ("heard",)
    noted = True
    ever: ClassVar[bool] = True
    text: str

    def __post_init__(self) -> None:
        if not self.text.strip():
            raise InputError(f"{quoted(self.keys[0])} is empty; give part of an utterance")

    def __str__(self) -> str:
        return f"{self.text!r} {'was' if self.ever else 'was not'} heard"

    def holds(self, facts: Facts) -> bool:
        return facts.has_heard(self.text) is self.ever

    def instead(self, facts: Facts) -> str | None:
        is_heard = facts.has_heard(self.text)
        if is_heard is self.ever:
            return None
        return f"{self.text!r} was {'' if is_heard else 'not '}heard"

    def found(self, facts: StateFacts, named: Named) -> tuple[str, str]:
        return f"{self.text!r}", "heard" if facts.has_heard(self.text) else "not heard"

    def bringers(self, events: Iterable["PerceivedEvent"]) -> set[str | None]:
        said = (each for each in events if each.kind is EventKind.CHAT)
        return {each.actor for each in said if self.text in each.detail["text"]}


class NotHeard(Heard):
    """Fact: no known utterance contains a text."""

    __slots__ = ()
    keys = ("not_heard",)
    ever = False


KINDS: tuple[type[Fact], ...] = (
    ItemsIn,
    Lacks,
    AgentAt,
    LeversHeld,
    ItemsWith,
    BlockIs,
    BlocksAlike,
    SignSays,
    Heard,
    NotHeard,
)
"""Kinds of facts that entries can state."""


def middle_of(place: Point | Position) -> Point:
    """Return the middle of the feet at a place: whole numbers name a block, others are a point."""
    x, y, z = place
    if all(float(value).is_integer() for value in place):
        return (x + 0.5, float(y), z + 0.5)
    return (x, y, z)


class StatedFact(msgspec.Struct, frozen=True):
    """Fact that somebody wants, expects or observes, in reality or in a belief.

    Attributes:
        fact: The fact.
        path: Belief path; `()` is reality.
        label: Name for tables.
    """

    fact: Fact
    path: BeliefPath = ()
    label: str = ""

    @property
    def simulator(self) -> str:
        """Return the path as text."""
        return path_text(self.path)

    @property
    def where(self) -> str:
        """Return the simulator for people: `reality`, or its path."""
        return self.simulator if self.path else "reality"

    def written(self) -> dict[str, Any]:
        """Return plain values: path, label, and the fact with the keys of scenario files."""
        return {"path": self.simulator, "label": self.label, "expected": self.fact.written()}

    def holds(self, look: Look) -> bool:
        """Return True if the fact holds there."""
        return self.fact.holds(look(self.path))

    def bringers(self, events: Iterable["PerceivedEvent"]) -> set[str | None]:
        """Return the agents that brought the condition about: by holding, having or doing."""
        return {self.path[0]} if self.path else self.fact.bringers(events)

    def __str__(self) -> str:
        return f"{self.simulator}: {self.fact}" if self.path else str(self.fact)


def _named(items: Items) -> str:
    """Return items with their names in the game; `nothing` if there are none."""
    return items_words(items, ids=True) or "nothing"


@cache
def agrees(there: str, wanted: str) -> bool:
    """Return True if a block has a state; properties that are not named may have any value."""
    name, stated = parse_state(wanted)
    is_named, properties = parse_state(there)
    return is_named == name and stated.items() <= properties.items()


def _acts_at(
    place: Position, events: Iterable["PerceivedEvent"], kind: EventKind | None = None
) -> list["PerceivedEvent"]:
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
    value = registry.properties(registry.state_id(text)).get(name)
    return None if value is None else str(value)
