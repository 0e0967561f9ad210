"""Chain of perceptions behind a belief, computed from the log.

The log is folded once more, entry by entry, from the oldest basis on the path. For each belief
along the path a `_Finding` notes when the belief took its present value, and the first later change
in the parent node that did not reach it. `sightings` then says why it did not.

Contents of a container rest on more than one thing: somebody looked in, then saw items put in, then
heard a claim. The node keeps the last basis only; `_ElementGrounds` keeps all that still matter.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import msgspec
from msgspec.structs import replace

from beliefnest.belief.columns import cell_of, place_of
from beliefnest.belief.forest import Forest
from beliefnest.belief.grounds import Basis, PerceivedEvent, Source
from beliefnest.belief.holdings import Content, Holdings
from beliefnest.belief.node_view import NodeView
from beliefnest.belief.priors import merged_belief
from beliefnest.belief.testimony import Verdict
from beliefnest.errors import InputError, PathError
from beliefnest.nest.explain.element_history import (
    ExplainedSpan,
    LogStep,
    cells_of,
    last_change,
    observed_at,
    steps_since,
    touches,
    value_in,
)
from beliefnest.nest.explain.explanation import Explanation
from beliefnest.nest.explain.parts import (
    Absence,
    BaseFact,
    Contents,
    Element,
    HeardClaim,
    Level,
    Missed,
    Reason,
    SeenElsewhere,
    Sighting,
    Value,
    ValueGround,
)
from beliefnest.nest.explain.sightings import sighting_of_agent, sighting_of_block
from beliefnest.nest.past.recording import Recording
from beliefnest.timeline.journal import Edit, ForkPoint, TimelineKey
from beliefnest.world.claims import Claim, ClaimKind, claims_of
from beliefnest.world.event_kinds import EventKind
from beliefnest.world.frames import Frame
from beliefnest.world.paths import BeliefPath
from beliefnest.world.values import Items, Point, Position

_Acts = Mapping[int, tuple[PerceivedEvent, ...]]
"""Perceived acts on an element by tick."""


@dataclass
class _ElementGrounds:
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
    seen: Sequence[_Acts]
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


def _mattering(chain: Sequence[Reason], value: Contents, here: Position) -> tuple[Reason, ...]:
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


def element_of(
    recording: Recording, container: Position | None, agent: str | None, block: Position | None
) -> Element:
    """Return the one element that is asked for; raises as `ShownSimulator.explain` does."""
    named = [name for name in (container, agent, block) if name is not None]
    if len(named) != 1:
        raise InputError(
            f"explain() was given {len(named)} things; give exactly one of container=(x, y, z), "
            "agent='name' and block=(x, y, z)"
        )
    if agent is not None:
        if agent not in recording.agents:
            raise PathError(
                f"there is no agent {agent!r}; the agents are {', '.join(recording.agents)}"
            )
        return Element("agent", agent)
    if container is not None:
        place = recording.state(()).container_at(_inside(recording, container))
        return Element("container", place, recording.setting.labels.get(place))
    return Element("block", _inside(recording, block))


def _inside(recording: Recording, place: Position | None) -> Position:
    if not (
        isinstance(place, tuple) and len(place) == 3 and all(isinstance(p, int) for p in place)
    ):
        raise InputError(f"{place!r} is not a block position; give a tuple of three whole numbers")
    recording.box.check(place)
    return place


def explain(
    recording: Recording, path: BeliefPath, asked: Sequence[tuple[int | None, Element]]
) -> list[Explanation]:
    """Return the chains of perceptions behind a node's beliefs, in the order of the questions.

    Args:
        recording: Recording of the nest.
        path: Path of the node.
        asked: Questions: the tick of a belief (None: now) and the element that it is about.

    Raises:
        TickError: A tick is in the future, or before the start of everything.
    """
    moments = [(recording.moment(path, tick), element) for tick, element in asked]
    return _explained(recording, path, moments)


def _explained(
    recording: Recording, path: BeliefPath, asked: Sequence[tuple[ForkPoint, Element]]
) -> list[Explanation]:
    """Explain beliefs at moments: the fact in the timeline's world, then each level of belief."""
    inquiries = [_inquiry(recording, path, moment, element) for moment, element in asked]
    together: dict[TimelineKey, list[_Inquiry]] = {}
    for inquiry in inquiries:
        together.setdefault(inquiry.moment.timeline, []).append(inquiry)
    for some in together.values():
        _follow(recording, path, some)
    return [_explanation(recording, inquiry) for inquiry in inquiries]


