"""Testimony (semantics, section 8), written from its text alone; slow, claim by claim.

Where the text leaves something open, the choice made here is:

* What is current in a node is what its holder perceives; the tick of the claim counts.
* Somebody whose last place is seen empty has no known place, as an item has none then.
* An item seen taken out of a container has no known place, unless more of it was perceived there.
* `located` takes the item from where it was believed last, and what is left there rests on what
  it rested on; it moves nothing if it is believed to be where the claim says.
* `absent` where nothing of it is believed has no effect.
* Properties that a claim about a block does not name stay as they are believed.
* Nobody can be told where they are themselves.
"""

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from tests.nest.reference_unique import is_perceived_elsewhere, remove

from beliefnest.belief.entries import Basis, ContainerBelief, Source
from beliefnest.world.claims import Claim, ClaimKind, claims_of
from beliefnest.world.registry import Registry
from beliefnest.world.values import Event, EventKind, Items, Point, Position

if TYPE_CHECKING:
    from tests.nest.reference_rules import Node, Rules, View

Matter = tuple[str, Any]
"""A place that can be watched: `("cell", position)` or `("agent", name)`."""


@dataclass
class Ear:
    """What a node's holder keeps in mind to weigh claims.

    Attributes:
        until: Tick to which `missed` is counted.
        missed: By agent, the ticks at which the holder did not perceive it.
        missing: Agents that it does not perceive now.
        seen: Places that it sees now.
        watched: By place, `missed` as it was when the place was last watched.
        found: By item, the container in which it was last perceived.
        counts: By container and item, how many of it were perceived there.
        met: By agent, where it was last perceived.
        verdicts: By number of event and claim of this tick, what became of the claim.
    """

    until: int
    missed: dict[str, int]
    missing: frozenset[str] = frozenset()
    seen: frozenset[Matter] = frozenset()
    watched: dict[Matter, dict[str, int]] = field(default_factory=dict)
    found: dict[str, Position] = field(default_factory=dict)
    counts: dict[tuple[Position, str], int] = field(default_factory=dict)
    met: dict[str, Point] = field(default_factory=dict)
    verdicts: dict[tuple[int, int], bool] = field(default_factory=dict)

    def copy(self) -> "Ear":
        return replace(
            self,
            missed=dict(self.missed),
            watched=dict(self.watched),
            found=dict(self.found),
            counts=dict(self.counts),
            met=dict(self.met),
            verdicts={},
        )

    def pass_to(self, tick: int) -> None:
        """Let ticks pass in which what was current stays so."""
        for name in self.missing:
            self.missed[name] += tick - self.until
        self.until = tick
        self._watch(self.seen)

    def perceive(self, missing: set[str], seen: set[Matter], acts: set[Matter], tick: int) -> None:
        """Note what is perceived at a tick, or between two if `until` has come there."""
        self.missing, self.seen = frozenset(missing), frozenset(seen)
        for name in missing:
            self.missed[name] += tick - self.until
        self.until = tick
        self._watch(seen | acts)

    def _watch(self, places: "set[Matter] | frozenset[Matter]") -> None:
        missed = dict(self.missed)
        self.watched.update(dict.fromkeys(places, missed))

    def put(self, place: Position, items: Items, sign: int) -> None:
        """Items were perceived to go into a container, or out of it."""
        for item, count in items.items():
            there = max(self.counts.get((place, item), 0) + sign * count, 0)
            self._is_there(place, item, there)

    def look_into(self, place: Position, items: Items) -> None:
        """All that is to be found in a container was perceived."""
        self.forget(place)
        for item, count in items.items():
            self._is_there(place, item, count)

    def find_elsewhere(self, item: str, kept: set[Position]) -> None:
        """It was perceived to be nowhere but in some containers."""
        for place, name in list(self.counts):
            if name == item and place not in kept:
                del self.counts[place, name]
        if self.found.get(item) not in kept:
            self.found.pop(item, None)

    def forget(self, place: Position) -> None:
        """Nothing of what was perceived there is there any more."""
        for at, item in [key for key in self.counts if key[0] == place]:
            del self.counts[at, item]
        for item in [item for item, at in self.found.items() if at == place]:
            del self.found[item]

    def _is_there(self, place: Position, item: str, count: int) -> None:
        if count:
            self.counts[place, item] = count
            self.found[item] = place
        else:
            self.counts.pop((place, item), None)
            self.found.pop(item, None)

    def known(self, claim: Claim) -> Matter | None:
        """The known place of what a claim is about."""
        if claim.kind is ClaimKind.POSITION:
            return ("agent", claim.agent) if claim.agent in self.met else None
        if claim.kind is ClaimKind.BLOCK:
            return ("cell", claim.place) if ("cell", claim.place) in self.watched else None
        return ("cell", self.found[claim.item]) if claim.item in self.found else None

    def missed_since(self, place: Matter, name: str) -> int:
        """Ticks without somebody since the place was last watched."""
        return self.missed[name] - self.watched[place][name]


def hear(rules: "Rules", after: "Node", around: "Node", me: str, view: "View | None") -> None:
    """Let the claims that are perceived in a tick have their effect (8.1 to 8.4)."""
    testimony = rules.options.testimony
    heard = [id(event) for event in after.news]
    for number, event in enumerate(around.events):
        if testimony == "none" or event not in around.news:
            continue
        for index, claim in enumerate(claims_of(event)):
            if _is_beaten(after, me, view, claim, rules.unique):
                believed = False
                after.ear.verdicts[number, index] = False
            elif event.actor == me:
                believed = _taken_at_its_word(rules, after, around, me, claim, (number, index))
            else:
                believed = id(event) in heard and _taken_up(rules, after, me, view, claim, event)
                after.ear.verdicts[number, index] = believed
            if believed:
                _believe(rules.registry, after, claim, event, rules.unique)


