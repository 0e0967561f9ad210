"""Cells in which an agent can stand, and the steps between them, in all alternatives of a doubt.

`geometry` has the rules. Above the box is air. Unknown cells are free but give no floor. Doors and
gates that open by hand are open. Steps lead to a neighbour that is at most one higher or lower.

A box of one chunk is prepared as a whole. In a larger one a flood visits only the cells that an
agent can reach.
"""

from collections.abc import Sequence
from functools import cached_property

import numpy as np
import numpy.typing as npt

from beliefnest.geometry.bodies import ROOM, BodyCodes, Doorways, body_codes
from beliefnest.minds.stage import DIAGONALS, SIDES
from beliefnest.world.array_types import Cells, Flags
from beliefnest.world.registry import Registry
from beliefnest.world.terrain import Terrain
from beliefnest.world.values import Box, Position

_MARGIN = (1, 2, 1)
"""Cells around a dense box, so that every neighbour of a cell has an index."""
_BELOW, _ABOVE, _ASIDE = 2, 3, 2
"""Greatest distances, in cells, at which a step to a neighbour looks at cells."""

_AT_ONCE = 4096
"""Number of cells whose steps are computed together."""


def bodies_in(registry: Registry, states: npt.NDArray[np.int32]) -> BodyCodes:
    """Return what block states, -1 unknown, are to a body, as in `geometry.bodies`."""
    codes: BodyCodes = body_codes(registry, Doorways.BY_HAND, guesses=False)[states + 1]
    return codes


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
        from beliefnest.geometry.steps import stands

        codes, sizes, places = self._around(cells)
        inside = _inside(cells, self.blocks.shape)
        are_standable = [bool(stands(codes, sizes, *place)) for place in places.tolist()]
        mask: Flags = np.array(are_standable, dtype=np.bool_).reshape(-1) & inside
        return mask

    def steps(self, cells: Cells, *, diagonal: bool) -> tuple[Cells, Flags]:
        """Return the cells (n, steps, 3) to which steps lead, and which of them open a door.

        A step that leads nowhere leads to its own cell.
        """
        from beliefnest.geometry.steps import NOWHERE, write_neighbours

        sides = np.array([*SIDES, *(DIAGONALS if diagonal else ())], dtype=np.int64)
        ups = np.zeros((len(cells), len(sides)), dtype=np.int8)
        doors = np.zeros(ups.shape, dtype=np.bool_)
        write_neighbours(*self._around(cells), sides, ups, doors)
        ahead = np.stack(np.broadcast_arrays(sides[:, 0], ups, sides[:, 1]), axis=2).astype(
            np.int64
        )
        ahead[ups == NOWHERE] = 0
        to = cells[:, None] + ahead
        # Feet are inside the box.
        outside = to[:, :, 1] >= self.blocks.shape[1]
        return np.where(outside[:, :, None], cells[:, None], to), doors & ~outside

    @cached_property
    def mask(self) -> Flags:
        """All cells of the box; only of a box of one chunk."""
        from beliefnest.geometry.steps import write_standing

        codes, sizes = self._whole
        standing = np.zeros(sizes, dtype=np.bool_)
        write_standing(codes, sizes, standing)
        x, y, z = _MARGIN
        part: Flags = standing[x:-x, y:-y, z:-z]
        return part

    @cached_property
    def _whole(self) -> tuple[BodyCodes, tuple[int, int, int]]:
        """Codes of the box with its margin, and its sizes; only of a box of one chunk."""
        codes = np.pad(
            bodies_in(self._registry, self.blocks.dense()), [(part, part) for part in _MARGIN]
        )
        x, y, z = _MARGIN
        codes[x:-x, -y, z:-z] = ROOM
        return codes.reshape(-1), codes.shape

    def _around(self, cells: Cells) -> tuple[BodyCodes, tuple[int, int, int], Cells]:
        """Return the codes of a grid that holds some cells with their neighbours, and their places.

        In a box of many chunks the grid is a row of the cells' surroundings.
        """
        if self.blocks.is_dense:
            return (*self._whole, cells + np.array(_MARGIN))
        shape = np.array(self.blocks.shape)
        sides, levels = range(-_ASIDE, _ASIDE + 1), range(-_BELOW, _ABOVE + 1)
        near = np.stack(np.meshgrid(sides, levels, sides, indexing="ij"), -1)
        places = (cells[:, None, None, None] + near).reshape(-1, 3)
        inside_places = np.clip(places, 0, shape - 1)
        codes = bodies_in(self._registry, self.blocks.at_indices(inside_places))
        aside = (inside_places[:, ::2] != places[:, ::2]).any(axis=1)
        codes[aside | (places[:, 1] < 0) | (places[:, 1] > shape[1])] = 0
        codes[~aside & (places[:, 1] == shape[1])] = ROOM
        at = np.full((len(cells), 3), (_ASIDE, _BELOW, _ASIDE))
        at[:, 0] += len(sides) * np.arange(len(cells))
        return codes, (len(sides) * len(cells), len(levels), len(sides)), at


