"""Cells in which an agent can stand, and the steps between them, in all alternatives of a doubt.

A cell is walkable if it and the cell above are free and a known block below holds. Above
the box is air. Unknown cells are free but give no floor. Doors and gates that open by hand are
free, shut or open. Steps lead to a neighbour that is at most one higher or lower.
"""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from beliefnest.minds.stage import DIAGONALS, SIDES
from beliefnest.world.doors import is_doorway, is_open, moves_by_hand
from beliefnest.world.frames import BlockGrid
from beliefnest.world.registry import Registry
from beliefnest.world.values import Box, Position

__all__ = ["Ways", "walkable", "ways_from"]

Flags = npt.NDArray[np.bool_]


def walkable(registry: Registry, blocks: BlockGrid) -> Flags:
    """Return a mask of the cells of a grid in which an agent can stand."""
    states, places = np.unique(blocks, return_inverse=True)
    listed = [state < 0 or _lets_through(registry, state) for state in states.tolist()]
    free = np.array(listed, dtype=np.bool_)[places].reshape(blocks.shape)
    above = np.ones_like(free)
    above[:, :-1] = free[:, 1:]
    held = np.zeros_like(free)
    held[:, 1:] = ~free[:, :-1]
    stands: Flags = free & above & held
    return stands


def _lets_through(registry: Registry, state: int) -> bool:
    name = registry.name(state)
    if is_doorway(name) and (moves_by_hand(name) or is_open(registry, state)):
        return True
    return not registry.boxes(state)


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
    walks: Sequence[Flags],
    starts: Sequence[Position],
    *,
    diagonal: bool,
) -> Ways:
    """Return all cells that are reachable from some cells in at least one alternative.

    Args:
        box: The part of space.
        walks: Mask of walkable cells for each alternative; equal ones may share an array.
        starts: The first cells; they are listed even if they are not walkable.
        diagonal: True if steps also lead to diagonal neighbours, with both cells at the corner
            free.
    """
    anywhere = np.logical_or.reduce(walks)
    for start in starts:
        anywhere[box.index(start)] = True
    cells = np.argwhere(anywhere)
    number = np.full(box.shape, -1, dtype=np.int32)
    number[tuple(cells.T)] = np.arange(len(cells), dtype=np.int32)
    by_walk = {id(walk): _moves(walk, cells, number, diagonal) for walk in walks}
    found = _reached(list(by_walk.values()), [int(number[box.index(at)]) for at in starts])
    renumbered = np.full(len(cells), -1, dtype=np.int32)
    renumbered[found] = np.arange(len(found), dtype=np.int32)
    moves = np.stack([renumbered[by_walk[id(walk)][found]] for walk in walks])
    kept: list[list[int]] = (cells[found] + np.array(box.low)).tolist()
    return Ways(tuple((x, y, z) for x, y, z in kept), moves)


def _moves(
    walk: Flags, cells: npt.NDArray[np.int64], number: npt.NDArray[np.int32], diagonal: bool
) -> npt.NDArray[np.int32]:
    own = number[tuple(cells.T)]
    sides = [_step(walk, cells, number, own, side) for side in SIDES]
    if not diagonal:
        return np.stack(sides, axis=1)
    moves = list(sides)
    for dx, dz in DIAGONALS:
        to = _step(walk, cells, number, own, (dx, dz))
        beside = (sides[SIDES.index((dx, 0))], sides[SIDES.index((0, dz))])
        is_free = (beside[0] != own) & (beside[1] != own)
        moves.append(np.where(is_free, to, own))
    return np.stack(moves, axis=1)


def _step(
    walk: Flags,
    cells: npt.NDArray[np.int64],
    number: npt.NDArray[np.int32],
    own: npt.NDArray[np.int32],
    side: tuple[int, int],
) -> npt.NDArray[np.int32]:
    """Return the number of the cell to which a step to a side leads, from each cell."""
    to = own.copy()
    for up in (-1, 1, 0):
        aside = cells + np.array([side[0], up, side[1]])
        inside = ((aside >= 0) & (aside < np.array(walk.shape))).all(axis=1)
        at = np.flatnonzero(inside)
        at = at[walk[tuple(aside[at].T)]]
        to[at] = number[tuple(aside[at].T)]
    return to


def _reached(
    moves: Sequence[npt.NDArray[np.int32]], starts: Sequence[int]
) -> npt.NDArray[np.int64]:
    seen = np.zeros(len(moves[0]), dtype=np.bool_)
    front = np.array(starts, dtype=np.int64)
    while len(front):
        seen[front] = True
        ahead = np.unique(np.concatenate([each[front].reshape(-1) for each in moves]))
        front = ahead[~seen[ahead]].astype(np.int64)
    return np.flatnonzero(seen)
