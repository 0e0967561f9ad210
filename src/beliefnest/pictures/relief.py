"""Ground of a wide world from above, one value for each column."""

from collections.abc import Mapping

import msgspec
import numpy as np
import numpy.typing as npt
from numpy.lib.stride_tricks import sliding_window_view

from beliefnest.belief.view import State
from beliefnest.world.registry import Registry
from beliefnest.world.values import Box

WIDE = 64
"""Width or depth in blocks from which plans show the ground in place of one storey. The page has
the same limit (`web/src/run.js`)."""

NOWHERE, UNKNOWN = -2, -1
"""Values of `Relief.blocks` where there is only air, and where nothing is known."""

_NARROW = 16
"""Width in blocks from which what stands on the ground is itself ground, such as a plateau."""
_HIGH = 2
"""Least height in blocks of a wall above the ground."""
_DEEP = -(2**20)
"""Level of columns without a known block: lower than any other."""

_AIR = ("air", "cave_air", "void_air")

_Mask = npt.NDArray[np.bool_]
_Numbers = npt.NDArray[np.int32]

_CELLS = 4_000_000
"""Number of blocks that are looked at together."""

ReliefWindow = tuple[tuple[int, int], tuple[int, int]]
"""Lowest and highest x and z of a part of a box."""


class Relief(msgspec.Struct, frozen=True):
    """Highest known blocks of columns, up to some height.

    Attributes:
        names: Block state texts.
        blocks: int32 (columns along x, along z), numbers of `names`; `UNKNOWN` or `NOWHERE`.
        levels: int32, same shape, heights of these blocks.
        wrong: Columns in which a block is false: numbers along x and z, in order.
    """

    names: tuple[str, ...]
    blocks: npt.NDArray[np.int32]
    levels: npt.NDArray[np.int32]
    wrong: tuple[tuple[int, int], ...] = ()


def is_wide(box: Box) -> bool:
    """Return True if plans of a box show the ground."""
    return max(box.shape[0], box.shape[2]) >= WIDE


def read_relief(
    state: State, window: ReliefWindow, height: int, sights: Mapping[str, npt.NDArray[np.bool_]]
) -> tuple[Relief, Mapping[str, npt.NDArray[np.bool_]]]:
    """Return the ground of a state from a height downwards, and who sees which column of it.

    Args:
        state: State of a simulator.
        window: Part of the box.
        height: Greatest y that is looked at.
        sights: Blocks that agents see, by name of the agent; shape of the box.
    """
    registry, box, terrain = Registry.load(), state.box, state.blocks.terrain
    (x0, z0), (x1, z1) = window
    first, last = x0 - box.low[0], x1 - box.low[0] + 1
    top, near, far = height - box.low[1] + 1, z0 - box.low[2], z1 - box.low[2] + 1
    is_air = np.zeros(registry.states + 1, dtype=np.bool_)
    is_air[registry.states_of(_AIR)] = True
    # -1, unknown, indexes the last place.
    is_air[-1] = True
    # A part of the columns at a time: all blocks of a large box would need much memory.
    step = max(1, _CELLS // max(1, top * (far - near)))
    columns = []
    for start in range(first, last, step):
        cut = (slice(start, min(start + step, last)), slice(0, top), slice(near, far))
        grid = terrain.cut((cut[0].start, 0, near), (cut[0].stop, top, far))
        columns.append(_columns(grid, is_air, {name: mask[cut] for name, mask in sights.items()}))
    tops, layers, empty = (np.concatenate([each[n] for each in columns]) for n in range(3))
    numbers, which = np.unique(tops, return_inverse=True)
    blocks = np.where(empty < 0, empty, which.reshape(tops.shape)).astype(np.int32)
    seen = {name: np.concatenate([each[3][name] for each in columns]) for name in sights}
    names = tuple("air" if n < 0 else registry.text(n) for n in numbers.tolist())
    return Relief(names, blocks, (layers + box.low[1]).astype(np.int32)), seen


def standing_columns(relief: Relief, height: int) -> _Mask:
    """Return the columns of walls and pillars, and the outlines of houses.

    They rise above a known neighbour, and above their surroundings: the white top-hat transform
    (Serra, 1982), which removes what holds a square of `_NARROW` blocks, such as hills.

    Args:
        relief: The relief.
        height: Greatest y of it. What reaches it may go on above and need not be `_HIGH`.
    """
    levels = np.where(relief.blocks >= 0, relief.levels, _DEEP)
    ground = np.pad(levels, _NARROW - 1, constant_values=_DEEP)
    for axis in (0, 1):
        ground = sliding_window_view(ground, _NARROW, axis).min(axis=-1)
    for axis in (0, 1):
        ground = sliding_window_view(ground, _NARROW, axis).max(axis=-1)
    # An unknown neighbour may be as high.
    beside = np.pad(np.where(relief.blocks == UNKNOWN, -_DEEP, levels), 1, constant_values=-_DEEP)
    # Diagonal neighbours count: walls may cross.
    lowest = sliding_window_view(beside, (3, 3)).min(axis=(-2, -1))
    least = np.where(levels == height, 1, _HIGH)
    stand: _Mask = (relief.blocks >= 0) & (levels - np.maximum(ground, lowest) >= least)
    return stand


def _columns(
    grid: npt.NDArray[np.int32], is_air: _Mask, sights: Mapping[str, _Mask]
) -> tuple[_Numbers, npt.NDArray[np.intp], _Numbers, Mapping[str, _Mask]]:
    """Return the highest blocks of columns, their layers, and who sees them.

    Args:
        grid: Block state ids (x, y, z).
        is_air: By state, True for air; the last entry is for unknown.
        sights: Blocks that agents see, by name of the agent; shape of the grid.

    Returns:
        Block state ids; layers; `UNKNOWN` or `NOWHERE` where all is air or unknown, else 0; and
        masks by name of the agent. All are arrays (x, z).
    """
    solid = ~is_air[grid]
    layers = grid.shape[1] - 1 - np.argmax(solid[:, ::-1], axis=1)
    tops = np.take_along_axis(grid, layers[:, None], axis=1)[:, 0]
    has = solid.any(axis=1)
    empty = np.where(has, 0, np.where((grid < 0).any(axis=1), UNKNOWN, NOWHERE))
    seen = {
        name: np.where(
            has, np.take_along_axis(mask, layers[:, None], axis=1)[:, 0], mask.any(axis=1)
        )
        for name, mask in sights.items()
    }
    return tops, layers, empty.astype(np.int32), seen
