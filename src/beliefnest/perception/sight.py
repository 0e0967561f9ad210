"""Who sees what: line of sight through a grid of blocks (semantics, section 3).

A block is seen if, from the eye, a ray inside the field of view reaches one of its sample
points without entering the shape of another opaque block, and its middle is within the
greatest visible distance. Sample points are the middle and, for each face strictly turned
to the eye, the face's middle and its corners pulled in by 0.01. Every block can be seen,
air and unknown ones included; the latter hide nothing, nor does anything outside the grid.

Entering means to overlap the inside of a box for more than 1e-9 blocks. A ray that lies
in the plane of a face is free if it is free when moved by 1e-7 to either side. Limits of
distance and angle are inclusive, to 1e-9. The kernels are compiled on first use.
"""

import functools
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from beliefnest.errors import InputError, UnknownNameError
from beliefnest.perception.codes import EMPTY, FIRST_SHAPE, FULL, CodeGrid, code_grid
from beliefnest.world.frames import BlockGrid
from beliefnest.world.registry import Registry
from beliefnest.world.values import Point, Position

if TYPE_CHECKING:  # Compiled code takes its time to load.
    from beliefnest.perception.beams import Eye
    from beliefnest.perception.rays import Scene

__all__ = ["Geometry", "Sight"]

BoolArray = npt.NDArray[np.bool_]
Points = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Sight:
    """How agents see; the same for every agent at every depth.

    Attributes:
        registry: Names and shapes of blocks.
        max_visible_distance: Greatest distance from the eye to a block's middle or an
            agent's body centre, in blocks; None: no limit.
        field_of_view: Full angle of the cone of sight, in degrees; 360: in all directions.
        transparent_blocks: Names of blocks that hide nothing, beside those of
            `Registry.default_transparent`.

    Raises:
        UnknownNameError: A name of `transparent_blocks` is no block.
    """

    registry: Registry
    max_visible_distance: float | None = 20.0
    field_of_view: float = 360.0
    transparent_blocks: Iterable[str] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "transparent_blocks", tuple(self.transparent_blocks))
        self._transparent  # noqa: B018 - a wrong name is refused here, not at the first look

    def geometry(self, blocks: BlockGrid, origin: Position) -> "Geometry":
        """Prepare a grid for many looks.

        Args:
            blocks: Block state ids, int32 (nx, ny, nz); -1 is unknown.
            origin: Position of blocks[0, 0, 0].

        Raises:
            InputError: The grid is not three-dimensional.
            UnknownNameError: A value is neither a block state id nor -1.
        """
        _check_grid(blocks, self.registry.states)
        codes = code_grid(blocks, self.state_codes, self.reaches)
        codes.flags.writeable = False
        return Geometry(self, origin, codes)

    @property
    def limits(self) -> tuple[float, float]:
        """Cosine of half the field of view (-2: no limit), and how far is seen (infinite too)."""
        angle, far = self.field_of_view, self.max_visible_distance
        cos_half = -2.0 if angle >= 360 else math.cos(math.radians(angle) / 2)
        return cos_half, math.inf if far is None else float(far)

    @functools.cached_property
    def _transparent(self) -> BoolArray:
        transparent = self.registry.default_transparent.copy()
        for name in self.transparent_blocks:
            ids = self.registry.state_ids(name)
            transparent[ids.start : ids.stop] = True
        return transparent

    @functools.cached_property
    def state_codes(self) -> npt.NDArray[np.uint16]:
        """Code (see `codes`) of each state, and at the end that of unknown."""
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
        """By code, the sides at which its shape reaches out of the cell, one bit for each."""
        starts, boxes = self.registry.shape_start, self.registry.shape_boxes
        reaches = np.zeros(len(starts) - 1 + FIRST_SHAPE, dtype=np.uint8)
        owners = np.repeat(np.arange(len(starts) - 1), np.diff(starts)) + FIRST_SHAPE
        for axis in range(3):
            for side, out in enumerate((boxes[:, axis] < 0, boxes[:, axis + 3] > 1)):
                reaches[owners[out]] |= 1 << 2 * axis + side
        return reaches


