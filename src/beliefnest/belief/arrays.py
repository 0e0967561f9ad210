"""The arrays that the belief kernel works on.

Cells are indices into a flat array over the box (x slowest, z fastest). A pose id is
a row of a pose table: one agent's pose as it was from some tick on. Nodes are the
simulators below one timeline, shallower ones first; node 0 is the timeline's own.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from beliefnest.perception.options import SenseLimits
from beliefnest.world.array_types import Flags, Floats, Ints, States

if TYPE_CHECKING:  # Compiled code takes its time to load.
    from beliefnest.perception.beams import Beam

UNKNOWN = -1
"""Value of a block state, a pose id or a cell that is unknown or absent."""

NOBODY = -1
"""Index of no agent."""

READ = -2
"""Number of the speaker of a claim that was read on a sign of unknown writer."""

SOURCE_SEEN = 1
"""Row of `Source.SEEN` in `belief.entries.SOURCES`."""


class Space(NamedTuple):
    """The box and its shapes, as the ray kernels take them.

    Attributes:
        sizes: Cells along x, y, z, with a margin of one on every side.
        chunks: Numbers of chunks along x, y, z; None: nodes hold dense arrays of the box.
        starts: int32, rows of each shape (see `perception.rays`).
        boxes: float64 (n, 6), shapes' boxes.
        reaches: uint8 by code, bit set of the sides on which a shape reaches out of its cell.
        codes: uint16, code of each block number; the last entry is for unknown blocks.
        shows: bool, True for each block number that shows a container; the last entry is for
            unknown.
        origin: float64 (3,), added to scenario coordinates to get the grid's.
        senses: Limits of what agents can perceive.
        beam: Scratch memory from `beams.beam_room`.
        no_rows: What a scene of a dense grid has for rows: None. With chunks an empty array, which
            no scene gets: numba wants one type from both branches of `cells.scene_of`.
    """

    sizes: tuple[int, int, int]
    chunks: tuple[int, int, int] | None
    starts: Ints
    boxes: Floats
    reaches: npt.NDArray[np.uint8]
    codes: npt.NDArray[np.uint16]
    shows: Flags
    origin: Floats
    senses: SenseLimits
    beam: "Beam"
    no_rows: Ints | None


class Poses(NamedTuple):
    """Pose table: by pose id, feet (x, y, z) in scenario coordinates, and (yaw, pitch)."""

    feet: Floats
    angles: Floats


class EntryFacts(NamedTuple):
    """Entries of a timeline in columns; `x_at[e]` to `x_at[e + 1] - 1` are entry e's rows.

    Attributes:
        tick: By entry.
        pose_at, pose_agent, pose_id: Agents that moved, and the ids of their new poses.
        block_at, block_cell, block_state: Blocks that changed.
        event_at, event_sense, event_actor, event_cell, event_to: Events. A sense is a number of
            `world.event_kinds.Sense`. The cell is `UNKNOWN` for an event without a place.
            `event_to` is the addressee of a whisper, `NOBODY` for speech aloud.
    """

    tick: Ints
    pose_at: Ints
    pose_agent: Ints
    pose_id: Ints
    block_at: Ints
    block_cell: Ints
    block_state: Ints
    event_at: Ints
    event_sense: Ints
    event_actor: Ints
    event_cell: Ints
    event_to: Ints


class Nodes(NamedTuple):
    """States of N nodes with A agents, C cells and T tracked cells.

    In a large box the cells of nodes are in chunks (`perception.chunks`), which nodes share while
    these are equal. `blocks` and `codes` then have one row, the pool, and `pending` has a bit for
    each chunk in which the parent may know another block. A chunk includes cells of the margin.

    Attributes:
        parent: (N,), index of the shallower node; -1 for node 0.
        agent: (N,), the owner, whose belief the node is; -1 for node 0.
        child_at, child: Node n's children are child[child_at[n]:child_at[n + 1]].
        twin: (N,), the earlier node of the same owner below the parent of the parent, as `/b` for
            `/a/b`; -1: there is none.
        pose: (N, A), id of each agent's believed pose; -1 unknown.
        equipment: (N, A), pose id of each agent's believed equipment; -1 unknown.
        seen_at: (N, A), last tick at which the pose was current, for poses that no longer are.
        current: (N, A), whether the pose is backed by a perception in this tick.
        rows: (N, chunks), row of the pool for each chunk; (N, 1) without chunks.
        shares: (rows of the pool,), number of chunks of all nodes that use the row.
        spare: Number of rows that were freed; the first row that was never used; the freed rows.
        blocks: (N, C), numbers of believed blocks (`BeliefContext.number`); -1 unknown.
        codes: (N, cells with margin), geometry of the blocks, as codes of `perception.codes`.
        geometry: (N,), number of changes of the geometry so far.
        versions: (N,), number of changes of blocks, or of the rows that hold them, so far.
        unlike: (N,), number of cells whose shape is not that of the parent's cell.
        pending: (N, words), bit set of cells where the parent knows another block.
        fresh: (N,), whether a bit of `pending` was set since the owner last looked for those cells.
        eye: (N,), id of the pose the owner last looked from; -1: it was not present.
        seen_geometry: (N,), the parent's `geometry` at the last look.
        tried: (N, A), pose id of each agent for which `sees` holds.
        sees: (N, A), whether the owner sees the agent in the parent.
        tracked: (T,), cells whose basis is tracked: those that ever hold a container.
        places: (T,), their places (`cells.place_of`).
        watched: (N, T), whether the owner sees the tracked cell in the parent.
        basis_at: (N, T), last tick at which the tracked cell was current, for cells that no longer
            are; -1 unknown.
        basis_current: (N, T), whether the block is backed by a perception in this tick.
        basis_source: (N, T), its source, a code of `BeliefContext.basis_code`.
    """

    parent: Ints
    agent: Ints
    child_at: Ints
    child: Ints
    twin: Ints
    pose: Ints
    equipment: Ints
    seen_at: Ints
    current: Flags
    rows: Ints
    shares: Ints
    spare: Ints
    blocks: States
    codes: npt.NDArray[np.uint16]
    geometry: Ints
    versions: Ints
    unlike: Ints
    pending: npt.NDArray[np.uint64]
    fresh: Flags
    eye: Ints
    seen_geometry: Ints
    tried: Ints
    sees: Flags
    tracked: Ints
    places: Ints
    watched: Flags
    basis_at: Ints
    basis_source: npt.NDArray[np.uint8]
    basis_current: Flags


class Looks(NamedTuple):
    """Arrays of `Nodes` about agents and eyes.

    Kernels take parts of `Nodes`, because each of them takes time to compile for each array.
    """

    parent: Ints
    agent: Ints
    twin: Ints
    pose: Ints
    equipment: Ints
    seen_at: Ints
    current: Flags
    eye: Ints
    seen_geometry: Ints
    tried: Ints
    sees: Flags


class Grids(NamedTuple):
    """Arrays of `Nodes` about blocks; see `Looks`."""

    parent: Ints
    child_at: Ints
    child: Ints
    rows: Ints
    shares: Ints
    spare: Ints
    blocks: States
    codes: npt.NDArray[np.uint16]
    geometry: Ints
    versions: Ints
    unlike: Ints
    pending: npt.NDArray[np.uint64]
    fresh: Flags


class Bases(NamedTuple):
    """Arrays of `Nodes` about tracked cells; see `Looks`."""

    parent: Ints
    tracked: Ints
    places: Ints
    watched: Flags
    basis_at: Ints
    basis_source: npt.NDArray[np.uint8]
    basis_current: Flags


class Weighing(NamedTuple):
    """Arrays by which hearers weigh claims (semantics, section 8), for N nodes as in `Nodes`.

    Attributes:
        counted: (N,), tick up to which the other arrays count.
        missed: (N, A), number of ticks at which the owner did not perceive the agent.
        met: (N, A), id of the pose in which the owner last perceived the agent; -1: it never
            did, or it has seen since that the agent is gone.
        meets: (N, A), whether the owner sees the agent in the parent.
        met_missed: (N, A, A), copy of `missed` from the tick at which the agent was last seen.
        watch_missed: (N, T, A), copy of `missed` from the tick at which the tracked cell was last
            watched; -1: it never was.
    """

    counted: Ints
    missed: Ints
    met: Ints
    meets: Flags
    met_missed: Ints
    watch_missed: Ints


class Span(NamedTuple):
    """Entries that a pass of the kernel folds.

    Attributes:
        start: Number of the first entry, counted from the beginning of the stretch.
        stop: Number after the last entry.
        entry: Number of the entry to begin with; an earlier call has folded those before it.
        node: Number of the node to begin with in that entry.
        happens: True for ticks. False: nothing happens, and nodes perceive the state that they
            find between two ticks.
    """

    start: int
    stop: int
    happens: bool
    entry: int
    node: int = 0


class Changes(NamedTuple):
    """Output of a pass of the kernel, for the rules that are not about rays.

    Attributes:
        perceived: bool (events, N), whether the owner of a node perceived an event of the pass.
        rows: (M, 7), changes at cells that held or hold a container: entry, node, cell,
            old state, new state, and tick and source of the basis of the new state.
        used: (2,), rows in use, and the number of the node for which the pool of chunks had no
            room; 0 if there is none.
    """

    perceived: Flags
    rows: Ints
    used: Ints
