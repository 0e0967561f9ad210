"""Percepts of a node's owner, tick by tick, read from the node's timeline.

A percept contains the current elements of the node (semantics, section 5): blocks, contents,
dropped items, and agents with their cells. If nothing changed for the owner at a tick, the
percept before still holds.
"""

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt
from msgspec.structs import replace

from beliefnest.belief.columns import cell_of, cells_between
from beliefnest.belief.forest import Forest
from beliefnest.belief.grounds import AgentBelief, PerceivedEvent
from beliefnest.belief.node_view import NodeView
from beliefnest.nest.past.recording import Recording
from beliefnest.timeline.journal import Edit, ForkPoint
from beliefnest.world.event_kinds import AT_CONTAINERS, EventKind
from beliefnest.world.paths import BeliefPath
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import EYE_HEIGHT, Items, Point, Position, block_at

DeedKey = tuple[str, str, Position, tuple[tuple[str, int], ...]]
"""Kind, actor, container, and the items that were seen being moved."""


class Percept(msgspec.Struct, frozen=True, eq=False):
    """Percept of the owner of a node at one tick.

    Attributes:
        tick: Its first tick; it holds until the next percept.
        present: False: the owner is credited with no percept (semantics, section 5.1).
        known: Block states if it perceived all known blocks, as in reality; None: it saw some.
        cells: int64 (n,), flat cells of the blocks that it saw, if it saw some.
        states: int32 (n,), their block states.
        contents: Complete contents that it perceived.
        agents: Feet, yaw and pitch of the agents that it perceived, its own included.
        items: Names and cells of the dropped items that it saw, with their numbers.
        deeds: Actions at containers that it saw in this very tick.
        events: All events that it perceived in this very tick.
        edits: Changes of the node by hand after this very tick.
    """

    tick: int
    present: bool
    known: Terrain | None
    cells: npt.NDArray[np.int64]
    states: npt.NDArray[np.int32]
    contents: Mapping[Position, Items]
    agents: Mapping[str, tuple[Point, float, float]]
    items: Mapping[tuple[str, Position], int]
    deeds: tuple[DeedKey, ...]
    events: tuple[PerceivedEvent, ...]
    edits: tuple[Edit, ...] = ()

    def is_new_after(self, before: "Percept") -> bool:
        """Return True if it differs from the percept before, or has events."""
        return bool(
            self.events
            or self.edits
            or self.present != before.present
            or self.known != before.known
            or not np.array_equal(self.cells, before.cells)
            or not np.array_equal(self.states, before.states)
            or self.contents != before.contents
            or self.agents != before.agents
            or self.items != before.items
        )

    def following(self, before: "Percept") -> "Percept":
        """Return the percept with what happened earlier in the same tick."""
        return replace(
            self,
            deeds=tuple(sorted((*before.deeds, *self.deeds))),
            events=before.events + self.events,
            edits=before.edits + self.edits,
        )


def deed_of(kind: EventKind, actor: str, detail: Mapping[str, Any]) -> DeedKey:
    """Return the visible part of an action at a container."""
    items: Mapping[str, int] = detail.get("items", {})
    return (str(kind), actor, detail["position"], tuple(sorted(items.items())))


def percepts_of(
    recording: Recording, path: BeliefPath, start: ForkPoint, until: ForkPoint
) -> list[tuple[Percept, Terrain]]:
    """Return the percepts of a node's owner, each with the blocks that it believed.

    Args:
        recording: Record with the node.
        path: The node.
        start: The moment of the first percept.
        until: The moment of the last percept.
    """
    percepts: list[tuple[Percept, Terrain]] = []
    for percept, blocks in _read(recording, path, start, until):
        if percepts and percepts[-1][0].tick == percept.tick:
            # A branch begins at this tick, and was edited there.
            percepts[-1] = (percept.following(percepts[-1][0]), blocks)
        elif not percepts or percept.is_new_after(percepts[-1][0]):
            percepts.append((percept, blocks))
    return percepts


