"""Accuracies with intervals, and paired differences, computed from the rows of a study."""

import itertools
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import msgspec

from beliefnest.errors import InputError
from beliefnest.scenarios.judging import OUTCOMES
from beliefnest.scenarios.scoring import wilson_interval
from beliefnest.studies.allocation import PARTICIPANT
from beliefnest.studies.clusters import (
    FEWEST,
    crossed_interval,
    exchange_p,
    mean_interval,
    rate_interval,
)
from beliefnest.studies.guessing import mean_chance

Row = Mapping[str, Any]
_Z95 = 1.959963984540054


def count_rows(
    rows: Sequence[Row], by: Sequence[str], means: Mapping[str, bool] | None = None
) -> list[dict[str, Any]]:
    """Count the right rows of each group, and compute their accuracy with its interval.

    Rows without expectations are counted but not judged; rows without an answer or a result are
    judged as not right. A row and its copies
    (`copy_of`) count as one row; `copies` is the number of rows left out. Intervals are clustered
    by the column `variation`; a row without it is a cluster of its own. If people answered, they
    are clustered by the column `participant`, too.

    Args:
        rows: Rows of a study.
        by: Columns that define the groups.
        means: Columns to average; True: over right rows only.

    Returns:
        One mapping for each group, in order of appearance: the columns of `by`; `rows`; `copies`;
        `judged`; `variations` (number of independent variations among the judged rows); `right`;
        `accuracy`, `low` and `high` (its 95 % interval) and `interval` (its method, see
        `rate_interval` and `crossed_interval`), all None if no row is judged; `chance`
        (accuracy of blind guesses; None if some judged row is no choice of options); the count of
        each outcome; `tokens`; `cost` (None if not known); for each column of `means`, its mean,
        and the 95 % interval as `NAME_low` and `NAME_high` (None if fewer than two variations have
        a value).
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
    """Yield the identity of each row: its cell and place in it; for a copy, the original's."""
    places: Counter[object] = Counter()
    for number, row in enumerate(rows):
        cell = row.get("cell", number)
        yield row.get("copy_of") or cell, places[cell]
        places[cell] += 1


def judged_rows(rows: Sequence[Row]) -> list[Row]:
    """Return the rows with a verdict, each without its copies."""
    firsts: dict[_Origin, Row] = {}
    for row, origin in zip(rows, _origins(rows), strict=True):
        if row.get("ok") is not None:
            firsts.setdefault(origin, row)
    return list(firsts.values())


def _counted(all_rows: Sequence[tuple[Row, _Origin]], means: Mapping[str, bool]) -> dict[str, Any]:
    firsts: dict[_Origin, Row] = {}
    for row, origin in all_rows:
        firsts.setdefault(origin, row)
    judged = _clusters(firsts, "ok")
    count, right = sum(map(len, judged)), sum(map(sum, judged))
    low, high, interval = _interval(firsts) if judged else (None, None, None)
    # Rows of cells without a result have no tokens.
    costs = [row.get("cost") for row, _ in all_rows if row.get("tokens") is not None]
    return {
        "rows": len(all_rows),
        "copies": len(all_rows) - len(firsts),
        "judged": count,
        "variations": len(judged),
        "right": right,
        "accuracy": right / count if judged else None,
        "low": low,
        "high": high,
        "interval": interval,
        "chance": mean_chance([row for row in firsts.values() if row.get("ok") is not None]),
        **{name: sum(row["outcome"] == name for row in firsts.values()) for name in OUTCOMES},
        "tokens": sum(row.get("tokens") or 0 for row, _ in all_rows),
        "cost": None if None in costs else sum(cost or 0.0 for cost in costs),
        **_means(firsts, means),
    }


def _interval(rows: Mapping[_Origin, Row]) -> tuple[float, float, str]:
    """Return the interval of the share of right rows, and its method."""
    judged = {origin: row for origin, row in rows.items() if row.get("ok") is not None}
    people = [_people(row) for row in judged.values()]
    if not any(people):
        return rate_interval(_clusters(judged, "ok"))
    variations = [_variation(row, origin) for origin, row in judged.items()]
    values = [row["ok"] for row in judged.values()]
    bounds, count = crossed_interval(values, variations, people)
    if bounds is None:
        return *wilson_interval(sum(values) / len(values) * count, count), "wilson"
    return *bounds, "two-way bootstrap"


def _clusters(rows: Mapping[_Origin, Row], column: str) -> list[list[Any]]:
    """Group the known values of a column by variation."""
    clusters: dict[object, list[Any]] = {}
    for origin, row in rows.items():
        if row.get(column) is not None:
            clusters.setdefault(_variation(row, origin), []).append(row[column])
    return list(clusters.values())


def _variation(row: Row, origin: _Origin) -> object:
    return row.get("variation") or origin


def _people(*rows: Row) -> frozenset[object]:
    """Return the people who gave some rows."""
    return frozenset(row[PARTICIPANT] for row in rows if row.get(PARTICIPANT) is not None)


def _means(rows: Mapping[_Origin, Row], means: Mapping[str, bool]) -> dict[str, Any]:
    columns: dict[str, Any] = {}
    for name, of_right in means.items():
        chosen = {key: row for key, row in rows.items() if row.get("ok") or not of_right}
        clusters = _clusters(chosen, name)
        low, high = mean_interval(clusters)
        count = sum(map(len, clusters))
        mean = sum(map(sum, clusters)) / count if clusters else None
        columns |= {name: mean, f"{name}_low": low, f"{name}_high": high}
    return columns


