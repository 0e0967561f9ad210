"""What becomes of believed container contents in one tick (semantics, section 4)."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from beliefnest.belief.entries import Basis, ContainerBelief, Source
from beliefnest.belief.possessions import changed_items
from beliefnest.belief.state import BeliefState
from beliefnest.perception.observe import Percept
from beliefnest.perception.options import Perception
from beliefnest.perception.terrain import Terrain
from beliefnest.world.registry import Registry
from beliefnest.world.values import Event, EventKind, Position

__all__ = ["container_at", "updated_containers"]

_MOVES = {EventKind.DEPOSIT_ITEM_INTO_CHEST: 1, EventKind.GET_ITEM_FROM_CHEST: -1}
_TOUCHES = frozenset({EventKind.OPEN_CONTAINER, *_MOVES})


def container_at(terrain: Terrain, position: Position, registry: Registry) -> str | None:
    """Name of the container block at a position of a terrain, None if there is none known."""
    state = int(terrain.blocks[terrain.box.index(position)])
    if state < 0:
        return None
    name = registry.name(state)
    return name if registry.is_container(name) else None


def updated_containers(
    belief: BeliefState,
    around: BeliefState,
    percept: Percept,
    terrain: Terrain,
    options: Perception,
    registry: Registry,
) -> Mapping[Position, ContainerBelief]:
    """Believed contents after a tick in which the agent was present.

    Args:
        belief: The belief before the tick.
        around: The simulator the agent lives in, after the tick.
        percept: What the agent perceived.
        terrain: The believed blocks after the tick.
        options: What agents can perceive.
        registry: Names of blocks.
    """
    contents = {place: replace(old, current=False) for place, old in belief.containers.items()}
    _forget_and_find(contents, belief.terrain, terrain, around, registry)
    looked_into = _looked_into(percept, around, options)
    touches = [event for event in percept.events if event.kind in _TOUCHES]
    for event in touches:
        place = event.detail["position"]
        if place not in looked_into and not _is_seen_gone(place, percept, around, registry):
            _witness(contents, around.tick, event)
    for place in looked_into:
        contents[place] = around.containers[place]
    for event in touches:
        place = event.detail["position"]
        if event.actor == percept.agent and place in looked_into and contents[place].current:
            basis = Basis(around.tick, Source.WITNESSED, event.kind)
            contents[place] = replace(contents[place], basis=basis)
    return contents


def _forget_and_find(
    contents: dict[Position, ContainerBelief],
    before: Terrain,
    after: Terrain,
    around: BeliefState,
    registry: Registry,
) -> None:
    """Forget containers seen replaced; add those seen for the first time, with nothing known."""
    if before is after:
        return
    low = after.box.low
    for index in np.argwhere(before.blocks != after.blocks).tolist():
        place = (low[0] + index[0], low[1] + index[1], low[2] + index[2])
        old, new = (container_at(terrain, place, registry) for terrain in (before, after))
        was_known = before.blocks[tuple(index)] >= 0
        if place in contents and (new is None or (was_known and old != new)):
            del contents[place]
        if new is not None and place not in contents:
            basis = around.grounds.basis((index[0], index[1], index[2]))
            assert basis is not None
            contents[place] = ContainerBelief({}, complete=False, basis=basis, current=False)


def _looked_into(percept: Percept, around: BeliefState, options: Perception) -> frozenset[Position]:
    """Containers whose whole content, as far as `around` holds it, the agent learns."""
    own = {
        event.detail["position"]
        for event in percept.events
        if event.actor == percept.agent and event.kind in _TOUCHES
    }
    if options.containers == "transparent":
        assert percept.visible is not None
        box = around.terrain.box
        own |= {place for place in around.containers if percept.visible[box.index(place)]}
    return frozenset(own & around.containers.keys())


def _is_seen_gone(
    place: Position, percept: Percept, around: BeliefState, registry: Registry
) -> bool:
    """Whether the agent sees by the end of the tick that there is no container any more."""
    assert percept.visible is not None
    index = around.terrain.box.index(place)
    seen = bool(percept.visible[index] and around.grounds.current[index])
    return seen and container_at(around.terrain, place, registry) is None


def _witness(contents: dict[Position, ContainerBelief], tick: int, event: Event) -> None:
    """Follow items that another agent was seen to move; opening shows nothing to others."""
    if event.kind not in _MOVES:
        return
    place: Position = event.detail["position"]
    basis = Basis(tick, Source.WITNESSED, event.kind)
    old = contents.get(place)
    items = changed_items(
        {} if old is None else old.items, event.detail["items"], _MOVES[event.kind]
    )
    complete = old is not None and old.complete
    contents[place] = ContainerBelief(items, complete=complete, basis=basis, current=True)
