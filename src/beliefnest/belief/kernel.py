"""Perception and belief update of all nodes below one timeline, compiled.

The rules of semantics, sections 3 to 5, as far as they are about poses, blocks and who
perceives which event. Contents, possessions and dropped items follow in `belief.holdings`,
from what this leaves in `Changes`. Cost grows with what changed: who looks from the same
place at the same blocks as before is not asked again, and a block is looked for only
where the believer's belief differs from what there is.
"""

import math

import numpy as np
import numpy.typing as npt

from beliefnest.belief.arrays import (
    HEAR_ALL,
    HEAR_SEEN,
    KIND_CHAT,
    KIND_THINK,
    KIND_UPDATE,
    NOBODY,
    SOURCE_SEEN,
    UNKNOWN,
    Changes,
    Facts,
    Nodes,
    Poses,
    Senses,
    Space,
    Span,
)
from beliefnest.belief.seeing import eye_of, grid_cell, sees_agent, sees_cell, whole
from beliefnest.perception.eyes import Eye, set_code
from beliefnest.perception.rays import compiled, inlined, inner, merged

__all__ = ["fold", "put", "put_all", "refresh_pending"]

_WORD = 64


@inner
def _mark(nodes: Nodes, node: int, cell: int) -> None:
    """Set or clear the pending bit of a cell in a node below node 0."""
    held = nodes.blocks[nodes.parent[node], cell]
    word, bit = cell // _WORD, np.uint64(1) << np.uint64(cell % _WORD)
    if held != UNKNOWN and held != nodes.blocks[node, cell]:
        nodes.pending[node, word] |= bit
        nodes.fresh[node] = True
    else:
        nodes.pending[node, word] &= ~bit


@compiled
def put(space: Space, nodes: Nodes, node: int, cell: int, state: int) -> None:
    """Let a node hold a block state at a cell, with all that hangs on it."""
    old = nodes.blocks[node, cell]
    if old == state:
        return
    nodes.blocks[node, cell] = state
    if space.codes[old] != space.codes[state]:
        place = grid_cell(space, cell)
        set_code(nodes.codes[node], space.sizes, space.reaches, place, space.codes[state])
        nodes.geometry[node] += 1
    if node > 0:
        _mark(nodes, node, cell)
    for n in range(nodes.child_at[node], nodes.child_at[node + 1]):
        _mark(nodes, whole(nodes.child[n]), cell)


@inlined
def _handed_source(nodes: Nodes, parent: int, spot: int) -> int:
    """Source of a tracked cell for whoever sees it in a node: all of node 0 is seen."""
    return SOURCE_SEEN if parent == 0 else nodes.basis_source[parent, spot]


@inner
def _settle(nodes: Nodes, node: int, last: int) -> None:
    """Date what is current to `last`, the last tick at which it is sure to be so (section 2)."""
    for who in range(nodes.pose.shape[1]):
        if nodes.current[node, who]:
            nodes.seen_at[node, who] = last
    for spot in range(len(nodes.tracked)):
        if nodes.basis_current[node, spot]:
            nodes.basis_at[node, spot] = last


@inner
def _put_noted(
    space: Space,
    nodes: Nodes,
    changes: Changes,
    entry: int,
    tick: int,
    node: int,
    cell: int,
    state: int,
) -> None:
    """`put`, and note it where a container is or was."""
    old = nodes.blocks[node, cell]
    if old == state:
        return
    if space.holds[old] or space.holds[state]:
        row = changes.used[0]
        changes.rows[row, 0] = entry
        changes.rows[row, 1] = node
        changes.rows[row, 2] = cell
        changes.rows[row, 3] = old
        changes.rows[row, 4] = state
        for spot in range(len(nodes.tracked)):
            if nodes.tracked[spot] == cell:
                parent = max(nodes.parent[node], 0)
                is_current = nodes.basis_current[parent, spot]
                changes.rows[row, 5] = tick if is_current else nodes.basis_at[parent, spot]
                changes.rows[row, 6] = _handed_source(nodes, parent, spot)
        changes.used[0] = row + 1
    put(space, nodes, node, cell, state)


@compiled
def put_all(
    space: Space,
    nodes: Nodes,
    which: npt.NDArray[np.int64],
    cell: int,
    states: npt.NDArray[np.int64],
) -> None:
    """`put` for several nodes, each with a state of its own."""
    for number in range(len(which)):
        put(space, nodes, whole(which[number]), whole(cell), whole(states[number]))


