"""Compiled rules of steps between cells, over a grid of codes of `geometry.bodies`.

A cell is the place of a body's feet. A grid may be the whole of a space with its margin, or a part
of it; outside it there is nothing to stand on or to pass. The functions are called by kernels.
"""

import math

import numpy as np
import numpy.typing as npt

from beliefnest.geometry.bodies import (
    ALONG_X,
    ALONG_Z,
    FLOOR,
    FULL,
    LADDER,
    LIQUID,
    OPENS,
    ROOM,
    SIDES,
    TOP_SHIFT,
    UNKNOWN,
    UPPER,
)
from beliefnest.perception.compiling import compiled, inlined, inner
from beliefnest.world.array_types import Cells, Flags, Ints

Sizes = tuple[int, int, int]
Grid = npt.NDArray[np.uint32]
Sides = npt.NDArray[np.int64]
Levels = npt.NDArray[np.int8]

NOWHERE = 2
"""Change of height of a step that leads nowhere."""

DEEPEST_DROP = 3
"""Greatest number of cells by which a body drops onto a floor."""
DEEPEST_DIVE = 8
"""Greatest number of cells by which a body drops into water."""
FARTHEST_JUMP = 4
"""Greatest number of cells that a jump leads ahead."""
MOST_JUMPS = 3
"""Largest number of cells to which jumps in one direction lead."""
_JUMP = FULL + 12
"""Greatest height of a step up, from the top of one block to that of another: 1.2 blocks."""

_LOW = FULL // 5
"""Height of a layer up to which a body on it fits below the next block but one."""

_WAYS = ALONG_X | ALONG_Z


@inlined
def code_at(codes: Grid, sizes: Sizes, x: int, y: int, z: int) -> int:
    """Return the code of a cell; 0 outside the grid."""
    if 0 <= x < sizes[0] and 0 <= y < sizes[1] and 0 <= z < sizes[2]:
        return int(codes[(x * sizes[1] + y) * sizes[2] + z])
    return 0


@inlined
def _enters(code: int) -> bool:
    """Return True if there is room for feet in a block, also in a doorway."""
    return code & ROOM != 0 or (code & _WAYS != 0 and code & UPPER == 0)


@inlined
def _clears(code: int) -> bool:
    """Return True if there is room for a head in a block: it has no shape there."""
    return code & ROOM != 0 and (code >> TOP_SHIFT == 0 or code & (LADDER | UNKNOWN) != 0)


@inlined
def _is_layer(code: int) -> bool:
    """Return True if a block is a thin layer. A body on it is in its cell, not in the one above."""
    return code & ROOM != 0 and code & FLOOR != 0 and code & LADDER == 0


@inner
def _bears(codes: Grid, sizes: Sizes, x: int, y: int, z: int) -> bool:
    """Return True if a block holds up a body in the cell above.

    A door or gate that opens by hand does so where nobody can walk through it.
    """
    code = code_at(codes, sizes, x, y, z)
    if code & (FLOOR | UNKNOWN) == 0 or _is_layer(code):
        return False
    if code & OPENS == 0:
        return True
    i, k = (1, 0) if code & ALONG_X else (0, 1)
    beside = code_at(codes, sizes, x + i, y, z + k) | code_at(codes, sizes, x - i, y, z - k)
    return beside & ROOM == 0


@inner
def _rise(codes: Grid, sizes: Sizes, x: int, y: int, z: int, ahead: int) -> int:
    """Return the height from the floor of a body in a cell to the top of a block at its feet."""
    own = code_at(codes, sizes, x, y, z)
    if _is_layer(own):
        return (ahead >> TOP_SHIFT) - (own >> TOP_SHIFT)
    floor = code_at(codes, sizes, x, y - 1, z)
    return (ahead >> TOP_SHIFT) + FULL - (floor >> TOP_SHIFT)


@inlined
def _crosses(code: int, dx: int, dz: int, is_high: bool) -> bool:
    """Return True if a step leads straight through a doorway, or there is no doorway.

    Bots cross what has no shape, as an open gate, in each direction if it is high enough there for
    a hop over it.
    """
    way = code & _WAYS
    if way == 0 or (dz == 0 and way == ALONG_X) or (dx == 0 and way == ALONG_Z):
        return True
    return is_high and code >> TOP_SHIFT == 0


@inlined
def _has_plate(code: int, dx: int, dz: int) -> bool:
    """Return True if a ladder has its plate on a side of its cell."""
    for x, z, bit in SIDES:
        if x == dx and z == dz:
            return code & bit != 0
    return False


