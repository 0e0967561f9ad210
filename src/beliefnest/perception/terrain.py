"""A grid of blocks with what can be derived from it: geometry and visible sets."""

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from beliefnest.perception.sight import Geometry, Sight
from beliefnest.world.frames import BlockGrid
from beliefnest.world.values import Box, Point, Position

__all__ = ["Terrain"]


class Terrain:
    """Blocks of one box, never changed after they were made.

    Belief states that hold the same blocks share one terrain, and with it the geometry
    and the visible sets computed from it.

    Attributes:
        box: The part of space covered.
        blocks: Block state ids, int32 of shape `box.shape`, -1 unknown; read-only.
    """

    __slots__ = ("_geometry", "_sight", "_visible", "blocks", "box")

    _REMEMBERED = 16

    def __init__(
        self, box: Box, blocks: BlockGrid, sight: Sight, geometry: Geometry | None = None
    ) -> None:
        blocks.flags.writeable = False
        self.box = box
        self.blocks = blocks
        self._sight = sight
        self._geometry = geometry
        self._visible: dict[tuple[Point, float, float], npt.NDArray[np.bool_]] = {}

    @property
    def geometry(self) -> Geometry:
        """The blocks prepared for looks."""
        if self._geometry is None:
            self._geometry = self._sight.geometry(self.blocks, self.box.low)
        return self._geometry

    def visible(self, eye: Point, yaw: float, pitch: float) -> npt.NDArray[np.bool_]:
        """Which blocks are seen from an eye; bool, shape of the box, read-only."""
        all_round = self._sight.field_of_view >= 360
        key = (eye, 0.0, 0.0) if all_round else (eye, yaw, pitch)
        seen = self._visible.get(key)
        if seen is None:
            seen = self.geometry.visible_blocks(eye, yaw, pitch)
            seen.flags.writeable = False
            if len(self._visible) >= self._REMEMBERED:
                del self._visible[next(iter(self._visible))]
            self._visible[key] = seen
        return seen

    def with_blocks(self, changes: Mapping[Position, int]) -> "Terrain":
        """The terrain with other blocks at some positions of the box."""
        blocks = self.blocks.copy()
        for position, state in changes.items():
            blocks[self.box.index(position)] = state
        geometry = None if self._geometry is None else self._geometry.with_blocks(changes)
        return Terrain(self.box, blocks, self._sight, geometry)

    def merged(self, other: "Terrain", where: npt.NDArray[np.bool_]) -> "Terrain":
        """The terrain with the known blocks of `other` at the places `where` is true."""
        changed = where & (self.blocks != other.blocks) & (other.blocks >= 0)
        if not changed.any():
            return self
        if changed.sum() == np.count_nonzero(self.blocks != other.blocks):
            return other
        return Terrain(
            self.box, np.where(changed, other.blocks, self.blocks).astype(np.int32), self._sight
        )