def _read(
    recording: Recording, path: BeliefPath, start: ForkPoint, until: ForkPoint
) -> Iterator[tuple[Percept, Terrain]]:
    journal, history = recording.journal, recording.history
    stretches = recording.stretches(until)
    first = next(n for n, each in enumerate(stretches) if each.timeline == start.timeline)
    for number, stretch in enumerate(stretches[first:]):
        key, begin = stretch.timeline, start.entries if number == 0 else 0
        forest = history.walk(key, [path])
        history.advance(key, forest, begin)
        events = journal.events_until(key, begin)
        if number == 0:
            before = journal.entries_until(key, start.tick - 1)
            yield _percept(forest, path, start.tick, journal.events_until(key, before))
        entries = list(journal.entries(key, begin, stretch.entries))
        edits: list[Edit] = []
        for offset, entry in enumerate(entries):
            history.advance(key, forest, begin + offset + 1)
            if isinstance(entry, Edit):
                edits.append(entry)
            following = entries[offset + 1] if offset + 1 < len(entries) else None
            if following is None or following.tick > entry.tick:
                percept, blocks = _percept(forest, path, entry.tick, events)
                yield replace(percept, edits=tuple(edits)), blocks
                events, edits = forest.count_of_events, []
                then = entry.tick + 1
                last = stretch.tick if following is None else following.tick - 1
                if percept.events and then <= last:
                    # Contents seen in an opened container are current at that tick only, whether
                    # the next tick has an entry or not.
                    yield _percept(forest, path, then, events)


def _percept(forest: Forest, path: BeliefPath, tick: int, before: int) -> tuple[Percept, Terrain]:
    view, context = NodeView(forest, path, tick), forest.context
    owner = path[-1] if path else None
    agents = view.agents
    present = owner is None or agents[owner].current
    # In reality every known block is current.
    terrain = view.terrain if owner is None else None
    seen: set[int] = set()
    if owner is not None and present:
        seen = forest.current_blocks(path, _in_reach(forest, path, owner))
    cells = np.array(sorted(seen), dtype=np.int64)

    def is_perceived(place: Position) -> bool:
        if place not in context.box:
            return False
        if terrain is not None:
            return terrain[context.box.index(place)] >= 0
        return cell_of(context.box, place) in seen

    contents = {
        place: dict(content.items)
        for place, content in view.containers.items()
        if present and content.current and content.complete
    }
    events = tuple(event for event in view.events_since(before) if event.tick == tick)
    deeds = [
        deed_of(event.kind, event.actor, event.detail)
        for event in events
        if event.kind in AT_CONTAINERS and event.actor is not None
    ]
    lying = Counter(
        (item.name, block_at(item.position))
        for item in view.items.values()
        if is_perceived(block_at(item.position))
    )
    percept = Percept(
        tick,
        present,
        terrain,
        cells,
        view.terrain.at(cells),
        contents,
        {name: _pose(agent) for name, agent in agents.items() if agent.current},
        lying,
        tuple(sorted(deeds)),
        events,
    )
    return percept, view.terrain


def _in_reach(forest: Forest, path: BeliefPath, owner: str) -> Iterable[int]:
    """Return cells among which are all whose block is current in a node; its owner is present."""
    context, far = forest.context, forest.context.options.max_visible_distance
    feet = forest.feet(path, owner)
    if context.is_dense or far is None or feet is None:
        return range(context.cells)
    eye = (feet[0], feet[1] + EYE_HEIGHT, feet[2])
    x, y, z = (math.floor(at) for at in eye)
    reach = math.ceil(far) + 1
    low, high = (x - reach, y - reach, z - reach), (x + reach, y + reach, z + reach)
    return cells_between(context.box, low, high)


def _pose(agent: AgentBelief) -> tuple[Point, float, float]:
    assert agent.position is not None
    return agent.position, agent.yaw, agent.pitch
