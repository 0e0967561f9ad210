"""Cache of the ground on which programs of the scripted world walk, one for each terrain."""

from typing import Any

from beliefnest.world.frames import BlockGrid
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box
from beliefnest.worlds.scripted.footpaths import Ground

_MOST = 32


class Grounds:
    """Cache of the grounds of the latest terrains.

    Bodies with the same terrain share an entry. In a small box, those with equal terrains do, too.
    """

    def __init__(self) -> None:
        self._registry = Registry.load()
        self._same: dict[int, tuple[Terrain | BlockGrid, Ground]] = {}
        self._equal: dict[tuple[Box, bytes], Ground] = {}

    def of(self, box: Box, blocks: Terrain) -> Ground:
        """Return the ground of a box."""
        grid = blocks.dense() if blocks.is_dense else blocks
        same = self._same.get(id(grid))
        if same is not None and same[0] is grid:
            return same[1]
        if isinstance(grid, Terrain):
            ground = Ground(self._registry, box, grid)
        else:
            content = (box, grid.tobytes())
            if content not in self._equal:
                self._equal[content] = Ground(self._registry, box, blocks)
            ground = self._equal[content]
        # Keep the blocks alive, so that no other ones get their id.
        self._same[id(grid)] = (grid, ground)
        caches: tuple[dict[Any, Any], ...] = (self._same, self._equal)
        for kept in caches:
            while len(kept) > _MOST:
                del kept[next(iter(kept))]
        return ground
