"""Blocks and codes of nodes, by node and place, compiled; dense or in chunks (`perception.chunks`).

Chunks of all nodes are rows of one pool. A row that several nodes use is copied before one of them
changes (`_own`). A node that comes to know all that its parent knows of a chunk takes over the
parent's row (`share`).
"""

from typing import Any

import numpy as np

from beliefnest.belief.arrays import Grids, Nodes, Space
from beliefnest.perception.chunks import Rows, chunk_in, index_at, place_at
from beliefnest.perception.codes import INTRUDED, OWN
from beliefnest.perception.compiling import inlined, inner, merged
from beliefnest.perception.eyes import set_code
from beliefnest.perception.rays import GridCell, RayScene, code_at, is_inside, neighbour
from beliefnest.world.array_types import Codes, States
from beliefnest.world.terrain import VOLUME, ChunkCounts

_Number = int | np.signedinteger[Any]


@inlined
def whole(number: _Number) -> int:
    """Return the number as int64, so that kernels are compiled for one kind of integer only."""
    return np.int64(number)  # type: ignore[return-value]  # Python's int, once compiled


@merged
def grids_of(nodes: Nodes) -> Grids:
    """Return the arrays about blocks."""
    return Grids(
        nodes.parent,
        nodes.child_at,
        nodes.child,
        nodes.rows,
        nodes.shares,
        nodes.spare,
        nodes.blocks,
        nodes.codes,
        nodes.geometry,
        nodes.versions,
        nodes.unlike,
        nodes.pending,
        nodes.fresh,
    )


@inlined
def grid_cell(space: Space, cell: int) -> GridCell:
    """Return the grid coordinates (with margin) of a flat cell."""
    ny, nz = space.sizes[1] - 2, space.sizes[2] - 2
    return cell // (ny * nz) + 1, cell // nz % ny + 1, cell % nz + 1


@inlined
def line_of(chunks: ChunkCounts | None, node: int) -> int:
    """Return the row of `Nodes.blocks` and `Nodes.codes` that holds a node's cells."""
    if chunks is None:
        return node
    return 0


@inlined
def chunk_at(chunks: ChunkCounts | None, place: int) -> int:
    """Return the number of the chunk of a place; in a dense grid, the place itself."""
    if chunks is None:
        return place
    return chunk_in(place)


@inlined
def place_of(chunks: ChunkCounts | None, space: Space, cell: int) -> int:
    """Return the place of a flat cell of the box in `Nodes.blocks`."""
    if chunks is None:
        return cell
    return place_at(chunks, space.sizes, grid_cell(space, cell))


@inlined
def block_at(chunks: ChunkCounts | None, blocks: States, rows: Rows, node: int, place: int) -> int:
    """Return the number of a node's block at a place; -1: unknown. `rows` are the node's."""
    return whole(blocks[line_of(chunks, node), index_at(chunks, rows, place)])


@inlined
def scene_of(chunks: ChunkCounts | None, space: Space, codes: Codes, rows: Rows) -> RayScene:
    """Return the shapes of a node, from its line of `Nodes.codes` and its rows."""
    if chunks is None:
        # As scenes without nodes: kernels of sight are then compiled once for both.
        return RayScene(codes, space.sizes, space.starts, space.boxes, space.no_rows, chunks)
    return RayScene(codes, space.sizes, space.starts, space.boxes, rows, chunks)


@inner
def _own(grids: Grids, node: int, chunk: int) -> None:
    """Give a node a chunk of its own: a copy, if other nodes use the present one."""
    old = whole(grids.rows[node, chunk])
    if grids.shares[old] == 1:
        return
    if grids.spare[0] > 0:
        new = whole(grids.spare[1 + grids.spare[0]])
        grids.spare[0] -= 1
    else:
        new = whole(grids.spare[1])
        grids.spare[1] += 1
    grids.shares[old] -= 1
    grids.shares[new] = 1
    grids.rows[node, chunk] = new
    grids.versions[node] += 1
    for cell in range(VOLUME):
        grids.blocks[0, new * VOLUME + cell] = grids.blocks[0, old * VOLUME + cell]
        grids.codes[0, new * VOLUME + cell] = grids.codes[0, old * VOLUME + cell]


@inner
def share(grids: Grids, node: int, parent: int, chunk: int) -> None:
    """Let a node use the parent's row of a chunk if both are equal, and free its own."""
    own, other = whole(grids.rows[node, chunk]), whole(grids.rows[parent, chunk])
    for cell in range(VOLUME):
        if (
            grids.blocks[0, own * VOLUME + cell] != grids.blocks[0, other * VOLUME + cell]
            or grids.codes[0, own * VOLUME + cell] != grids.codes[0, other * VOLUME + cell]
        ):
            return
    grids.rows[node, chunk] = other
    grids.versions[node] += 1
    grids.shares[other] += 1
    grids.shares[own] -= 1
    if grids.shares[own] == 0:
        grids.spare[0] += 1
        grids.spare[1 + grids.spare[0]] = own


@inner
def _intrude(space: Space, grids: Grids, node: int, cell: GridCell) -> None:
    """Set or clear `INTRUDED` of a cell of a grid in chunks, from the shapes of its neighbours."""
    scene = scene_of(space.chunks, space, grids.codes[0], grids.rows[node])
    intruded = False
    for side in range(6):
        other = neighbour(cell, side)
        if is_inside(space.sizes, other):
            intruded |= (space.reaches[code_at(scene, other) & OWN] >> (side ^ 1)) & 1 != 0
    code = code_at(scene, cell)
    wanted = code & OWN | INTRUDED if intruded else code & OWN
    if wanted != code:
        place = place_at(space.chunks, space.sizes, cell)
        _own(grids, node, chunk_in(place))
        grids.codes[0, index_at(space.chunks, grids.rows[node], place)] = wanted


@inner
def _put_in_chunk(space: Space, grids: Grids, node: int, cell: GridCell, state: int) -> None:
    """Set a block of a node whose cells are in chunks, and its geometry."""
    place = place_at(space.chunks, space.sizes, cell)
    _own(grids, node, chunk_in(place))
    index = index_at(space.chunks, grids.rows[node], place)
    before, code = grids.codes[0, index], space.codes[state]
    grids.blocks[0, index] = state
    if before & OWN == code:
        return
    grids.codes[0, index] = before & INTRUDED | code
    grids.geometry[node] += 1
    if space.reaches[before & OWN] != 0 or space.reaches[code] != 0:
        for side in range(6):
            _intrude(space, grids, node, neighbour(cell, side))


@inlined
def put_block(
    chunks: ChunkCounts | None, space: Space, grids: Grids, node: int, cell: int, state: int
) -> None:
    """Set a block of a node, and its geometry."""
    grids.versions[node] += 1
    if chunks is None:
        old = grids.blocks[node, cell]
        grids.blocks[node, cell] = state
        if space.codes[old] != space.codes[state]:
            place = grid_cell(space, cell)
            code = whole(space.codes[state])
            set_code(grids.codes[node], space.sizes, space.reaches, place, code)
            grids.geometry[node] += 1
    else:
        _put_in_chunk(space, grids, node, grid_cell(space, cell), state)