@compiled
def refresh_pending(nodes: Nodes, node: int) -> None:
    """Compute a node's pending bits anew."""
    nodes.pending[node, :] = 0
    for cell in range(nodes.blocks.shape[1]):
        _mark(nodes, node, cell)


@merged
def _apply_entry(space: Space, facts: Facts, nodes: Nodes, changes: Changes, entry: int) -> None:
    """An entry in node 0, where everything known is current."""
    for row in range(facts.pose_at[entry], facts.pose_at[entry + 1]):
        who, pose = facts.pose_agent[row], facts.pose_id[row]
        nodes.pose[0, who] = pose
        nodes.equipment[0, who] = pose
    for who in range(nodes.pose.shape[1]):
        known = nodes.pose[0, who] != UNKNOWN
        nodes.current[0, who] = known
        if known:
            nodes.seen_at[0, who] = facts.tick[entry]
    for row in range(facts.block_at[entry], facts.block_at[entry + 1]):
        cell, state = whole(facts.block_cell[row]), whole(facts.block_state[row])
        _put_noted(space, nodes, changes, entry, facts.tick[entry], whole(0), cell, state)
    for spot in range(len(nodes.tracked)):
        known = nodes.blocks[0, nodes.tracked[spot]] != UNKNOWN
        nodes.basis_current[0, spot] = known
        if known:
            nodes.basis_at[0, spot] = facts.tick[entry]
            nodes.basis_source[0, spot] = SOURCE_SEEN


@merged
def _propagate_bases(space: Space, nodes: Nodes, node: int, eye: Eye, moved: bool) -> None:
    """Hand on what tracked cells rest on, where the owner of a node sees them."""
    parent = whole(nodes.parent[node])
    for spot in range(len(nodes.tracked)):
        if moved:
            cell = whole(nodes.tracked[spot])
            nodes.watched[node, spot] = sees_cell(space, nodes, parent, eye, cell)
        nodes.basis_current[node, spot] = False
        if nodes.watched[node, spot] and nodes.blocks[parent, nodes.tracked[spot]] != UNKNOWN:
            nodes.basis_at[node, spot] = nodes.basis_at[parent, spot]
            nodes.basis_source[node, spot] = _handed_source(nodes, parent, spot)
            nodes.basis_current[node, spot] = nodes.basis_current[parent, spot]


@merged
def _observe_agents(
    space: Space, poses: Poses, nodes: Nodes, node: int, eye: Eye, moved: bool
) -> None:
    """What the owner of a node learns of the agents in its parent node."""
    parent, me = whole(nodes.parent[node]), whole(nodes.agent[node])
    for who in range(nodes.pose.shape[1]):
        pose = whole(nodes.pose[parent, who])
        seen = who == me
        if not seen and pose != UNKNOWN:
            if moved or nodes.tried[node, who] != pose:
                nodes.sees[node, who] = sees_agent(space, poses, nodes, parent, eye, pose)
                nodes.tried[node, who] = pose
            seen = nodes.sees[node, who]
        if seen:
            nodes.pose[node, who] = pose
            if nodes.equipment[parent, who] != UNKNOWN:
                nodes.equipment[node, who] = nodes.equipment[parent, who]
            nodes.seen_at[node, who] = nodes.seen_at[parent, who]
            nodes.current[node, who] = nodes.current[parent, who]
            continue
        nodes.current[node, who] = False
        believed = whole(nodes.pose[node, who])
        if (
            space.senses.negative
            and believed != UNKNOWN
            and sees_agent(space, poses, nodes, parent, eye, believed)
        ):
            nodes.pose[node, who] = UNKNOWN


@merged
def _observe_blocks(
    space: Space,
    nodes: Nodes,
    changes: Changes,
    entry: int,
    tick: int,
    node: int,
    eye: Eye,
) -> None:
    """Take over what the owner of a node sees of the blocks it knew otherwise."""
    parent = whole(nodes.parent[node])
    for word in range(nodes.pending.shape[1]):
        bits = nodes.pending[node, word]
        if bits == 0:
            continue
        for place in range(_WORD):
            if (bits >> np.uint64(place)) & np.uint64(1):
                cell = word * _WORD + place
                if sees_cell(space, nodes, parent, eye, cell):
                    state = whole(nodes.blocks[parent, cell])
                    _put_noted(space, nodes, changes, entry, tick, node, cell, state)
    nodes.fresh[node] = False