def _inquiry(
    recording: Recording, path: BeliefPath, moment: ForkPoint, element: Element
) -> "_Inquiry":
    root = moment.timeline.path
    paths = [path[:depth] for depth in range(len(root), len(path) + 1)]
    now = _held_now(recording, path, moment, element)
    fact = _fact(recording, moment, now[root], element)
    traces = [
        _Finding(node, now[node], _grounds(recording, node, now, element)) for node in paths[1:]
    ]
    return _Inquiry(moment, element, fact, traces)


def _explanation(recording: Recording, inquiry: "_Inquiry") -> Explanation:
    """Return the answer to an inquiry.

    If the element has not changed since the fork of the timeline, also explain the belief there.
    """
    moment, element, fact = inquiry.moment, inquiry.element, inquiry.fact
    before = None
    base = recording.journal.info(moment.timeline).base
    if base is not None and fact.since is None:
        (before,) = _explained(recording, moment.timeline.path, [(base, element)])
    weighed = recording.setting.perception.testimony == "informed"
    levels = tuple(replace(_level(each, element), weighed=weighed) for each in inquiry.traces)
    return Explanation(element, moment.tick, fact, levels, before)


class _HeldNow(msgspec.Struct, frozen=True):
    """Value of an element in a node at the explained moment, with its ground, as users read it."""

    value: Value
    block: str | None
    basis: Basis | None
    current: bool
    events: tuple[PerceivedEvent, ...]


@dataclass
class _Finding:
    """Facts about one belief, collected while the log is folded.

    Attributes:
        path: Path of the node.
        held: The belief at the explained moment.
        since: Tick since which the node has held that value.
        stood: The owner's feet in the parent node at that tick.
        parent: Value in the parent node at that tick.
        was_known: True if the node ever held another value.
        missed: First later change in the parent node that did not reach the node.
        grounds: Grounds of the belief.
    """

    path: BeliefPath
    held: _HeldNow
    grounds: _ElementGrounds
    since: int | None = None
    stood: Point | None = None
    parent: Value = None
    was_known: bool = False
    missed: Missed | None = None

    @property
    def observed_at(self) -> int | None:
        """The last tick at which the belief was current."""
        return None if self.held.basis is None else self.held.basis.observed_at


@dataclass
class _Inquiry:
    """Question for a belief: its moment and element, the fact, and findings for each level."""

    moment: ForkPoint
    element: Element
    fact: BaseFact
    traces: list[_Finding]


def _held_now(
    recording: Recording, path: BeliefPath, moment: ForkPoint, element: Element
) -> dict[BeliefPath, _HeldNow]:
    root, history = moment.timeline.path, recording.history
    cells = cells_of(element, recording.box)
    states = {}
    if cells:
        (forest,) = history.steps(moment.timeline, path, moment.entries, moment.entries, cells)
    else:
        forest = history.shared(moment.timeline, path, moment.entries)
    for depth in range(len(root), len(path) + 1):
        node = path[:depth]
        basis, current = _ground_of(recording, moment, forest, node, element)
        block, value = None, value_in(forest, node, element)
        if not isinstance(element.where, str):
            number = forest.block(node, cell_of(recording.box, element.where))
            # Contents can be believed where no container is known: in the air, for example.
            context = recording.context
            is_container = isinstance(value, Contents)
            block = context.container_name(number) if is_container else context.block_name(number)
        events = NodeView(forest, node).perceived
        if current and basis is not None:
            basis = replace(basis, observed_at=moment.tick)
        states[node] = _HeldNow(value, block, basis, current, events)
    return states


def _ground_of(
    recording: Recording, moment: ForkPoint, forest: Forest, node: BeliefPath, element: Element
) -> tuple[Basis | None, bool]:
    """Return the basis of a node's value, and True if the value is current."""
    reading = NodeView(forest, node, moment.tick)
    if isinstance(element.where, str):
        agent = reading.agents[element.where]
        return agent.basis, agent.current
    if element.kind == "container":
        content = reading.containers.get(element.where)
        return (None, False) if content is None else (content.basis, content.current)
    cell = cell_of(recording.box, element.where)
    basis = forest.bases(node, [cell])[cell]
    current = recording.history.current_blocks(moment, node, (cell,))
    return basis, cell in current


