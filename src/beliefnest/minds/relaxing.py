"""Value iteration over the cells of one knowledge: compiled, in place, for many hypotheses."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from beliefnest.perception.rays import compiled

__all__ = ["relax", "sweep"]

Floats = npt.NDArray[np.float64]


def relax(
    values: Floats,
    inner: npt.NDArray[np.int32],
    mixes: Sequence[tuple[int, Floats, Sequence[tuple[int, Floats]]]],
    discount: float,
    step_cost: float,
) -> None:
    """Raise values to the fixed point of the Bellman equation, from below.

    Args:
        values: float64 (cells, hypotheses), what is to be had without a step inside; changed.
        inner: int32 (cells, steps), the cell that a step leads to for certain, or -1.
        mixes: Steps that keep the knowledge with a probability: the cell, the expected value
            (hypotheses,) of what leaves the knowledge, and cells with probabilities (hypotheses,).
        discount: Of one step.
        step_cost: Of one step.
    """
    if not len(values):
        return
    count = values.shape[1]
    starts = np.cumsum([0, *(len(within) for _, _, within in mixes)]).astype(np.int32)
    at = np.array([cell for cell, _, _ in mixes], dtype=np.int32)
    fixed = np.array([out for _, out, _ in mixes], dtype=np.float64).reshape(len(mixes), count)
    pairs = [pair for _, _, within in mixes for pair in within]
    to = np.array([cell for cell, _ in pairs], dtype=np.int32)
    shares = np.array([share for _, share in pairs], dtype=np.float64).reshape(len(pairs), count)
    tolerance = 1e-12 * (1 - discount)
    room = np.empty(count)
    sweep(values, inner, at, fixed, starts, to, shares, discount, step_cost, tolerance, room)


@compiled
def sweep(
    values: Floats,
    inner: npt.NDArray[np.int32],
    at: npt.NDArray[np.int32],
    fixed: Floats,
    starts: npt.NDArray[np.int32],
    to: npt.NDArray[np.int32],
    shares: Floats,
    discount: float,
    step_cost: float,
    tolerance: float,
    room: Floats,
) -> None:
    """Sweep to and fro over the cells (Gauss-Seidel) until nothing changes any more."""
    cells, count = values.shape
    sweep = 0
    changing = True
    while changing:
        changing = False
        for number in range(cells):
            cell = number if sweep % 2 == 0 else cells - 1 - number
            for step in range(inner.shape[1]):
                other = inner[cell, step]
                if other < 0 or other == cell:
                    continue
                excess = 0.0
                for h in range(count):
                    old = values[cell, h]
                    new = discount * values[other, h] - step_cost
                    better = max(old, new)
                    values[cell, h] = better
                    excess = max(excess, better - old - tolerance * max(1.0, abs(better)))
                if excess > 0.0:
                    changing = True
        for number in range(len(at)):
            for h in range(count):
                room[h] = fixed[number, h]
            for pair in range(starts[number], starts[number + 1]):
                for h in range(count):
                    room[h] += shares[pair, h] * values[to[pair], h]
            cell = at[number]
            for h in range(count):
                old = values[cell, h]
                better = max(old, discount * room[h] - step_cost)
                values[cell, h] = better
                if better - old > tolerance * max(1.0, abs(better)):
                    changing = True
        sweep += 1
