"""Chain of perceptions behind a belief, computed from the log.

The log is folded once more, entry by entry, from the oldest basis on the path. For each belief
along the path a `_Finding` notes when the belief took its present value, and the first later change
in the parent node that did not reach it. `sightings` then says why it did not.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from beliefnest.belief.columns import cell_of, place_of
from beliefnest.belief.forest import Forest
from beliefnest.belief.grounds import Basis, PerceivedEvent
from beliefnest.belief.node_view import NodeView
from beliefnest.belief.testimony import Verdict
from beliefnest.errors import InputError, PathError
from beliefnest.nest.explain.element_history import (
    LogStep,
    cells_of,
    is_current,
    last_change,
    observed_at,
    steps_since,
    touches,
    value_in,
)
from beliefnest.nest.explain.explanation import Explanation
from beliefnest.nest.explain.parts import (
    Absence,
    Contents,
    Element,
    Fact,
    HeardClaim,
    Level,
    Missed,
    SeenElsewhere,
    Sighting,
    Value,
)
from beliefnest.nest.explain.sightings import sighting_of_agent, sighting_of_block
from beliefnest.nest.past.recording import Recording
from beliefnest.timeline.journal import Edit, Entry, ForkPoint
from beliefnest.world.claims import ClaimKind, claims_of
from beliefnest.world.frames import Frame
from beliefnest.world.paths import BeliefPath
from beliefnest.world.values import EventKind, Point, Position

__all__ = ["element_of", "explain"]


def element_of(
    recording: Recording,
    container: Position | None,
    agent: str | None,
    block: Position | None,
) -> Element:
    """Return the one element that is asked for; raises as `ShownSimulator.explain` does."""
    given = [name for name in (container, agent, block) if name is not None]
    if len(given) != 1:
        raise InputError(
            f"explain() was given {len(given)} things; give exactly one of container=(x, y, z), "
            "agent='name' and block=(x, y, z)"
        )
    if agent is not None:
        if agent not in recording.agents:
            raise PathError(
                f"there is no agent {agent!r}; the agents are {', '.join(recording.agents)}"
            )
        return Element("agent", agent)
    if container is not None:
        return Element("container", _inside(recording, container))
    return Element("block", _inside(recording, block))


def _inside(recording: Recording, place: Position | None) -> Position:
    if not (
        isinstance(place, tuple) and len(place) == 3 and all(isinstance(p, int) for p in place)
    ):
        raise InputError(f"{place!r} is not a block position; give a tuple of three whole numbers")
    recording.box.check(place)
    return place


def explain(
    recording: Recording, path: BeliefPath, tick: int | None, element: Element
) -> Explanation:
    """Return the chain of perceptions behind a node's belief about an element.

    Args:
        recording: Recording of the nest.
        path: Path of the node.
        tick: Tick of the belief; None: now.
        element: The element.

    Raises:
        TickError: The tick is in the future, or before the start of everything.
    """
    return _explained(recording, path, recording.moment(path, tick), element)


def _explained(
    recording: Recording, path: BeliefPath, moment: ForkPoint, element: Element
) -> Explanation:
    """Explain a belief at a moment: the fact in the timeline's world, then each level of belief.

    If the element has not changed since the fork of the timeline, also explain the belief there.
    """
    root = moment.timeline.path
    paths = [path[:depth] for depth in range(len(root), len(path) + 1)]
    now = _held_now(recording, path, moment, element)
    fact = _fact(recording, moment, now[root], element)
    traces = [_Finding(node, now[node]) for node in paths[1:]]
    _follow(recording, path, moment, element, traces)
    before = None
    base = recording.journal.info(moment.timeline).base
    if base is not None and fact.since is None:
        before = _explained(recording, root, base, element)
    weighed = recording.setting.perception.testimony == "informed"
    levels = tuple(replace(_level(trace, element), weighed=weighed) for trace in traces)
    return Explanation(element, moment.tick, fact, levels, before)


@dataclass(frozen=True)
class _HeldNow:
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
        was_known: Whether the node ever held another value.
        missed: First later change in the parent node that did not reach the node.
        value: Value in the node after the last entry.
        told: Claims that moved the element's items.
        elsewhere: Perceptions of unique items that moved the element's items.
    """

    path: BeliefPath
    held: _HeldNow
    since: int | None = None
    stood: Point | None = None
    parent: Value = None
    was_known: bool = False
    missed: Missed | None = None
    value: Value = None
    told: list[HeardClaim] = field(default_factory=list)
    elsewhere: list[SeenElsewhere] = field(default_factory=list)

    @property
    def observed_at(self) -> int | None:
        """The last tick at which the belief was current."""
        return None if self.held.basis is None else self.held.basis.observed_at


