"""Checks of the rows of a regression: what they cannot determine, in words."""

import itertools
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from beliefnest.studies.counting import Row
from beliefnest.world.array_types import Floats
from beliefnest.world.words import counted

FEWEST = 3
"""Least number of variations from which an error between variations can be estimated."""

ColumnNames = tuple[str, ...]
"""Name of a column, or names of columns that interact."""


def level_of(row: Row, name: str) -> str:
    """Return the level of a row, as text."""
    value = row.get(name)
    return "-" if value is None else str(value)


def rows_fault(rows: Sequence[Row], names: Sequence[str]) -> str:
    """Return what prevents any regression on some columns; empty: nothing."""
    if not rows:
        return "no row is judged"
    if len({bool(row["ok"]) for row in rows}) == 1:
        side = "right" if rows[0]["ok"] else "wrong"
        return f"all {len(rows)} judged rows are {side}, so that there is nothing to explain"
    for name in names:
        levels = {level_of(row, name) for row in rows}
        if len(levels) == 1:
            return f"{name} is {levels.pop()} in all judged rows; leave it out"
    return ""


def support_fault(
    rows: Sequence[Row],
    effects: Sequence[ColumnNames],
    design: Floats,
    groups: Any,
    terms: Sequence[str],
) -> str:
    """Return which coefficients rest on too few variations; empty: none.

    Args:
        rows: Judged rows.
        effects: Columns, alone or interacting.
        design: Design matrix of full rank.
        groups: Number of the variation of each row.
        terms: Names of the columns of the design matrix.
    """
    total = int(groups.max()) + 1
    if total < FEWEST:
        return f"the judged rows have {counted(total, 'variation')}; at least {FEWEST} are needed"
    for names, values, own in _cells(rows, effects):
        variations = len({rows[number]["variation"] for number in own})
        if variations < FEWEST:
            return (
                f"{_told(names, values)} has judged rows of {counted(variations, 'variation')}; an "
                f"error between variations needs at least {FEWEST}"
            )
    whole = design.T @ design
    for number in range(total):
        own = design[groups == number]
        rest = whole - own.T @ own
        if np.linalg.matrix_rank(rest, hermitian=True) < len(terms):
            _, vectors = np.linalg.eigh(rest)
            lost = [each for each, at in zip(terms, vectors[:, 0], strict=True) if abs(at) > 1e-6]
            return f"{', '.join(lost)} cannot be told apart without the rows of a single variation"
    return ""


def certainty_fault(right: Floats, design: Floats) -> str:
    """Return that the effects leave no error to estimate; empty: they leave some."""
    patterns, codes = np.unique(design, axis=0, return_inverse=True)
    shares = np.bincount(codes.ravel(), right) / np.bincount(codes.ravel())
    if ((shares > 0) & (shares < 1)).any() or len(patterns) > design.shape[1]:
        return ""
    return "the effects explain every answer, so that there is no error to estimate"


def one_sided_level(rows: Sequence[Row], effects: Sequence[ColumnNames], right: Floats) -> str:
    """Return which level, or combination of levels, has right or wrong rows only; empty: none."""
    for names, values, own in _cells(rows, effects):
        sides = {float(right[number]) for number in own}
        if len(sides) == 1:
            side = "right" if sides == {1.0} else "wrong"
            return f"all {counted(len(own), 'row')} with {_told(names, values)} are {side}"
    return ""


def separation_fault(
    rows: Sequence[Row],
    effects: Sequence[ColumnNames],
    right: Floats,
    design: Floats,
    terms: Sequence[str],
) -> str:
    """Return which log odds have no finite estimate; empty: all have one.

    Rows are separated, or quasi-separated, if a linear combination of the design's columns is
    nowhere on the wrong side and somewhere on the right one. A linear program finds it (Konis,
    2007).
    """
    endless = _endless(right, design)
    if not endless:
        return ""
    if level := one_sided_level(rows, effects, right):
        return f"{level} (separation), so that its log odds have no finite estimate"
    return (
        "the levels of the effects predict some rows without an error (quasi-separation), so that "
        f"the log odds of {', '.join(terms[number] for number in endless)} have no finite estimate"
    )


def _endless(right: Floats, design: Floats) -> list[int]:
    """Return the numbers of the columns whose coefficients may grow without bound."""
    from scipy.optimize import linprog

    patterns, codes = np.unique(design, axis=0, return_inverse=True)
    shares = np.bincount(codes.ravel(), right) / np.bincount(codes.ravel())
    both = (shares > 0) & (shares < 1)
    sides = np.where(shares == 1, 1.0, -1.0)[:, None] * patterns
    equal = {"A_eq": patterns[both], "b_eq": np.zeros(both.sum())} if both.any() else {}
    if both.all():
        return []
    limits = {"A_ub": -sides[~both], "b_ub": np.zeros((~both).sum()), "bounds": (-1, 1)}
    if linprog(-sides[~both].sum(axis=0), **limits, **equal).fun > -1e-7:
        return []
    endless = []
    for number in range(design.shape[1]):
        aim = np.zeros(design.shape[1])
        aim[number] = 1.0
        if any(linprog(sign * aim, **limits, **equal).fun < -1e-7 for sign in (1, -1)):
            endless.append(number)
    return endless


def _cells(
    rows: Sequence[Row], effects: Sequence[ColumnNames]
) -> Iterator[tuple[ColumnNames, tuple[str, ...], list[int]]]:
    """Yield each combination of levels of each effect, and of the columns in it."""
    every = itertools.chain.from_iterable(
        itertools.combinations(names, size)
        for names in effects
        for size in range(1, len(names) + 1)
    )
    for names in sorted(dict.fromkeys(every), key=len):
        cells: dict[tuple[str, ...], list[int]] = {}
        for number, row in enumerate(rows):
            cells.setdefault(tuple(level_of(row, name) for name in names), []).append(number)
        for values, own in cells.items():
            yield names, values, own


def _told(names: ColumnNames, values: Sequence[str]) -> str:
    return " and ".join(f"{name} {value}" for name, value in zip(names, values, strict=True))
