"""Perception and belief update of all nodes below one timeline, compiled.

The kernel applies semantics, sections 3 to 5, to poses, blocks and the perception of events.
`belief.holdings_table` then updates contents, possessions and dropped items from the rows that
the kernel leaves in `Changes`.

**One pass for all depths.** A node depends on nothing but the state of its parent and on its own
past (section 5). Every node has a higher number than its parent. `fold` therefore takes an entry,
applies it to node 0 and then updates all other nodes in rising order: each owner looks at a parent
that already is as it is after this entry.

**Cost grows with what changed.** Caches in `Nodes` spare lines of sight:

* `pending` has a bit for each cell where the parent knows another block than the node. Perception
  replaces a value by the parent's value (section 4), so it can change no other cell.
* `sees` and `watched` hold what the owner saw last. They stay true while the owner looks from the
  same pose (`eye`) at the same shapes (`seen_geometry`). `tried` says for which pose of the other
  agent `sees` holds.
* Nodes of one owner share lines of sight: `/a/b` looks from the same eye as `/b`, its *twin*. While
  `/a` believes in the shapes of the real world (`unlike` is 0), it sees what the twin sees, unless
  it believes an agent elsewhere.
* `fresh` says that a bit of `pending` was set since the last look. Without it, and without a
  change of the eye or of the shapes, every pending cell was out of sight before and still is.
"""

import math

import numpy as np
import numpy.typing as npt

from beliefnest.belief.arrays import (
    NOBODY,
    SOURCE_SEEN,
    UNKNOWN,
    Bases,
    Changes,
    EntryFacts,
    Grids,
    Looks,
    Nodes,
    Poses,
    Space,
    Span,
    Weighing,
)
from beliefnest.belief.cells import (
    block_at,
    chunk_at,
    grid_cell,
    grids_of,
    line_of,
    place_of,
    put_block,
    scene_of,
    share,
    whole,
)
from beliefnest.belief.seeing import eye_of, sees_agent, sees_cell
from beliefnest.perception.beams import Eye
from beliefnest.perception.chunks import chunk_in, place_at
from beliefnest.perception.compiling import compiled, inlined, inner, merged
from beliefnest.perception.eyes import open_room
from beliefnest.perception.options import SenseLimits
from beliefnest.perception.percept import is_common, perceives
from beliefnest.perception.rays import GridCell, RayScene, lower, upper
from beliefnest.world.event_kinds import Sense
from beliefnest.world.terrain import SIDE, VOLUME, ChunkCounts

_WORD = 64
_ABSENT, _STILL, _MOVED = 0, 1, 2
_At = tuple[int, int, int]
"""Number of an entry, its tick, and the node that is updated."""

_perceives = inlined(perceives)
_is_common = inlined(is_common)


@merged
def _looks_of(nodes: Nodes) -> Looks:
    """Return the arrays about agents and eyes."""
    return Looks(
        nodes.parent,
        nodes.agent,
        nodes.twin,
        nodes.pose,
        nodes.equipment,
        nodes.seen_at,
        nodes.current,
        nodes.eye,
        nodes.seen_geometry,
        nodes.tried,
        nodes.sees,
    )


@merged
def _bases_of(nodes: Nodes) -> Bases:
    """Return the arrays about tracked cells."""
    return Bases(
        nodes.parent,
        nodes.tracked,
        nodes.places,
        nodes.watched,
        nodes.basis_at,
        nodes.basis_source,
        nodes.basis_current,
    )


@inlined
def _held(space: Space, grids: Grids, node: int, place: int) -> int:
    """Return the number of a node's block at a place."""
    return block_at(space.chunks, grids.blocks, grids.rows[node], node, place)


@inlined
def _scene(space: Space, grids: Grids, node: int) -> RayScene:
    """Return the shapes of a node."""
    return scene_of(space.chunks, space, grids.codes[line_of(space.chunks, node)], grids.rows[node])


@inner
def _mark(space: Space, grids: Grids, node: int, place: int) -> None:
    """Set the pending bit of a place in a node below node 0 if the parent knows another block.

    Clear the bit otherwise, unless it stands for a chunk.
    """
    block = _held(space, grids, whole(grids.parent[node]), place)
    number = chunk_at(space.chunks, place)
    word, bit = number // _WORD, np.uint64(1) << np.uint64(number % _WORD)
    if block != UNKNOWN and block != _held(space, grids, node, place):
        grids.pending[node, word] |= bit
        grids.fresh[node] = True
    elif space.chunks is None:
        grids.pending[node, word] &= ~bit


