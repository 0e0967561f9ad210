"""What a kind of study puts into its table."""

from collections.abc import Callable, Iterable, Iterator, Mapping
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
        further_groups: Columns that are further ones of them where they have several values.
        compared: Columns whose values the page compares in pairs.
        apart: Columns that tell groups apart, in each of which pairs are compared anew, where
            nothing else is asked for.
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
    further_groups: tuple[str, ...]
    compared: tuple[str, ...]
    apart: tuple[str, ...]
    shown: tuple[str, ...]
    same: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    means: Mapping[str, bool] = field(default_factory=dict)

    def names(self, varied: Iterable[str]) -> tuple[str, ...]:
        """Return names of all columns, with those of what varies."""
        return (*self.first, *varied, *self.columns)