@inlined
def _is_common_ground(senses: Senses, facts: Facts, event: int, me: int) -> bool:
    """Whether who perceives an utterance credits an agent with hearing it, present or not (5.5)."""
    to = facts.event_to[event]
    if to != NOBODY:
        return bool(me in (to, facts.event_actor[event]))
    return bool(senses.hearing == HEAR_ALL or facts.event_actor[event] == me)


@inlined
def _hears(senses: Senses, poses: Poses, nodes: Nodes, node: int, speaker: int) -> bool:
    """Return True if the present owner of a node hears somebody else who speaks aloud."""
    if senses.hearing == HEAR_SEEN:
        known = nodes.pose[nodes.parent[node], speaker] != UNKNOWN
        return bool(nodes.sees[node, speaker] and known)
    parent = whole(nodes.parent[node])
    other = whole(nodes.pose[parent, speaker])
    if other == UNKNOWN:
        return False
    own = whole(nodes.pose[parent, nodes.agent[node]])
    x = poses.feet[own, 0] - poses.feet[other, 0]
    y = poses.feet[own, 1] - poses.feet[other, 1]
    z = poses.feet[own, 2] - poses.feet[other, 2]
    return math.sqrt(x * x + z * z + y * y) <= senses.radius


@merged
def _perceive_events(
    space: Space,
    poses: Poses,
    facts: Facts,
    nodes: Nodes,
    changes: Changes,
    span: Span,
    entry: int,
    node: int,
) -> None:
    """Which events of an entry the present owner of a node perceives."""
    parent, me = whole(nodes.parent[node]), whole(nodes.agent[node])
    first_event = whole(facts.event_at[span.start])
    for event in range(facts.event_at[entry], facts.event_at[entry + 1]):
        if not changes.perceived[event - first_event, parent]:
            continue
        kind, actor = facts.event_kind[event], whole(facts.event_actor[event])
        if actor == me:
            got = True
        elif kind == KIND_THINK:
            got = False
        elif kind == KIND_CHAT:
            got = _is_common_ground(space.senses, facts, event, me) or (
                facts.event_to[event] == NOBODY and _hears(space.senses, poses, nodes, node, actor)
            )
        elif kind == KIND_UPDATE:
            cell, eye = whole(facts.event_cell[event]), eye_of(space, poses, whole(nodes.eye[node]))
            got = sees_cell(space, nodes, parent, eye, cell)
        else:
            got = actor >= 0 and nodes.pose[parent, actor] != UNKNOWN and nodes.sees[node, actor]
        changes.perceived[event - first_event, node] = got


@inner
def _update_absent(
    senses: Senses,
    facts: Facts,
    nodes: Nodes,
    changes: Changes,
    span: Span,
    entry: int,
    node: int,
) -> None:
    """An owner that is not present is credited with common ground alone (5.2, 5.5)."""
    nodes.current[node, :] = False
    nodes.basis_current[node, :] = False
    nodes.eye[node] = UNKNOWN
    nodes.watched[node, :] = False
    nodes.meets[node, :] = False
    me = whole(nodes.agent[node])
    first_event = whole(facts.event_at[span.start])
    for event in range(facts.event_at[entry], facts.event_at[entry + 1]):
        is_chat = facts.event_kind[event] == KIND_CHAT
        if is_chat and _is_common_ground(senses, facts, event, me):
            heard = changes.perceived[event - first_event, nodes.parent[node]]
            changes.perceived[event - first_event, node] = heard


@inlined
def _copy(row: npt.NDArray[np.int32], to: npt.NDArray[np.int32]) -> None:
    """Copy a row; an assignment would be compiled with all that it could say of wrong shapes."""
    for place in range(len(row)):
        to[place] = row[place]


@inner
def _count_to(nodes: Nodes, node: int, tick: int) -> None:
    """Count ticks whom the owner of a node misses, all being as it was last (section 8)."""
    if nodes.counted[node] < 0:
        nodes.counted[node] = tick
    passed = tick - nodes.counted[node]
    nodes.counted[node] = tick
    for who in range(nodes.missed.shape[1]):
        if not nodes.current[node, who]:
            nodes.missed[node, who] += passed
    for spot in range(len(nodes.tracked)):
        if nodes.watched[node, spot]:
            _copy(nodes.missed[node], nodes.watch_missed[node, spot])
    for who in range(nodes.missed.shape[1]):
        if nodes.meets[node, who]:
            _copy(nodes.missed[node], nodes.met_missed[node, who])