@inlined
def _newly_unlike(space: Space, other: int, before: int, after: int) -> int:
    """Return 1 if a change of a block makes its shape differ from another block's, -1 if equal.

    Return 0 if nothing changes in this respect.
    """
    shape = space.codes[other]
    return whole(space.codes[after] != shape) - whole(space.codes[before] != shape)


@inner
def _put(space: Space, grids: Grids, node: int, cell: int, state: int) -> None:
    """Set the block of a cell in a node, its geometry, and what depends on it.

    This is the node's and its children's `unlike`, and their pending bits.
    """
    place = place_of(space.chunks, space, cell)
    before = _held(space, grids, node, place)
    if before == state:
        return
    put_block(space.chunks, space, grids, node, cell, state)
    if node > 0:
        above = _held(space, grids, whole(grids.parent[node]), place)
        grids.unlike[node] += _newly_unlike(space, above, before, state)
        _mark(space, grids, node, place)
    for n in range(grids.child_at[node], grids.child_at[node + 1]):
        child = whole(grids.child[n])
        below = _held(space, grids, child, place)
        grids.unlike[child] += _newly_unlike(space, below, before, state)
        _mark(space, grids, child, place)


@inlined
def _handed_source(bases: Bases, parent: int, spot: int) -> int:
    """Return the source that an owner takes over for a tracked cell that it sees in its parent.

    In the real world everything is current (section 2), so a child of node 0 holds it as seen.
    """
    return SOURCE_SEEN if parent == 0 else bases.basis_source[parent, spot]


@merged
def _settle(looks: Looks, bases: Bases, node: int, last: int) -> None:
    """Set `observed_at` of everything that was current so far to tick `last` (section 2).

    While an element is current no tick is written. This function runs before the flags are computed
    anew: an element that is no longer current then keeps `last` as its `observed_at`.
    """
    for who in range(looks.pose.shape[1]):
        if looks.current[node, who]:
            looks.seen_at[node, who] = last
    for spot in range(len(bases.tracked)):
        if bases.basis_current[node, spot]:
            bases.basis_at[node, spot] = last


@inner
def _put_noted(
    space: Space, grids: Grids, bases: Bases, changes: Changes, at: _At, cell: int, state: int
) -> None:
    """Call `_put`. Add a row to `changes` if the old or the new block shows a container.

    The row carries the basis of the new block: that of the parent, from which the owner took it.
    """
    entry, tick, node = at
    old = _held(space, grids, node, place_of(space.chunks, space, cell))
    if old == state:
        return
    if space.shows[old] or space.shows[state]:
        row = changes.used[0]
        changes.rows[row, 0] = entry
        changes.rows[row, 1] = node
        changes.rows[row, 2] = cell
        changes.rows[row, 3] = old
        changes.rows[row, 4] = state
        for spot in range(len(bases.tracked)):
            if bases.tracked[spot] == cell:
                parent = grids.parent[node] if node > 0 else 0
                is_current = bases.basis_current[parent, spot]
                changes.rows[row, 5] = tick if is_current else bases.basis_at[parent, spot]
                changes.rows[row, 6] = _handed_source(bases, parent, spot)
        changes.used[0] = row + 1
    _put(space, grids, node, cell, state)


@compiled
def put_all(
    space: Space,
    nodes: Nodes,
    which: npt.NDArray[np.int64],
    cell: int,
    states: npt.NDArray[np.int64],
) -> None:
    """Call `_put` for several nodes: `states[k]` is for node `which[k]`."""
    grids = grids_of(nodes)
    for number in range(len(which)):
        _put(space, grids, whole(which[number]), whole(cell), whole(states[number]))


