"""Blocks and codes of nodes, by node and place, compiled; dense or in chunks (`perception.chunks`).

Chunks of all nodes are rows of one pool. A row that several nodes use is copied before one of them
changes (`_own`). A node that comes to know all that its parent knows of a chunk takes over the
parent's row (`share`).
"""

from typing import Any

import numpy as np

from beliefnest.belief.arrays import Nodes, Space, States
from beliefnest.perception.chunks import Rows, chunk_in, index_at, place_at
from beliefnest.perception.codes import INTRUDED, OWN
from beliefnest.perception.compiling import inlined, inner
from beliefnest.perception.eyes import set_code
from beliefnest.perception.rays import Cell, Codes, Scene, code_at, is_inside, neighbour
from beliefnest.world.terrain import VOLUME, Chunks

__all__ = [
    "block_at",
    "chunk_at",
    "grid_cell",
    "line_of",
    "place_of",
    "put_block",
    "scene_of",
    "share",
    "whole",
]

_Number = int | np.signedinteger[Any]


@inlined
def whole(number: _Number) -> int:
    """Return the number as int64, so that kernels are compiled for one kind of integer only."""
    return np.int64(number)  # type: ignore[return-value]  # Python's int, once compiled


@inlined
def grid_cell(space: Space, cell: int) -> Cell:
    """Return the grid coordinates (with margin) of a flat cell."""
    ny, nz = space.sizes[1] - 2, space.sizes[2] - 2
    return cell // (ny * nz) + 1, cell // nz % ny + 1, cell % nz + 1


@inlined
def line_of(chunks: Chunks | None, node: int) -> int:
    """Return the row of `Nodes.blocks` and `Nodes.codes` that holds a node's cells."""
    if chunks is None:
        return node
    return 0


@inlined
def chunk_at(chunks: Chunks | None, place: int) -> int:
    """Return the number of the chunk of a place; in a dense grid, the place itself."""
    if chunks is None:
        return place
    return chunk_in(place)


@inlined
def place_of(chunks: Chunks | None, space: Space, cell: int) -> int:
    """Return the place of a flat cell of the box in `Nodes.blocks`."""
    if chunks is None:
        return cell
    return place_at(chunks, space.sizes, grid_cell(space, cell))


@inlined
def block_at(chunks: Chunks | None, blocks: States, rows: Rows, node: int, place: int) -> int:
    """Return the number of a node's block at a place; -1: unknown. `rows` are the node's."""
    return whole(blocks[line_of(chunks, node), index_at(chunks, rows, place)])


@inlined
def scene_of(space: Space, codes: Codes, rows: Rows) -> Scene:
    """Return the shapes of a node, from its line of `Nodes.codes` and its rows."""
    return Scene(codes, space.sizes, space.starts, space.boxes, rows, space.chunks)


@inner
def _own(nodes: Nodes, node: int, chunk: int) -> None:
    """Give a node a chunk of its own: a copy, if other nodes use the present one."""
    old = whole(nodes.rows[node, chunk])
    if nodes.shares[old] == 1:
        return
    if nodes.spare[0] > 0:
        new = whole(nodes.spare[1 + nodes.spare[0]])
        nodes.spare[0] -= 1
    else:
        new = whole(nodes.spare[1])
        nodes.spare[1] += 1
    nodes.shares[old] -= 1
    nodes.shares[new] = 1
    nodes.rows[node, chunk] = new
    for cell in range(VOLUME):
        nodes.blocks[0, new * VOLUME + cell] = nodes.blocks[0, old * VOLUME + cell]
        nodes.codes[0, new * VOLUME + cell] = nodes.codes[0, old * VOLUME + cell]


@inner
def share(nodes: Nodes, node: int, parent: int, chunk: int) -> None:
    """Let a node use the parent's row of a chunk if both are equal, and free its own."""
    own, other = whole(nodes.rows[node, chunk]), whole(nodes.rows[parent, chunk])
    for cell in range(VOLUME):
        if (
            nodes.blocks[0, own * VOLUME + cell] != nodes.blocks[0, other * VOLUME + cell]
            or nodes.codes[0, own * VOLUME + cell] != nodes.codes[0, other * VOLUME + cell]
        ):
            return
    nodes.rows[node, chunk] = other
    nodes.shares[other] += 1
    nodes.shares[own] -= 1
    if nodes.shares[own] == 0:
        nodes.spare[0] += 1
        nodes.spare[1 + nodes.spare[0]] = own


@inner
def _intrude(space: Space, nodes: Nodes, node: int, cell: Cell) -> None:
    """Set or clear `INTRUDED` of a cell of a grid in chunks, from the shapes of its neighbours."""
    scene = scene_of(space, nodes.codes[0], nodes.rows[node])
    intruded = False
    for side in range(6):
        other = neighbour(cell, side)
        if is_inside(space.sizes, other):
            intruded |= (space.reaches[code_at(scene, other) & OWN] >> (side ^ 1)) & 1 != 0
    code = code_at(scene, cell)
    wanted = code & OWN | INTRUDED if intruded else code & OWN
    if wanted != code:
        place = place_at(space.chunks, space.sizes, cell)
        _own(nodes, node, chunk_in(place))
        nodes.codes[0, index_at(space.chunks, nodes.rows[node], place)] = wanted


@inner
def _put_in_chunk(space: Space, nodes: Nodes, node: int, cell: Cell, state: int) -> None:
    """Set a block of a node whose cells are in chunks, and its geometry."""
    place = place_at(space.chunks, space.sizes, cell)
    _own(nodes, node, chunk_in(place))
    index = index_at(space.chunks, nodes.rows[node], place)
    before, code = nodes.codes[0, index], space.codes[state]
    nodes.blocks[0, index] = state
    if before & OWN == code:
        return
    nodes.codes[0, index] = before & INTRUDED | code
    nodes.geometry[node] += 1
    if space.reaches[before & OWN] != 0 or space.reaches[code] != 0:
        for side in range(6):
            _intrude(space, nodes, node, neighbour(cell, side))


@inlined
def put_block(
    chunks: Chunks | None, space: Space, nodes: Nodes, node: int, cell: int, state: int
) -> None:
    """Set a block of a node, and its geometry."""
    nodes.versions[node] += 1
    if chunks is None:
        old = nodes.blocks[node, cell]
        nodes.blocks[node, cell] = state
        if space.codes[old] != space.codes[state]:
            place = grid_cell(space, cell)
            set_code(nodes.codes[node], space.sizes, space.reaches, place, space.codes[state])
            nodes.geometry[node] += 1
    else:
        _put_in_chunk(space, nodes, node, grid_cell(space, cell), state)
