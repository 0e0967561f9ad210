"""Form of the table of a kind of study."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from beliefnest.studies.study_folder import StudyFolder

__all__ = ["Table"]


@dataclass(frozen=True, slots=True)
class Table:
    """Form of a table.

    Attributes:
        rows: Function that yields the rows of a folder's cells, for a plan.
        first: Columns before those of variations, and their types.
        columns: Other columns, and their types.
        identity: Columns that identify a row, besides those of variations.
        groups: Default columns by which summaries group rows.
        further_groups: Columns that are added to `groups` if they have several values.
        compared: Columns whose values the page compares in pairs.
        apart: Default columns that define the groups of comparisons.
        shown: Columns that the page shows after `first` and those of variations.
        same: Columns that carry the same information. Rows that are compared by one of them may
            differ in the others.
        means: Columns whose means are in summaries; True: means over successes only.
    """

    rows: Callable[[StudyFolder, Mapping[str, Any]], Iterator[dict[str, Any]]]
    first: Mapping[str, str]
    columns: Mapping[str, str]
    identity: tuple[str, ...]
    groups: tuple[str, ...]
    further_groups: tuple[str, ...]
    compared: tuple[str, ...]
    apart: tuple[str, ...]
    shown: tuple[str, ...]
    same: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    means: Mapping[str, bool] = field(default_factory=dict)

    def names(self, varied: Iterable[str]) -> tuple[str, ...]:
        """Return the names of all columns, including those of variations."""
        return (*self.first, *varied, *self.columns)