@merged
def _apply_entry(
    space: Space,
    facts: EntryFacts,
    looks: Looks,
    grids: Grids,
    bases: Bases,
    changes: Changes,
    entry: int,
) -> None:
    """Apply an entry to node 0. Everything that node 0 knows is current (section 2)."""
    for row in range(facts.pose_at[entry], facts.pose_at[entry + 1]):
        who, pose = facts.pose_agent[row], facts.pose_id[row]
        looks.pose[0, who] = pose
        looks.equipment[0, who] = pose
    for who in range(looks.pose.shape[1]):
        is_known = looks.pose[0, who] != UNKNOWN
        looks.current[0, who] = is_known
        if is_known:
            looks.seen_at[0, who] = facts.tick[entry]
    for row in range(facts.block_at[entry], facts.block_at[entry + 1]):
        cell, state = whole(facts.block_cell[row]), whole(facts.block_state[row])
        at = whole(entry), whole(facts.tick[entry]), whole(0)
        _put_noted(space, grids, bases, changes, at, cell, state)
    for spot in range(len(bases.tracked)):
        is_known = _held(space, grids, whole(0), whole(bases.places[spot])) != UNKNOWN
        bases.basis_current[0, spot] = is_known
        if is_known:
            bases.basis_at[0, spot] = facts.tick[entry]
            bases.basis_source[0, spot] = SOURCE_SEEN


@inlined
def _guide(looks: Looks, grids: Grids, node: int) -> int:
    """Return the node's twin if it looks from the same eye at the same shapes; otherwise -1.

    The twin has been updated for this entry: it has a lower number and is at a lower depth.
    """
    twin, parent = whole(looks.twin[node]), whole(looks.parent[node])
    if (
        twin != UNKNOWN
        and grids.unlike[parent] == 0
        and looks.eye[twin] == looks.eye[node]
        and looks.seen_geometry[twin] == grids.geometry[looks.parent[twin]]
    ):
        return twin
    return UNKNOWN


@merged
def _propagate_bases(
    space: Space, grids: Grids, bases: Bases, node: int, eye: Eye, moved: bool
) -> None:
    """Take over the basis of each tracked cell that the owner of a node sees in its parent.

    A cell is current for the owner only if it is current in the parent. A stale one keeps its old
    tick (section 5.4).
    """
    parent = whole(grids.parent[node])
    for spot in range(len(bases.tracked)):
        if moved:
            cell = grid_cell(space, whole(bases.tracked[spot]))
            bases.watched[node, spot] = sees_cell(space, _scene(space, grids, parent), eye, cell)
        bases.basis_current[node, spot] = False
        block = _held(space, grids, parent, whole(bases.places[spot]))
        if bases.watched[node, spot] and block != UNKNOWN:
            bases.basis_at[node, spot] = bases.basis_at[parent, spot]
            bases.basis_source[node, spot] = _handed_source(bases, parent, spot)
            bases.basis_current[node, spot] = bases.basis_current[parent, spot]


@merged
def _observe_agents(
    space: Space, poses: Poses, looks: Looks, grids: Grids, node: int, eye: Eye, moved: bool
) -> None:
    """Take over poses and equipment of the agents that the owner sees in its parent.

    The owner always perceives itself. A pose is current for it only if it is current in the parent
    (section 5.4). With `negative_evidence` a believed pose becomes unknown if the owner sees that
    place without the agent (section 4).
    """
    parent, me = whole(looks.parent[node]), whole(looks.agent[node])
    scene, guide = _scene(space, grids, parent), _guide(looks, grids, node)
    for who in range(looks.pose.shape[1]):
        pose = whole(looks.pose[parent, who])
        seen = who == me
        if not seen and pose != UNKNOWN:
            if moved or looks.tried[node, who] != pose:
                if guide != UNKNOWN and looks.pose[looks.parent[guide], who] == pose:
                    looks.sees[node, who] = looks.sees[guide, who]
                else:
                    looks.sees[node, who] = sees_agent(space, poses, scene, eye, pose)
                looks.tried[node, who] = pose
            seen = looks.sees[node, who]
        if seen:
            looks.pose[node, who] = pose
            if looks.equipment[parent, who] != UNKNOWN:
                looks.equipment[node, who] = looks.equipment[parent, who]
            looks.seen_at[node, who] = looks.seen_at[parent, who]
            looks.current[node, who] = looks.current[parent, who]
            continue
        looks.current[node, who] = False
        believed = whole(looks.pose[node, who])
        if (
            space.senses.negative
            and believed != UNKNOWN
            and sees_agent(space, poses, scene, eye, believed)
        ):
            looks.pose[node, who] = UNKNOWN


