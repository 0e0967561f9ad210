"""Initial states of bodies: states of timelines, adapted where a belief is impossible."""

from collections.abc import Iterable

import msgspec
from msgspec.structs import replace

from beliefnest.belief.grounds import Source
from beliefnest.belief.node_view import NodeView
from beliefnest.nest.acting.placement import BodySpace, moved_agents, placed, unknown_floors
from beliefnest.nest.past.body_state import internal_state_at
from beliefnest.nest.past.embodiable import embodiable, with_chests
from beliefnest.nest.past.history import StateHistory
from beliefnest.nest.past.placing import fork_of_belief
from beliefnest.timeline.journal import ForkPoint
from beliefnest.timeline.store import Journal
from beliefnest.world.frames import Frame, Snapshot
from beliefnest.world.paths import BeliefPath
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import AgentState, Position

_FLOOR = "barrier"
"""Block that a body puts for an unknown floor below a believed agent."""


class BodyStart(msgspec.Struct, frozen=True):
    """Initial state of a body, and the frame to record for it.

    Attributes:
        snapshot: Snapshot with which the body is filled.
        frame: Poses of the agents that cannot be where they are believed to be; None if there are
            none.
    """

    snapshot: Snapshot
    frame: Frame | None = None


def start_of(
    journal: Journal,
    history: StateHistory,
    path: BeliefPath,
    moment: ForkPoint,
    *,
    has_physics: bool,
) -> BodyStart:
    """Return the initial state of a body of a node (semantics, section 7).

    Args:
        journal: Journal of the timelines.
        history: History that computes their states.
        path: Path of the node: the timeline's own simulator or one below it.
        moment: Moment of a timeline. If the timeline is not the node's own, the node is about to be
            forked from it.
        has_physics: True if agents in the body stand, fall and are stopped by blocks.
    """
    reading = history.state(moment.timeline, path, moment.entries, moment.tick)
    is_own = moment.timeline.path == path
    state = internal_state_at(journal, moment) if is_own else b""
    snapshot, blocks = _filled(reading, history)
    snapshot = replace(snapshot, tick=moment.tick, internal_state=state)
    if not has_physics:
        return BodyStart(snapshot)
    if not is_own:
        return _begun(snapshot, blocks, reading, history)
    fork = fork_of_belief(journal, moment.timeline)
    if fork is None:
        return BodyStart(snapshot)
    # A body keeps the floors that it was given at its fork, while the blocks there are unknown.
    # They are computed again from the state at the fork, so they need not be recorded.
    if blocks.span[0] >= 0:
        return BodyStart(snapshot)
    _, base = fork
    believed = history.state(base.timeline, path, base.entries, base.tick)
    before, known_blocks = _filled(believed, history)
    begun = _begun(before, known_blocks, believed, history).snapshot.agents
    space = BodySpace(history.context.registry, snapshot.box, known_blocks)
    return BodyStart(_floored(snapshot, blocks, unknown_floors(space, begun), history))


def _filled(reading: NodeView, history: StateHistory) -> tuple[Snapshot, Terrain]:
    """Return the snapshot with which a body can be filled, and its blocks, -1 unknown."""
    snapshot, blocks = reading.snapshot(), reading.terrain
    if not reading.path:
        return snapshot, blocks
    registry = history.context.registry
    with_all_chests = with_chests(registry, snapshot.box, blocks, snapshot.containers)
    return embodiable(registry, snapshot, with_all_chests), with_all_chests


def _begun(
    snapshot: Snapshot, blocks: Terrain, believed: NodeView, history: StateHistory
) -> BodyStart:
    """Return the start of a body of a belief, with agents moved and unknown floors made solid."""
    space = BodySpace(history.context.registry, snapshot.box, blocks)
    seen_at = {}
    for name in snapshot.agents:
        basis = believed.agents[name].basis
        seen = basis is not None and basis.source is not Source.PRIOR
        seen_at[name] = basis.observed_at if basis is not None and seen else None
    seen_now = [name for name in snapshot.agents if believed.agents[name].current]
    moved = moved_agents(snapshot.agents, placed(space, snapshot.agents, seen_at, seen_now))
    agents: dict[str, AgentState] = {**snapshot.agents, **moved}
    floors = unknown_floors(space, agents)
    filled = _floored(replace(snapshot, agents=agents), blocks, floors, history)
    return BodyStart(filled, Frame(snapshot.tick, agents=moved) if moved else None)


def _floored(
    snapshot: Snapshot, known_blocks: Terrain, floors: Iterable[Position], history: StateHistory
) -> Snapshot:
    cells = [snapshot.box.index(floor) for floor in floors]
    cells = [cell for cell in cells if known_blocks[cell] < 0]
    if not cells:
        return snapshot
    blocks = snapshot.blocks.draft()
    for cell in cells:
        blocks[cell] = history.context.registry.state_id(_FLOOR)
    return replace(snapshot, blocks=blocks.terrain())