def _fact(recording: Recording, moment: ForkPoint, belief: _HeldNow, element: Element) -> BaseFact:
    change = last_change(recording.history, recording.journal, moment, element)
    base = recording.journal.info(moment.timeline).base
    return BaseFact(
        path=moment.timeline.path,
        branch=moment.timeline.branch,
        value=belief.value,
        block=belief.block,
        since=None if change is None else change.tick,
        acts=() if change is None else _acts(belief.events, change.tick, element),
        edited=isinstance(change, Edit),
        forked_at=None if base is None else base.tick,
    )


def _follow(recording: Recording, path: BeliefPath, inquiries: Sequence[_Inquiry]) -> None:
    """Fold the log from the oldest basis on, and note in each trace what happened.

    Args:
        recording: Recording of the nest.
        path: Path of the node.
        inquiries: Inquiries about one timeline.
    """
    spans = {
        number: ExplainedSpan(each.moment, min(_begin(recording, trace) for trace in each.traces))
        for number, each in enumerate(inquiries)
        if each.traces
    }
    if not spans:
        return
    cells = {cell for each in inquiries for cell in cells_of(each.element, recording.box)}
    history, journal = recording.history, recording.journal
    for number, step in steps_since(history, journal, path, spans, sorted(cells)):
        moment, element = inquiries[number].moment, inquiries[number].element
        is_last = (step.timeline, step.forest.position) == (moment.timeline, moment.entries)
        for trace in inquiries[number].traces:
            _take(recording, trace, step, element)
            if is_last and trace.held.basis is None:
                parent = value_in(step.forest, trace.path[:-1], element)
                if parent is not None:
                    # The node never knew the element: explain why the owner does not see it now.
                    missed = _missed(recording, trace.path, step, element, parent, acts=())
                    trace.missed = replace(missed, tick=moment.tick)


def _take(recording: Recording, trace: _Finding, step: LogStep, element: Element) -> None:
    """Update the findings on one belief after one entry."""
    forest = step.forest
    outside = value_in(forest, trace.path[:-1], element)
    mine = value_in(forest, trace.path, element)
    trace.grounds.take(step)
    is_held, goes_on = _is_held(trace, forest, mine, element)
    if not is_held:
        trace.was_known = True
        trace.since, trace.missed = None, None
        return
    if trace.since is None or goes_on:
        if trace.observed_at is None and not trace.was_known:
            return
        trace.since, trace.parent = forest.tick, outside
        trace.stood = forest.feet(trace.path[:-1], trace.path[-1])
    elif trace.missed is None and outside != trace.parent and trace.observed_at is not None:
        edited = isinstance(step.entry, Edit) and step.entry.path == trace.path[:-1]
        events = NodeView(forest, trace.path[:-1]).perceived
        acts = () if edited else _acts(events, forest.tick, element)
        missed = _missed(recording, trace.path, step, element, trace.parent, acts)
        trace.missed = replace(missed, edited=edited)


def _is_held(trace: _Finding, forest: Forest, value: Value, element: Element) -> tuple[bool, bool]:
    """Return if a node holds the explained value already, and if it still perceives it.

    While a value is current it is one perception, which lasts up to its `observed_at`. So a value
    with an earlier `observed_at` is the same belief as long as it is current.
    """
    ground, current = observed_at(forest, trace.path, element)
    if value != trace.held.value or trace.observed_at is None or ground is None:
        return value == trace.held.value and ground == trace.observed_at, False
    if current:
        return ground <= trace.observed_at, ground <= trace.observed_at
    return ground == trace.observed_at, False


def _missed(
    recording: Recording,
    path: BeliefPath,
    step: LogStep,
    element: Element,
    before: Value,
    acts: tuple[PerceivedEvent, ...],
) -> Missed:
    """Return why a change or a value in the parent of a node did not reach the node."""
    forest = step.forest
    mine = NodeView(forest, path).perceived if acts else ()
    present = forest.is_present(path)
    parent = NodeView(forest, path[:-1])
    return Missed(
        tick=forest.tick,
        before=before,
        after=value_in(forest, path[:-1], element),
        acts=acts,
        edited=False,
        stood=forest.feet(path[:-1], path[-1]),
        absence=None if present else _absence(recording, forest, path),
        sightings=_sightings(recording, parent, path[-1], element, acts) if present else (),
        saw_acts=bool(acts) and all(act in mine for act in acts),
    )