class Ways:
    """Reachable cells, and the destinations of steps in each alternative.

    Attributes:
        cells: The cells, in order of position.
        moves: int32 (alternatives, cells, steps), as in `Stage`.
        doors: bool (alternatives, cells, steps), as in `Stage`.
    """

    def __init__(
        self, cells: tuple[Position, ...], moves: npt.NDArray[np.int32], doors: Flags
    ) -> None:
        self.cells, self.moves, self.doors = cells, moves, doors


def ways_from(
    box: Box, floors: Sequence[Floor], starts: Sequence[Position], *, diagonal: bool, most: int
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
    made = {id(floor): _moves(floor, cells, diagonal=diagonal) for floor in distinct}
    by_floor = {key: np.searchsorted(cells, to) for key, (to, _) in made.items()}
    reached = _reached(list(by_floor.values()), np.searchsorted(cells, first))
    renumbered = np.full(len(cells), -1, dtype=np.int32)
    renumbered[reached] = np.arange(len(reached), dtype=np.int32)
    moves = np.stack([renumbered[by_floor[id(floor)][reached]] for floor in floors])
    doors = np.stack([made[id(floor)][1][reached] for floor in floors])
    kept: list[list[int]] = (_indices(cells[reached], box.shape) + np.array(box.low)).tolist()
    return Ways(tuple((x, y, z) for x, y, z in kept), moves, doors)


def _flooded(floors: Sequence[Floor], starts: Cells, most: int, *, diagonal: bool) -> Cells | None:
    """Return the numbers of the cells that are reachable from some cells, in order.

    None: there are more than `most`.
    """
    seen, front = set(starts.tolist()), starts
    while len(front):
        moves = [_moves(floor, front, diagonal=diagonal)[0] for floor in floors]
        ahead = [cell for cell in np.unique(np.stack(moves)).tolist() if cell not in seen]
        seen.update(ahead)
        if len(seen) > most:
            return None
        front = np.array(ahead, dtype=np.int64)
    return np.sort(np.fromiter(seen, dtype=np.int64, count=len(seen)))


def _moves(floor: Floor, cells: Cells, *, diagonal: bool) -> tuple[Cells, Flags]:
    """Return the numbers (n, steps) of the cells to which steps lead from cells of some numbers.

    Also return which of the steps open a door.
    """
    shape = floor.blocks.shape
    parts = [
        floor.steps(_indices(cells[start : start + _AT_ONCE], shape), diagonal=diagonal)
        for start in range(0, len(cells), _AT_ONCE)
    ]
    to = np.concatenate([part[0] for part in parts])
    numbers = np.ravel_multi_index((to[..., 0], to[..., 1], to[..., 2]), shape)
    return numbers.astype(np.int64), np.concatenate([part[1] for part in parts])


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