@inner
def _observe_meetings(space: Space, poses: Poses, nodes: Nodes, node: int, moved: bool) -> None:
    """Where the present owner of a node perceives others, and where it sees that they are gone."""
    parent, me = whole(nodes.parent[node]), whole(nodes.agent[node])
    eye = eye_of(space, poses, whole(nodes.eye[node]))
    for who in range(nodes.missed.shape[1]):
        pose = whole(nodes.pose[parent, who])
        if who == me or (pose != UNKNOWN and nodes.sees[node, who]):
            nodes.met[node, who] = pose
            nodes.meets[node, who] = True
            continue
        met = whole(nodes.met[node, who])
        if (
            met != UNKNOWN
            and (moved or nodes.meets[node, who])
            and sees_agent(space, poses, nodes, parent, eye, met)
        ):
            nodes.met[node, who] = UNKNOWN
        nodes.meets[node, who] = False


@inner
def _note_watched_places(
    facts: Facts,
    nodes: Nodes,
    changes: Changes,
    span: Span,
    entry: int,
    node: int,
) -> None:
    """Note the places at which the present owner of a node perceives somebody act."""
    first_event = whole(facts.event_at[span.start])
    for event in range(facts.event_at[entry], facts.event_at[entry + 1]):
        cell = facts.event_cell[event]
        if cell < 0 or facts.event_actor[event] < 0:
            continue
        if changes.perceived[event - first_event, node]:
            for spot in range(len(nodes.tracked)):
                if nodes.tracked[spot] == cell:
                    _copy(nodes.missed[node], nodes.watch_missed[node, spot])


@merged
def _update_node(
    space: Space,
    poses: Poses,
    facts: Facts,
    nodes: Nodes,
    changes: Changes,
    span: Span,
    entry: int,
    node: int,
) -> None:
    """Fold an entry into one node, after its parent."""
    tick = whole(facts.tick[entry])
    last = tick - 1 if span.happens else tick
    _settle(nodes, node, last)
    if space.senses.weighs:
        _count_to(nodes, node, last)
    parent, me = whole(nodes.parent[node]), whole(nodes.agent[node])
    if not nodes.current[parent, me]:
        _update_absent(space.senses, facts, nodes, changes, span, entry, node)
        if space.senses.weighs:
            _count_to(nodes, node, tick)
        return
    pose = whole(nodes.pose[parent, me])
    eye = eye_of(space, poses, pose)
    moved = nodes.eye[node] != pose or nodes.seen_geometry[node] != nodes.geometry[parent]
    nodes.eye[node] = pose
    nodes.seen_geometry[node] = nodes.geometry[parent]
    _observe_agents(space, poses, nodes, node, eye, moved)
    if moved or nodes.fresh[node]:
        _observe_blocks(space, nodes, changes, entry, tick, node, eye)
    _perceive_events(space, poses, facts, nodes, changes, span, entry, node)
    _propagate_bases(space, nodes, node, eye, moved)
    if space.senses.weighs:
        _observe_meetings(space, poses, nodes, node, moved)
        _count_to(nodes, node, tick)
        _note_watched_places(facts, nodes, changes, span, entry, node)


@compiled
def fold(
    space: Space,
    poses: Poses,
    facts: Facts,
    nodes: Nodes,
    changes: Changes,
    span: Span,
    which: npt.NDArray[np.bool_],
) -> int:
    """Fold the entries of a pass into the nodes that `which` marks.

    Returns the entry it got to: it stops early when `changes.rows` might not hold what the next
    entry adds.
    """
    first_event = whole(facts.event_at[span.start])
    room = changes.rows.shape[0]
    for entry in range(span.start, span.stop):
        if changes.used[0] > 0 and changes.used[0] > room // 2:
            return entry
        if which[0]:
            _apply_entry(space, facts, nodes, changes, entry)
            for event in range(facts.event_at[entry], facts.event_at[entry + 1]):
                changes.perceived[event - first_event, 0] = True
        for node in range(1, len(nodes.parent)):
            if which[node]:
                _update_node(space, poses, facts, nodes, changes, span, entry, node)
    return span.stop
