"""Refusal of environments for which memory has no room, before anything is made."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from beliefnest.belief.context import BeliefContext
from beliefnest.belief.node_memory import check_depth, check_room
from beliefnest.env.bounds import ArrayShape, SpaceBounds
from beliefnest.errors import InputError
from beliefnest.world.memory import MEGABYTE

_MOST_BYTES = 256_000_000
"""Greatest size of one observation."""
_BOUNDS = 2
"""Arrays of bounds that a space has: the least and the greatest value of each number."""


def check_nested(context: BeliefContext, acting: Sequence[str], depth: int) -> None:
    """Raise InputError if memory has no room for the beliefs of acting agents down to a depth.

    Args:
        context: The part that all nodes of the nest share.
        acting: Names of the agents that act.
        depth: Number of names in the longest paths of beliefs.
    """
    for agent in acting:
        check_depth(context, (agent,), depth - 1)
    others = len(context.agents) - 1
    count = 1 + len(acting) * sum(others**deep for deep in range(depth))
    check_room(context, count, f" to depth {depth}", "choose a smaller depth of nested beliefs")


def check_arrays(context: BeliefContext, bounds: SpaceBounds, acting: int, nested: int) -> None:
    """Raise InputError if memory has no room for observations as arrays, and for their spaces.

    Args:
        context: The part that all nodes of the nest share.
        bounds: Sizes of the arrays.
        acting: Number of agents that act.
        nested: Number of further beliefs in infos.
    """
    each, own = _bytes(bounds.shapes()), _bytes(bounds.own_shapes())
    limit, needed = context.memory, each * acting * (1 + _BOUNDS) + own * nested
    sides = " x ".join(map(str, bounds.box.shape))
    if each > _MOST_BYTES:
        raise InputError(
            f"an observation as arrays would have {_megabytes(each)} in a box of {sides} blocks, "
            f"new for each agent and step; at most {_megabytes(_MOST_BYTES)} are possible: choose "
            "observations='dict', or take a smaller box"
        )
    if limit is None or needed <= limit.bytes:
        return
    raise InputError(
        f"observations as arrays need at least {_megabytes(needed)}, {_megabytes(each)} for each "
        f"of {acting} agents and {nested} nested beliefs, in a box of {sides} blocks. This process "
        f"may use {_megabytes(limit.bytes)}, {limit.source}: choose observations='dict', or take "
        "fewer agents or a smaller box"
    )


def _bytes(shapes: Mapping[str, ArrayShape]) -> int:
    sizes = (math.prod(shape) * np.dtype(kind).itemsize for shape, kind, _, _ in shapes.values())
    return sum(sizes)


def _megabytes(size: int) -> str:
    return f"{-(-size // MEGABYTE):,} MB"
