"""What a kind of study puts into its table."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from beliefnest.studies.store import StudyFolder

__all__ = ["Table"]


@dataclass(frozen=True, slots=True)
class Table:
    """The form of a table.

    Attributes:
        rows: Gives the rows that the cells of a folder come to, for a plan.
        first: Columns before those of variations, and their types.
        columns: The other columns, and their types.
        identity: Columns, besides those of variations, that say which row it is, and not what
            came of it.
        groups: What summaries are made by where nothing else is asked for.
        further_group: A column that is one more of them where it has several values.
        compared: Columns whose values the page compares in pairs.
        shown: Columns that the page shows after `first` and those of variations.
        same: Columns that say the same in other words: what is compared by one of them is the
            same in all but these.
        means: Columns whose means are in summaries; True: those of successes alone.
    """

    rows: Callable[[StudyFolder, Mapping[str, Any]], Iterator[dict[str, Any]]]
    first: Mapping[str, str]
    columns: Mapping[str, str]
    identity: tuple[str, ...]
    groups: tuple[str, ...]
    further_group: str
    compared: tuple[str, ...]
    shown: tuple[str, ...]
    same: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    means: Mapping[str, bool] = field(default_factory=dict)
