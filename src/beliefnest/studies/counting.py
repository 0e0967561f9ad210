"""Accuracies with intervals, and differences of pairs, from the rows of a study."""

import itertools
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from beliefnest.errors import InputError
from beliefnest.scenarios.judging import OUTCOMES
from beliefnest.scenarios.scoring import mean_interval, wilson_interval

__all__ = ["Pairs", "Row", "count_rows", "paired_rows"]

Row = Mapping[str, Any]
_Z95 = 1.959963984540054


def count_rows(
    rows: Sequence[Row], by: Sequence[str], means: Mapping[str, bool] | None = None
) -> list[dict[str, Any]]:
    """For each group of rows how many came out as expected, and how sure that is.

    Rows in which nothing was expected, or which have no result, are counted and not judged. Of a
    row and its copies (`copy_of`) one is counted; `copies` are those that are left out.

    Args:
        rows: Of a study.
        by: Columns that tell the groups apart.
        means: Columns whose means are told; True: of what is right alone.

    Returns:
        One mapping for each group, in the order in which they come: the columns of `by`; `rows`;
        `copies`; `judged`; `right`; `accuracy`, `low` and `high` (the 95 % interval of Wilson),
        None where none is judged; each outcome with its count; `tokens`, `cost` (None if not
        known); of each of `means` the mean, and its 95 % interval as `NAME_low`, `NAME_high`
        (None: no values).
    """
    groups: dict[tuple[Any, ...], list[tuple[Row, _Origin]]] = {}
    for row, origin in zip(rows, _origins(rows), strict=True):
        groups.setdefault(tuple(row.get(name) for name in by), []).append((row, origin))
    return [
        {**dict(zip(by, values, strict=True)), **_counted(group, means or {})}
        for values, group in groups.items()
    ]


_Origin = tuple[object, int]


def _origins(rows: Iterable[Row]) -> Iterator[_Origin]:
    """What tells rows apart: cell and place in it, of a copy those of what it is a copy of."""
    places: Counter[object] = Counter()
    for number, row in enumerate(rows):
        cell = row.get("cell", number)
        yield row.get("copy_of") or cell, places[cell]
        places[cell] += 1


def _counted(all_rows: Sequence[tuple[Row, _Origin]], means: Mapping[str, bool]) -> dict[str, Any]:
    firsts: dict[_Origin, Row] = {}
    for row, origin in all_rows:
        firsts.setdefault(origin, row)
    group = list(firsts.values())
    judged = [row["ok"] for row in group if row.get("ok") is not None]
    right = sum(judged)
    low, high = wilson_interval(right, len(judged)) if judged else (None, None)
    costs = [row.get("cost") for row, _ in all_rows if row["outcome"] != "error"]
    return {
        "rows": len(all_rows),
        "copies": len(all_rows) - len(group),
        "judged": len(judged),
        "right": right,
        "accuracy": right / len(judged) if judged else None,
        "low": low,
        "high": high,
        **{name: sum(row["outcome"] == name for row in group) for name in OUTCOMES},
        "tokens": sum(row.get("tokens") or 0 for row, _ in all_rows),
        "cost": None if None in costs else sum(cost or 0.0 for cost in costs),
        **_means(group, means),
    }


def _means(group: Sequence[Row], means: Mapping[str, bool]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, of_right in means.items():
        chosen = [row for row in group if row.get("ok") or not of_right]
        values = [row[name] for row in chosen if row.get(name) is not None]
        low, high = mean_interval(values)
        mean = sum(values) / len(values) if values else None
        found |= {name: mean, f"{name}_low": low, f"{name}_high": high}
    return found


@dataclass(frozen=True, slots=True)
class Pairs:
    """Two levels of one column, compared on what is the same otherwise.

    Attributes:
        one: A value of the column.
        other: Another one.
        pairs: Rows that both have a judged result for; copies of a pair are left out.
        both: Pairs that are right with both.
        only_one: Pairs that are right with `one` only.
        only_other: Pairs that are right with `other` only.
    """

    one: Any
    other: Any
    pairs: int
    both: int
    only_one: int
    only_other: int

    @property
    def difference(self) -> float:
        """Accuracy of `one` less that of `other`."""
        return (self.only_one - self.only_other) / self.pairs

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % interval of the difference.

        Source: Bonett and Price (2012), Wald's interval with one added to either kind of
        discordant pairs, which holds for few pairs too.
        """
        first = (self.only_one + 1) / (self.pairs + 2)
        second = (self.only_other + 1) / (self.pairs + 2)
        middle = first - second
        half = _Z95 * math.sqrt((first + second - middle**2) / (self.pairs + 2))
        return max(-1.0, middle - half), min(1.0, middle + half)

    @property
    def p(self) -> float:
        """How likely a difference as great is by chance: McNemar's exact test, two-sided."""
        discordant = self.only_one + self.only_other
        fewer = min(self.only_one, self.only_other)
        tail = sum(math.comb(discordant, k) for k in range(fewer + 1))
        return float(min(1.0, 2 * tail / 2**discordant))


def paired_rows(
    rows: Sequence[Row], column: str, identity: Sequence[str], same: Sequence[str] = ()
) -> list[Pairs]:
    """All pairs of levels of a column, on rows that are the same in all but it.

    Args:
        rows: Of a study.
        column: Whose values are compared.
        identity: Columns that say which row it is, and not what came of it.
        same: Those of them that say the same as the column in other words.

    Raises:
        InputError: The column is none of them.
    """
    if column not in identity:
        raise InputError(
            f"rows cannot be compared by {column!r}; columns are {', '.join(identity)}"
        )
    others = [name for name in identity if name not in (column, *same)]
    table: dict[tuple[Any, ...], dict[Any, tuple[_Origin, bool]]] = {}
    levels: dict[Any, None] = {}
    for row, origin in zip(rows, _origins(rows), strict=True):
        levels[row[column]] = None
        if row.get("ok") is not None:
            key = tuple(row.get(name) for name in others)
            table.setdefault(key, {})[row[column]] = (origin, row["ok"])
    every = (_pairs(table.values(), one, other) for one, other in itertools.combinations(levels, 2))
    return [pairs for pairs in every if pairs.pairs]


def _pairs(table: Iterable[Mapping[Any, tuple[_Origin, bool]]], one: Any, other: Any) -> Pairs:
    judged: dict[tuple[_Origin, _Origin], tuple[bool, bool]] = {}
    for each in table:
        if one in each and other in each:
            (first, a), (second, b) = each[one], each[other]
            judged[first, second] = (a, b)
    # A row and its own copy are no pair.
    found = [oks for (first, second), oks in judged.items() if first != second]
    return Pairs(
        one,
        other,
        len(found),
        sum(a and b for a, b in found),
        sum(a and not b for a, b in found),
        sum(b and not a for a, b in found),
    )
