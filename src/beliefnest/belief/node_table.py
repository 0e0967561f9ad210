"""Arrays of the nodes of one forest for the kernel, which grow as nodes are added."""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from beliefnest.belief.arrays import UNKNOWN, Nodes, Poses, Space, Weighing
from beliefnest.belief.chunk_pool import NOTHING, ChunkPool, cut_grids
from beliefnest.belief.context import BeliefContext, SavedWriting
from beliefnest.belief.grounds import Basis
from beliefnest.belief.node_memory import check_room, columns_of, most_nodes
from beliefnest.belief.poses import PoseDetails, PoseTable
from beliefnest.perception.codes import code_grid
from beliefnest.world.paths import BeliefPath
from beliefnest.world.terrain import SIDE, VOLUME, Terrain
from beliefnest.world.values import Point

NodeRow = npt.NDArray[Any]

_POSE_IDS = ("pose", "equipment", "eye", "tried", "met")
"""Names of the arrays that hold pose ids."""

_BY_SPOT = ("watched", "basis_at", "basis_source", "basis_current", "watch_missed")
"""Names of the arrays with a column for each tracked cell."""


class SavedNode(msgspec.Struct, frozen=True):
    """Rows of one node as native bytes, by their names in `arrays.Nodes`.

    `weighing` has the rows that exist only if hearers weigh claims. In a box with chunks, `blocks`
    and `codes` have the chunks that are not those of the parent, and `rows` has the number of each
    chunk among them; -1: it is the parent's. Otherwise `blocks` has all cells, and the other two
    are empty.
    """

    path: BeliefPath
    blocks: bytes
    codes: bytes
    rows: bytes
    pose: bytes
    equipment: bytes
    seen_at: bytes
    current: bytes
    basis_at: bytes
    basis_source: bytes
    basis_current: bytes
    edited_cells: list[int]
    weighing: dict[str, bytes] = msgspec.field(default_factory=dict)


_TERRAINS = 16
"""Number of states of nodes' blocks that are kept for later readers."""
_SAVED = (
    *("pose", "equipment", "seen_at", "current"),
    *("basis_at", "basis_source", "basis_current"),
)