@inner
def stands_at(codes: Grid, sizes: Sizes, x: int, y: int, z: int) -> bool:
    """Return True if a body can be in a cell: it stands on a floor, or swims."""
    own, head = code_at(codes, sizes, x, y, z), code_at(codes, sizes, x, y + 1, z)
    # Whoever opens a door opens both of its halves, but one gate of two.
    is_doorway = own & head & _WAYS and (head & OPENS == 0 or head & UPPER)
    if not _enters(own) or not (_clears(head) or is_doorway):
        return False
    # On a high layer the head reaches into the next cell.
    is_raised = own & ROOM and own & (LADDER | UNKNOWN) == 0 and own >> TOP_SHIFT > _LOW
    if is_raised and not _clears(code_at(codes, sizes, x, y + 2, z)):
        return False
    return _is_layer(own) or own & LIQUID != 0 or _bears(codes, sizes, x, y - 1, z)


@inner
def landing(codes: Grid, sizes: Sizes, x: int, y: int, z: int, dx: int, dz: int) -> int:
    """Return the height to which a step sideways leads; -1: it leads nowhere.

    A step leads ahead, else up one block, else down. Diagonal steps need room at both corners and
    lead ahead only. Doorways are passed straight and entered on their own level.
    """
    own, ahead = code_at(codes, sizes, x, y, z), code_at(codes, sizes, x + dx, y, z + dz)
    is_high = False
    if (own | ahead) & _WAYS:
        is_high = _has_room(codes, sizes, x, y + 1, z) and _has_room(
            codes, sizes, x + dx, y + 1, z + dz
        )
    if not _crosses(own, dx, dz, is_high):
        return -1
    is_ahead = _crosses(ahead, dx, dz, is_high) and stands_at(codes, sizes, x + dx, y, z + dz)
    if dx != 0 and dz != 0:
        is_open = _has_room(codes, sizes, x + dx, y, z) and _has_room(codes, sizes, x, y, z + dz)
        return y if is_ahead and is_open else -1
    if is_ahead:
        return y if _passes_plates(codes, sizes, x, y, z, dx, dz) else -1
    head = code_at(codes, sizes, x + dx, y + 1, z + dz)
    if ahead & head & ROOM and _bears(codes, sizes, x + dx, y - 1, z + dz):
        # There is something at the height of the head that bots take for room.
        return -1
    return _landing_off_level(codes, sizes, x, y, z, dx, dz)


@inner
def _has_room(codes: Grid, sizes: Sizes, x: int, y: int, z: int) -> bool:
    """Return True if a body touches nothing in a cell, whatever is below."""
    return _clears(code_at(codes, sizes, x, y, z)) and _clears(code_at(codes, sizes, x, y + 1, z))


@inner
def _passes_plates(codes: Grid, sizes: Sizes, x: int, y: int, z: int, dx: int, dz: int) -> bool:
    """Return True if no plate of a ladder stops a body between two cells.

    A body jumps or climbs over the plate that it leaves, and over one at the height of its feet.
    """
    i, k = x + dx, z + dz
    own, ahead = code_at(codes, sizes, x, y, z), code_at(codes, sizes, i, y, k)
    head, next_head = code_at(codes, sizes, x, y + 1, z), code_at(codes, sizes, i, y + 1, k)
    if _has_plate(next_head, -dx, -dz) or (_has_plate(head, dx, dz) and own & LADDER == 0):
        return False
    if not (_has_plate(own, dx, dz) or _has_plate(ahead, -dx, -dz) or _has_plate(head, dx, dz)):
        return True
    above, beyond = code_at(codes, sizes, x, y + 2, z), code_at(codes, sizes, i, y + 2, k)
    return _clears(above) and _clears(beyond)


@inner
def _landing_off_level(codes: Grid, sizes: Sizes, x: int, y: int, z: int, dx: int, dz: int) -> int:
    """Return the height to which a step leads up one block, or down; -1: it leads nowhere."""
    i, k = x + dx, z + dz
    own, ahead = code_at(codes, sizes, x, y, z), code_at(codes, sizes, i, y, k)
    is_free = own & _WAYS == 0 or _clears(code_at(codes, sizes, x, y + 1, z))
    feet = code_at(codes, sizes, i, y + 1, k)
    # Bots take an open gate for an obstacle, and jump onto a layer above it.
    is_covered = _is_layer(feet) and ahead & _WAYS != 0 and ahead >> TOP_SHIFT == 0
    if (ahead & FLOOR or is_covered) and is_free and feet & ROOM:
        high, top = code_at(codes, sizes, x, y + 2, z), code_at(codes, sizes, i, y + 2, k)
        is_low = _bears(codes, sizes, i, y, k) and _rise(codes, sizes, x, y, z, ahead) <= _JUMP
        if (is_low or is_covered) and _clears(high) and _clears(top):
            return y + 1
    if not _has_room(codes, sizes, i, y, k) or ahead & LIQUID:
        return -1
    if not code_at(codes, sizes, i, y - 1, k) & ROOM:
        return -1
    return _fall(codes, sizes, i, y, k)


