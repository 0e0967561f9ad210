"""Value iteration over the cells of one knowledge: compiled, in place, for many hypotheses.

A label-correcting search: when the values of a cell have risen, a queue collects its predecessors,
because only their values can rise next. The fixed point is that of sweeps over all cells.
"""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from beliefnest.perception.compiling import compiled, inner
from beliefnest.world.array_types import Floats

_WIDTH = 64
"""Number of hypotheses processed at a time, so that their values fit the processor's cache."""


def relax(
    values: Floats,
    steps: npt.NDArray[np.int32],
    mixes: Sequence[tuple[int, Floats, Sequence[tuple[int, Floats]]]],
    discount: float,
    step_cost: float,
    start: float,
) -> None:
    """Raise values to the fixed point of the Bellman equation, from below.

    Args:
        values: float64 (cells, hypotheses), best values without a step inside; changed in place.
        steps: int32 (cells, steps), the cell to which a step certainly leads, or -1.
        mixes: Steps that keep the knowledge with a probability: the cell, the expected value
            (hypotheses,) of leaving the knowledge, and cells with probabilities (hypotheses,).
        discount: Discount of one step.
        step_cost: Cost of one step.
        start: Value of staying forever, the smallest value: no step to a cell with this value pays.
    """
    count = values.shape[1]
    starts = np.cumsum([0, *(len(within) for _, _, within in mixes)]).astype(np.int32)
    at = np.array([cell for cell, _, _ in mixes], dtype=np.int32)
    fixed = np.array([out for _, out, _ in mixes], dtype=np.float64).reshape(len(mixes), count)
    pairs = [pair for _, _, within in mixes for pair in within]
    to = np.array([cell for cell, _ in pairs], dtype=np.int32)
    shares = np.array([share for _, share in pairs], dtype=np.float64).reshape(len(pairs), count)
    first, before = _predecessors(steps)
    mixed = (at, fixed, starts, to, shares, np.empty(_WIDTH))
    queue, waits = np.empty(len(values), dtype=np.int32), np.zeros(len(values), dtype=np.bool_)
    rules = (discount, step_cost, 1e-12 * (1 - discount))
    for left in range(0, count, _WIDTH):
        columns = (left, min(left + _WIDTH, count))
        raise_values(values, columns, first, before, mixed, rules, start, queue, waits)


def _predecessors(
    steps: npt.NDArray[np.int32],
) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.int32]]:
    """Return the predecessors of all cells: the start of each list, and the joined lists."""
    cells = np.broadcast_to(np.arange(len(steps), dtype=np.int32)[:, None], steps.shape)
    there = (steps >= 0) & (steps != cells)
    order = np.argsort(steps[there], kind="stable")
    first = np.searchsorted(steps[there][order], np.arange(len(steps) + 1)).astype(np.int32)
    return first, cells[there][order]


@compiled
def raise_values(
    values: Floats,
    columns: tuple[int, int],
    first: npt.NDArray[np.int32],
    before: npt.NDArray[np.int32],
    mixed: "_Mixed",
    rules: tuple[float, float, float],
    start: float,
    queue: npt.NDArray[np.int32],
    waits: npt.NDArray[np.bool_],
) -> None:
    """Raise values in some columns until no step improves one by more than the tolerance."""
    at = mixed[0]
    head, length = 0, 0
    for cell in range(len(values)):
        if _is_above(values, cell, columns, start):
            queue[length] = cell
            length += 1
            waits[cell] = True
    while length > 0:
        while length > 0:
            other = queue[head]
            head = (head + 1) % len(queue)
            length -= 1
            waits[other] = False
            for number in range(first[other], first[other + 1]):
                cell = before[number]
                if _rises(values, cell, other, columns, rules) and not waits[cell]:
                    waits[cell] = True
                    queue[(head + length) % len(queue)] = cell
                    length += 1
        for number in range(len(at)):
            if _rises_by_mix(values, number, columns, mixed, rules) and not waits[at[number]]:
                waits[at[number]] = True
                queue[(head + length) % len(queue)] = at[number]
                length += 1


_Mixed = tuple[
    npt.NDArray[np.int32], Floats, npt.NDArray[np.int32], npt.NDArray[np.int32], Floats, Floats
]
"""Cells, fixed parts, starts of the lists of pairs, cells and shares of pairs, working space."""


@inner
def _is_above(values: Floats, cell: int, columns: tuple[int, int], start: float) -> bool:
    above = False
    for h in range(columns[0], columns[1]):
        above |= values[cell, h] > start
    return above


@inner
def _rises(
    values: Floats,
    cell: int,
    other: int,
    columns: tuple[int, int],
    rules: tuple[float, float, float],
) -> bool:
    """Raise the values of a cell by a step to another; return True if any rose."""
    discount, step_cost, _ = rules
    rises = 0
    # Two loops; often the first one suffices. LLVM uses vector instructions for each.
    for h in range(columns[0], columns[1]):
        rises |= int(discount * values[other, h] - step_cost > values[cell, h])
    if rises:
        for h in range(columns[0], columns[1]):
            values[cell, h] = max(values[cell, h], discount * values[other, h] - step_cost)
    return rises != 0


@inner
def _rises_by_mix(
    values: Floats,
    number: int,
    columns: tuple[int, int],
    mixed: _Mixed,
    rules: tuple[float, float, float],
) -> bool:
    """Raise the values of a cell by a step that keeps the knowledge with a probability."""
    at, fixed, starts, to, shares, room = mixed
    discount, step_cost, tolerance = rules
    left, right = columns
    for h in range(left, right):
        room[h - left] = fixed[number, h]
    for pair in range(starts[number], starts[number + 1]):
        for h in range(left, right):
            room[h - left] += shares[pair, h] * values[to[pair], h]
    cell = at[number]
    rises = False
    for h in range(left, right):
        old = values[cell, h]
        better = max(old, discount * room[h - left] - step_cost)
        values[cell, h] = better
        rises |= better - old > tolerance * max(1.0, abs(better))
    return rises
