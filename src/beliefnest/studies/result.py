"""What a study has come to: tables, intervals, a figure, a page."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from beliefnest.errors import InputError
from beliefnest.studies.checking import checked_columns
from beliefnest.studies.counting import Pairs, count_rows, paired_rows
from beliefnest.studies.episode_rows import EPISODES
from beliefnest.studies.plainframe import Typed, plain_frame, write_typed
from beliefnest.studies.rows import PROBES, variation_columns
from beliefnest.studies.store import StudyFolder
from beliefnest.studies.table import Table

if TYPE_CHECKING:  # Extras, imported when they are asked for.
    import pandas
    from matplotlib.figure import Figure

__all__ = ["StudyResult"]

_COMPARED = (
    *("one", "other", "pairs", "variations", "both", "only_one", "only_other", "difference"),
)
"""What `differences` tells of `Pairs`, in columns of the same names."""


@dataclass(frozen=True)
class StudyResult:
    """What the folder of a study holds.

    Attributes:
        folder: The folder.
    """

    folder: StudyFolder

    @classmethod
    def read(cls, path: str | Path) -> "StudyResult":
        """The result in a folder, of a study that has ended or not; InputError if there is none."""
        result = cls(StudyFolder.existing(path))
        # What is no study is told of here, not at its first use.
        result.folder.plan()
        return result

    def __repr__(self) -> str:
        tried = sum(self.folder.cell(cell["name"]) is not None for cell in self._plan["cells"])
        return f"<study in {self.folder.path}: {tried} of {len(self._plan['cells'])} cells>"

    @cached_property
    def _plan(self) -> dict[str, Any]:
        return self.folder.plan()

    @cached_property
    def table(self) -> Table:
        """The form of `frame`: of episodes, or of scenarios' probes."""
        return EPISODES if "tasks" in self._plan else PROBES

    @cached_property
    def rows(self) -> list[dict[str, Any]]:
        """The rows of `frame` as plain values."""
        return list(self.table.rows(self.folder, self._plan))

    @property
    def invalid(self) -> list[dict[str, Any]]:
        """Combinations that make no scenario, and why."""
        return list(self._plan["invalid"])

    @property
    def plan(self) -> dict[str, Any]:
        """What was planned last, as plain values."""
        return dict(self._plan)

    def frame(self) -> "pandas.DataFrame":
        """Return one row for each probe of each cell, or each episode, in the order of the plan.

        The same study gives the same rows, however many jobs it ran with. Wall times, which are
        not the same twice, are in `seconds`. Types are pandas's plain ones, see `plain_frame`.

        Raises:
            MissingExtraError: pandas is not installed.
        """
        return plain_frame(self._typed())

    def _typed(self) -> dict[str, Typed]:
        table = self.table
        kinds = {
            **table.first,
            **dict.fromkeys(variation_columns(self._plan)),
            **table.columns,
        }
        return {
            name: Typed([row.get(name) for row in self.rows], kind) for name, kind in kinds.items()
        }

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns of `frame`."""
        return self.table.names(variation_columns(self._plan))

    @property
    def groups(self) -> tuple[str, ...]:
        """The columns that summaries are made by where nothing else is asked for."""
        table = self.table
        return (*table.groups, *self._several(table.further_groups))

    def _several(self, columns: Iterable[str]) -> tuple[str, ...]:
        """Choose the columns that have several values."""
        return tuple(name for name in columns if len({row.get(name) for row in self.rows}) > 1)

    def summary(self, by: Sequence[str] | str | None = None) -> "pandas.DataFrame":
        """Return for each group its accuracy with a 95 % interval, and counts of all outcomes.

        Rows of one variation are not independent. So the interval is that of Wilson where each
        variation has one row in the group, and otherwise that of the cluster bootstrap over
        variations; the column `interval` says which, `variations` how many there are. Of episodes
        there are also means with their 95 % intervals, by the same bootstrap.

        `accuracy` is of what was judged: rows with the outcome `error` are counted, not judged.

        Args:
            by: Columns of `frame` that tell the groups apart; None: `groups`.

        Raises:
            InputError: There is no such column.
            MissingExtraError: pandas is not installed.
        """
        names = self._columns(self.groups if by is None else by)
        counted = self.counted(names)
        columns = counted[0] if counted else names
        return plain_frame({name: Typed([row[name] for row in counted]) for name in columns})

    def counted(self, by: Sequence[str]) -> list[dict[str, Any]]:
        """Return the rows of `summary` as plain values."""
        return count_rows(self.rows, by, self.table.means)

    def paired(self, between: str, by: Sequence[str] = ()) -> list[tuple[tuple[Any, ...], Pairs]]:
        """Return the rows of `differences` as values: those of `by`, and what is compared.

        Raises:
            InputError: Rows are not told apart by the column.
        """
        table = self.table
        identity = [*table.identity, *variation_columns(self._plan)]
        groups: dict[tuple[Any, ...], list[dict[str, Any]]] = {}
        for row in self.rows:
            groups.setdefault(tuple(row.get(name) for name in by), []).append(row)
        return [
            (values, pairs)
            for values, rows in groups.items()
            for pairs in paired_rows(rows, between, identity, table.same.get(between, ()))
        ]

    def apart(self, between: str) -> tuple[str, ...]:
        """The columns in whose groups a column is compared where nothing else is asked for."""
        same = (between, *self.table.same.get(between, ()))
        return self._several(name for name in self.table.apart if name not in same)

    def differences(
        self, between: str, by: Sequence[str] | str | None = None
    ) -> "pandas.DataFrame":
        """Return paired differences of accuracy between the values of a column.

        Pairs are rows that are the same in scenario, condition, variation, model, template, repeat
        and probe, but for that column; or in task, instance, repeat and player. Intervals and
        tests take variations, and not pairs, for independent.

        Args:
            between: Such as `model` or `condition`.
            by: Columns that tell groups apart, in each of which it is done anew; None: model,
                template and order of the question, or of episodes the player, as far as there
                are several and they are not what is compared; an empty list: one comparison.

        Returns:
            For each two values: those of `by`; `one`, `other`; `pairs`, the independent
            `variations` among them, how many pairs are right with `both` or one of them; the
            `difference`, `low` and `high` (95 %: Bonett and Price with one pair in each variation,
            else the cluster bootstrap); `p` (exact permutation of the levels within variations;
            with one pair in each, McNemar's exact test).

        Raises:
            InputError: There is no such column, or no two rows differ in it alone.
            MissingExtraError: pandas is not installed.
        """
        self._columns(between)
        names = self._columns(self.apart(between) if by is None else by)
        compared = self.paired(between, names)
        levels = list(dict.fromkeys(row[between] for row in self.rows))
        if len(levels) > 1 and not compared:
            raise InputError(
                f"no two rows differ in {between!r} alone, which is {levels[0]!r}, {levels[1]!r}"
            )
        found = [
            {
                **dict(zip(names, values, strict=True)),
                **{name: getattr(pairs, name) for name in _COMPARED},
                "low": pairs.interval[0],
                "high": pairs.interval[1],
                "p": pairs.p,
            }
            for values, pairs in compared
        ]
        columns = [*names, *_COMPARED, "low", "high", "p"]
        return plain_frame({name: Typed([row[name] for row in found]) for name in columns})

    def seconds(self) -> "pandas.DataFrame":
        """Wall time of each cell, as far as it is known: `cell`, `seconds`."""
        noted = self.folder.seconds()
        cells = [cell["name"] for cell in self._plan["cells"] if cell["name"] in noted]
        times = [noted[name] for name in cells]
        return plain_frame({"cell": Typed(cells), "wall_seconds": Typed(times)})

    def plot(
        self,
        by: Sequence[str] | str | None = None,
        size: tuple[float, float] | None = None,
    ) -> "Figure":
        """Draw accuracies with their intervals, as `summary` computes them.

        The first column is drawn along the axis, the others by colour.

        Args:
            by: The columns; None: condition and model, or of episodes task and policy.
            size: Width and height in millimetres; None: as the bars and texts need.

        Raises:
            InputError: There is no such column.
            MissingExtraError: matplotlib is not installed.
        """
        from beliefnest.studies.plot import plot_accuracy

        names = self._columns(self.table.groups[-2:] if by is None else by)
        if not names:
            raise InputError("by is empty; name at least one column to draw along")
        return plot_accuracy(count_rows(self.rows, names), names, size)

    def write_page(self, file: str | Path, by: Sequence[str] | str | None = None) -> Path:
        """Write all of it as one HTML page that needs no network; `by` as for `summary`.

        Raises:
            InputError: There is no such column, or the file cannot be written.
        """
        from beliefnest.studies.page import page_text

        path = Path(file)
        text = page_text(self, self._columns(self.groups if by is None else by))
        try:
            path.write_text(text, encoding="utf-8")
        except OSError as error:
            raise InputError(f"{path} cannot be written: {error.strerror}") from None
        return path

    def write_tables(self) -> tuple[Path, Path]:
        """Write `rows.csv` and `rows.parquet` into the folder, with the type of each column.

        In the CSV file an apostrophe stands before texts that a spreadsheet would compute.
        """
        csv, parquet = self.folder.path / "rows.csv", self.folder.path / "rows.parquet"
        write_typed(self._typed(), csv, parquet)
        return csv, parquet

    def _columns(self, names: Sequence[str] | str) -> list[str]:
        return checked_columns(names, self.columns)