def _absence(recording: Recording, forest: Forest, path: BeliefPath) -> Absence:
    """Return why the parent of a node does not see the node's owner."""
    parent = path[:-1]
    last_seen = forest.seen_at(parent, path[-1])
    if forest.node(parent) == 0 or not forest.is_present(parent):
        return Absence(last_seen, None)
    outer = NodeView(forest, parent[:-1])
    box = recording.box
    return Absence(last_seen, sighting_of_agent(outer, box, parent[-1], path[-1]))


def _sightings(
    recording: Recording,
    parent: NodeView,
    viewer: str,
    element: Element,
    acts: Iterable[PerceivedEvent],
) -> tuple[Sighting, ...]:
    """Return the looks that would have shown a change: at its actors and at the element."""
    box = recording.box
    if isinstance(element.where, str):
        return (sighting_of_agent(parent, box, viewer, element.where),)
    actors: list[str] = []
    if element.kind == "container":
        actors = sorted({act.actor for act in acts if act.actor is not None})
    return (
        *(sighting_of_agent(parent, box, viewer, actor) for actor in actors),
        sighting_of_block(parent, box, viewer, element.where),
    )


def _acts(
    events: Iterable[PerceivedEvent], tick: int, element: Element
) -> tuple[PerceivedEvent, ...]:
    return tuple(event for event in events if event.tick == tick and touches(element, event))


def _grounds(
    recording: Recording, path: BeliefPath, beliefs: Mapping[BeliefPath, _HeldNow], element: Element
) -> _ElementGrounds:
    """Return the grounds of a node at the beginning of everything: its prior beliefs."""
    seen = []
    for node in (path[:depth] for depth in range(len(path), 0, -1) if path[:depth] in beliefs):
        acts: dict[int, tuple[PerceivedEvent, ...]] = {}
        for event in beliefs[node].events:
            if touches(element, event):
                acts[event.tick] = (*acts.get(event.tick, ()), event)
        seen.append(acts)
    grounds = _ElementGrounds(path, element, seen)
    setting = recording.setting
    basis = Basis(setting.snapshot.tick, Source.PRIOR)
    priors = merged_belief(setting.initial_beliefs, path).containers
    for place, (items, complete) in priors.items() if element.kind == "container" else ():
        if place == element.where:
            grounds.content = Content(dict(items), complete, basis)
            contents = Contents(dict(items), complete)
            grounds.chain.append(ValueGround(basis, basis.observed_at, None, found=contents))
    return grounds


def _begin(recording: Recording, trace: _Finding) -> int:
    """Return the tick from which on the log has to be folded for a belief.

    For an unknown element this is the beginning, to find out if it was ever known. It is also for
    contents that rest on more than their basis.
    """
    basis, path = trace.held.basis, trace.path
    first = recording.setting.snapshot.tick
    if basis is None:
        return first
    if isinstance(trace.held.value, Contents):
        acts = trace.grounds.seen[0].get(basis.observed_at, ())
        is_change = basis.source is Source.WITNESSED and all(a.actor != path[-1] for a in acts)
        if is_change or basis.source is Source.HEARD or recording.setting.unique:
            return first
    return basis.observed_at


def _level(trace: _Finding, element: Element) -> Level:
    belief = trace.held
    at = trace.observed_at
    since = trace.since
    if since is not None and at is not None:
        since = max(since, at)
    return Level(
        path=trace.path,
        holder=trace.path[-1],
        value=belief.value,
        block=belief.block,
        basis=belief.basis,
        current=belief.current,
        since=since,
        stood=trace.stood,
        missed=trace.missed,
        reasons=_reasons(trace, since, element),
    )


def _reasons(trace: _Finding, since: int | None, element: Element) -> tuple[Reason, ...]:
    """Return what a value rests on, in the order in which it came."""
    chain, basis, value = trace.grounds.chain, trace.held.basis, trace.held.value
    if isinstance(value, Contents) and not isinstance(element.where, str) and basis and chain:
        *before, last = _mattering(chain, value, element.where)
        if isinstance(last, ValueGround) and trace.held.current:
            last = replace(last, basis=basis)
        return (*before, last)
    if basis is None or since is None:
        return tuple(chain) if element.kind == "container" else ()
    claims = tuple(e for e in chain if isinstance(e, HeardClaim) and e.tick == basis.observed_at)
    if basis.source is Source.HEARD and claims:
        return claims
    return (trace.grounds.ground(basis, since, trace.stood),)
