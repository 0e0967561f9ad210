"""What a study has come to: tables, intervals, a figure, a page."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from beliefnest.errors import InputError, MissingExtraError
from beliefnest.studies.checking import several
from beliefnest.studies.counting import Pairs, count_rows, paired_rows
from beliefnest.studies.episode_rows import EPISODES
from beliefnest.studies.rows import PROBES, variation_columns
from beliefnest.studies.store import StudyFolder
from beliefnest.studies.table import Table

if TYPE_CHECKING:  # Extras, imported when they are asked for.
    import pandas
    from matplotlib.figure import Figure

__all__ = ["StudyResult"]

_DIFFERENCES = (
    *("one", "other", "pairs", "both", "only_one", "only_other"),
    *("difference", "low", "high", "p"),
)
"""Columns of `differences`, also where there is no pair."""


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
        """One row for each probe of each cell, or each episode, in the order of the plan.

        The same study gives the same rows, however many jobs it ran with. Wall times, which are
        not the same twice, are in `seconds`.

        Raises:
            MissingExtraError: pandas is not installed.
        """
        return _frame(self.rows, self.table, variation_columns(self._plan))

    @property
    def groups(self) -> tuple[str, ...]:
        """The columns that summaries are made by where nothing else is asked for."""
        table = self.table
        several = len({row[table.further_group] for row in self.rows}) > 1
        return (*table.groups, table.further_group) if several else table.groups

    def summary(self, by: Sequence[str] | str | None = None) -> "pandas.DataFrame":
        """For each group its accuracy with the 95 % interval of Wilson, and all outcomes' counts.

        Of episodes also means with their 95 % intervals, by the bootstrap.

        `accuracy` is of what was judged: rows with the outcome `error` are counted, not judged.

        Args:
            by: Columns of `frame` that tell the groups apart; None: `groups`.

        Raises:
            InputError: There is no such column.
            MissingExtraError: pandas is not installed.
        """
        names = self._columns(self.groups if by is None else by)
        return _pandas().DataFrame.from_records(self.counted(names))

    def counted(self, by: Sequence[str]) -> list[dict[str, Any]]:
        """The rows of `summary` as plain values."""
        return count_rows(self.rows, by, self.table.means)

    def paired(self, between: str, by: Sequence[str] = ()) -> list[tuple[tuple[Any, ...], Pairs]]:
        """The rows of `differences` as values: those of `by`, and what is compared.

        Raises:
            InputError: Rows are not told apart by the column.
        """
        table = self.table
        identity = [*table.identity, *variation_columns(self._plan)]
        groups: dict[tuple[Any, ...], list[dict[str, Any]]] = {}
        for row in self.rows:
            groups.setdefault(tuple(row[name] for name in by), []).append(row)
        return [
            (values, pairs)
            for values, rows in groups.items()
            for pairs in paired_rows(rows, between, identity, table.same.get(between, ()))
        ]

    def differences(self, between: str, by: Sequence[str] | str = ()) -> "pandas.DataFrame":
        """Paired differences of accuracy between the values of a column.

        Pairs are rows that are the same in scenario, condition, variation, model, template, repeat
        and probe, but for that column; or in task, instance, repeat and who plays.

        Args:
            between: Such as `model` or `condition`.
            by: Columns that tell groups apart, such as `task`, in each of which it is done anew.

        Returns:
            For each two values: those of `by`; `one`, `other`; `pairs`, how many are right with
            `both` or one of them, the `difference`, `low` and `high` (95 %, Bonett and Price), `p`
            (McNemar, exact).

        Raises:
            InputError: There is no such column, or no two rows differ in it alone.
            MissingExtraError: pandas is not installed.
        """
        self._columns(between)
        names = self._columns(by)
        compared = self.paired(between, names)
        levels = list(dict.fromkeys(row[between] for row in self.rows))
        if len(levels) > 1 and not compared:
            raise InputError(
                f"no two rows differ in {between!r} alone, which is {levels[0]!r}, {levels[1]!r}"
            )
        found = [
            {
                **dict(zip(names, values, strict=True)),
                "one": pairs.one,
                "other": pairs.other,
                "pairs": pairs.pairs,
                "both": pairs.both,
                "only_one": pairs.only_one,
                "only_other": pairs.only_other,
                "difference": pairs.difference,
                "low": pairs.interval[0],
                "high": pairs.interval[1],
                "p": pairs.p,
            }
            for values, pairs in compared
        ]
        columns = [*names, *_DIFFERENCES]
        return _pandas().DataFrame.from_records(found, columns=columns)

    def seconds(self) -> "pandas.DataFrame":
        """Wall time of each cell, as far as it is known: `cell`, `seconds`."""
        noted = self.folder.seconds()
        records = [
            {"cell": cell["name"], "wall_seconds": noted[cell["name"]]}
            for cell in self._plan["cells"]
            if cell["name"] in noted
        ]
        return _pandas().DataFrame.from_records(records, columns=["cell", "wall_seconds"])

    def plot(self, by: Sequence[str] | str | None = None) -> "Figure":
        """Accuracies with their intervals: the first column along the axis, the second by colour.

        Args:
            by: The columns; None: condition and model, or of episodes task and policy.

        Raises:
            InputError: There is no such column.
            MissingExtraError: matplotlib is not installed.
        """
        from beliefnest.studies.plot import plot_accuracy

        names = self._columns(self.table.groups[-2:] if by is None else by)
        if not names:
            raise InputError("by is empty; name at least one column to draw along")
        return plot_accuracy(count_rows(self.rows, names), names)

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
        """Write `rows.csv` and `rows.parquet` into the folder."""
        frame = self.frame()
        csv, parquet = self.folder.path / "rows.csv", self.folder.path / "rows.parquet"
        frame.to_csv(csv, index=False, lineterminator="\n")
        frame.to_parquet(parquet, index=False)
        return csv, parquet

    def _columns(self, names: Sequence[str] | str) -> list[str]:
        known = [*self.table.first, *variation_columns(self._plan), *self.table.columns]
        chosen = several("by", names)
        for name in chosen:
            if name not in known:
                raise InputError(f"there is no column {name!r}; there are {', '.join(known)}")
        return list(chosen)


def _frame(
    rows: Sequence[dict[str, Any]], table: Table, varied: Sequence[str]
) -> "pandas.DataFrame":
    pandas = _pandas()
    import pyarrow

    arrow = {"string": pyarrow.string(), "bool": pyarrow.bool_()}
    arrow |= {"int64": pyarrow.int64(), "float64": pyarrow.float64()}
    columns: dict[str, Any] = {}
    kinds = {**table.first, **dict.fromkeys(varied), **table.columns}
    for name, kind in kinds.items():
        values = [row.get(name) for row in rows]
        told = pyarrow.array(values if kind else _alike(values), arrow[kind] if kind else None)
        columns[name] = pandas.array(told, dtype=pandas.ArrowDtype(told.type))
    return pandas.DataFrame(columns)


def _alike(values: Sequence[Any]) -> list[Any]:
    """Values of one type: what a list of a study mixes becomes text."""
    kinds = {type(value) for value in values if value is not None}
    if len(kinds) <= 1 or kinds == {int, float}:
        return [float(v) if kinds == {int, float} and v is not None else v for v in values]
    return [None if value is None else str(value) for value in values]


def _pandas() -> Any:
    try:
        import pandas
        import pyarrow  # noqa: F401  # what the columns are kept in
    except ModuleNotFoundError as error:
        raise MissingExtraError(f"tables of studies need {error.name}", "study") from None
    return pandas