def _held_now(
    recording: Recording, path: BeliefPath, moment: ForkPoint, element: Element
) -> dict[BeliefPath, _HeldNow]:
    root, history = moment.timeline.path, recording.history
    cells = cells_of(element, recording.box)
    held = {}
    if cells:
        (forest,) = history.steps(moment.timeline, path, moment.entries, moment.entries, cells)
    else:
        forest = history.shared(moment.timeline, path, moment.entries)
    for depth in range(len(root), len(path) + 1):
        node = path[:depth]
        basis, current = _ground_of(recording, moment, forest, node, element)
        block = None
        if not isinstance(element.where, str):
            cell = cell_of(recording.box, element.where)
            block = recording.context.block_name(forest.block(node, cell))
        events = NodeView(forest, node).events()
        if current and basis is not None:
            basis = replace(basis, observed_at=moment.tick)
        held[node] = _HeldNow(value_in(forest, node, element), block, basis, current, events)
    return held


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
    current = recording.history.current_blocks(moment.timeline, node, moment.entries, (cell,))
    return basis, cell in current


def _fact(recording: Recording, moment: ForkPoint, held: _HeldNow, element: Element) -> Fact:
    change = last_change(recording.history, recording.journal, moment, element)
    base = recording.journal.info(moment.timeline).base
    return Fact(
        path=moment.timeline.path,
        branch=moment.timeline.branch,
        value=held.value,
        block=held.block,
        since=None if change is None else change.tick,
        acts=() if change is None else _acts(held.events, change.tick, element),
        edited=isinstance(change, Edit),
        forked_at=None if base is None else base.tick,
    )


def _follow(
    recording: Recording,
    path: BeliefPath,
    moment: ForkPoint,
    element: Element,
    traces: list[_Finding],
) -> None:
    """Fold the log from the oldest basis on, and note in each trace what happened."""
    if not traces:
        return
    # For an unknown element start at the beginning, to find out if it was ever known.
    first = recording.setting.snapshot.tick
    start = min(first if trace.observed_at is None else trace.observed_at for trace in traces)
    last = None
    for step in steps_since(recording.history, recording.journal, path, moment, start, element):
        last = step
        for trace in traces:
            _take(recording, trace, step, element)
    for trace in traces:
        if last is not None and trace.held.basis is None:
            parent = value_in(last.forest, trace.path[:-1], element)
            if parent is not None:
                # The node never knew the element: explain why the owner does not see it now.
                missed = _missed(recording, trace.path, last, element, parent, acts=())
                trace.missed = replace(missed, tick=moment.tick)


def _take(recording: Recording, trace: _Finding, step: LogStep, element: Element) -> None:
    """Update the findings on one belief after one entry."""
    forest = step.forest
    outside = value_in(forest, trace.path[:-1], element)
    mine = value_in(forest, trace.path, element)
    if mine != trace.value:
        trace.elsewhere += _elsewhere(step, trace.path, element, trace.value)
        trace.value = mine
        trace.told += _told(recording, trace.path, step, element)
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
        entry = _entry(recording, step)
        edited = isinstance(entry, Edit) and entry.path == trace.path[:-1]
        events = NodeView(forest, trace.path[:-1]).events()
        acts = () if edited else _acts(events, forest.tick, element)
        missed = _missed(recording, trace.path, step, element, trace.parent, acts)
        trace.missed = replace(missed, edited=edited)


