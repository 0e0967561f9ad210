"""Memory of nodes, and the refusal of more nodes than it has room for."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from beliefnest.belief.context import BeliefContext
from beliefnest.errors import InputError
from beliefnest.world.memory import MEGABYTE
from beliefnest.world.paths import BeliefPath, path_text, paths_below
from beliefnest.world.terrain import chunks_of

_OBJECTS = 1_000
"""Bytes of the Python objects of a node that knows nothing: path, number and holdings."""


class NodeColumn(NamedTuple):
    """Array with a row for each node: the shape of a row, and the type of its numbers."""

    shape: tuple[int, ...]
    kind: npt.DTypeLike

    @property
    def bytes(self) -> int:
        """Return the bytes of a row."""
        return math.prod(self.shape) * np.dtype(self.kind).itemsize


def columns_of(context: BeliefContext, spots: int) -> Mapping[str, NodeColumn]:
    """Return the columns of a table of nodes by name; see `arrays.Nodes` for what each holds.

    Args:
        context: The part that all nodes of the nest share.
        spots: Number of tracked cells.
    """
    agents, number, flag = (len(context.agents),), np.int32, np.bool_
    columns = {
        **{name: NodeColumn((), number) for name in ("parent", "agent", "twin", "unlike")},
        **{
            name: NodeColumn((), number)
            for name in ("geometry", "versions", "eye", "seen_geometry")
        },
        "fresh": NodeColumn((), flag),
        **{name: NodeColumn(agents, number) for name in ("pose", "equipment", "seen_at", "tried")},
        **{name: NodeColumn(agents, flag) for name in ("current", "sees")},
        "watched": NodeColumn((spots,), flag),
        "basis_at": NodeColumn((spots,), number),
        "basis_source": NodeColumn((spots,), np.uint8),
        "basis_current": NodeColumn((spots,), flag),
        **_cells(context),
    }
    if context.weighs:
        columns |= {
            "counted": NodeColumn((), number),
            "missed": NodeColumn(agents, number),
            "met": NodeColumn(agents, number),
            "meets": NodeColumn(agents, flag),
            "met_missed": NodeColumn((*agents, *agents), number),
            "watch_missed": NodeColumn((spots, *agents), number),
        }
    return columns


def _cells(context: BeliefContext) -> Mapping[str, NodeColumn]:
    """Return the columns with cells: dense arrays of the box, or rows of a pool of chunks."""
    nx, ny, nz = context.box.shape
    sizes = (nx + 2, ny + 2, nz + 2)
    if context.is_dense:
        return {
            "rows": NodeColumn((1,), np.int32),
            "blocks": NodeColumn((context.cells,), np.int16),
            "codes": NodeColumn((math.prod(sizes),), np.uint16),
            "pending": NodeColumn((-(-context.cells // 64),), np.uint64),
        }
    chunks = math.prod(chunks_of(sizes))
    return {
        "rows": NodeColumn((chunks,), np.int32),
        "pending": NodeColumn((-(-chunks // 64),), np.uint64),
    }


def node_bytes(context: BeliefContext) -> int:
    """Return the bytes that a node needs at least.

    In a large box its own chunks are added to this, whose number depends on what it learns.
    """
    columns = columns_of(context, len(context.tracked))
    return _OBJECTS + sum(column.bytes for column in columns.values())


def check_room(
    context: BeliefContext, nodes: int, which: str = "", advice: str = "ask for fewer paths"
) -> None:
    """Raise InputError if the memory of this process has no room for a number of nodes.

    Args:
        context: The part that all nodes of the nest share.
        nodes: Number of nodes, the real world included.
        which: Words about where the number comes from, for the message.
        advice: Words about how to need fewer nodes, for the message.
    """
    limit, each = context.memory, node_bytes(context)
    if limit is None or nodes * each <= limit.bytes:
        return
    x, y, z = context.box.shape
    if context.weighs:
        advice += ", another 'testimony' than 'informed'"
    raise InputError(
        f"{nodes:,} simulators{which} need at least {_megabytes(nodes * each)}, "
        f"{-(-each // 1000):,} kB each, for {len(context.agents)} agents and a box of {x} x {y} x "
        f"{z} blocks. This process may use {_megabytes(limit.bytes)}, {limit.source}: {advice}, "
        "or take fewer agents or a smaller box"
    )


def most_nodes(context: BeliefContext) -> int | None:
    """Return the greatest number of nodes for which there is room; None: it is unknown."""
    return None if context.memory is None else context.memory.bytes // node_bytes(context)


def check_depth(context: BeliefContext, root: BeliefPath, depth: int) -> None:
    """Raise InputError if memory has no room for a node and all nodes `depth` levels below it."""
    most, others = most_nodes(context), len(context.agents) - 1
    # The nodes above the root are needed, too.
    count, level = len(root) + 1, 1
    for deep in range(0 if most is None else depth):
        level *= others if deep or root else others + 1
        count += level
        if level == 0:
            return
        if most is not None and count > most:
            below = f" below {path_text(root)}" if root else ""
            advice = f"choose depth {deep}" if deep else "ask for single paths"
            check_room(context, count, f"{below} to depth {deep + 1}", advice)


def paths_with_room(context: BeliefContext, root: BeliefPath, depth: int) -> list[BeliefPath]:
    """Return a path and all paths with up to `depth` more agents, short ones first.

    Raises:
        InputError: Memory has no room for their nodes; the paths were not made.
    """
    check_depth(context, root, depth)
    return paths_below(root, depth, context.agents)


def _megabytes(size: int) -> str:
    return f"{-(-size // MEGABYTE):,} MB"
