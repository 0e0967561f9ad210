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

import dataclasses
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from msgspec.structs import replace
from tests.semantics.reference_unique import is_perceived_elsewhere, remove

from beliefnest.belief.grounds import Basis, ContainerBelief, Source
from beliefnest.world.claims import Claim, ClaimKind, claims_of
from beliefnest.world.double_chests import holds_items
from beliefnest.world.registry import Registry
from beliefnest.world.values import EventKind, Items, Point, Position

if TYPE_CHECKING:
    from collections.abc import Iterable

    from tests.semantics.reference_rules import Block, Node, Rules, View

Matter = tuple[str, Any]
"""A place that can be watched: `("cell", position)` or `("agent", name)`."""


@dataclass
class Ear:
    """Memory by which the owner of a node weighs claims.

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
    verdicts: dict[Any, bool] = field(default_factory=dict)

    def copy(self) -> "Ear":
        return dataclasses.replace(
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
        """Return True if it was perceived to be nowhere but in some containers."""
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
        """Return the known place of a claim's subject."""
        if claim.kind is ClaimKind.POSITION:
            return ("agent", claim.agent) if claim.agent in self.met else None
        if claim.kind is ClaimKind.BLOCK:
            return ("cell", claim.place) if ("cell", claim.place) in self.watched else None
        return ("cell", self.found[claim.item]) if claim.item in self.found else None

    def missed_since(self, place: Matter, name: str) -> int:
        """Ticks without somebody since the place was last watched."""
        return self.missed[name] - self.watched[place][name]


def read(node: "Node", signs: "Iterable[tuple[Position, Block]]") -> None:
    """Read signs that are seen, each text on each once; who wrote is known from the writing."""
    for event in node.news:
        if event.kind is EventKind.BLOCK_UPDATE and event.actor and event.detail.get("text"):
            node.writers[event.detail["position"], event.detail["text"]] = event.actor
    seen = [(at, block) for at, block in signs if (at, block.text) not in node.read]
    node.read |= {(at, block.text) for at, block in seen}
    node.told = tuple((at, block, node.writers.get((at, block.text))) for at, block in seen)


def hear(rules: "Rules", after: "Node", around: "Node", me: str, view: "View | None") -> None:
    """Let the claims that are perceived in a tick have their effect (8.0 to 8.5)."""
    if rules.options.testimony == "none":
        return
    heard = [id(event) for event in after.news]
    for event in around.news:
        if event.kind is EventKind.CHAT:
            known = id(event) in heard
            for index, claim in enumerate(claims_of(event)):
                key = (id(event), index)
                _weigh(rules, after, around, me, view, claim, event.actor, key, known=known)
    # A sign is known to a model of its writer from whom it models.
    theirs = [told for told in around.told if told[2] == me]
    own = [told for told in after.told if told[2] != me]
    for place, block, writer in sorted([*theirs, *own], key=lambda told: told[0]):
        for index, claim in enumerate(block.claims):
            key = ((place, block.text, block.claims, writer), index)
            _weigh(rules, after, around, me, view, claim, writer, key, known=True)


def _weigh(
    rules: "Rules",
    after: "Node",
    around: "Node",
    me: str,
    view: "View | None",
    claim: Claim,
    speaker: str | None,
    key: Any,
    *,
    known: bool,
) -> None:
    if _is_beaten(rules, after, around, me, view, claim):
        believed = False
        after.ear.verdicts[key] = False
    elif speaker == me:
        believed = _taken_at_its_word(rules, after, around, me, claim, key)
    else:
        believed = known and _taken_up(rules, after, me, view, claim, speaker)
        after.ear.verdicts[key] = believed
    if believed:
        _believe(rules.registry, after, claim, speaker, rules.unique)


def _is_beaten(
    rules: "Rules", after: "Node", around: "Node", me: str, view: "View | None", claim: Claim
) -> bool:
    """Rule 0: whether what is perceived of the matter in this tick beats what is said."""
    if claim.kind is ClaimKind.POSITION and view is not None and claim.agent in view.agents:
        return True
    if claim.item is None:
        return view is not None and _sees_claimed(view, claim)
    if after.perceives(claim.cell, claim.item) or claim.kind is not ClaimKind.LOCATED:
        return after.perceives(claim.cell, claim.item)
    if view is not None and rules.is_gone(claim.cell, around, view):
        return True
    if claim.item in rules.unique and is_perceived_elsewhere(after, me, claim.item, claim.cell):
        return True
    return any(
        place != claim.cell and claim.item in content.items and after.perceives(place, claim.item)
        for place, content in after.containers.items()
    )


def _taken_up(
    rules: "Rules", after: "Node", me: str, view: "View | None", claim: Claim, speaker: str | None
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
    if known is None or speaker is None:
        return True
    return ear.missed_since(known, speaker) > rules.options.grace


def _taken_at_its_word(
    rules: "Rules", after: "Node", around: "Node", me: str, claim: Claim, key: Any
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
    registry: Registry, node: "Node", claim: Claim, speaker: str | None, unique: frozenset[str]
) -> None:
    """Condition 2: what a claim does to a node's beliefs."""
    basis = Basis(node.tick, Source.HEARD)
    if speaker is not None:
        basis = Basis(node.tick, Source.HEARD, EventKind.CHAT, speaker)
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
    from tests.semantics.reference_rules import Block

    place, text = claim.cell, claim.state or ""
    state, old = registry.state_id(text), node.blocks.get(place)
    name, written = registry.name(state), ""
    claims: tuple[Claim, ...] = ()
    if old is not None and registry.name(old.state) == name:
        written, claims = old.text, old.claims
        stated = dict(pair.split("=") for pair in text[len(name) + 1 : -1].split(",") if pair)
        properties = registry.properties(old.state) | stated
        inner = ",".join(f"{key}={value}" for key, value in properties.items())
        state = registry.state_id(f"{name}[{inner}]" if inner else name)
    node.blocks[place] = Block(state, basis, False, written, claims)
    old_name = None if old is None else registry.name(old.state)
    if not holds_items(registry, state) or old_name not in (None, name):
        node.drop(place)
    if holds_items(registry, state) and place not in node.containers:
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
