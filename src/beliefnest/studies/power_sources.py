"""Sources of simulated variations: the plan of a study, or the results of one."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from beliefnest.errors import InputError
from beliefnest.studies.counting import Pairs, Row, judged_rows
from beliefnest.studies.power import AssumedRates, Resampled, VariationSource

SIZES = (10, 20, 40, 80, 160, 320)
"""Numbers of variations of simulated studies."""

NamedSource = tuple[str, VariationSource]
"""Source with the group of rows or the comparison that it stands for."""


def assumed_sources(
    rows: Sequence[Row], by: Sequence[str], assumed: Mapping[str, float], *, between: str | None
) -> Iterator[NamedSource]:
    """Yield a source for each number of rows that variations of a planned study have in a group.

    Args:
        rows: Planned rows.
        by: Columns that define the groups.
        assumed: `accuracy`, `difference` and `correlation` of `AssumedRates`.
        between: Column whose values are compared on the same variations; None: none.
    """
    counts: dict[tuple[Any, ...], Counter[str]] = {}
    for row in rows:
        group = tuple(row.get(name) for name in by)
        counts.setdefault(group, Counter())[row["variation"]] += 1
    # Variations of one group may differ, if combinations are invalid: take the usual number.
    sizes = {Counter(each.values()).most_common(1)[0][0] for each in counts.values()}
    for size in sorted(sizes):
        label = f"{size} row{'' if size == 1 else 's'} in each variation"
        if between is not None:
            label += f" and {between}"
        yield label, AssumedRates(**assumed, rows=size, pairs=0 if between is None else size)


def recorded_sources(
    rows: Sequence[Row],
    by: Sequence[str],
    compared: Sequence[tuple[Sequence[tuple[str, Any]], str, Pairs]],
) -> Iterator[NamedSource]:
    """Yield a source for each group of recorded rows, and for each comparison.

    Args:
        rows: Recorded rows.
        by: Columns that define the groups.
        compared: Groups, compared columns and pairs.

    Raises:
        InputError: No row is judged.
    """
    groups: dict[tuple[Any, ...], dict[str, list[bool]]] = {}
    for row in judged_rows(rows):
        group = tuple(row.get(name) for name in by)
        groups.setdefault(group, {}).setdefault(row["variation"], []).append(bool(row["ok"]))
    if not groups:
        raise InputError("no row is judged, so there is nothing to draw from; play the study first")
    for group, variations in groups.items():
        label = _told(list(zip(by, group, strict=True)))
        yield label, Resampled(tuple((tuple(own), ()) for own in variations.values()))
    for within, column, pairs in compared:
        label = ", ".join(filter(None, [_told(within), f"{column} {pairs.one} - {pairs.other}"]))
        yield label, Resampled(tuple(((), cluster) for cluster in pairs.clusters))


def _told(values: Sequence[tuple[str, Any]]) -> str:
    return ", ".join(f"{name} {'-' if value is None else value}" for name, value in values)
