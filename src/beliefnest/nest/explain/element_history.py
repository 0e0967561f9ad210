"""History of one element in the nodes of a path, entry by entry, up to the explained moment."""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import msgspec

from beliefnest.belief.columns import cell_of
from beliefnest.belief.forest import Forest
from beliefnest.belief.grounds import PerceivedEvent
from beliefnest.nest.explain.parts import Contents, Element, Value
from beliefnest.nest.past.history import StateHistory
from beliefnest.timeline.journal import Edit, Entry, EntryFilter, ForkPoint, TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.world.double_chests import holds_items
from beliefnest.world.paths import BeliefPath
from beliefnest.world.registry import Registry
from beliefnest.world.signs import block_words, plain_state
from beliefnest.world.values import Box


class LogStep(msgspec.Struct, frozen=True):
    """Forest after one more entry of a timeline.

    Attributes:
        timeline: The timeline.
        forest: The forest.
        entry: The entry; None for the forest before the first one.
    """

    timeline: TimelineKey
    forest: Forest
    entry: Entry | None


class ExplainedSpan(NamedTuple):
    """Part of a log that explains a belief: from just before a tick to a moment."""

    moment: ForkPoint
    tick: int


def cells_of(element: Element, box: Box) -> Sequence[int]:
    """Return the cells whose basis must be tracked. Contents and poses carry a basis anyway."""
    if isinstance(element.where, str) or element.kind == "container":
        return ()
    return (cell_of(box, element.where),)


def steps_since(
    history: StateHistory,
    journal: Journal,
    path: BeliefPath,
    spans: Mapping[int, ExplainedSpan],
    cells: Sequence[int],
) -> Iterator[tuple[int, LogStep]]:
    """Yield the forests of a node that belong to spans of a log, which is folded only once.

    Args:
        history: History of the nest.
        journal: Its journal.
        path: Path of the node.
        spans: Spans by any numbers; their moments are in one timeline.
        cells: Cells whose basis must be tracked.

    Yields:
        The number of a span, and the forest after each entry of it. The forests of one span come
        in the order of time, and begin with that before its first entry.
    """
    (timeline,) = {span.moment.timeline for span in spans.values()}
    info = journal.info(timeline)
    older = {number: span for number, span in spans.items() if span.tick <= info.start}
    if info.base is not None and older:
        earlier = {number: ExplainedSpan(info.base, span.tick) for number, span in older.items()}
        yield from steps_since(history, journal, path, earlier, cells)
    firsts = {
        number: min(journal.entries_until(timeline, span.tick - 1), span.moment.entries)
        for number, span in spans.items()
    }
    first, last = min(firsts.values()), max(span.moment.entries for span in spans.values())
    entries = itertools.chain([None], journal.entries(timeline, first, last))
    forests = history.steps(timeline, path, first, last, cells)
    for position, (forest, entry) in enumerate(zip(forests, entries, strict=True), first):
        for number, span in spans.items():
            if firsts[number] <= position <= span.moment.entries:
                is_first = position == firsts[number]
                yield number, LogStep(timeline, forest, None if is_first else entry)


def value_in(forest: Forest, path: BeliefPath, element: Element) -> Value:
    """Return the value of an element in a node of a forest."""
    if isinstance(element.where, str):
        return forest.feet(path, element.where)
    node, context = forest.node(path), forest.context
    cell = cell_of(context.box, element.where)
    if element.kind == "block":
        return context.block_text(forest.block(path, cell))
    if cell not in forest.holdings.of(node).containers:
        return None
    content = forest.holdings.content(node, cell)
    return Contents(dict(content.items), content.complete)


def observed_at(forest: Forest, path: BeliefPath, element: Element) -> tuple[int | None, bool]:
    """Return the last tick at which a node's value of an element was current (None: no value).

    The second part is True if a perception in the last entry backs the value.
    """
    if isinstance(element.where, str):
        return forest.seen_at(path, element.where), forest.is_current(path, element.where)
    node, cell = forest.node(path), cell_of(forest.context.box, element.where)
    if element.kind == "block":
        basis = forest.bases(path, [cell])[cell]
        current = bool(forest.current_blocks(path, (cell,)))
        return None if basis is None else basis.observed_at, current
    if cell not in forest.holdings.of(node).containers:
        return None, False
    content = forest.holdings.content(node, cell).at(forest.tick)
    return content.basis.observed_at, content.current


def touches(element: Element, event: PerceivedEvent) -> bool:
    """Return True if an event is about an element's content or block, which none is for agents."""
    return element.kind != "agent" and event.detail.get("position") == element.where


def last_change(
    history: StateHistory, journal: Journal, moment: ForkPoint, element: Element
) -> Entry | None:
    """Return the last entry of a timeline that changed an element in its own world."""
    path = moment.timeline.path
    value: object = _bare(value_in(history.shared(moment.timeline, path, 0), path, element))
    last = None
    entries = journal.entries(moment.timeline, 0, moment.entries)
    if element.kind != "agent":
        changes = journal.filtered(moment.timeline, 0, moment.entries, EntryFilter.CHANGES)
        entries = (entry for _, entry in changes)
    for entry in entries:
        if isinstance(entry, Edit) and entry.path != path:
            continue
        after = _after(entry, element, history.context.registry, value)
        if after != value:
            value = after
            last = entry
    return last


def _after(entry: Entry, element: Element, registry: Registry, value: object) -> object:
    """Return the value of an element in its own world after an entry, in the form of `_bare`.

    Args:
        entry: The entry.
        element: The element.
        registry: Registry of blocks.
        value: Value before the entry, in the same form.
    """
    if isinstance(element.where, str):
        if isinstance(entry, Edit) or element.where not in entry.agents:
            return value
        agent = entry.agents[element.where]
        return None if agent is None else agent.position
    if element.kind == "container" and element.where in entry.containers:
        items = entry.containers[element.where]
        return None if items is None else dict(items)
    block = entry.blocks.get(element.where)
    if block is None:
        return value
    if element.kind == "block":
        return block_words(registry, block)
    state = plain_state(block)
    holds = state >= 0 and holds_items(registry, state)
    return (value or {}) if holds else None


def _bare(value: Value) -> object:
    """Return a value in the form that entries give: contents without completeness."""
    return dict(value.items) if isinstance(value, Contents) else value
