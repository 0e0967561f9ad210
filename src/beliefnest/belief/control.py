"""Control-mode simulators and starting points: states that are facts, not beliefs.

In control mode everything known is current (semantics, section 6); what a fork did not
know, unknown blocks and incomplete contents, stays so until something is done to it.
"""

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from beliefnest.belief.content import container_at
from beliefnest.belief.entries import (
    AgentBelief,
    Basis,
    ContainerBelief,
    InitialBelief,
    Source,
)
from beliefnest.belief.state import SOURCES, BeliefState, Grounds, ItemBelief
from beliefnest.belief.update import logged
from beliefnest.perception.sight import Sight
from beliefnest.perception.terrain import Terrain
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.registry import Registry
from beliefnest.world.values import AgentState, Box, Items, Position

__all__ = ["applied", "edited", "forked", "prior", "reality", "snapshot_of"]


def reality(snapshot: Snapshot, agents: Iterable[str], sight: Sight) -> BeliefState:
    """The real world as a state, at its first tick."""
    basis = Basis(snapshot.tick, Source.SEEN)
    terrain = Terrain(snapshot.box, snapshot.blocks.copy(), sight)
    return BeliefState(
        tick=snapshot.tick,
        terrain=terrain,
        grounds=_current_grounds(terrain, snapshot.tick),
        containers={
            place: ContainerBelief(dict(items), complete=True, basis=basis, current=True)
            for place, items in snapshot.containers.items()
        },
        agents={
            name: _known_agent(snapshot.agents[name], basis, complete=True)
            if name in snapshot.agents
            else AgentBelief()
            for name in agents
        },
        items={n: ItemBelief(item, basis, current=True) for n, item in snapshot.items.items()},
        log=None,
        news=(),
    )


def prior(
    world: BeliefState,
    static_blocks: frozenset[str],
    initial: InitialBelief | None,
    registry: Registry,
    sight: Sight,
) -> BeliefState:
    """What a node of the nest holds before its first perception.

    Args:
        world: The real world at its first tick.
        static_blocks: Names of blocks that everybody knows from the start.
        initial: Further priors of this node.
        registry: Names of blocks.
        sight: How agents see.
    """
    basis = Basis(world.tick, Source.PRIOR)
    blocks = _static(world.terrain, static_blocks, registry)
    agents = {name: AgentBelief() for name in world.agents}
    contents: dict[Position, ContainerBelief] = {}
    if initial is not None:
        for place, state in initial.blocks.items():
            blocks[world.terrain.box.index(place)] = state
        for name, position in initial.agents.items():
            agents[name] = AgentBelief(position=position, basis=basis)
        for place, (items, complete) in initial.containers.items():
            contents[place] = ContainerBelief(dict(items), complete, basis, current=False)
    terrain = Terrain(world.terrain.box, blocks, sight)
    for place in _container_places(terrain, registry):
        contents.setdefault(place, ContainerBelief({}, False, basis, current=False))
    known = blocks >= 0
    return BeliefState(
        tick=world.tick,
        terrain=terrain,
        grounds=Grounds(
            observed_at=np.where(known, world.tick, -1).astype(np.int32),
            sources=np.full(blocks.shape, SOURCES.index(Source.PRIOR), dtype=np.uint8),
            current=np.zeros(blocks.shape, dtype=np.bool_),
        ),
        containers=contents,
        agents=agents,
        items={},
        log=None,
        news=(),
    )


def applied(state: BeliefState, frame: Frame) -> BeliefState:
    """A control-mode state after one frame of its own timeline."""
    basis = Basis(frame.tick, Source.SEEN)
    terrain = state.terrain.with_blocks(frame.blocks) if frame.blocks else state.terrain
    containers = {
        place: replace(old, basis=basis, current=True) for place, old in state.containers.items()
    }
    for place, content in frame.containers.items():
        old = containers.pop(place, None)
        if content is not None:
            complete = old is None or old.complete
            containers[place] = ContainerBelief(dict(content), complete, basis, current=True)
    agents = {name: _standing(old, basis) for name, old in state.agents.items()}
    for name, fact in frame.agents.items():
        complete = state.agents[name].inventory_complete or state.agents[name].position is None
        agents[name] = AgentBelief() if fact is None else _known_agent(fact, basis, complete)
    items = {n: replace(known, basis=basis, current=True) for n, known in state.items.items()}
    for number, item in frame.items.items():
        items.pop(number, None)
        if item is not None:
            items[number] = ItemBelief(item, basis, current=True)
    return BeliefState(
        tick=frame.tick,
        terrain=terrain,
        grounds=_current_grounds(terrain, frame.tick),
        containers=containers,
        agents=agents,
        items=items,
        log=logged(state.log, frame.tick, frame.events),
        news=frame.events,
    )


def forked(state: BeliefState) -> BeliefState:
    """A belief as the first state of a timeline of its own: all that is known is current."""
    return replace(
        state,
        grounds=replace(state.grounds, current=state.terrain.blocks >= 0),
        containers={p: replace(c, current=True) for p, c in state.containers.items()},
        agents={n: replace(a, current=a.position is not None) for n, a in state.agents.items()},
        items={n: replace(i, current=True) for n, i in state.items.items()},
        news=(),
    )