@inner
def _fall(codes: Grid, sizes: Sizes, x: int, y: int, z: int) -> int:
    """Return the height at which a body lands that drops from a cell by one at least."""
    if _is_layer(code_at(codes, sizes, x, y - 1, z)):
        return y - 1
    for depth in range(2, DEEPEST_DIVE + 1):
        code = code_at(codes, sizes, x, y - depth, z)
        if code & LIQUID and code & ROOM:
            return y - depth
        if _is_layer(code):
            return y - depth if depth <= DEEPEST_DROP + 1 else -1
        if _bears(codes, sizes, x, y - depth, z):
            return y - depth + 1 if depth <= DEEPEST_DROP + 1 else -1
        if not code & ROOM:
            return -1
    return -1


@inner
def climb(codes: Grid, sizes: Sizes, x: int, y: int, z: int) -> bool:
    """Return True if a body climbs one cell up from a cell."""
    own = code_at(codes, sizes, x, y, z)
    return own & LADDER != 0 and code_at(codes, sizes, x, y + 2, z) & ROOM != 0


@inner
def descent(codes: Grid, sizes: Sizes, x: int, y: int, z: int) -> int:
    """Return the height to which a body gets straight down from a cell; -1: nowhere."""
    own = code_at(codes, sizes, x, y, z)
    if own & LIQUID or _is_layer(own) or not code_at(codes, sizes, x, y - 1, z) & ROOM:
        return -1
    return _fall(codes, sizes, x, y, z)


@inner
def _is_edge(codes: Grid, sizes: Sizes, x: int, y: int, z: int, dx: int, dz: int) -> bool:
    """Return True if the floor ends or is lower in a direction, with room for a body above."""
    floor, ahead = code_at(codes, sizes, x, y - 1, z), code_at(codes, sizes, x + dx, y - 1, z + dz)
    own = code_at(codes, sizes, x, y, z)
    is_floor = _is_layer(ahead) or _bears(codes, sizes, x + dx, y - 1, z + dz)
    if is_floor and (_is_layer(own) or ahead >> TOP_SHIFT >= floor >> TOP_SHIFT):
        return False
    feet, head = (
        code_at(codes, sizes, x + dx, y, z + dz),
        code_at(codes, sizes, x + dx, y + 1, z + dz),
    )
    return own & (LIQUID | _WAYS) == 0 and feet & head & ROOM != 0


@inner
def jumps(codes: Grid, sizes: Sizes, x: int, y: int, z: int, dx: int, dz: int, steps: Ints) -> int:
    """Write distance and change of height of jumps in one direction; return their number.

    A jump leads over a gap of one to three cells, by one block up or down.
    """
    if not _is_edge(codes, sizes, x, y, z, dx, dz):
        return 0
    count = 0
    is_high = (
        code_at(codes, sizes, x, y + 2, z) & code_at(codes, sizes, x + dx, y + 2, z + dz) & ROOM
    ) != 0
    is_deep = not _is_layer(code_at(codes, sizes, x + dx, y - 2, z + dz))
    is_deep = is_deep and not _bears(codes, sizes, x + dx, y - 2, z + dz)
    for far in range(2, FARTHEST_JUMP + 1):
        i, k = x + far * dx, z + far * dz
        above, head = code_at(codes, sizes, i, y + 2, k), code_at(codes, sizes, i, y + 1, k)
        ahead, below = code_at(codes, sizes, i, y, k), code_at(codes, sizes, i, y - 1, k)
        deep = code_at(codes, sizes, i, y - 2, k)
        is_room = head & ahead & ROOM != 0
        if is_high and is_room and (_bears(codes, sizes, i, y - 1, k) or _is_layer(below)):
            steps[2 * count], steps[2 * count + 1] = far, -1 if _is_layer(below) else 0
            return count + 1
        if is_high and head & ROOM and ahead & FLOOR and above & ROOM and far < FARTHEST_JUMP:
            is_held = _is_layer(ahead) or _bears(codes, sizes, i, y, k)
            if is_held and _rise(codes, sizes, x, y, z, ahead) <= _JUMP:
                steps[2 * count], steps[2 * count + 1] = far, 0 if _is_layer(ahead) else 1
                count += 1
            return count
        if (is_high or far == 2) and is_room and below & ROOM and is_deep:
            if _bears(codes, sizes, i, y - 2, k) or _is_layer(deep):
                steps[2 * count], steps[2 * count + 1] = far, -2 if _is_layer(deep) else -1
                count += 1
                is_deep = False
        elif not is_room:
            return count
        is_high = is_high and above & ROOM != 0
    return count