def _is_held(trace: _Finding, forest: Forest, value: Value, element: Element) -> tuple[bool, bool]:
    """Return if a node holds the explained value already, and if it still perceives it.

    While a value is current it is one perception, which lasts up to its `observed_at`. So a value
    with an earlier `observed_at` is the same belief as long as it is current.
    """
    ground = observed_at(forest, trace.path, element)
    if value != trace.held.value or trace.observed_at is None or ground is None:
        return value == trace.held.value and ground == trace.observed_at, False
    if is_current(forest, trace.path, element):
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
    mine = NodeView(forest, path).events() if acts else ()
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


def _told(
    recording: Recording, path: BeliefPath, step: LogStep, element: Element
) -> Iterable[HeardClaim]:
    """Yield the claims of one entry that may have moved items in a node out of a container."""
    entry = _entry(recording, step) if element.kind == "container" else None
    if not isinstance(entry, Frame):
        return
    node = step.forest.node(path)
    for row, event in enumerate(entry.events):
        for index, claim in enumerate(claims_of(event) if event.kind is EventKind.CHAT else ()):
            is_here = claim.cell == element.where
            takes = claim.kind is (ClaimKind.ABSENT if is_here else ClaimKind.LOCATED)
            if takes and step.forest.verdicts[row, index][node].believed:
                yield HeardClaim(entry.tick, str(event.actor), claim)
    for (cell, _), told in step.forest.holdings.of(node).told.items():
        claims = step.forest.context.claims_on(step.forest.block(path, cell))
        if told.tick != entry.tick:
            continue
        for claim, verdict in zip(claims, told.verdicts, strict=False):
            about = claim.cell == element.where or claim.kind is ClaimKind.LOCATED
            if about and claim.item is not None and Verdict(verdict).believed:
                sign = place_of(recording.box, cell)
                yield HeardClaim(entry.tick, told.speaker, claim, sign)


def _elsewhere(
    step: LogStep, path: BeliefPath, element: Element, before: Value
) -> Iterable[SeenElsewhere]:
    """Yield the unique items that one entry took out of a container: they are elsewhere."""
    forest = step.forest
    after = value_in(forest, path, element)
    held = forest.holdings.of(forest.node(path))
    had = before.items if isinstance(before, Contents) else {}
    left = after.items if isinstance(after, Contents) else {}
    for item, sole in held.sole.items():
        if sole.tick != forest.tick or item not in had or item in left:
            continue
        where = forest.place_of(path, sole.place)
        if where != element.where:
            yield SeenElsewhere(sole.tick, item, where)


def _entry(recording: Recording, step: LogStep) -> Entry | None:
    """Return the entry that a step folded; None at the beginning of a timeline."""
    count = step.forest.position
    return next(recording.journal.entries(step.timeline, count - 1, count)) if count else None


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


def _level(trace: _Finding, element: Element) -> Level:
    held = trace.held
    at = trace.observed_at
    acts = () if at is None else [act for act in held.events if act.tick <= at]
    latest = next((act.tick for act in reversed(acts) if touches(element, act)), None)
    since = trace.since
    if since is not None and at is not None:
        since = max(since, at)
    return Level(
        path=trace.path,
        holder=trace.path[-1],
        value=held.value,
        block=held.block,
        basis=held.basis,
        current=held.current,
        acts=() if latest is None else _acts(acts, latest, element),
        since=since,
        stood=trace.stood,
        missed=trace.missed,
        told=tuple(each for each in trace.told if at is not None and each.tick >= at),
        elsewhere=tuple(each for each in trace.elsewhere if at is not None and each.tick >= at),
    )