class NodeTable:
    """Arrays of nodes; see `arrays.Nodes` for what each holds.

    Args:
        context: The part that all nodes of the nest share.
        poses: The pose table.
        extra: Further cells whose basis is to be tracked.
        room: Number of nodes that will be added, if it is known.

    Raises:
        InputError: The memory of this process has no room for these nodes.

    Attributes:
        index: Number of each node by path; a node's number is above its parent's.
        count: Number of nodes.
        context: The part that all nodes of the nest share.
        poses: The pose table to which the nodes' pose ids refer.
        pool: Chunks of the nodes; None if these hold dense arrays.
        edited_cells: Pairs of node and cell of blocks that were changed by hand since the node
            last perceived them.
    """

    def __init__(
        self, context: BeliefContext, poses: PoseTable, extra: Sequence[int] = (), room: int = 2
    ) -> None:
        check_room(context, room)
        self.context = context
        self.poses = poses
        self.edited_cells: set[tuple[int, int]] = set()
        self.index: dict[BeliefPath, int] = {}
        self.count = 0
        self._linked = 1
        tracked_cells = set(context.tracked)
        others = [cell for cell in extra if cell not in tracked_cells]
        tracked = self._tracked = np.array([*context.tracked, *others], dtype=np.int32)
        # Not initialized: `_grow` fills the row of each node that is added.
        self._rows: dict[str, NodeRow] = {
            name: np.empty((room, *column.shape), column.kind)
            for name, column in columns_of(context, len(tracked)).items()
        }
        self.pool = None if context.space.chunks is None else ChunkPool(context.box.shape)
        self._child_at = np.zeros(1, dtype=np.int32)
        self._child = np.zeros(0, dtype=np.int32)
        self._nodes: Nodes | None = None
        self._weighing: Weighing | None = None
        # Results of the last call for the next one, until `link`: geometry of the blocks that were
        # set last, and rows of the chunks of another table that were copied.
        self._coded: tuple[Terrain, NodeRow] | None = None
        self._terrains: dict[tuple[int, int], Terrain] = {}
        self._copied: tuple[NodeTable, NodeRow] | None = None

    def nodes(self) -> Nodes:
        """Return the arrays for the kernel."""
        if self._nodes is None:
            rows = {name: row[: self.count] for name, row in self._rows.items()}
            rows |= {"child_at": self._child_at, "child": self._child, "tracked": self._tracked}
            rows["places"] = self.places(self._tracked).astype(np.int32)
            rows |= self._stored()
            self._nodes = Nodes(*(rows[name] for name in Nodes._fields))
            if self.context.weighs:
                self._weighing = Weighing(*(rows[name] for name in Weighing._fields))
        return self._nodes

    def _stored(self) -> dict[str, NodeRow]:
        """Return the arrays of chunks that the kernel takes; of no chunks if nodes have none."""
        if self.pool is None:
            return {"shares": np.zeros(0, np.int32), "spare": np.zeros(0, np.int32)}
        pool = self.pool
        lines = {"blocks": pool.blocks.reshape(1, -1), "codes": pool.codes.reshape(1, -1)}
        return {**lines, "shares": pool.shares, "spare": pool.spare}

    def reserve(self) -> None:
        """Make room for the chunks that the kernel may need for the next node."""
        if self.pool is not None and self.pool.reserve(2 * self.pool.count):
            self._nodes = None

    def weighing(self) -> Weighing | None:
        """Return the arrays for weighing claims; None if hearers weigh none."""
        self.nodes()
        return self._weighing

    def add(self, path: BeliefPath, parent: int) -> int:
        """Add a node that knows nothing and return its number.

        Call `link` once its blocks are set.
        """
        node = self._grow()
        self.index[path] = node
        self._rows["parent"][node] = parent
        if parent >= 0:
            self._rows["agent"][node] = self.context.numbers[path[-1]]
        return node

    def enter(self, poses: PoseTable) -> None:
        """Move to another pose table, and copy the poses in use to it."""
        names = [name for name in _POSE_IDS if name in self._rows]
        numbers = [self._rows[name][: self.count].ravel() for name in names]
        used = np.unique(np.concatenate(numbers))
        used = used[used >= 0]
        table = np.full(len(self.poses) + 1, UNKNOWN, dtype=np.int32)
        table[used] = poses.take(self.poses, used)
        for name in names:
            # -1, which is no pose, indexes the last place of the table, where -1 stands.
            self._rows[name][: self.count] = table[self._rows[name][: self.count]]
        self.poses = poses

    def copy_node(self, other: "NodeTable", source: int, *, is_root: bool, recorded: bool) -> int:
        """Add a copy of a node of another table and return its number.

        As node 0 it holds everything that it knows as current (semantics, section 6).

        Args:
            other: The other table.
            source: Number of the node in the other table.
            is_root: True if the copy becomes node 0.
            recorded: True if poses that the other's timeline recorded count as recorded by this
                one's.
        """
        path = other.path(source)
        node = self._grow()
        spots = {cell: spot for spot, cell in enumerate(other.tracked.tolist())}
        theirs = [spots.get(cell, -1) for cell in self._tracked.tolist()]
        for name, row in self._rows.items():
            if name == "rows":
                row[node] = self._copied_rows(other, other._rows[name][source])
            elif name in _BY_SPOT:
                values = other._rows[name][source]
                none = np.full((1, *values.shape[1:]), _filler(values), dtype=values.dtype)
                row[node] = np.concatenate([values, none])[theirs]
            else:
                row[node] = other._rows[name][source]
        for name in ("eye", "seen_geometry", "tried"):
            self._rows[name][node] = UNKNOWN
        for name in {"pose", "equipment", "met"} & self._rows.keys():
            row = self._rows[name][node]
            row[row >= 0] = self.poses.take(other.poses, row[row >= 0], recorded=recorded)
        self._rows["geometry"][node] = 0
        if recorded:
            self.edited_cells |= {(node, c) for n, c in other.edited_cells if n == source}
        self.index[path] = node
        if is_root:
            self._rows["parent"][node] = self._rows["agent"][node] = UNKNOWN
            self._rows["current"][node] = self._rows["pose"][node] >= 0
            self._rows["basis_current"][node] = self.blocks_at(node, self._tracked) >= 0
        else:
            self._rows["parent"][node] = self.index[path[:-1]]
        return node

    def forked(self) -> "NodeTable":
        """Return a table with copies of all nodes and poses of its own, as `copy_node` makes them.

        Node 0 holds everything that it knows as current, and no pose counts as recorded.
        """
        made = NodeTable(self.context, PoseTable())
        made.count = made._linked = self.count
        made.index, made._tracked = dict(self.index), self._tracked
        made._child_at, made._child = self._child_at, self._child
        made._rows = {name: row[: self.count].copy() for name, row in self._rows.items()}
        rows = made._rows
        names = [each for each in ("pose", "equipment", "met") if each in rows]
        numbers = np.concatenate([rows[each].ravel() for each in names])
        used = np.unique(numbers[numbers >= 0])
        table = np.full(len(self.poses) + 1, UNKNOWN, dtype=np.int32)
        table[used] = made.poses.take(self.poses, used, recorded=False)
        for each in names:
            # -1, which is no pose, indexes the last place of the table, where -1 stands.
            rows[each] = table[rows[each]]
        for unset in ("eye", "seen_geometry", "tried"):
            rows[unset][:] = UNKNOWN
        rows["geometry"][:] = 0
        rows["fresh"][1:] |= rows["pending"][1:].any(axis=1)
        rows["parent"][0] = rows["agent"][0] = UNKNOWN
        rows["current"][0] = rows["pose"][0] >= 0
        if self.pool is not None:
            made.pool = self.pool.copy()
        rows["basis_current"][0] = made.blocks_at(0, self._tracked) >= 0
        return made

    def _copied_rows(self, other: "NodeTable", rows: NodeRow) -> NodeRow:
        """Return rows of this table's pool with the same chunks as rows of another table's."""
        if self.pool is None or other.pool is None:
            return rows
        if self._copied is None or self._copied[0] is not other:
            self._copied = (other, np.full(len(other.pool.shares), UNKNOWN, dtype=np.int32))
        copies = self._copied[1]
        new = np.unique(rows[copies[rows] < 0])
        copies[new] = self.pool.add(other.pool.blocks[new], other.pool.codes[new])
        self.pool.leave(np.full(len(rows), NOTHING, np.int32))
        self.pool.use(copies[rows])
        self._nodes = None
        return copies[rows]

    def path(self, node: int) -> BeliefPath:
        """Return the path of a node."""
        return next(path for path, number in self.index.items() if number == node)

    def link(self) -> None:
        """Index the children of all nodes; find twins and differences from parents of new ones."""
        parent = self._rows["parent"][: self.count]
        order = np.argsort(parent, kind="stable").astype(np.int32)
        self._child = order[np.searchsorted(parent[order], 0) :]
        self._child_at = np.searchsorted(parent[self._child], np.arange(self.count + 1)).astype(
            np.int32
        )
        self._nodes = self._coded = self._copied = None
        for path, node in self.index.items():
            if node >= self._linked:
                self._rows["twin"][node] = self._twin(path, node)
                self._compare_with_parent(node)
        self._linked = max(self.count, 1)

    def _twin(self, path: BeliefPath, node: int) -> int:
        """Return the twin of a node; see `arrays.Nodes`."""
        twin = self.index.get((*path[:-2], path[-1]), UNKNOWN) if len(path) > 1 else UNKNOWN
        return twin if twin < node else UNKNOWN

    def _compare_with_parent(self, node: int) -> None:
        """Compute all pending bits of a node, and the number of cells with another shape."""
        grids = self._rows["rows" if self.pool is not None else "blocks"]
        own, above = grids[node], grids[self.parent(node)]
        differs = np.flatnonzero(above != own)
        shapes = self.context.space.codes
        own, above = own[differs], above[differs]
        if self.pool is not None:
            # A pair of chunks is compared once, wherever it is.
            size = len(self.pool.blocks)
            pairs, times = np.unique(own.astype(np.int64) * size + above, return_counts=True)
            own, above = self.pool.blocks[pairs // size], self.pool.blocks[pairs % size]
            is_pending = np.ones(len(differs), dtype=np.bool_)
            unlike = np.count_nonzero(shapes[own] != shapes[above], axis=1) @ times
        else:
            is_pending = above != UNKNOWN
            unlike = np.count_nonzero(shapes[own] != shapes[above])
        pending = np.zeros(self._rows["pending"].shape[1] * 64, dtype=np.bool_)
        pending[differs] = is_pending
        self._rows["unlike"][node] = unlike
        self._rows["pending"][node] = np.packbits(pending, bitorder="little").view("<u8")
        self._rows["fresh"][node] |= is_pending.any()

    def set_blocks(self, node: int, blocks: Terrain) -> None:
        """Set all blocks of a node, and its geometry."""
        space = self.context.space
        if self.pool is not None:
            (rows,) = self.pool.add_grids(cut_grids(space.codes, space.reaches, (blocks,)))
            self.set_rows(node, rows)
            self.leave(rows)
            return
        # Most nodes start with the same array, so the last geometry is kept for the next call.
        if self._coded is None or self._coded[0] is not blocks:
            codes = code_grid(blocks.dense(), space.codes, space.reaches)
            self._coded = (blocks, codes.ravel())
        self._rows["blocks"][node] = blocks.dense().ravel()
        self._rows["codes"][node] = self._coded[1]

    def set_rows(self, node: int, rows: NodeRow) -> None:
        """Set the rows of all chunks of a node, and so its blocks and its geometry."""
        if self.pool is not None:
            self.pool.use(rows)
            self.pool.leave(self._rows["rows"][node])
            self._rows["rows"][node] = rows
            self._nodes = None

    def leave(self, rows: NodeRow) -> None:
        """End the use of rows by the caller of `ChunkPool.add_grids`."""
        if self.pool is not None:
            self.pool.leave(rows)

    def set_pose(self, node: int, agent: int, pose: int, seen_at: int, *, current: bool) -> None:
        """Set the believed pose of an agent."""
        self._rows["pose"][node, agent] = pose
        self._rows["seen_at"][node, agent] = seen_at
        self._rows["current"][node, agent] = current

    def set_equipment(self, node: int, agent: int, pose: int) -> None:
        """Set the believed equipment of an agent to that of a pose."""
        self._rows["equipment"][node, agent] = pose

    def worn(self, node: int, agent: int) -> Collection[str]:
        """Return items that an agent is believed to wear or hold."""
        details = self.poses.details(self.equipment(node, agent))
        return () if details is None else details.equipment.values()

    def take_off(self, node: int, agent: int, item: str) -> None:
        """Remove an item from the equipment that a node believes of an agent."""
        if item in self.worn(node, agent):
            pose = self.poses.without(self.equipment(node, agent), item)
            self.set_equipment(node, agent, pose)

    def sees_worn(self, node: int) -> list[int]:
        """Return the agents whose equipment the present owner of a node sees, itself included."""
        parent, owner = self.parent(node), self.owner(node)
        seen = self._rows["sees"][node] & (self._rows["pose"][parent] >= 0)
        seen[owner] = True
        return [
            int(agent) for agent in np.flatnonzero(seen & (self._rows["equipment"][parent] >= 0))
        ]

    def set_basis(self, node: int, cell: int, basis: Basis | None) -> None:
        """Set the basis of a cell, if it is tracked."""
        for spot in np.flatnonzero(self._tracked == cell):
            self._rows["basis_at"][node, spot] = UNKNOWN if basis is None else basis.observed_at
            self._rows["basis_current"][node, spot] = node == 0 and basis is not None
            if basis is not None:
                self._rows["basis_source"][node, spot] = self.context.basis_code(basis)

    def set_known_bases(self, node: int, basis: Basis) -> None:
        """Set one basis for all tracked cells whose block a node knows."""
        is_known = self.blocks_at(node, self._tracked) >= 0
        self._rows["basis_at"][node][is_known] = basis.observed_at
        self._rows["basis_source"][node][is_known] = self.context.basis_code(basis)
        self._rows["basis_current"][node][is_known] = node == 0

    def bases(self, node: int, cells: Sequence[int], tick: int) -> dict[int, Basis | None]:
        """Return the bases of tracked cells in a node at a tick; None where a block is unknown."""
        spots = {cell: spot for spot, cell in enumerate(self._tracked.tolist())}
        current = self._rows["basis_current"][node]
        ticks = np.where(current, tick, self._rows["basis_at"][node]).tolist()
        codes = self._rows["basis_source"][node].tolist()
        basis = self.context.basis
        are_known = (self.blocks_at(node, np.array(cells, dtype=np.int64)) >= 0).tolist()
        return {
            cell: basis(ticks[spots[cell]], codes[spots[cell]]) if is_known else None
            for cell, is_known in zip(cells, are_known, strict=True)
        }

    def change(self, node: int, blocks: Mapping[int, int]) -> None:
        """Set blocks of a node by cell, after `link`; their bases stay."""
        for cell, state in blocks.items():
            self._put_all(np.array([node]), cell, np.array([state]))

    def put(self, node: int, cell: int, state: int, basis: Basis) -> None:
        """Set a block of a node by hand, with its basis."""
        self.edited_cells.add((node, cell))
        self.change(node, {cell: state})
        self.set_basis(node, cell, basis if state >= 0 else None)

    def tell(
        self, which: npt.NDArray[np.int64], cell: int, states: Sequence[int], basis: Basis
    ) -> None:
        """Set a claimed block in several nodes: `states[k]` in node `which[k]`."""
        self._put_all(which, cell, np.array(states, dtype=np.int64))
        for node in which.tolist():
            self.set_basis(node, cell, basis)

    def _put_all(
        self, which: npt.NDArray[np.int64], cell: int, states: npt.NDArray[np.int64]
    ) -> None:
        """Set a block in several nodes; in chunks one by one, with room for each."""
        from beliefnest.belief import kernel

        step = 1 if self.pool is not None else max(len(which), 1)
        for first in range(0, len(which), step):
            self.reserve()
            some = slice(first, first + step)
            kernel.put_all(self.context.space, self.nodes(), which[some], cell, states[some])

    def levels(self) -> Iterator[npt.NDArray[np.bool_]]:
        """Yield for each depth a mask of the nodes at that depth, node 0 first."""
        parent = self._rows["parent"][: self.count]
        level = parent == UNKNOWN
        while level.any():
            yield level
            level = (parent >= 0) & level[parent]

    def track(self) -> None:
        """Add columns for the cells that the context has begun to track since the last call."""
        tracked = set(self._tracked.tolist())
        new = [cell for cell in self.context.tracked if cell not in tracked]
        if not new:
            return
        self._tracked = np.array([*self._tracked.tolist(), *new], dtype=np.int32)
        size = len(self._rows["parent"])
        for name in self._rows.keys() & _BY_SPOT:
            row = self._rows[name]
            wide = np.full((size, len(new), *row.shape[2:]), _filler(row), dtype=row.dtype)
            self._rows[name] = np.concatenate([row, wide], axis=1)
        self._nodes = None
        # An unknown eye makes every owner look anew, and so cover the new cells.
        self._rows["eye"][: self.count] = UNKNOWN

    def saved(self, node: int) -> SavedNode:
        """Return the state of a node as plain data, without the kernel's caches."""
        row = {name: self._rows[name][node].tobytes() for name in _SAVED}
        edited = sorted(cell for other, cell in self.edited_cells if other == node)
        names = (*Weighing._fields, "watched") if self.context.weighs else ()
        weighing = {name: self._rows[name][node].tobytes() for name in names}
        cells = self._saved_cells(node)
        return SavedNode(self.path(node), **cells, **row, edited_cells=edited, weighing=weighing)

    def _saved_cells(self, node: int) -> dict[str, bytes]:
        """Return `blocks`, `codes` and `rows` of `SavedNode`."""
        if self.pool is None:
            return {"blocks": self._rows["blocks"][node].tobytes(), "codes": b"", "rows": b""}
        rows, parent = self._rows["rows"][node], self.parent(node)
        numbers = np.full(len(rows), UNKNOWN, dtype=np.int32)
        own = rows >= 0 if parent < 0 else rows != self._rows["rows"][parent]
        saved, numbers[own] = np.unique(rows[own], return_inverse=True)
        blocks, codes = self.pool.blocks[saved], self.pool.codes[saved]
        return {"blocks": blocks.tobytes(), "codes": codes.tobytes(), "rows": numbers.tobytes()}

    def _restore_cells(self, node: int, saved: SavedNode, signs: Sequence[SavedWriting]) -> None:
        """Set the cells of a node to those of `_saved_cells`; its parent is restored already."""
        numbers = self.context.renumbered(np.frombuffer(saved.blocks, dtype=np.int16), signs)
        if self.pool is None:
            self.set_blocks(node, Terrain.of(numbers.reshape(self.context.box.shape)))
            return
        codes = np.frombuffer(saved.codes, dtype=np.uint16).reshape(-1, VOLUME)
        added = self.pool.add(numbers.reshape(-1, VOLUME), codes)
        rows = np.frombuffer(saved.rows, dtype=np.int32)
        # Number -1 indexes the last place, which is not used.
        restored = np.append(added, UNKNOWN)[rows]
        parents = self._rows["rows"][max(self.parent(node), 0)]
        self.set_rows(node, np.where(rows < 0, parents, restored).astype(np.int32))

    def restore(
        self, saved: SavedNode, tracked: npt.NDArray[np.int32], signs: Sequence[SavedWriting]
    ) -> None:
        """Add a saved node; call `link` afterwards.

        Args:
            saved: The node.
            tracked: Cells that were tracked when it was saved; all of them are tracked now.
            signs: Signs with texts at that time, in order of their block numbers.
        """
        node = self.add(saved.path, self.index.get(saved.path[:-1], UNKNOWN))
        self.edited_cells |= {(node, cell) for cell in saved.edited_cells}
        spots = {cell: spot for spot, cell in enumerate(self._tracked.tolist())}
        places = [spots[cell] for cell in tracked.tolist()]
        self._restore_cells(node, saved, signs)
        bodies = {name: getattr(saved, name) for name in _SAVED} | saved.weighing
        for name, body in bodies.items():
            row = self._rows[name]
            values = np.frombuffer(body, dtype=row.dtype)
            if name in _BY_SPOT:
                row[node] = _filler(row)
                row[node, places] = values.reshape(len(places), *row.shape[2:])
            else:
                row[node] = values.reshape(row.shape[1:])

    @property
    def tracked(self) -> npt.NDArray[np.int32]:
        """The cells whose basis is tracked."""
        return self._tracked

    def spot(self, cell: int) -> int:
        """Return the index of a cell among the tracked ones; -1: it is not tracked."""
        spots = np.flatnonzero(self._tracked == cell)
        return int(spots[0]) if len(spots) else UNKNOWN

    def parent(self, node: int) -> int:
        """Return the number of the parent of a node; -1 for node 0."""
        return int(self._rows["parent"][node])

    def owner(self, node: int) -> int:
        """Return the number of the agent whose belief a node is; -1 for node 0."""
        return int(self._rows["agent"][node])

    def block(self, node: int, cell: int) -> int:
        """Return the number of a node's block; -1: unknown."""
        if self.pool is None:
            return int(self._rows["blocks"][node, cell])
        return int(self.blocks_at(node, np.array([cell]))[0])

    def blocks_at(
        self, nodes: int | npt.NDArray[np.int64], cells: int | npt.NDArray[np.integer[Any]]
    ) -> npt.NDArray[np.int16]:
        """Return the numbers of blocks of one or several nodes at one or several cells."""
        places = self.places(np.asarray(cells))
        blocks: npt.NDArray[np.int16]
        if self.pool is None:
            blocks = self._rows["blocks"][nodes, places]
            return blocks
        blocks = self.pool.blocks[self._rows["rows"][nodes, places // VOLUME], places % VOLUME]
        return blocks

    def places(self, cells: npt.NDArray[np.integer[Any]]) -> npt.NDArray[np.integer[Any]]:
        """Return the places of cells in the blocks of a node; see `perception.chunks`."""
        if self.pool is None:
            return cells
        (_, ny, nz), (_, high, deep) = self.context.box.shape, self.pool.chunks
        cells = cells.astype(np.int64)
        x, y, z = cells // (ny * nz) + 1, cells // nz % ny + 1, cells % nz + 1
        chunk = (x // SIDE * high + y // SIDE) * deep + z // SIDE
        within = (x % SIDE * SIDE + y % SIDE) * SIDE + z % SIDE
        places: npt.NDArray[np.integer[Any]] = chunk * VOLUME + within
        return places

    def blocks(self, node: int) -> Terrain:
        """Return the numbers of a node's blocks."""
        if self.pool is not None:
            return self.pool.terrain(self._rows["rows"][node])
        key = node, int(self._rows["versions"][node])
        if key not in self._terrains:
            if len(self._terrains) == _TERRAINS:
                self._terrains.clear()
            grid = self._rows["blocks"][node].reshape(self.context.box.shape)
            self._terrains[key] = Terrain.of(grid)
        return self._terrains[key]

    def codes(self, node: int) -> tuple[npt.NDArray[np.uint16], NodeRow]:
        """Return the geometry of a node of a box with a pool: its chunks, and one by place."""
        if self.pool is None:
            raise AssertionError("the box has no pool of chunks")
        return self.pool.codes_of(self._rows["rows"][node])

    def flat_blocks(self, node: int) -> npt.NDArray[np.int16]:
        """Return the numbers of a node's blocks by cell, of a box without a pool of chunks.

        Do not change the array.
        """
        flat: npt.NDArray[np.int16] = self._rows["blocks"][node]
        return flat

    @property
    def bytes(self) -> int:
        """Memory of the arrays of nodes; of chunks, without the room for more."""
        rows = sum(row.nbytes for row in self._rows.values())
        return rows if self.pool is None else rows + self.pool.bytes

    def versions(self) -> npt.NDArray[np.int32]:
        """Return a number by node that grows with every change of its blocks or of its rows."""
        versions: npt.NDArray[np.int32] = self._rows["versions"][: self.count]
        return versions

    def pose(self, node: int, agent: int) -> int:
        """Return the id of an agent's believed pose; -1: unknown."""
        return int(self._rows["pose"][node, agent])

    def equipment(self, node: int, agent: int) -> int:
        """Return the id of the pose with an agent's believed equipment; -1: unknown."""
        return int(self._rows["equipment"][node, agent])

    def details_of(self, node: int, agent: int) -> PoseDetails | None:
        """Return the details of an agent's believed pose.

        None: the pose is unknown, or it was claimed or given and nobody was seen in it.
        """
        return self.poses.details(self.pose(node, agent))

    def seen_at(self, node: int, agent: int) -> int:
        """Return the last tick at which an agent's pose was current, for one that no longer is."""
        return int(self._rows["seen_at"][node, agent])

    def is_current(self, node: int, agent: int) -> bool:
        """Return True if an agent's pose is current in a node."""
        return bool(self._rows["current"][node, agent])

    def in_sight(self, node: int) -> Iterator[tuple[int, int]]:
        """Yield the numbers of the agents whose poses are current in a node, and these poses."""
        poses = self._rows["pose"][node]
        for agent in np.flatnonzero(self._rows["current"][node] & (poses >= 0)).tolist():
            yield agent, int(poses[agent])

    def present(self) -> npt.NDArray[np.bool_]:
        """Return by node if its owner is present in its parent node (semantics, section 5.1)."""
        present = np.ones(self.count, dtype=np.bool_)
        parent, agent = (self._rows[name][1 : self.count] for name in ("parent", "agent"))
        present[1:] = self._rows["current"][parent, agent]
        return present

    def is_present(self, node: int) -> bool:
        """Return True if the owner of a node is present in its parent (semantics, section 5.1)."""
        return node == 0 or self.is_current(self.parent(node), self.owner(node))

    def sees_cells(self, node: int, cells: Iterable[int]) -> set[int]:
        """Return those of some cells that the present owner of a node sees in the parent node."""
        from beliefnest.belief import seeing

        wanted = np.array([*cells], dtype=np.int64)
        return set(wanted[seeing.sees_cells(*self._look(node), wanted)].tolist())

    def _look(self, node: int) -> tuple[Space, Poses, NodeRow, NodeRow, int]:
        """Return the first arguments of kernels of `seeing` for the present owner of a node."""
        parent = self.parent(node)
        codes = self._rows["codes"][parent] if self.pool is None else self.pool.codes.ravel()
        rows, eye = self._rows["rows"][parent], self.pose(parent, self.owner(node))
        return self.context.space, self.poses.arrays(), codes, rows, eye

    def sees_point(self, node: int, point: Point) -> bool:
        """Return True if the present owner of a node sees a point (scenario coordinates)."""
        from beliefnest.belief import seeing

        return seeing.sees_point(*self._look(node), point)

    def current_blocks(self, node: int, cells: Iterable[int]) -> set[int]:
        """Return the cells whose block is current in a node (semantics, section 5.4).

        A block is current if the owner sees it in its parent and it is current there. The loop
        therefore climbs from the node to node 0 and keeps the cells that are seen at every step.
        Nothing is left at an owner that is not present, or where a block was edited by hand since
        it was perceived. In node 0 every known block is current.
        """
        left = set(cells)
        while left and node > 0:
            if not self.is_present(node):
                return set()
            left = self.sees_cells(
                node, [cell for cell in left if (node, cell) not in self.edited_cells]
            )
            node = self.parent(node)
        places = np.array([*left], dtype=np.int64)
        return set(places[self.blocks_at(0, places) >= 0].tolist())

    def below(self, node: int) -> npt.NDArray[np.bool_]:
        """Return a mask of the nodes below a node."""
        below = np.zeros(self.count, dtype=np.bool_)
        for other in range(node + 1, self.count):
            parent = self.parent(other)
            below[other] = parent == node or below[parent]
        return below

    def _grow(self) -> int:
        node = self.count
        size = len(self._rows["parent"])
        if node == size:
            check_room(self.context, node + 1)
            # The system gives memory to pages when they are written, so spare rows cost nothing.
            room = min(8 * size, most_nodes(self.context) or 8 * size)
            for name, row in self._rows.items():
                self._rows[name] = np.empty((room, *row.shape[1:]), dtype=row.dtype)
                self._rows[name][:size] = row
        for row in self._rows.values():
            row[node] = _filler(row)
        self._rows["versions"][node] = 0
        self._rows["geometry"][node] = 0
        self._rows["rows"][node] = NOTHING
        if self.pool is not None:
            self.pool.shares[NOTHING] += self.pool.count
        if self.context.weighs:
            self._rows["missed"][node] = 0
        self.count += 1
        self._nodes = None
        return node


def _filler(row: NodeRow) -> int:
    """Return the value that stands for "nothing known" in an array."""
    return UNKNOWN if row.dtype.kind == "i" else 0