@dataclass(frozen=True, eq=False)
class Geometry:
    """A grid of blocks prepared for looks; make it with `Sight.geometry`.

    Positions and points are scenario coordinates. An eye is a point; yaw and pitch are
    Mineflayer's radians (yaw 0 looks along -z, pi/2 along -x, positive pitch up) and
    matter only for a field of view below 360 degrees.

    Attributes:
        sight: How agents see.
        origin: Position of the grid's low corner.
        codes: What each cell holds, as described in `codes`, read-only.
    """

    sight: Sight
    origin: Position
    codes: CodeGrid

    def with_blocks(self, changes: Mapping[Position, int]) -> "Geometry":
        """Return the geometry with other block states (-1: unknown) at some positions of the grid.

        Raises:
            InputError, UnknownNameError: A position lies outside the grid, an id is none.
        """
        from beliefnest.perception.eyes import set_code

        codes = self.codes.copy()
        states = self.sight.registry.states
        for position, state in changes.items():
            cell = tuple(p - o for p, o in zip(position, self.origin, strict=True))
            if not all(0 <= c < size - 2 for c, size in zip(cell, codes.shape, strict=True)):
                raise InputError(f"position {position} lies outside the grid at {self.origin}")
            _check_states(state, state, states)
            i, j, k = cell
            code = int(self.sight.state_codes[state])
            place = (i + 1, j + 1, k + 1)
            set_code(codes.reshape(-1), self._scene.sizes, self.sight.reaches, place, code)
        codes.flags.writeable = False
        return Geometry(self.sight, self.origin, codes)

    def visible_blocks(self, eye: Point, yaw: float, pitch: float) -> BoolArray:
        """Which blocks of the grid are seen: bool (nx, ny, nz)."""
        from beliefnest.perception import shadows, views

        seer = self._eye(eye, yaw, pitch)
        noted = shadows.cast_shadows(self._scene, self.sight.reaches, seer[0])
        no_cells = np.empty((0, 3), dtype=np.int64)
        seen = views.seen_blocks(self._scene, seer, no_cells, noted)
        return seen.reshape(self.codes.shape)[1:-1, 1:-1, 1:-1]

    def sees_blocks(
        self, eye: Point, yaw: float, pitch: float, positions: npt.ArrayLike
    ) -> BoolArray:
        """Which of the blocks at integer positions (n, 3), in or out of the grid, are seen.

        InputError if they are not rows of three integers.
        """
        from beliefnest.perception import shadows, views

        rows = _rows(positions)
        if rows.dtype.kind not in "iu" and len(rows):
            raise InputError(f"block positions are of type {rows.dtype}; give integers")
        cells = rows.astype(np.int64) + (1 - np.array(self.origin))
        seer = self._eye(eye, yaw, pitch)
        return views.seen_blocks(self._scene, seer, cells, shadows.no_shadows())

    def sees_points(self, eye: Point, yaw: float, pitch: float, points: npt.ArrayLike) -> BoolArray:
        """Which of the points (n, 3) are seen; each has to be within the visible distance.

        InputError if they are not rows of three numbers.
        """
        from beliefnest.perception import views

        places = self._local(_rows(points).astype(np.float64))
        return views.seen_points(self._scene, self._eye(eye, yaw, pitch), places)

    def sees_agents(self, eye: Point, yaw: float, pitch: float, feet: npt.ArrayLike) -> BoolArray:
        """Which of the agents with feet at (n, 3) are seen.

        One of the points at `AGENT_SAMPLE_HEIGHTS` has to be seen, and the body centre
        has to be within the visible distance. InputError if `feet` are not rows of three numbers.
        """
        from beliefnest.perception import views

        places = self._local(_rows(feet).astype(np.float64))
        return views.seen_agents(self._scene, self._eye(eye, yaw, pitch), places)

    def blocker(self, eye: Point, point: Point) -> Position | None:
        """Return the position of the first block whose shape the ray from eye to point enters."""
        from beliefnest.perception import rays

        start, end = self._local(np.array([eye, point], dtype=np.float64)).tolist()
        d = (end[0] - start[0], end[1] - start[1], end[2] - start[2])
        i, j, k = rays.hidden_by(self._scene, rays.NOWHERE, (start[0], start[1], start[2]), d)
        if i < 0:
            return None
        x, y, z = self.origin
        return (x + i - 1, y + j - 1, z + k - 1)

    @functools.cached_property
    def _scene(self) -> "Scene":
        from beliefnest.perception.rays import Scene

        nx, ny, nz = self.codes.shape
        registry = self.sight.registry
        return Scene(
            self.codes.reshape(-1), (nx, ny, nz), registry.shape_start, registry.shape_boxes
        )

    def _local(self, points: Points) -> Points:
        """Points in coordinates of the codes, which have a margin of one cell."""
        return points + (1.0 - np.array(self.origin))

    def _eye(self, eye: Point, yaw: float, pitch: float) -> "Eye":
        from beliefnest.perception import beams

        x, y, z = (float(e) + (1 - o) for e, o in zip(eye, self.origin, strict=True))
        return beams.eye_of((x, y, z), yaw, pitch, *self.sight.limits)


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