@inner
def feet_above(codes: Grid, sizes: Sizes, x: int, y: int, z: int) -> int:
    """Return the height of the feet above the lower face of a cell, negative on low blocks."""
    own, below = code_at(codes, sizes, x, y, z), code_at(codes, sizes, x, y - 1, z)
    if own & FLOOR or (own & ROOM and own >> TOP_SHIFT):
        return 0 if own & (LADDER | _WAYS | UNKNOWN) else own >> TOP_SHIFT
    if not below & FLOOR or _is_layer(below):
        return 0
    return (below >> TOP_SHIFT) - FULL


@inner
def step_cost(codes: Grid, sizes: Sizes, x: int, y: int, z: int, i: int, j: int, k: int) -> float:
    """Return the cost of a step or jump from one cell to another, never below its length.

    A step up, out of a liquid or into a door that must be opened takes longer.
    """
    across, up = (i - x) * (i - x) + (k - z) * (k - z), j - y
    cost = 2.0 if up == 1 and across == 1 else math.sqrt(across + up * up)
    if code_at(codes, sizes, x, y, z) & LIQUID:
        cost += 1.0
    if code_at(codes, sizes, i, j, k) & OPENS:
        cost += 1.0
    return cost


@compiled
def stands(codes: Grid, sizes: Sizes, x: int, y: int, z: int) -> bool:
    """Return True if a body can be in a cell; for callers that are no kernels."""
    return stands_at(codes, sizes, x, y, z)


@compiled
def feet_height(codes: Grid, sizes: Sizes, x: int, y: int, z: int) -> int:
    """Return the height of the feet in a cell, as `feet_above`; for callers that are no kernels."""
    return feet_above(codes, sizes, x, y, z)


@compiled
def write_neighbours(
    codes: Grid, sizes: Sizes, cells: Cells, sides: Sides, ups: Levels, doors: Flags
) -> None:
    """Write the changes of height of steps to neighbours that are at most one higher or lower.

    Args:
        codes: Codes of the grid.
        sizes: Number of cells along x, y, z.
        cells: Indices of the first cells (n, 3).
        sides: Changes of x and z (sides, 2), the four straight ones first, in a circle.
        ups: Change of height by cell and side (n, sides); `NOWHERE` if there is no step.
        doors: Whether a door must be opened, by cell and side (n, sides).
    """
    for n in range(len(cells)):
        x, y, z = int(cells[n, 0]), int(cells[n, 1]), int(cells[n, 2])
        for side in range(len(sides)):
            dx, dz = int(sides[side, 0]), int(sides[side, 1])
            level = landing(codes, sizes, x, y, z, dx, dz)
            if dx != 0 and dz != 0:
                if ups[n, side - 4] == NOWHERE or ups[n, (side - 3) % 4] == NOWHERE:
                    level = -1
                elif level < 0:
                    level = _steep(codes, sizes, x, y, z, dx, dz)
            ups[n, side] = level - y if level >= 0 and -1 <= level - y <= 1 else NOWHERE
            code = code_at(codes, sizes, x + dx, level, z + dz)
            doors[n, side] = ups[n, side] != NOWHERE and code & OPENS != 0


@inner
def _steep(codes: Grid, sizes: Sizes, x: int, y: int, z: int, dx: int, dz: int) -> int:
    """Return the height to which a diagonal step leads by one up or down; -1: nowhere."""
    i, k = x + dx, z + dz
    ahead, high = code_at(codes, sizes, i, y, k), code_at(codes, sizes, x, y + 2, z)
    is_up = ahead & FLOOR and not _is_layer(ahead)
    if is_up and _rise(codes, sizes, x, y, z, ahead) <= _JUMP and _clears(high):
        return y + 1 if stands_at(codes, sizes, i, y + 1, k) else -1
    is_down = _has_room(codes, sizes, i, y, k) and stands_at(codes, sizes, i, y - 1, k)
    return y - 1 if is_down else -1


@compiled
def write_standing(codes: Grid, sizes: Sizes, standing: Flags) -> None:
    """Write True for each cell of a grid in which a body can be (x, y, z)."""
    for x in range(sizes[0]):
        for y in range(sizes[1]):
            for z in range(sizes[2]):
                standing[x, y, z] = stands_at(codes, sizes, x, y, z)
