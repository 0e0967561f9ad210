"""The belief update `b_i' = update(b_i, o_i)` (semantics, sections 4 and 5; the paper's Common-2).

`update` folds one tick into the belief of one agent of a simulator: what the agent
perceives there replaces what it believed, everything else stays and is no longer current.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from beliefnest.belief.content import updated_containers
from beliefnest.belief.entries import AgentBelief, PerceivedEvent
from beliefnest.belief.possessions import after_own_acts
from beliefnest.belief.state import BeliefState, Grounds, ItemBelief, Log
from beliefnest.perception.observe import ITEM_HEIGHT, Percept, Scene, eye_of, observe
from beliefnest.perception.options import Perception
from beliefnest.world.registry import Registry
from beliefnest.world.values import Event

__all__ = ["logged", "update"]


def update(
    belief: BeliefState,
    around: BeliefState,
    agent: str,
    options: Perception,
    registry: Registry,
) -> BeliefState:
    """Fold one tick into a belief.

    Args:
        belief: What `agent` believed before: the state of the deeper simulator.
        around: The simulator the agent lives in, after everything that happened in the
            tick: the state of the shallower simulator.
        agent: The perceiver.
        options: What agents can perceive.
        registry: Names of blocks.

    Returns:
        The belief after the tick `around.tick`.
    """
    scene = around.scene()
    percept = observe(scene, agent, options)
    tick = around.tick
    log = logged(belief.log, tick, percept.events)
    if percept.visible is None:
        return replace(
            belief,
            tick=tick,
            grounds=_stale(belief.grounds),
            containers={p: replace(c, current=False) for p, c in belief.containers.items()},
            agents={n: replace(a, current=False) for n, a in belief.agents.items()},
            items={n: replace(i, current=False) for n, i in belief.items.items()},
            log=log,
            news=percept.events,
        )
    terrain = belief.terrain.merged(around.terrain, percept.visible)
    return BeliefState(
        tick=tick,
        terrain=terrain,
        grounds=_seen_grounds(belief.grounds, around, percept.visible),
        containers=updated_containers(belief, around, percept, terrain, options, registry),
        agents=_updated_agents(belief, around, scene, percept, options),
        items=_updated_items(belief, around, scene, percept),
        log=log,
        news=percept.events,
    )


def logged(log: Log | None, tick: int, events: tuple[Event, ...]) -> Log | None:
    """The log with the events of a tick added."""
    for event in events:
        log = Log(log, PerceivedEvent(tick, event.kind, event.actor, event.detail))
    return log


def _stale(grounds: Grounds) -> Grounds:
    if not grounds.current.any():
        return grounds
    return replace(grounds, current=np.zeros_like(grounds.current))


def _seen_grounds(grounds: Grounds, around: BeliefState, visible: npt.NDArray[np.bool_]) -> Grounds:
    """Grounds handed on for what is seen: a stale block keeps its old tick (5.4)."""
    seen = visible & (around.terrain.blocks >= 0)
    return Grounds(
        observed_at=np.where(seen, around.grounds.observed_at, grounds.observed_at),
        sources=np.where(seen, around.grounds.sources, grounds.sources),
        current=seen & around.grounds.current,
    )


def _updated_agents(
    belief: BeliefState,
    around: BeliefState,
    scene: Scene,
    percept: Percept,
    options: Perception,
) -> Mapping[str, AgentBelief]:
    agents = {}
    gone = _seen_gone(belief, scene, percept) if options.negative_evidence else frozenset()
    for name, old in belief.agents.items():
        there = around.agents[name]
        acts = [event for event in percept.events if event.actor == name]
        if name == percept.agent:
            agents[name] = there
        elif name in percept.agents:
            agents[name] = after_own_acts(
                replace(
                    old,
                    position=there.position,
                    yaw=there.yaw,
                    pitch=there.pitch,
                    on_ground=there.on_ground,
                    equipment=old.equipment if there.equipment is None else there.equipment,
                    basis=there.basis,
                    current=there.current,
                ),
                acts,
            )
        elif name in gone:
            agents[name] = replace(
                old, position=None, yaw=0.0, pitch=0.0, on_ground=True, basis=None, current=False
            )
        else:
            agents[name] = after_own_acts(replace(old, current=False), acts)
    return agents


def _seen_gone(belief: BeliefState, scene: Scene, percept: Percept) -> frozenset[str]:
    """Agents that would be seen if they still were where they are believed to be."""
    assert percept.pose is not None
    missing = {
        name: agent.position
        for name, agent in belief.agents.items()
        if name not in percept.agents and agent.position is not None
    }
    if not missing:
        return frozenset()
    flags = scene.terrain.geometry.sees_agents(
        eye_of(percept.pose), percept.pose.yaw, percept.pose.pitch, list(missing.values())
    )
    return frozenset(name for name, flag in zip(missing, flags.tolist(), strict=True) if flag)


def _updated_items(
    belief: BeliefState, around: BeliefState, scene: Scene, percept: Percept
) -> Mapping[int, ItemBelief]:
    """Seen items are taken over; an item whose believed place is seen empty is dropped."""
    assert percept.pose is not None
    items = {number: replace(old, current=False) for number, old in belief.items.items()}
    missing = {n: old.item.position for n, old in items.items() if n not in percept.items}
    if missing:
        flags = scene.terrain.geometry.sees_points(
            eye_of(percept.pose),
            percept.pose.yaw,
            percept.pose.pitch,
            [(x, y + ITEM_HEIGHT, z) for x, y, z in missing.values()],
        )
        for number, flag in zip(missing, flags.tolist(), strict=True):
            if flag:
                del items[number]
    items.update({number: around.items[number] for number in percept.items})
    return items
