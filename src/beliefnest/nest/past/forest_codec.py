"""Forests as bytes, so that a timeline need not be folded from its beginning.

What is saved is what the next entries need. What a forest knows besides, to ask less often
(who looked from where, what is pending), is worked out anew.
"""

import msgspec
import numpy as np
import zstandard

from beliefnest.belief.columns import Columns
from beliefnest.belief.context import BeliefContext
from beliefnest.belief.forest import Forest
from beliefnest.belief.holdings import Holdings
from beliefnest.belief.node_table import SavedNode
from beliefnest.belief.poses import PoseTable, SavedPoses
from beliefnest.belief.protocols import EventHistory
from beliefnest.errors import StoreError
from beliefnest.timeline import codec

__all__ = ["restored", "saved"]

Path = tuple[str, ...]

_LEVEL = 1


class _Node(msgspec.Struct, forbid_unknown_fields=True):
    row: SavedNode
    holdings: Holdings
    heard: bytes
    looked: int
    edited_cells: list[int]
    doubtful: dict[int, int]


class _Saved(msgspec.Struct, forbid_unknown_fields=True):
    position: int
    events: int
    tick: int
    facts_tick: int | None
    edited_facts: list[int]
    first_vitals: dict[int, tuple[float | None, float | None]]
    tracked: bytes
    poses: SavedPoses
    nodes: list[tuple[Path, bytes]]


def saved(forest: Forest) -> bytes:
    """Bytes of a forest, which leaves the stretch it is in; `restored` is the inverse."""
    forest.leave()
    count, table = forest.count_of_events, forest.table
    # Many nodes with all their blocks take a lot of memory, so each is packed by itself.
    packer = zstandard.ZstdCompressor(level=_LEVEL)
    nodes = []
    for path, node in table.index.items():
        body = _Node(
            table.saved(node),
            forest.holdings[node],
            np.packbits(forest.hearing.of(node, count)).tobytes(),
            forest.last_look(node),
            sorted(cell for other, cell in forest.edited_cells if other == node),
            {cell: s for (other, cell), s in sorted(forest.doubtful.items()) if other == node},
        )
        nodes.append((path, packer.compress(codec.encode(body))))
    return codec.encode(
        _Saved(
            position=forest.position,
            events=count,
            tick=forest.tick,
            facts_tick=forest.facts_tick,
            edited_facts=sorted(forest.edited_facts),
            first_vitals=forest.first_vitals,
            tracked=table.tracked.tobytes(),
            poses=forest.poses.saved(),
            nodes=nodes,
        )
    )


def restored(
    context: BeliefContext, events: EventHistory, data: bytes, path: Path | None = None
) -> Forest | None:
    """A forest from the bytes of `saved`, made on the same context.

    Args:
        context: What all nodes share.
        events: What happens on the forest's timeline.
        data: The bytes.
        path: The deepest node wanted; None: all there are.

    Returns:
        The forest, with the nodes down to that one; None if it is not among those saved.

    Raises:
        StoreError: The bytes hold no forest.
    """
    body = codec.decode(data, _Saved)
    nodes = [node for node in body.nodes if path is None or path[: len(node[0])] == node[0]]
    if path is not None and all(other != path for other, _ in nodes):
        return None
    tracked = np.frombuffer(body.tracked, dtype=np.int32)
    context.track(tracked.tolist())
    forest = Forest(context, events, body.tick)
    columns = Columns(context.box, context.agents, context.holds, body.position, body.events)
    columns.poses = PoseTable.restored(body.poses)
    forest.enter(columns)
    forest.position = body.position
    forest.facts_tick = body.facts_tick
    forest.edited_facts = set(body.edited_facts)
    forest.first_vitals = body.first_vitals
    for number, (_, packed) in enumerate(nodes):
        node = codec.decode(_unpacked(packed), _Node)
        forest.table.restore(node.row, tracked)
        forest.holdings.append(node.holdings)
        heard = np.unpackbits(np.frombuffer(node.heard, dtype=np.uint8), count=body.events)
        forest.hearing.set(number, 0, heard.astype(np.bool_))
        forest.looked[number] = node.looked
        forest.edited_cells |= {(number, cell) for cell in node.edited_cells}
        forest.doubtful |= {(number, cell): state for cell, state in node.doubtful.items()}
    forest.table.link()
    return forest


def _unpacked(packed: bytes) -> bytes:
    try:
        return zstandard.ZstdDecompressor().decompress(packed)
    except zstandard.ZstdError as fault:
        raise StoreError(f"stored bytes are no node of a forest: {fault}") from fault
