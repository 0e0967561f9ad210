"""Numbers as short texts, and blocks of grids as such texts.

A number is written in base 32, the lowest digit first; a digit that is followed by a further one of
the same number is raised by 32. Each of these 64 values is one character, so that texts are short
and compress well. Source maps of JavaScript use the same idea ("base 64 VLQ"). The page reads them
in `web/src/runs.js`.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

AS_FIRST, UNKNOWN, FIRST_STATE = 0, 1, 2
"""Marks of runs: the block that reality had there at first, an unknown block, block number 0."""

_DIGITS = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_"
_BITS = 5
_SAME = -2
"""Value in place of a block that is the same as at first."""
_ALPHABET = np.frombuffer(_DIGITS, dtype=np.uint8)


def numbers_text(numbers: Sequence[int] | npt.NDArray[np.int64]) -> str:
    """Return numbers, none of them negative, as a text."""
    values = np.asarray(numbers, dtype=np.int64)
    if not len(values):
        return ""
    most = max(1, -(-int(values.max()).bit_length() // _BITS))
    shifted = values[:, None] >> (_BITS * np.arange(most + 1))
    digits, follows = shifted[:, :-1] & (2**_BITS - 1), shifted[:, 1:] > 0
    used = np.ones(digits.shape, dtype=np.bool_)
    used[:, 1:] = follows[:, :-1]
    codes = digits + 2**_BITS * follows
    letters: bytes = _ALPHABET[codes[used]].tobytes()
    return letters.decode("ascii")


def runs_text(
    cells: npt.NDArray[np.int64],
    states: npt.NDArray[np.int16],
    first: npt.NDArray[np.int16] | None,
    number_of: Callable[[int], int],
) -> str:
    """Return blocks at some cells as a text.

    Neighbouring cells with the same mark are a run: the number of cells since the last run; twice
    the length, plus 1 if the mark is not `AS_FIRST`; and then the mark, less 1.

    Args:
        cells: Flat cells, rising.
        states: The block of each; -1 unknown.
        first: The blocks that reality had there at first; None: each run has its block.
        number_of: Function that returns the page's number of a block.
    """
    if not len(cells):
        return ""
    begins = np.ones(len(cells), dtype=np.bool_)
    if first is None:
        begins[1:] = (np.diff(cells) != 1) | (states[1:] != states[:-1])
        same = np.zeros(len(cells), dtype=np.bool_)
    else:
        same = states == first
        apart = np.where(same, _SAME, states)
        begins[1:] = (np.diff(cells) != 1) | (apart[1:] != apart[:-1])
    starts = np.flatnonzero(begins)
    lengths = np.diff(starts, append=len(cells))
    return _text(cells[starts], lengths, states[starts], same[starts], number_of)


class Runs(NamedTuple):
    """Runs of equal blocks of a grid, in order.

    Attributes:
        starts: First cell of each.
        lengths: Number of cells of each.
        states: Block of each; -1 unknown.
    """

    starts: npt.NDArray[np.int64]
    lengths: npt.NDArray[np.int64]
    states: npt.NDArray[np.int16]


def grid_runs(states: npt.NDArray[np.int16], first: npt.NDArray[np.int16] | None) -> Runs:
    """Return the runs of a part of a grid, without cells that have their first block.

    Cells are counted from its first one.

    Args:
        states: The block of each cell; -1 unknown.
        first: The blocks that reality had there at first; None: all cells count.
    """
    apart = states if first is None else np.where(states == first, _SAME, states)
    starts = np.append(0, np.flatnonzero(apart[1:] != apart[:-1]) + 1)
    lengths = np.diff(starts, append=len(states))
    is_sent = apart[starts] != _SAME
    starts, lengths = starts[is_sent], lengths[is_sent]
    return Runs(starts, lengths, states[starts])


def joined(parts: Sequence[Runs]) -> Runs:
    """Return the runs of a grid from those of its parts, in order."""
    starts, lengths, states = (
        np.concatenate([each[at] for each in parts]) for at in range(len(Runs._fields))
    )
    begins = np.ones(len(starts), dtype=np.bool_)
    begins[1:] = (starts[1:] != starts[:-1] + lengths[:-1]) | (states[1:] != states[:-1])
    first = np.flatnonzero(begins)
    if len(first) == len(starts):
        return Runs(starts, lengths, states)
    return Runs(starts[first], np.add.reduceat(lengths, first), states[first])


def grid_text(runs: Runs, number_of: Callable[[int], int]) -> str:
    """Return the runs of a grid as `runs_text` does.

    Args:
        runs: The runs.
        number_of: As for `runs_text`.
    """
    same = np.zeros(len(runs.starts), dtype=np.bool_)
    return _text(*runs, same, number_of)


def _text(
    starts: npt.NDArray[np.int64],
    lengths: npt.NDArray[np.int64],
    states: npt.NDArray[np.int16],
    same: npt.NDArray[np.bool_],
    number_of: Callable[[int], int],
) -> str:
    """Return runs as a text: first cell, length and block of each, and if it has `AS_FIRST`."""
    if not len(starts):
        return ""
    distinct, which = np.unique(states, return_inverse=True)
    marks = np.array([UNKNOWN if s < 0 else FIRST_STATE + number_of(s) for s in distinct.tolist()])
    gaps = np.diff(starts, prepend=0)
    gaps[1:] -= lengths[:-1]
    numbers = np.stack([gaps, 2 * lengths + ~same, marks[which] - 1], axis=1)
    used = np.ones(numbers.shape, dtype=np.bool_)
    used[:, 2] = ~same
    return numbers_text(numbers[used])
