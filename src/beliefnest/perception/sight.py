"""Line of sight through a grid of blocks (semantics, section 3).

An agent sees a block if two conditions hold. The centre of the block is within the greatest
visible distance. And a ray inside the field of view runs from the eye to one of the block's
sample points without entering the shape of another opaque block. Sample points are the centre
of the block and, for each face strictly turned to the eye, the centre of the face and its four
corners, pulled in by 0.01. Every block can be seen, also air and unknown blocks. Unknown
blocks and everything outside the grid hide nothing.

A ray enters a box if it overlaps the inside of the box for more than 1e-9 blocks. A ray in the
plane of a face is free if it is free when moved by 1e-7 to either side. Limits of distance and
angle are inclusive, with a tolerance of 1e-9. The kernels are compiled on first use.
"""

import functools
from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from beliefnest.errors import InputError, UnknownNameError
from beliefnest.perception.codes import EMPTY, FIRST_SHAPE, FULL, OWN, CodeGrid, code_grid
from beliefnest.perception.options import sight_limits
from beliefnest.world.frames import BlockGrid
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import SIDE, chunks_of
from beliefnest.world.values import Point, Position

if TYPE_CHECKING:  # Compiled code takes its time to load.
    from beliefnest.perception.beams import Eye
    from beliefnest.perception.rays import RayScene

BoolArray = npt.NDArray[np.bool_]
Points = npt.NDArray[np.float64]

_DENSE = 0.25
"""Share of full cubes above which light does not get far. Both ways are equal at 30 % solid."""
_NEAR = 5
"""Number of layers around the eye whose lit cells show how far light gets."""


@dataclass(frozen=True, eq=False)
class Sight:
    """Options of sight, the same for every agent at every depth.

    Attributes:
        registry: Names and shapes of blocks.
        max_visible_distance: Greatest distance from the eye to a block's middle or an
            agent's body centre, in blocks; None: no limit.
        field_of_view: Full angle of the cone of sight, in degrees; 360: in all directions.
        transparent_blocks: Names of blocks that hide nothing, in addition to those of
            `Registry.default_transparent`.

    Raises:
        UnknownNameError: A name in `transparent_blocks` is not the name of a block.
    """

    registry: Registry
    max_visible_distance: float | None = 20.0
    field_of_view: float = 360.0
    transparent_blocks: Iterable[str] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "transparent_blocks", tuple(self.transparent_blocks))
        self._transparent  # noqa: B018 - refuse an unknown name here, not at the first look

    def geometry(self, blocks: BlockGrid, origin: Position) -> "Geometry":
        """Prepare a grid for many looks.

        Args:
            blocks: Block state ids, int32 (nx, ny, nz); -1 is unknown.
            origin: Position of blocks[0, 0, 0].

        Raises:
            InputError: The grid is not three-dimensional.
            UnknownNameError: A value of the grid is neither a block state id nor -1.
        """
        _check_grid(blocks, self.registry.states)
        codes = code_grid(blocks, self.state_codes, self.reaches)
        return Geometry(self, origin, codes)

    @functools.cached_property
    def _transparent(self) -> BoolArray:
        transparent = self.registry.default_transparent.copy()
        transparent[self.registry.states_of(self.transparent_blocks)] = True
        return transparent

    @functools.cached_property
    def state_codes(self) -> npt.NDArray[np.uint16]:
        """Shape code (see `codes`) of each block state; the last entry is for unknown."""
        shape_codes = np.arange(len(self.registry.shape_start) - 1) + FIRST_SHAPE
        sizes = np.diff(self.registry.shape_start)
        single = np.flatnonzero(sizes == 1)
        boxes = self.registry.shape_boxes[self.registry.shape_start[single]]
        shape_codes[single[(boxes == (0, 0, 0, 1, 1, 1)).all(axis=1)]] = FULL
        codes = shape_codes[self.registry.state_shape]
        codes[self._transparent] = EMPTY
        return np.append(codes, EMPTY).astype(np.uint16)

    @functools.cached_property
    def reaches(self) -> npt.NDArray[np.uint8]:
        """Sides at which the shape of each code reaches out of its cell, one bit a side."""
        starts, boxes = self.registry.shape_start, self.registry.shape_boxes
        reaches = np.zeros(len(starts) - 1 + FIRST_SHAPE, dtype=np.uint8)
        owners = np.repeat(np.arange(len(starts) - 1), np.diff(starts)) + FIRST_SHAPE
        for axis in range(3):
            for side, out in enumerate((boxes[:, axis] < 0, boxes[:, axis + 3] > 1)):
                reaches[owners[out]] |= 1 << 2 * axis + side
        return reaches


