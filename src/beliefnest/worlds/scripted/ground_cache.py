"""Cache of block data for programs of the scripted world, computed once for each grid."""

import json
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from beliefnest.world.frames import BlockGrid
from beliefnest.world.registry import Registry
from beliefnest.world.values import Box
from beliefnest.worlds.scripted.footpaths import Ground

__all__ = ["Grounds", "KnownBlocks"]

_MOST = 32
_Key = TypeVar("_Key")
_Value = TypeVar("_Value")


@dataclass(frozen=True, slots=True)
class KnownBlocks:
    """Blocks of a box in the forms that programs use.

    Attributes:
        text: All blocks as JSON.
        ground: Cells in which agents can stand.
    """

    text: str
    ground: Ground


class Grounds:
    """Cache of the latest grids that programs read. Bodies with equal grids share an entry."""

    def __init__(self) -> None:
        self._registry = Registry.load()
        self._same: dict[int, tuple[BlockGrid, KnownBlocks]] = {}
        self._equal: dict[tuple[Box, bytes], KnownBlocks] = {}

    def of(self, box: Box, grid: BlockGrid) -> KnownBlocks:
        """Return the data of a grid, which must not change any more."""
        same = self._same.get(id(grid))
        if same is not None and same[0] is grid:
            return same[1]
        content = (box, grid.tobytes())
        known = self._equal.get(content)
        if known is None:
            known = KnownBlocks(self._text(box, grid), Ground(self._registry, box, grid))
            self._equal[content] = known
        # Keep the grid alive, so that no other one gets its id.
        self._same[id(grid)] = (grid, known)
        _keep_latest(self._same)
        _keep_latest(self._equal)
        return known

    def _text(self, box: Box, grid: BlockGrid) -> str:
        states, places = np.unique(grid, return_inverse=True)
        palette = [None if s < 0 else self._registry.text(s) for s in states.tolist()]
        return json.dumps(
            {
                "low": box.low,
                "shape": box.shape,
                "palette": palette,
                "states": places.reshape(-1).tolist(),
            }
        )


def _keep_latest(known: dict[_Key, _Value]) -> None:
    while len(known) > _MOST:
        del known[next(iter(known))]