def edited(
    state: BeliefState,
    tick: int,
    blocks: Mapping[Position, int],
    containers: Mapping[Position, Items],
    registry: Registry,
    *,
    control: bool,
) -> BeliefState:
    """A state after a change made by hand.

    Args:
        state: The state before.
        tick: The tick after which the change is made.
        blocks: New block state ids, -1 for unknown.
        containers: New contents, complete.
        registry: Names of blocks.
        control: Whether the simulator is in control mode, where all that is known is current.
    """
    basis = Basis(tick, Source.EDITED)
    terrain = state.terrain.with_blocks(blocks) if blocks else state.terrain
    grounds = _edited_grounds(state.grounds, terrain, tick, blocks, control=control)
    contents = dict(state.containers)
    for place in blocks:
        new, old = (container_at(t, place, registry) for t in (terrain, state.terrain))
        if new != old or new is None:
            contents.pop(place, None)
        if new is not None and place not in contents:
            contents[place] = ContainerBelief({}, control, basis, control)
    for place, items in containers.items():
        contents[place] = ContainerBelief(dict(items), complete=True, basis=basis, current=control)
    return replace(state, tick=tick, terrain=terrain, grounds=grounds, containers=contents, news=())


def snapshot_of(state: BeliefState) -> Snapshot:
    """What a body of the state is filled with.

    Unknown blocks are air, agents of unknown pose are absent, and who was seen to wear or
    hold something has it.
    """
    agents = {
        name: AgentState(
            position=agent.position,
            yaw=agent.yaw,
            pitch=agent.pitch,
            on_ground=agent.on_ground,
            equipment=dict(agent.equipment or {}),
            inventory=_with_equipment(agent),
            health=20.0 if agent.health is None else agent.health,
            food=20.0 if agent.food is None else agent.food,
        )
        for name, agent in state.agents.items()
        if agent.position is not None
    }
    return Snapshot(
        tick=state.tick,
        box=state.terrain.box,
        blocks=np.maximum(state.terrain.blocks, 0),
        containers={place: dict(c.items) for place, c in state.containers.items()},
        agents=agents,
        items={number: belief.item for number, belief in state.items.items()},
    )


def _with_equipment(agent: AgentBelief) -> dict[str, int]:
    worn = Counter((agent.equipment or {}).values())
    names = [*agent.inventory, *(worn.keys() - agent.inventory.keys())]
    return {name: max(agent.inventory.get(name, 0), worn[name]) for name in names}


def _known_agent(fact: AgentState, basis: Basis, complete: bool) -> AgentBelief:
    return AgentBelief(
        position=fact.position,
        yaw=fact.yaw,
        pitch=fact.pitch,
        on_ground=fact.on_ground,
        equipment=dict(fact.equipment),
        inventory=dict(fact.inventory),
        inventory_complete=complete,
        health=fact.health,
        food=fact.food,
        basis=basis,
        current=True,
    )


def _standing(agent: AgentBelief, basis: Basis) -> AgentBelief:
    return agent if agent.position is None else replace(agent, basis=basis, current=True)


def _current_grounds(terrain: Terrain, tick: int) -> Grounds:
    known = terrain.blocks >= 0
    return Grounds(
        observed_at=np.where(known, tick, -1).astype(np.int32),
        sources=np.full(known.shape, SOURCES.index(Source.SEEN), dtype=np.uint8),
        current=known,
    )


def _edited_grounds(
    grounds: Grounds, terrain: Terrain, tick: int, blocks: Mapping[Position, int], *, control: bool
) -> Grounds:
    observed_at = grounds.observed_at.copy()
    sources = grounds.sources.copy()
    current = grounds.current.copy()
    for place, state in blocks.items():
        index = terrain.box.index(place)
        observed_at[index] = tick if state >= 0 else -1
        sources[index] = SOURCES.index(Source.EDITED)
        current[index] = control and state >= 0
    return Grounds(observed_at, sources, current)


def _static(
    terrain: Terrain, static_blocks: frozenset[str], registry: Registry
) -> "np.ndarray[tuple[int, int, int], np.dtype[np.int32]]":
    known = np.zeros(registry.states, dtype=np.bool_)
    for name in static_blocks:
        ids = registry.state_ids(name)
        known[ids.start : ids.stop] = True
    return np.where(known[terrain.blocks], terrain.blocks, -1).astype(np.int32)


def _container_places(terrain: Terrain, registry: Registry) -> list[Position]:
    box: Box = terrain.box
    there = np.unique(terrain.blocks).tolist()
    states = {s for s in there if s >= 0 and registry.is_container(registry.name(s))}
    low = box.low
    indices = np.argwhere(np.isin(terrain.blocks, sorted(states))).tolist() if states else []
    return [(low[0] + i, low[1] + j, low[2] + k) for i, j, k in indices]