@dataclass(frozen=True, eq=False)
class SightLines(ABC):
    """Blocks prepared for single looks.

    Positions and points are scenario coordinates. An eye is a point. Yaw and pitch are in
    Mineflayer's radians (yaw 0 looks along -z, pi/2 along -x, positive pitch up); they
    matter only for a field of view below 360 degrees.

    Attributes:
        sight: Options of sight.
        origin: Position of the low corner of the blocks.
    """

    sight: Sight
    origin: Position

    def sees_blocks(
        self, eye: Point, yaw: float, pitch: float, positions: npt.ArrayLike
    ) -> BoolArray:
        """Return a mask of the visible blocks among given ones: bool (n,).

        Args:
            eye: Place of the eye.
            yaw: Direction of the look, in radians.
            pitch: Elevation of the look, in radians.
            positions: Integer positions (n, 3), inside or outside the grid.

        Raises:
            InputError: `positions` are not rows of three integers.
        """
        from beliefnest.perception import eye_loops

        rows = _rows(positions)
        if rows.dtype.kind not in "iu" and len(rows):
            raise InputError(f"block positions are of type {rows.dtype}; give integers")
        cells = rows.astype(np.int64) + (1 - np.array(self.origin))
        return eye_loops.seen_blocks(self._scene, self._eye(eye, yaw, pitch), cells)

    def sees_points(self, eye: Point, yaw: float, pitch: float, points: npt.ArrayLike) -> BoolArray:
        """Return a mask of the visible points among `points` (n, 3): bool (n,).

        A point is visible only within the greatest visible distance.

        Raises:
            InputError: `points` are not rows of three numbers.
        """
        from beliefnest.perception import eye_loops

        places = self._local(_rows(points).astype(np.float64))
        return eye_loops.seen_points(self._scene, self._eye(eye, yaw, pitch), places)

    def sees_agents(self, eye: Point, yaw: float, pitch: float, feet: npt.ArrayLike) -> BoolArray:
        """Return a mask of the visible agents among those with `feet` (n, 3): bool (n,).

        An agent is visible if one of its points at `AGENT_SAMPLE_HEIGHTS` is visible and the
        centre of its body is within the greatest visible distance.

        Raises:
            InputError: `feet` are not rows of three numbers.
        """
        from beliefnest.perception import eye_loops

        places = self._local(_rows(feet).astype(np.float64))
        return eye_loops.seen_agents(self._scene, self._eye(eye, yaw, pitch), places)

    def blocker(self, eye: Point, point: Point, target: Position | None = None) -> Position | None:
        """Return the position of the first block whose shape the ray from eye to point enters.

        The block at `target`, if given, hides nothing.
        """
        from beliefnest.perception import rays

        start, end = self._local(np.array([eye, point], dtype=np.float64)).tolist()
        d = (end[0] - start[0], end[1] - start[1], end[2] - start[2])
        x, y, z = self.origin
        but = rays.NOWHERE
        if target is not None:
            but = (target[0] - x + 1, target[1] - y + 1, target[2] - z + 1)
        i, j, k = rays.blocker(self._scene, but, (start[0], start[1], start[2]), d)
        return None if i < 0 else (x + i - 1, y + j - 1, z + k - 1)

    @abstractmethod
    def codes_at(self, cells: npt.NDArray[np.int64]) -> CodeGrid:
        """Return the shape codes of cells with some indices (n, 3), in the box or its margin."""

    @property
    @abstractmethod
    def _scene(self) -> "RayScene":
        """Codes of the blocks and their shapes, as kernels take them."""

    def _local(self, points: Points) -> Points:
        """Return points in the coordinates of the code grid, which has a margin of one cell."""
        return points + (1.0 - np.array(self.origin))

    def _eye(self, eye: Point, yaw: float, pitch: float) -> "Eye":
        from beliefnest.perception import beams

        x, y, z = (float(e) + (1 - o) for e, o in zip(eye, self.origin, strict=True))
        far, cos_half = sight_limits(self.sight.max_visible_distance, self.sight.field_of_view)
        return beams.eye_of((x, y, z), yaw, pitch, cos_half, far)


