"""Cells in which an agent can stand, and the steps between them, in all alternatives of a doubt.

A cell is walkable if it and the cell above are free and a known block below holds. Above
the box is air. Unknown cells are free but give no floor. Doors and gates that open by hand are
free, shut or open. Steps lead to a neighbour that is at most one higher or lower.

A box of one chunk is prepared as a whole. In a larger one a flood visits only the cells that an
agent can reach.
"""

from collections.abc import Sequence
from functools import cached_property, lru_cache

import numpy as np
import numpy.typing as npt

from beliefnest.minds.stage import DIAGONALS, SIDES
from beliefnest.world.doors import is_doorway, is_open, moves_by_hand
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box, Position

__all__ = ["Floor", "Ways", "let_through", "ways_from"]

Flags = npt.NDArray[np.bool_]
Cells = npt.NDArray[np.int64]
"""Indices of cells, shape (n, 3), or their numbers in a dense array, shape (n,)."""

_HEIGHTS = (0, 1, -1)
"""Changes of height of a step; the first one that leads to a walkable cell counts."""

_AT_ONCE = 4096
"""Number of cells whose steps are computed together."""


@lru_cache(maxsize=1)
def _passing(registry: Registry) -> Flags:
    """Return by state, counted from -1, True for blocks through which a body passes."""
    sizes = np.diff(registry.shape_start)[registry.state_shape]
    passes = np.concatenate([[True], sizes == 0])
    for name in filter(is_doorway, registry.block_names):
        ids = registry.state_ids(name)
        opens = [moves_by_hand(name) or bool(is_open(registry, state)) for state in ids]
        passes[ids.start + 1 : ids.stop + 1] |= opens
    return passes


def let_through(registry: Registry, states: npt.NDArray[np.int32]) -> Flags:
    """Return a mask of the block states through which a body passes, walking or opening doors."""
    passes: Flags = _passing(registry)[states + 1]
    return passes


class Floor:
    """Cells of one alternative in which an agent can stand.

    Args:
        registry: Names and shapes of blocks.
        blocks: Block states, -1 unknown.
    """

    def __init__(self, registry: Registry, blocks: Terrain) -> None:
        self._registry, self.blocks = registry, blocks

    def stands(self, cells: Cells) -> Flags:
        """Return a mask of those of some cells (n, 3), inside or outside the box."""
        shape = self.blocks.shape
        found = np.zeros(len(cells), dtype=np.bool_)
        if self.blocks.is_dense:
            at = np.flatnonzero(_inside(cells, shape))
            found[at] = self.mask[tuple(cells[at].T)]
            return found
        # Nothing holds a body in the lowest layer of the box.
        at = np.flatnonzero(_inside(cells, shape) & (cells[:, 1] > 0))
        columns = cells[at, None] + np.array([(0, -1, 0), (0, 0, 0), (0, 1, 0)])
        # Above the box is air, as the free cell below it.
        columns[:, 2, 1] = np.minimum(columns[:, 2, 1], shape[1] - 1)
        states = self.blocks.at_indices(columns.reshape(-1, 3))
        below, own, above = let_through(self._registry, states).reshape(-1, 3).T
        found[at] = ~below & own & above
        return found

    @cached_property
    def mask(self) -> Flags:
        """All cells of the box; only of a box of one chunk."""
        free = let_through(self._registry, self.blocks.dense())
        above = np.ones_like(free)
        above[:, :-1] = free[:, 1:]
        held = np.zeros_like(free)
        held[:, 1:] = ~free[:, :-1]
        stands: Flags = free & above & held
        return stands


class Ways:
    """Reachable cells, and the destinations of steps in each alternative.

    Attributes:
        cells: The cells, in order of position.
        moves: int32 (alternatives, cells, steps), as in `Stage`.
    """

    def __init__(self, cells: tuple[Position, ...], moves: npt.NDArray[np.int32]) -> None:
        self.cells, self.moves = cells, moves


