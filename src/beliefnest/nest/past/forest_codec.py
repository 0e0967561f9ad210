"""Codec of forests: their state as bytes, for checkpoints."""

from collections.abc import Sequence

import msgspec

from beliefnest.belief.context import BeliefContext
from beliefnest.belief.forest import EventHistory, Forest, ForestState, NodeState
from beliefnest.timeline import codec
from beliefnest.world.compression import compressed, decompressed
from beliefnest.world.paths import BeliefPath

_LEVEL = 1
_LARGEST = 2**30
"""Greatest number of bytes of a node; its grids have some bytes for each cell of the box."""


class _Saved(msgspec.Struct, forbid_unknown_fields=True):
    state: ForestState
    nodes: list[tuple[BeliefPath, bytes]]


def saved(forest: Forest) -> bytes:
    """Return the bytes of a forest; `restored` is the inverse. The forest leaves its stretch."""
    state, nodes = forest.saved()
    # Nodes hold all blocks of the box, so each is compressed by itself to bound the memory in use.
    packed = [(node.row.path, compressed(codec.encode(node), _LEVEL)) for node in nodes]
    return codec.encode(_Saved(state, packed))


def restored(
    context: BeliefContext,
    events: EventHistory,
    data: bytes,
    paths: Sequence[BeliefPath] | None = None,
) -> Forest | None:
    """Return a forest from the bytes of `saved`.

    Args:
        context: The part that all nodes share.
        events: Events of the timeline.
        data: The bytes.
        paths: Nodes to restore, with their ancestors, as far as there are any; None: all nodes.

    Returns:
        The forest. None if it lacks the first of `paths`.

    Raises:
        StoreError: The bytes are not those of a forest.
    """
    body = codec.decode(data, _Saved)
    nodes = body.nodes
    if paths is not None:
        there = {path for path, _ in nodes}
        if paths[0] not in there:
            return None
        wanted = {path[:depth] for path in paths if path in there for depth in range(len(path) + 1)}
        nodes = [node for node in nodes if node[0] in wanted]
    states = (codec.decode(decompressed(packed, _LARGEST), NodeState) for _, packed in nodes)
    return Forest.restored(context, events, body.state, states)
