"""Grounds on which a node's value of an element rests, collected entry by entry.

Contents of a container rest on more than one thing: somebody looked in, then saw items put in, then
heard a claim. The node keeps the last basis only; this module keeps all that still matter.
"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from msgspec.structs import replace

from beliefnest.belief.columns import cell_of, place_of
from beliefnest.belief.forest import Forest
from beliefnest.belief.grounds import Basis, PerceivedEvent, Source
from beliefnest.belief.holdings import Content, Holdings
from beliefnest.belief.node_view import NodeView
from beliefnest.belief.testimony import Verdict
from beliefnest.nest.explain.element_history import LogStep
from beliefnest.nest.explain.parts import (
    Contents,
    Element,
    HeardClaim,
    Reason,
    SeenElsewhere,
    ValueGround,
)
from beliefnest.timeline.journal import Edit
from beliefnest.world.claims import Claim, ClaimKind, claims_of
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.frames import Frame
from beliefnest.world.paths import BeliefPath
from beliefnest.world.values import Items, Point, Position

Acts = Mapping[int, tuple[PerceivedEvent, ...]]
"""Perceived acts on an element by tick."""


@dataclass
class ElementGrounds:
    """Grounds of one node's value of an element.

    Attributes:
        path: Path of the node.
        element: The element.
        seen: Acts on the element as the node perceived them, then as its ancestors did, the nearest
            first.
        content: Contents of the container after the last entry; None: the node knows of none.
        chain: Grounds and claims in the order in which they came. For blocks and agents these are
            claims alone.
    """

    path: BeliefPath
    element: Element
    seen: Sequence[Acts]
    content: Content | None = None
    chain: list[Reason] = field(default_factory=list)
    _confirmed: set[HeardClaim] = field(default_factory=set)

    def take(self, step: LogStep) -> None:
        """Follow one entry of the log."""
        if self.element.kind != "container" or isinstance(self.element.where, str):
            self.chain += self._told(step, {})
            return
        forest, old = step.forest, self.content
        holdings = forest.holdings.of(forest.node(self.path))
        new = holdings.containers.get(cell_of(forest.context.box, self.element.where))
        self.content = None if new is None else new.at(forest.tick)
        had = {} if old is None else old.items
        left = {} if self.content is None else self.content.items
        lost = [item for item in had if item not in left]
        moves: list[Reason] = [*self._told(step, had), *self._elsewhere(step, lost)]
        if self.content is None:
            self.chain = [*moves]
            return
        self._perceive(step, old, self.content, is_moved=bool(moves))
        # If a claim was repeated, keep only its last utterance.
        said = [_said(each) for each in moves]
        self.chain = [each for each in self.chain if _said(each) not in said] + moves
        self._refute(forest, holdings)

    def _perceive(
        self, step: LogStep, old: Content | None, new: Content, *, is_moved: bool
    ) -> None:
        """Add what the owner perceived of the container in an entry, if it perceived anything.

        Args:
            step: The forest after the entry.
            old: Contents before it.
            new: Contents after it.
            is_moved: True if claims or unique items elsewhere changed the contents.
        """
        tick, owner, basis = step.forest.tick, self.path[-1], new.basis
        acts = self.seen[0].get(tick, ()) if isinstance(step.entry, Frame) else ()
        acts = tuple(act for act in acts if act.kind.traits.stores or act.actor == owner)
        if is_moved and acts:
            basis = Basis(tick, Source.WITNESSED, acts[-1].kind)
        elif is_moved or (old is not None and (old.basis, old.items) == (basis, new.items)):
            return
        if old is not None and old.in_sight and basis == old.at(basis.observed_at).basis:
            *self.chain, last = self.chain
            if isinstance(last, ValueGround) and not new.in_sight:
                # The owner lost sight of it: the same ground, with the last tick at which it held.
                self.chain.append(replace(last, basis=basis, since=basis.observed_at))
                return
        is_change = bool(acts) and all(act.actor != owner for act in acts) and not new.in_sight
        contents = None if is_change or is_moved else Contents(dict(new.items), new.complete)
        ground = self.ground(basis, tick, step.forest.feet(self.path[:-1], owner))
        ground = replace(ground, is_change=is_change, found=contents)
        self.chain = [*(self.chain if is_change else ()), ground]

    def ground(self, basis: Basis, since: int, stood: Point | None) -> ValueGround:
        """Return the ground of a basis that the node took up at a tick."""
        handed_on = since > basis.observed_at or basis.source is Source.HEARD
        seen = self.seen if handed_on else self.seen[:1]
        acts = next((acts[basis.observed_at] for acts in seen if basis.observed_at in acts), ())
        return ValueGround(basis, since, stood, handed_on, acts=acts)

    def _told(self, step: LogStep, had: Items) -> Iterator[HeardClaim]:
        """Yield the claims of one entry about the element that the node believed.

        Args:
            step: The forest after the entry.
            had: Items in the container before the entry.
        """
        forest = step.forest
        node, whole = forest.node(self.path), NodeView(forest, self.path).container_at
        events = step.entry.events if isinstance(step.entry, Frame) else ()
        for row, event in enumerate(events):
            for index, claim in enumerate(claims_of(event) if event.kind is EventKind.CHAT else ()):
                verdicts = forest.verdicts.get((row, index))
                about = claim.of_whole(whole)
                if verdicts and verdicts[node].believed and self._matters(about, had):
                    yield HeardClaim(forest.tick, event.actor, about)
        for (cell, _), statement in forest.holdings.of(node).told.items():
            if statement.tick != forest.tick or isinstance(step.entry, Edit):
                continue
            claims = forest.context.claims_on(forest.block(self.path, cell))
            for claim, verdict in zip(claims, statement.verdicts, strict=False):
                about = claim.of_whole(whole)
                if self._matters(about, had) and Verdict(verdict).believed:
                    sign = place_of(forest.context.box, cell)
                    yield HeardClaim(forest.tick, statement.speaker, about, sign)

    def _matters(self, claim: Claim, had: Items) -> bool:
        """Return True if a believed claim changes or confirms the value of the element."""
        match claim.kind:
            case ClaimKind.POSITION:
                return claim.agent == self.element.where
            case ClaimKind.BLOCK:
                return claim.cell == self.element.where
            case ClaimKind.ABSENT:
                return claim.cell == self.element.where and claim.item in had
            case ClaimKind.LOCATED:
                return self.element.kind == "container" and (
                    claim.cell == self.element.where or claim.item in had
                )

    def _elsewhere(self, step: LogStep, lost: Sequence[str]) -> Iterator[SeenElsewhere]:
        """Yield the items among `lost` that are unique and that one entry placed elsewhere."""
        forest = step.forest
        tick, sole = forest.tick, forest.holdings.of(forest.node(self.path)).sole
        for item in lost:
            if isinstance(step.entry, Edit):
                to = [place for place, items in step.entry.containers.items() if item in items]
                if step.entry.path == self.path and to not in ([], [self.element.where]):
                    yield SeenElsewhere(tick, item, to[0], edited=True)
            elif item in sole and sole[item].tick == tick:
                where = forest.place_of(self.path, sole[item].place)
                if where != self.element.where:
                    yield SeenElsewhere(tick, item, where)

    def _refute(self, forest: Forest, holdings: Holdings) -> None:
        """Set `refuted` of claims if the owner now perceives that the item is not there."""
        for number, each in enumerate(self.chain):
            if (
                not isinstance(each, HeardClaim)
                or each.claim.kind is not ClaimKind.LOCATED
                or each.claim.cell == self.element.where
                or each.refuted is not None
                or each in self._confirmed
            ):
                continue
            cell, item = cell_of(forest.context.box, each.claim.cell), str(each.claim.item)
            content = holdings.containers.get(cell)
            if content is None or (
                item not in content.items
                and content.basis.source in (Source.SEEN, Source.WITNESSED)
            ):
                self.chain[number] = replace(each, refuted=forest.tick)
            elif item in holdings.counts.get(cell, {}):
                self._confirmed.add(each)


def _said(each: Reason) -> object:
    if isinstance(each, HeardClaim):
        return each.speaker, each.claim, each.sign
    return each


def mattering(chain: Sequence[Reason], value: Contents, here: Position) -> tuple[Reason, ...]:
    """Return the part of a chain that explains some contents: its last element and what it needs.

    A deposit explains as many items as were put in. A claim that an item is there does not replace
    earlier perceptions of this item. If the contents are known to be complete, the last removal of
    each item is part of the explanation.

    Args:
        chain: Grounds and claims in the order in which they came; not empty.
        value: The contents.
        here: Position of the container.
    """
    need, removed = Counter(value.items), set[str]()
    kept: list[Reason] = []
    for each in reversed(chain):
        if isinstance(each, ValueGround) and not each.is_change:
            if not kept or (each.tells_contents and (value.complete or need.total() > 0)):
                kept.append(each)
            break
        change = _change(each, here)
        gone = {item for item, count in change.items() if count < 0} - removed
        removed |= gone
        if kept and not (any(need[item] for item in change) or (value.complete and gone)):
            continue
        kept.append(each)
        for item, count in change.items():
            if need[item] or not isinstance(each, ValueGround):
                need[item] = max(0, need[item] - count)
    return tuple(reversed(kept))


def _change(each: Reason, here: Position) -> Mapping[str, int]:
    """Return by how much a ground or claim changed the count of items; 0: it said the same."""
    match each:
        case ValueGround(acts=acts):
            change = Counter[str]()
            for act in acts:
                for item, count in act.detail.get("items", {}).items():
                    change[item] += (act.kind.traits.stores or 0) * count
            return change
        case SeenElsewhere(item=item):
            return {item: -1}
        case HeardClaim(claim=claim):
            stays = claim.kind is ClaimKind.LOCATED and claim.cell == here
            return {} if claim.item is None else {claim.item: 0 if stays else -1}
