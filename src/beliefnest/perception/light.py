"""Flood of light: a compiled bound on the cells of a dense grid that an eye can see anything of.

Light starts at the eye and spreads from cell to cell until full cubes stop it; other shapes let it
through. It is followed in six pyramids of directions, two for each main axis. A direction in a
pyramid has two slopes, both from -1 to 1: its components along the other axes per block along the
main axis. For each cell the flood keeps a rectangle of slopes that holds those of all rays that
enter the cell. It goes layer by layer along the main axis, so only two layers are kept.
"""

import math

import numpy as np
import numpy.typing as npt

from beliefnest.perception.codes import FULL, OWN
from beliefnest.perception.compiling import allocating, inlined, inner
from beliefnest.perception.rays import GridCell, RayScene, Vector, turned
from beliefnest.world.array_types import Flags

Light = npt.NDArray[np.float64]
SlopeBounds = tuple[float, float, float, float]
"""Least and greatest slope along b, then along c; b and c are the axes after the main axis."""

# No light: the least slope exceeds the greatest.
_DARK = (1.0, -1.0, -1.0, -1.0)
# Rectangles are made this much larger, so that rays through edges and rounding do no harm.
_GROW = 1e-6
# The eye is at least this far from each cell, along the main axis, when slopes are computed.
_LEAST = 1e-9


@inlined
def _slopes(low: float, high: float, near: float, far: float) -> tuple[float, float]:
    """Return the least and greatest slope to points low to high.

    `near` and `far` are 1 / the least and the greatest distance of the points.
    """
    return low * (near if low < 0.0 else far) - _GROW, high * (near if high > 0.0 else far) + _GROW


@inlined
def side(e: float, cell: int) -> int:
    """Return the step to the neighbour of a cell that is nearer to the eye; 0: it is level."""
    if e < cell:
        return -1
    return 1 if e > cell + 1 else 0


@inlined
def outwards(e: float, first: int, last: int, number: int) -> int:
    """Return a cell of a row by number, such that nearer cells have smaller numbers."""
    start = min(max(math.floor(e), first), last)
    return start + number if start + number <= last else last - number


@inlined
def _arriving(
    light: Light,
    cell: GridCell,
    sides: GridCell,
    place: tuple[float, float],
    near: float,
    far: float,
) -> SlopeBounds:
    """Return the rectangle of the light that a cell gets from its nearer neighbours.

    Light comes across sides, edges and a corner. From each neighbour it passes what both cells
    share: that part's slopes bound those of the rays.

    Args:
        light: Rectangles of this layer and the one before.
        cell: Layer (0 or 1, index in `light`), b and c.
        sides: Steps to the nearer neighbours, 0 where there is none.
        place: The eye's b and c.
        near: 1 / the distance at which the layer begins, along the main axis.
        far: 1 / the distance at which it ends.
    """
    here, b, c = cell
    u0, u1, v0, v1 = _DARK
    for n in range(1, 8):
        by_a, by_b, by_c = (n & 1) * sides[0], (n >> 1 & 1) * sides[1], (n >> 2) * sides[2]
        if (n & 1 and not by_a) or (n & 2 and not by_b) or (n & 4 and not by_c):
            continue
        other = light[here ^ by_a, b + by_b, c + by_c]
        if other[0] > other[1]:
            continue
        until = near if by_a else far
        s0, s1 = _slopes(b + (by_b > 0) - place[0], b + (by_b >= 0) - place[0], near, until)
        t0, t1 = _slopes(c + (by_c > 0) - place[1], c + (by_c >= 0) - place[1], near, until)
        s0, s1 = max(s0, other[0]), min(s1, other[1])
        t0, t1 = max(t0, other[2]), min(t1, other[3])
        if s0 <= s1 and t0 <= t1:
            if u0 > u1:
                u0, u1, v0, v1 = s0, s1, t0, t1
            else:
                u0, u1, v0, v1 = min(u0, s0), max(u1, s1), min(v0, t0), max(v1, t1)
    return u0, u1, v0, v1


@inner
def _flood(
    scene: RayScene, eye: Vector, axis: int, step: int, layers: int, light: Light, lit: Flags
) -> None:
    """Let light spread in the pyramid along an axis and mark the cells that it reaches.

    `light` is scratch memory: by parity of the layer, b and c, the rectangle.
    """
    codes, sizes = scene.codes, scene.sizes
    ea, eb, ec = turned(eye, axis)
    size_a, size_b, size_c = turned(sizes, axis)
    stride_a, stride_b, stride_c = turned((sizes[1] * sizes[2], sizes[2], 1), axis)
    light[:] = _DARK[1]
    light[:, :, :, 0] = _DARK[0]
    first = math.floor(ea) if step > 0 else math.ceil(ea) - 1
    for layer in range(first, min(max(first + step * layers, 0), size_a - 1), step):
        far = (layer + 0.5 - ea) * step + 0.5
        near = max(far - 1.0, _LEAST)
        b0, b1 = max(math.floor(eb - far), 1), min(math.floor(eb + far), size_b - 2)
        c0, c1 = max(math.floor(ec - far), 1), min(math.floor(ec + far), size_c - 2)
        goes_on = False
        for number_b in range(b1 - b0 + 1):
            b = outwards(eb, b0, b1, number_b)
            side_b = side(eb, b)
            for number_c in range(c1 - c0 + 1):
                c = outwards(ec, c0, c1, number_c)
                sides = (1 if layer != first else 0, side_b, side(ec, c))
                ray = _arriving(light, (layer % 2, b, c), sides, (eb, ec), 1.0 / near, 1.0 / far)
                if sides == (0, 0, 0):  # The eye is in this cell.
                    ray = (-1.0, 1.0, -1.0, 1.0)
                index = layer * stride_a + b * stride_b + c * stride_c
                if ray[0] <= ray[1]:
                    lit[index] = True
                    if codes[index] & OWN == FULL:
                        ray = _DARK
                    else:
                        goes_on = True
                here = light[layer % 2, b, c]
                here[0], here[1], here[2], here[3] = ray
        if not goes_on:
            break


@allocating
def lit_cells(scene: RayScene, eye: Vector, layers: int) -> Flags:
    """Return a mask of the cells that light may reach; all others are certainly not seen.

    Args:
        scene: The grid.
        eye: Place of the eye, in the grid and inside its margin.
        layers: Number of layers from the eye on, in each direction, to which light is followed.
    """
    lit = np.zeros(scene.sizes, dtype=np.bool_)
    for axis in range(3):
        _, size_b, size_c = turned(scene.sizes, axis)
        light = np.empty((2, size_b, size_c, 4))
        for step in (-1, 1):
            _flood(scene, eye, axis, step, layers, light, lit.reshape(-1))
    return lit