def ways_from(
    box: Box,
    floors: Sequence[Floor],
    starts: Sequence[Position],
    *,
    diagonal: bool,
    most: int,
) -> Ways | None:
    """Return all cells that are reachable from some cells in at least one alternative.

    None: there are too many.

    Args:
        box: The part of space.
        floors: The floor of each alternative; equal ones may be one object.
        starts: The first cells; they are listed even if they are not walkable.
        diagonal: True if steps also lead to diagonal neighbours, with both cells at the corner
            free.
        most: Greatest number of cells that a flood visits.
    """
    distinct = list({id(floor): floor for floor in floors}.values())
    first = np.unique(np.ravel_multi_index(np.array([box.index(at) for at in starts]).T, box.shape))
    cells: Cells | None
    if floors[0].blocks.is_dense:
        standing = np.logical_or.reduce([floor.mask for floor in distinct])
        cells = np.union1d(np.flatnonzero(standing), first)
    else:
        cells = _flooded(distinct, first, most, diagonal=diagonal)
        if cells is None:
            return None
    by_floor = {
        id(floor): np.searchsorted(cells, _moves(floor, cells, diagonal=diagonal))
        for floor in distinct
    }
    found = _reached(list(by_floor.values()), np.searchsorted(cells, first))
    renumbered = np.full(len(cells), -1, dtype=np.int32)
    renumbered[found] = np.arange(len(found), dtype=np.int32)
    moves = np.stack([renumbered[by_floor[id(floor)][found]] for floor in floors])
    kept: list[list[int]] = (_indices(cells[found], box.shape) + np.array(box.low)).tolist()
    return Ways(tuple((x, y, z) for x, y, z in kept), moves)


def _flooded(floors: Sequence[Floor], starts: Cells, most: int, *, diagonal: bool) -> Cells | None:
    """Return the numbers of the cells that are reachable from some cells, in order.

    None: there are more than `most`.
    """
    seen, front = set(starts.tolist()), starts
    while len(front):
        moves = [_moves(floor, front, diagonal=diagonal) for floor in floors]
        ahead = [cell for cell in np.unique(np.stack(moves)).tolist() if cell not in seen]
        seen.update(ahead)
        if len(seen) > most:
            return None
        front = np.array(ahead, dtype=np.int64)
    return np.sort(np.fromiter(seen, dtype=np.int64, count=len(seen)))


def _moves(floor: Floor, cells: Cells, *, diagonal: bool) -> Cells:
    """Return the numbers (n, steps) of the cells to which steps lead from cells of some numbers."""
    parts = [cells[start : start + _AT_ONCE] for start in range(0, len(cells), _AT_ONCE)]
    return np.concatenate([_steps(floor, part, diagonal=diagonal) for part in parts])


def _steps(floor: Floor, cells: Cells, *, diagonal: bool) -> Cells:
    shape = floor.blocks.shape
    sides = np.array([*SIDES, *(DIAGONALS if diagonal else ())])
    offsets = np.array([[(x, up, z) for up in _HEIGHTS] for x, z in sides.tolist()])
    aside = (_indices(cells, shape)[:, None, None] + offsets).reshape(-1, 3)
    stands = floor.stands(aside).reshape(-1, len(sides), len(_HEIGHTS))
    chosen = stands.argmax(axis=2)
    ahead = np.arange(len(aside)).reshape(stands.shape)[..., 0] + chosen
    is_free = stands.max(axis=2)
    for number, (dx, dz) in enumerate(DIAGONALS if diagonal else (), len(SIDES)):
        is_free[:, number] &= is_free[:, SIDES.index((dx, 0))] & is_free[:, SIDES.index((0, dz))]
    to = np.broadcast_to(cells[:, None], is_free.shape).copy()
    to[is_free] = np.ravel_multi_index(aside[ahead[is_free]].T, shape)
    return to


def _reached(moves: Sequence[npt.NDArray[np.int64]], starts: Cells) -> Cells:
    seen = np.zeros(len(moves[0]), dtype=np.bool_)
    front = starts
    while len(front):
        seen[front] = True
        ahead = np.unique(np.concatenate([each[front].reshape(-1) for each in moves]))
        front = ahead[~seen[ahead]]
    return np.flatnonzero(seen)


def _inside(cells: Cells, shape: tuple[int, int, int]) -> Flags:
    inside: Flags = np.logical_and.reduce((cells >= 0) & (cells < np.array(shape)), axis=1)
    return inside


def _indices(numbers: Cells, shape: tuple[int, int, int]) -> Cells:
    """Return the indices (n, 3) of the cells with some numbers in a dense array."""
    return np.stack(np.unravel_index(numbers, shape), axis=1)