@inlined
def _in_range(place: float, far: float, first: int, end: int) -> tuple[int, int]:
    """Return the first cell of an axis with its middle within a distance, and one after the last.

    There may be one cell more on each side. Cells before `first` and from `end` on are left out.
    """
    low, high, least, most = place - 1.0 - far, place + 1.0 + far, float(first), float(end)
    return int(lower(upper(low, least), most)), int(lower(upper(high, least), most))


@merged
def _observe_cells(
    space: Space, grids: Grids, bases: Bases, changes: Changes, at: _At, eye: Eye
) -> None:
    """Take over the pending blocks that the owner of a node sees, where grids are dense.

    The loop visits the columns of the box that may be within the visible distance, and there the
    bits of cells within this distance, in words of which columns share some. `_put` clears the bit
    of each block taken over.
    """
    node = at[2]
    parent = whole(grids.parent[node])
    scene = _scene(space, grids, parent)
    ny, nz = space.sizes[1] - 2, space.sizes[2] - 2
    (px, py, pz), _, _, far = eye
    # Most nodes have few pending cells, or none.
    first, last = 0, grids.pending.shape[1] - 1
    while first <= last and grids.pending[node, first] == 0:
        first += 1
    while first < last and grids.pending[node, last] == 0:
        last -= 1
    if first > last:
        return
    (x0, y0, low), (x1, y1, high) = open_room(scene, eye[0])
    x0, x1 = _in_range(px - 1.0, far, x0, x1)
    x0 = upper(x0, first * _WORD // (ny * nz))
    x1 = lower(x1, (last * _WORD + _WORD) // (ny * nz) + 1)
    y0, y1 = _in_range(py - 1.0, far, y0, y1)
    for x in range(x0, x1):
        for y in range(y0, y1):
            dx, dy = x + 1.5 - px, y + 1.5 - py
            near = math.sqrt(upper(far * far - dx * dx - dy * dy, 0.0))
            z0, z1 = _in_range(pz - 1.0, near, low, high)
            row = (x * ny + y) * nz
            for word in range((row + z0) // _WORD, (row + z1 + _WORD - 1) // _WORD):
                start, stop = upper(row + z0, word * _WORD), lower(row + z1, word * _WORD + _WORD)
                bits = grids.pending[node, word] >> np.uint64(start - word * _WORD)
                for cell in range(start, stop if bits != 0 else start):
                    there, bit = (x + 1, y + 1, cell - row + 1), bits >> np.uint64(cell - start)
                    if bit & np.uint64(1) and sees_cell(space, scene, eye, there):
                        state = whole(grids.blocks[parent, cell])
                        _put_noted(space, grids, bases, changes, at, cell, state)


@inner
def _observe_chunk(
    space: Space,
    grids: Grids,
    bases: Bases,
    changes: Changes,
    at: _At,
    eye: Eye,
    corner: GridCell,
) -> bool:
    """Take over the blocks of a chunk that the owner of a node sees; return True if any is left.

    `corner` is the first cell of the chunk. Cells of the margin are unknown in all nodes.
    """
    node = at[2]
    parent = whole(grids.parent[node])
    chunk = chunk_in(place_at(space.chunks, space.sizes, corner))
    theirs, ny, nz = grids.rows[parent, chunk], space.sizes[1] - 2, space.sizes[2] - 2
    if grids.rows[node, chunk] == theirs:
        return False
    scene, left = _scene(space, grids, parent), False
    for within in range(VOLUME):
        state = whole(grids.blocks[0, theirs * VOLUME + within])
        own = whole(grids.blocks[0, grids.rows[node, chunk] * VOLUME + within])
        if state not in (UNKNOWN, own):
            i, j, k = corner[0] + within // (SIDE * SIDE), within // SIDE % SIDE, within % SIDE
            j, k = corner[1] + j, corner[2] + k
            if sees_cell(space, scene, eye, (i, j, k)):
                cell = ((i - 1) * ny + j - 1) * nz + k - 1
                _put_noted(space, grids, bases, changes, at, cell, state)
            else:
                left = True
    if not left:
        share(grids, node, parent, chunk)
    return left


@inner
def _observe_chunks(
    space: Space, grids: Grids, bases: Bases, changes: Changes, at: _At, eye: Eye
) -> None:
    """Take over the pending blocks that the owner of a node sees, where grids are in chunks."""
    node, ((px, py, pz), _, _, far) = at[2], eye
    x0, x1 = _in_range(px, far, 0, space.sizes[0])
    y0, y1 = _in_range(py, far, 0, space.sizes[1])
    z0, z1 = _in_range(pz, far, 0, space.sizes[2])
    for i in range(x0 // SIDE * SIDE, x1, SIDE):
        for j in range(y0 // SIDE * SIDE, y1, SIDE):
            for k in range(z0 // SIDE * SIDE, z1, SIDE):
                chunk = chunk_in(place_at(space.chunks, space.sizes, (i, j, k)))
                word, bit = chunk // _WORD, np.uint64(1) << np.uint64(chunk % _WORD)
                if grids.pending[node, word] & bit and not _observe_chunk(
                    space, grids, bases, changes, at, eye, (i, j, k)
                ):
                    grids.pending[node, word] &= ~bit


@inlined
def _is_common_ground(senses: SenseLimits, facts: EntryFacts, event: int, me: int) -> bool:
    """Return True if everybody who perceives an event credits agent `me` with perceiving it.

    Presence does not matter then (section 5.5).
    """
    to, is_own = facts.event_to[event], facts.event_actor[event] == me
    if to != NOBODY:
        return bool(me == to or is_own)
    return _is_common(senses, facts.event_sense[event], is_own)


@inlined
def _distance(poses: Poses, one: int, other: int) -> float:
    """Return the distance between the feet of two poses."""
    x = poses.feet[one, 0] - poses.feet[other, 0]
    y = poses.feet[one, 1] - poses.feet[other, 1]
    z = poses.feet[one, 2] - poses.feet[other, 2]
    return math.sqrt(x * x + z * z + y * y)


@merged
def _perceive_events(
    space: Space,
    poses: Poses,
    facts: EntryFacts,
    looks: Looks,
    grids: Grids,
    changes: Changes,
    span: Span,
    entry: int,
    node: int,
    eye: Eye,
) -> None:
    """Set in `changes.perceived` which events of an entry the present owner of a node perceives.

    An event that was not perceived in the parent is skipped: a deeper belief never contains more
    than the shallower one.
    """
    parent, me = whole(looks.parent[node]), whole(looks.agent[node])
    first_event = whole(facts.event_at[span.start])
    for event in range(facts.event_at[entry], facts.event_at[entry + 1]):
        if not changes.perceived[event - first_event, parent]:
            continue
        sense, actor = facts.event_sense[event], whole(facts.event_actor[event])
        if actor == me:
            got = True
        elif facts.event_to[event] != NOBODY:
            got = facts.event_to[event] == me
        else:
            sees_actor, away = False, math.inf
            other = whole(looks.pose[parent, actor]) if actor >= 0 else UNKNOWN
            if other != UNKNOWN:
                sees_actor = looks.sees[node, actor]
                away = _distance(poses, whole(looks.pose[parent, me]), other)
            sees_place = False
            if sense == Sense.PLACE:
                place = grid_cell(space, whole(facts.event_cell[event]))
                sees_place = sees_cell(space, _scene(space, grids, parent), eye, place)
            got = _perceives(space.senses, sense, sees_actor, sees_place, away)
        changes.perceived[event - first_event, node] = got


@merged
def _update_absent(
    senses: SenseLimits,
    facts: EntryFacts,
    looks: Looks,
    bases: Bases,
    changes: Changes,
    span: Span,
    entry: int,
    node: int,
) -> None:
    """Update a node whose owner is not present in the parent.

    Nothing stays current, and the owner is credited with nothing but events that are common
    ground (sections 5.2 and 5.5).
    """
    for who in range(looks.pose.shape[1]):
        looks.current[node, who] = False
    for spot in range(len(bases.tracked)):
        bases.basis_current[node, spot] = False
        bases.watched[node, spot] = False
    looks.eye[node] = UNKNOWN
    me = whole(looks.agent[node])
    first_event = whole(facts.event_at[span.start])
    for event in range(facts.event_at[entry], facts.event_at[entry + 1]):
        if _is_common_ground(senses, facts, event, me):
            perceived = changes.perceived[event - first_event, looks.parent[node]]
            changes.perceived[event - first_event, node] = perceived


@inlined
def _copy(row: npt.NDArray[np.int32], to: npt.NDArray[np.int32]) -> None:
    """Copy a row. A slice assignment would also compile Numba's checks and messages of shapes."""
    for place in range(len(row)):
        to[place] = row[place]


@inner
def _count_to(looks: Looks, bases: Bases, weighing: Weighing, node: int, tick: int) -> None:
    """Count the ticks up to `tick` for condition 1b of section 8.1, with the present flags.

    `missed` grows for every agent that the owner did not perceive. The copies of `missed` for
    places and agents that the owner watches follow it. The difference between `missed` and such a
    copy is therefore the number of ticks without the agent since the owner last watched.
    """
    if weighing.counted[node] < 0:
        weighing.counted[node] = tick
    passed = tick - weighing.counted[node]
    weighing.counted[node] = tick
    for who in range(weighing.missed.shape[1]):
        if not looks.current[node, who]:
            weighing.missed[node, who] += passed
    for spot in range(len(bases.tracked)):
        if bases.watched[node, spot]:
            _copy(weighing.missed[node], weighing.watch_missed[node, spot])
    for who in range(weighing.missed.shape[1]):
        if weighing.meets[node, who]:
            _copy(weighing.missed[node], weighing.met_missed[node, who])


@inner
def _observe_meetings(
    space: Space,
    poses: Poses,
    looks: Looks,
    grids: Grids,
    weighing: Weighing,
    node: int,
    moved: bool,
) -> None:
    """Note the pose in which the present owner of a node perceives each agent.

    Set `met` to unknown where the owner sees the last such place without the agent. The test is
    repeated only if the owner looks anew (`moved`) or has just lost the agent from sight.
    """
    parent, me = whole(looks.parent[node]), whole(looks.agent[node])
    eye = eye_of(space, poses, whole(looks.eye[node]))
    for who in range(weighing.missed.shape[1]):
        pose = whole(looks.pose[parent, who])
        if who == me or (pose != UNKNOWN and looks.sees[node, who]):
            weighing.met[node, who] = pose
            weighing.meets[node, who] = True
            continue
        met = whole(weighing.met[node, who])
        if (
            met != UNKNOWN
            and (moved or weighing.meets[node, who])
            and sees_agent(space, poses, _scene(space, grids, parent), eye, met)
        ):
            weighing.met[node, who] = UNKNOWN
        weighing.meets[node, who] = False


@inner
def _note_watched_places(
    facts: EntryFacts,
    bases: Bases,
    weighing: Weighing,
    changes: Changes,
    span: Span,
    entry: int,
    node: int,
) -> None:
    """Count tracked cells as watched where the present owner of a node perceives an act.

    See section 8: an agent watches a place also when it acts there or perceives somebody act there.
    """
    first_event = whole(facts.event_at[span.start])
    for event in range(facts.event_at[entry], facts.event_at[entry + 1]):
        cell = facts.event_cell[event]
        if cell < 0 or facts.event_actor[event] < 0:
            continue
        if changes.perceived[event - first_event, node]:
            for spot in range(len(bases.tracked)):
                if bases.tracked[spot] == cell:
                    _copy(weighing.missed[node], weighing.watch_missed[node, spot])


@merged
def _begin(
    space: Space,
    facts: EntryFacts,
    looks: Looks,
    grids: Grids,
    bases: Bases,
    weighing: Weighing | None,
    changes: Changes,
    span: Span,
    entry: int,
    node: int,
) -> int:
    """Begin to fold an entry into a node whose parent was updated before; return how it looks.

    The order matters. First the ticks before this one are accounted for, with the flags that held
    during them. The caller then computes the flags anew. The tick of the entry counts with the
    new ones.

    Returns:
        `_ABSENT` if the owner is not present in the parent; the node is complete then. `_MOVED` if
        the eye or the shapes changed since the last look; otherwise `_STILL`.
    """
    tick = whole(facts.tick[entry])
    # An edit lies between two ticks: what was current before it was so at this tick too.
    last = tick - 1 if span.happens else tick
    _settle(looks, bases, node, last)
    if weighing is not None:
        _count_to(looks, bases, weighing, node, last)
    parent, me = whole(looks.parent[node]), whole(looks.agent[node])
    if not looks.current[parent, me]:
        _update_absent(space.senses, facts, looks, bases, changes, span, entry, node)
        if weighing is not None:
            for who in range(weighing.missed.shape[1]):
                weighing.meets[node, who] = False
            _count_to(looks, bases, weighing, node, tick)
        return _ABSENT
    pose, shapes = whole(looks.pose[parent, me]), whole(grids.geometry[parent])
    moved = looks.eye[node] != pose or looks.seen_geometry[node] != shapes
    looks.eye[node] = pose
    looks.seen_geometry[node] = shapes
    return _MOVED if moved else _STILL


@merged
def _lacks_room(chunks: ChunkCounts | None, grids: Grids) -> bool:
    """Return True if a node that changes all of its chunks might not find room in the pool."""
    if chunks is None:
        return False
    free = grids.spare[0] + len(grids.shares) - grids.spare[1]
    return bool(free < grids.rows.shape[1])


@compiled
def fold(
    space: Space,
    poses: Poses,
    facts: EntryFacts,
    nodes: Nodes,
    weighing: Weighing | None,
    changes: Changes,
    span: Span,
    which: npt.NDArray[np.bool_],
    chunks: ChunkCounts | None,
) -> int:
    """Fold the entries of a pass into the nodes that `which` marks; see the module's docstring.

    Args:
        space: Box, shapes and senses.
        poses: Poses that the facts and the nodes refer to.
        facts: Entries of the stretch.
        nodes: States of all nodes, changed in place.
        weighing: Arrays by which hearers weigh claims, changed in place; None if they weigh none.
            The kernel is compiled for either, without these rules if they are not needed.
        changes: Receives who perceived which event, and changes at containers.
        span: Entries to fold.
        which: bool (N,), nodes to update. The parent of a marked node is marked too or is up to
            date.
        chunks: Those of `space`. The branches for the other kind of grids are then not compiled.

    Returns:
        Number of the first entry that was not folded. The kernel stops early if the rows that the
        next entry adds might not fit into `changes.rows`, or the chunks that the next node changes
        into the pool; then it leaves the number of that node in `changes.used`.
    """
    looks, grids, bases = _looks_of(nodes), grids_of(nodes), _bases_of(nodes)
    first_event = whole(facts.event_at[span.start])
    room = changes.rows.shape[0]
    first_node = span.node
    for entry in range(span.entry, span.stop):
        # An entry adds at most one row for each node and tracked cell, a quarter of the room (see
        # `Forest._changes`). So no entry that begins with half of the room free can overflow it.
        if first_node == 0 and changes.used[0] > 0 and changes.used[0] > room // 2:
            return entry
        for node in range(first_node, len(looks.parent)):
            if which[node]:
                if _lacks_room(chunks, grids):
                    changes.used[1] = node
                    return entry
                if node == 0:
                    _apply_entry(space, facts, looks, grids, bases, changes, entry)
                    for event in range(facts.event_at[entry], facts.event_at[entry + 1]):
                        changes.perceived[event - first_event, 0] = True
                    continue
                look = _begin(
                    space, facts, looks, grids, bases, weighing, changes, span, entry, node
                )
                if look == _ABSENT:
                    continue
                eye, tick = eye_of(space, poses, whole(looks.eye[node])), whole(facts.tick[entry])
                at = whole(entry), tick, whole(node)
                _observe_agents(space, poses, looks, grids, node, eye, look == _MOVED)
                if look == _MOVED or grids.fresh[node]:
                    if chunks is None:
                        _observe_cells(space, grids, bases, changes, at, eye)
                    else:
                        _observe_chunks(space, grids, bases, changes, at, eye)
                    grids.fresh[node] = False
                _perceive_events(space, poses, facts, looks, grids, changes, span, entry, node, eye)
                _propagate_bases(space, grids, bases, node, eye, look == _MOVED)
                if weighing is not None:
                    _observe_meetings(space, poses, looks, grids, weighing, node, look == _MOVED)
                    _count_to(looks, bases, weighing, node, tick)
                    _note_watched_places(facts, bases, weighing, changes, span, entry, node)
        first_node = 0
    return span.stop
