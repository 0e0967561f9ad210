"""Cache of block data for programs of the scripted world, computed once for each terrain."""

import json
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

from beliefnest.world.frames import BlockGrid
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import SIDE, VOLUME, Terrain
from beliefnest.world.values import Box
from beliefnest.worlds.scripted.footpaths import Ground

__all__ = ["Grounds", "KnownBlocks"]

_MOST = 32
_FIRST = 35
"""Character of the first state in texts of chunks, after those that JSON writes differently."""
_Key = TypeVar("_Key")
_Value = TypeVar("_Value")


class KnownBlocks:
    """Blocks of a box in the forms that programs use, each made when it is first needed.

    Args:
        registry: Names and shapes of blocks.
        box: The box.
        blocks: Its block states, -1 is unknown.
    """

    def __init__(self, registry: Registry, box: Box, blocks: Terrain) -> None:
        self._registry, self._box, self._blocks = registry, box, blocks

    @cached_property
    def ground(self) -> Ground:
        """Cells in which agents can stand."""
        return Ground(self._registry, self._box, self._blocks)

    @cached_property
    def text(self) -> str:
        """All blocks as JSON, as the prelude of programs reads them."""
        told = self._cells() if self._blocks.is_dense else self._chunks()
        return json.dumps({"low": self._box.low, "shape": self._box.shape, **told})

    def _cells(self) -> dict[str, Any]:
        states, places = np.unique(self._blocks.dense(), return_inverse=True)
        return {"palette": self._palette(states), "states": places.reshape(-1).tolist()}

    def _chunks(self) -> dict[str, Any]:
        """Return each different chunk once, and the chunks of the box as runs of equal ones."""
        used, rows = np.unique(self._blocks.rows, return_inverse=True)
        rows = rows.reshape(-1)
        chunks = np.stack([self._blocks.chunks[row] for row in used.tolist()])
        states, places = np.unique(chunks, return_inverse=True)
        codes = (places.reshape(-1, VOLUME) + _FIRST).astype("<u2")
        ends = np.append(np.flatnonzero(np.diff(rows)) + 1, len(rows))
        return {
            "palette": self._palette(states),
            "side": SIDE,
            "counts": self._blocks.lattice.counts,
            "margin": [-part for part in self._blocks.lattice.start(0)],
            "first": _FIRST,
            "chunks": [each.tobytes().decode("utf-16-le") for each in codes],
            "runs": [ends.tolist(), rows[ends - 1].tolist()],
        }

    def _palette(self, states: "np.ndarray[Any, np.dtype[np.int32]]") -> list[str | None]:
        return [None if s < 0 else self._registry.text(s) for s in states.tolist()]


class Grounds:
    """Cache of the latest terrains that programs read.

    Bodies with the same terrain share an entry. So do those with equal ones, if the box is small.
    """

    def __init__(self) -> None:
        self._registry = Registry.load()
        self._same: dict[int, tuple[Terrain | BlockGrid, KnownBlocks]] = {}
        self._equal: dict[tuple[Box, bytes], KnownBlocks] = {}

    def of(self, box: Box, blocks: Terrain) -> KnownBlocks:
        """Return the data of the blocks of a box."""
        held = blocks.dense() if blocks.is_dense else blocks
        same = self._same.get(id(held))
        if same is not None and same[0] is held:
            return same[1]
        if isinstance(held, Terrain):
            known = KnownBlocks(self._registry, box, held)
        else:
            content = (box, held.tobytes())
            if content not in self._equal:
                self._equal[content] = KnownBlocks(self._registry, box, blocks)
            known = self._equal[content]
        # Keep the blocks alive, so that no other ones get their id.
        self._same[id(held)] = (held, known)
        _keep_latest(self._same)
        _keep_latest(self._equal)
        return known


def _keep_latest(known: dict[_Key, _Value]) -> None:
    while len(known) > _MOST:
        del known[next(iter(known))]