def _is_beaten(
    after: "Node", me: str, view: "View | None", claim: Claim, unique: frozenset[str]
) -> bool:
    """Rule 0: whether what is perceived of the matter in this tick beats what is said."""
    if claim.kind is ClaimKind.POSITION and view is not None and claim.agent in view.agents:
        return True
    if claim.item is None:
        return view is not None and _sees_claimed(view, claim)
    if after.perceives(claim.cell, claim.item):
        return True
    if claim.kind is ClaimKind.LOCATED and claim.item in unique:
        if is_perceived_elsewhere(after, me, claim.item, claim.cell):
            return True
    return claim.kind is ClaimKind.LOCATED and any(
        place != claim.cell and claim.item in content.items and after.perceives(place, claim.item)
        for place, content in after.containers.items()
    )


def _taken_up(
    rules: "Rules", after: "Node", me: str, view: "View | None", claim: Claim, event: Event
) -> bool:
    """Condition 1: of somebody who is not the speaker."""
    if claim.agent == me:
        return False
    if rules.options.testimony == "accept":
        return True
    known, ear = after.ear.known(claim), after.ear
    if claim.item is None:
        if known in ear.seen or (view is not None and _sees_claimed(view, claim)):
            return False
    elif any(
        after.perceives(place, claim.item) for place in (ear.found.get(claim.item), claim.cell)
    ):
        return False
    assert event.actor is not None
    return known is None or ear.missed_since(known, event.actor) > rules.options.grace


def _taken_at_its_word(
    rules: "Rules", after: "Node", around: "Node", me: str, claim: Claim, key: tuple[int, int]
) -> bool:
    """Condition 3: of the speaker, in somebody's model of it."""
    if not around.path:
        return False
    if rules.options.testimony == "accept":
        return True
    known, grace = after.ear.known(claim), rules.options.grace
    if known is not None and after.ear.missed_since(known, me) <= grace:
        return False
    return rules.options.sincere or around.ear.verdicts.get(key, False)


def _sees_claimed(view: "View", claim: Claim) -> bool:
    if claim.kind is ClaimKind.POSITION:
        return view.would_see(claim.place)
    return view.sees(claim.cell)


def _believe(
    registry: Registry, node: "Node", claim: Claim, event: Event, unique: frozenset[str]
) -> None:
    """Condition 2: what a claim does to a node's beliefs."""
    basis = Basis(node.tick, Source.HEARD, EventKind.CHAT, event.actor)
    match claim.kind:
        case ClaimKind.POSITION:
            old = node.agents[claim.agent or ""]
            node.agents[claim.agent or ""] = replace(
                old,
                position=claim.place,
                yaw=0.0,
                pitch=0.0,
                on_ground=True,
                basis=basis,
                current=False,
            )
        case ClaimKind.BLOCK:
            _believe_block(registry, node, claim, basis)
        case ClaimKind.LOCATED:
            _believe_located(node, claim.item or "", claim.cell, basis)
            if claim.item in unique:
                remove(node, claim.item, basis, {("container", claim.cell)})
        case ClaimKind.ABSENT:
            item, old_content = claim.item or "", node.containers.get(claim.cell)
            if old_content is not None and item in old_content.items:
                items = {name: n for name, n in old_content.items.items() if name != item}
                _hold(node, claim.cell, items, basis)


def _believe_block(registry: Registry, node: "Node", claim: Claim, basis: Basis) -> None:
    from tests.nest.reference_rules import Block

    place, text = claim.cell, claim.state or ""
    state, old = registry.state_id(text), node.blocks.get(place)
    name, written = registry.name(state), ""
    if old is not None and registry.name(old.state) == name:
        written = old.text
        stated = dict(pair.split("=") for pair in text[len(name) + 1 : -1].split(",") if pair)
        properties = registry.properties(old.state) | stated
        inner = ",".join(f"{key}={value}" for key, value in properties.items())
        state = registry.state_id(f"{name}[{inner}]" if inner else name)
    node.blocks[place] = Block(state, basis, False, written)
    old_name = None if old is None else registry.name(old.state)
    if not registry.is_container(name) or old_name not in (None, name):
        node.drop(place)
    if registry.is_container(name) and place not in node.containers:
        node.containers[place] = ContainerBelief({}, False, basis, current=False)


def _believe_located(node: "Node", item: str, place: Position, basis: Basis) -> None:
    there = node.containers.get(place)
    items = {} if there is None else dict(there.items)
    if item not in items:
        holding = {p: c for p, c in node.containers.items() if item in c.items}
        if holding:
            donor = min(holding, key=lambda p: (-holding[p].basis.observed_at, p))
            left = dict(holding[donor].items)
            left[item] -= 1
            left = {name: n for name, n in left.items() if n}
            _hold(node, donor, left, holding[donor].basis if left else basis)
        items[item] = 1
    _hold(node, place, items, basis)


def _hold(node: "Node", place: Position, items: Items, basis: Basis) -> None:
    old = node.containers.get(place)
    complete = old is not None and old.complete
    node.containers[place] = ContainerBelief(items, complete, basis, current=False)
