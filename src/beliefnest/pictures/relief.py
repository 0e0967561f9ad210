"""Ground of a wide world from above, one value for each column."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from beliefnest.belief.view import State
from beliefnest.world.registry import Registry
from beliefnest.world.values import Box

__all__ = ["NOWHERE", "UNKNOWN", "Relief", "Window", "is_wide", "read_relief"]

WIDE = 64
"""Width or depth in blocks from which plans show the ground in place of one storey. The page has
the same limit (`web/src/run.js`)."""

NOWHERE, UNKNOWN = -2, -1
"""Values of `Relief.blocks` where there is only air, and where nothing is known."""

_AIR = ("air", "cave_air", "void_air")

Window = tuple[tuple[int, int], tuple[int, int]]
"""Lowest and highest x and z of a part of a box."""


@dataclass(frozen=True)
class Relief:
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
    state: State, window: Window, height: int, sights: Mapping[str, npt.NDArray[np.bool_]]
) -> tuple[Relief, Mapping[str, npt.NDArray[np.bool_]]]:
    """Return the ground of a state from a height downwards, and who sees which column of it.

    Args:
        state: State of a simulator.
        window: Part of the box.
        height: Greatest y that is looked at.
        sights: Blocks that agents see, by name of the agent; shape of the box.
    """
    registry, box = Registry.load(), state.box
    (x0, z0), (x1, z1) = window
    cut = (
        slice(x0 - box.low[0], x1 - box.low[0] + 1),
        slice(0, height - box.low[1] + 1),
        slice(z0 - box.low[2], z1 - box.low[2] + 1),
    )
    grid = state.blocks.grid[cut]
    is_air = np.zeros(registry.states + 1, dtype=np.bool_)
    for name in _AIR:
        ids = registry.state_ids(name)
        is_air[ids.start : ids.stop] = True
    # -1, unknown, indexes the last place.
    is_air[-1] = True
    solid = ~is_air[grid]
    depth = np.argmax(solid[:, ::-1], axis=1)
    layers = grid.shape[1] - 1 - depth
    found = np.take_along_axis(grid, layers[:, None], axis=1)[:, 0]
    numbers, which = np.unique(found, return_inverse=True)
    blocks = which.reshape(found.shape).astype(np.int32)
    has = solid.any(axis=1)
    blocks[~has] = np.where((grid < 0).any(axis=1), UNKNOWN, NOWHERE)[~has]
    seen = {
        name: np.where(
            has, np.take_along_axis(mask[cut], layers[:, None], axis=1)[:, 0], mask[cut].any(axis=1)
        )
        for name, mask in sights.items()
    }
    names = tuple("air" if n < 0 else registry.text(n) for n in numbers.tolist())
    return Relief(names, blocks, (layers + box.low[1]).astype(np.int32)), seen