class Pairs(msgspec.Struct, frozen=True):
    """Two levels of one column, compared on rows that are the same otherwise.

    Attributes:
        one: A value of the column.
        other: Another value of the column.
        clusters: Pairs of each independent variation. A pair is (True if right with `one`, True
            if right with `other`). Copies of a pair are left out.
        people: People of each pair, in the same form; empty: no pair has any.
    """

    one: Any
    other: Any
    clusters: tuple[tuple[tuple[bool, bool], ...], ...]
    people: tuple[tuple[frozenset[object], ...], ...] = ()

    @property
    def variations(self) -> int:
        """Number of independent variations."""
        return len(self.clusters)

    @property
    def pairs(self) -> int:
        """Number of pairs of rows."""
        return sum(map(len, self.clusters))

    @property
    def both(self) -> int:
        """Number of pairs that are right with both levels."""
        return self._count(True, True)

    @property
    def only_one(self) -> int:
        """Number of pairs that are right with `one` only."""
        return self._count(True, False)

    @property
    def only_other(self) -> int:
        """Number of pairs that are right with `other` only."""
        return self._count(False, True)

    def _count(self, one: bool, other: bool) -> int:
        return sum(cluster.count((one, other)) for cluster in self.clusters)

    @property
    def difference(self) -> float:
        """Accuracy with `one` minus accuracy with `other`."""
        return (self.only_one - self.only_other) / self.pairs

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % interval of the difference.

        With one pair in each variation, the method is that of Bonett and Price (2012): Wald's
        interval after adding one to both counts of discordant pairs, which is valid for few pairs
        too. With several pairs, it is the cluster bootstrap. If all variations have the same
        difference, or there are fewer than `FEWEST`, the method is Bonett and Price's for as many
        pairs as there are variations. With people in pairs, it is the pigeonhole bootstrap
        over variations and people.
        """
        differences = [[one - other for one, other in cluster] for cluster in self.clusters]
        if any(person for cluster in self.people for person in cluster):
            bounds, count = self._crossed(differences)
            return self._after_adding(count) if bounds is None else bounds
        if self.variations >= FEWEST and any(len(cluster) > 1 for cluster in differences):
            low, high = mean_interval(differences)
            if low is not None and high is not None:
                return low, high
        return self._after_adding(self.variations)

    def _crossed(
        self, differences: Sequence[Sequence[int]]
    ) -> tuple[tuple[float, float] | None, int]:
        """Return the interval over variations and people, see `crossed_interval`."""
        numbers = [number for number, each in enumerate(differences) for _ in each]
        values = [value for each in differences for value in each]
        return crossed_interval(values, numbers, [each for own in self.people for each in own])

    def _after_adding(self, count: int) -> tuple[float, float]:
        """Return the interval of Bonett and Price for a number of independent pairs."""
        first = (self.only_one * count / self.pairs + 1) / (count + 2)
        second = (self.only_other * count / self.pairs + 1) / (count + 2)
        middle = first - second
        half = _Z95 * math.sqrt((first + second - middle**2) / (count + 2))
        return max(-1.0, middle - half), min(1.0, middle + half)

    @property
    def p(self) -> float:
        """Probability of at least this difference by chance: `exchange_p` of the variations."""
        return exchange_p([sum(one - other for one, other in each) for each in self.clusters])


def paired_rows(
    rows: Sequence[Row], column: str, identity: Sequence[str], same: Sequence[str] = ()
) -> list[Pairs]:
    """Pair rows that are the same in all but one column, for any two levels of that column.

    Args:
        rows: Rows of a study.
        column: Column whose levels are compared.
        identity: Columns that identify a row, as opposed to its results. Rows of people are
            paired with the rows of all other people, and with those of models.
        same: Columns of `identity` that carry the same information as `column`.

    Raises:
        InputError: The column is not in `identity`.
    """
    if column not in identity:
        raise InputError(
            f"rows cannot be compared by {column!r}; columns are {', '.join(identity)}"
        )
    others = [name for name in identity if name not in (column, PARTICIPANT, *same)]
    table: dict[tuple[Any, ...], dict[Any, list[tuple[Row, _Origin]]]] = {}
    levels: dict[Any, None] = {}
    for row, origin in zip(rows, _origins(rows), strict=True):
        levels[row[column]] = None
        if row.get("ok") is not None:
            key = tuple(row.get(name) for name in others)
            table.setdefault(key, {}).setdefault(row[column], []).append((row, origin))
    every = (_pairs(table.values(), one, other) for one, other in itertools.combinations(levels, 2))
    return [pairs for pairs in every if pairs.clusters]


def _pairs(
    table: Iterable[Mapping[Any, Sequence[tuple[Row, _Origin]]]], one: Any, other: Any
) -> Pairs:
    rows_of_pair: dict[tuple[_Origin, _Origin], tuple[Row, Row]] = {}
    for each in table:
        # Several rows differ by participant only.
        for (first, a), (second, b) in itertools.product(each.get(one, ()), each.get(other, ())):
            # A row does not form a pair with its own copy.
            if a != b:
                rows_of_pair[a, b] = (first, second)
    clusters: dict[tuple[object, object], list[tuple[bool, bool]]] = {}
    people: dict[tuple[object, object], list[frozenset[object]]] = {}
    for (a, b), (first, second) in rows_of_pair.items():
        # If the column is part of the variation, the two rows belong to two variations.
        cluster = _variation(first, a), _variation(second, b)
        clusters.setdefault(cluster, []).append((first["ok"], second["ok"]))
        people.setdefault(cluster, []).append(_people(first, second))
    return Pairs(
        one, other, tuple(map(tuple, clusters.values())), tuple(map(tuple, people.values()))
    )