@dataclass(frozen=True, eq=False)
class Geometry(SightLines):
    """A dense grid of blocks prepared for looks; made by `Sight.geometry`.

    Attributes:
        codes: Shape code of each cell (see the module `codes`), read-only.
    """

    codes: CodeGrid

    def codes_at(self, cells: npt.NDArray[np.int64]) -> CodeGrid:
        """Return the shape codes of cells with some indices (n, 3), in the box or its margin."""
        codes: CodeGrid = self.codes[tuple(cells.T + 1)]
        return codes

    def visible_blocks(self, eye: Point, yaw: float, pitch: float) -> BoolArray:
        """Return a mask of the visible blocks of the grid: bool (nx, ny, nz).

        Both ways give the same result. Where light does not get far it is faster to test the few
        cells that it reaches than to cast the shadows of all blocks.
        """
        from beliefnest.perception import eye_loops, shadows

        seer = self._eye(eye, yaw, pitch)
        lit = self._lit(seer[0])
        if lit is not None:
            seen = np.zeros(self.codes.shape, dtype=np.bool_)
            # In the order of `sees_blocks`: the kernel is compiled for each order.
            cells = np.ascontiguousarray(np.argwhere(lit))
            seen[lit] = eye_loops.seen_blocks(self._scene, seer, cells)
        else:
            noted = shadows.cast_shadows(self._scene, self.sight.reaches, seer[0])
            seen = eye_loops.seen_grid(self._scene, seer, noted)
        return seen[1:-1, 1:-1, 1:-1]

    @functools.cached_property
    def _scene(self) -> "RayScene":
        from beliefnest.perception.rays import RayScene

        nx, ny, nz = self.codes.shape
        registry = self.sight.registry
        return RayScene(
            self.codes.reshape(-1), (nx, ny, nz), registry.shape_start, registry.shape_boxes
        )

    @functools.cached_property
    def _is_dense(self) -> bool:
        return _share_of_cubes(self.codes[1:-1, 1:-1, 1:-1]) > _DENSE

    def _lit(self, eye: tuple[float, float, float]) -> BoolArray | None:
        """Return a mask of the cells that light may reach; None if it seems to get far."""
        shape = self.codes.shape
        inside = all(1 <= e <= size - 1 for e, size in zip(eye, shape, strict=True))
        if not inside or not self._is_dense:
            return None
        from beliefnest.perception import light

        near = light.lit_cells(self._scene, eye, _NEAR)
        if _share_of_cubes(self.codes[near]) <= _DENSE:
            return None
        return light.lit_cells(self._scene, eye, max(shape))


@dataclass(frozen=True, eq=False)
class ChunkGeometry(SightLines):
    """Chunks of blocks prepared for single looks; the module `chunks` describes them.

    Attributes:
        shape: Shape of the box.
        codes: Shape codes of the chunks, uint16 (n, VOLUME), read-only.
        rows: By chunk of the box, its row in `codes`.
    """

    shape: tuple[int, int, int]
    codes: CodeGrid
    rows: npt.NDArray[np.int32]

    def codes_at(self, cells: npt.NDArray[np.int64]) -> CodeGrid:
        """Return the shape codes of cells with some indices (n, 3), in the box or its margin."""
        x, y, z = self.shape
        chunks, within = np.divmod(cells.T + 1, SIDE)
        numbers = np.ravel_multi_index(tuple(chunks), chunks_of((x + 2, y + 2, z + 2)))
        places = np.ravel_multi_index(tuple(within), (SIDE, SIDE, SIDE))
        codes: CodeGrid = self.codes[self.rows[numbers], places]
        return codes

    @functools.cached_property
    def _scene(self) -> "RayScene":
        from beliefnest.perception.rays import RayScene

        x, y, z = (size + 2 for size in self.shape)
        registry = self.sight.registry
        return RayScene(
            self.codes.reshape(-1),
            (x, y, z),
            registry.shape_start,
            registry.shape_boxes,
            self.rows,
            chunks_of((x, y, z)),
        )


def _share_of_cubes(codes: CodeGrid) -> float:
    return float(np.mean(codes & OWN == FULL))


def _rows(points: npt.ArrayLike) -> npt.NDArray[np.generic]:
    rows = np.asarray(points)
    if rows.size == 0:
        return rows.reshape(0, 3)
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise InputError(f"points have shape {rows.shape}; give rows of x, y, z")
    return rows


def _check_grid(blocks: BlockGrid, states: int) -> None:
    if blocks.ndim != 3 or blocks.size == 0 or blocks.dtype.kind not in "iu":
        raise InputError(
            f"a grid of blocks has shape {blocks.shape} of {blocks.dtype}; "
            "give block state ids along x, y and z"
        )
    _check_states(int(blocks.min()), int(blocks.max()), states)


def _check_states(low: int, high: int, states: int) -> None:
    if low < -1 or high >= states:
        wrong = low if low < -1 else high
        raise UnknownNameError(
            f"no block state {wrong}; ids are 0 to {states - 1}, and -1 is unknown"
        )
