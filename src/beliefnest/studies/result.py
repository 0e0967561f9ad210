"""Results of a study: tables, intervals, a figure, a page."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from beliefnest.errors import InputError
from beliefnest.studies.checking import checked_columns
from beliefnest.studies.counting import Pairs, count_rows, paired_rows
from beliefnest.studies.episode_rows import EPISODES
from beliefnest.studies.plainframe import Typed, plain_frame, write_csv, write_parquet
from beliefnest.studies.positions import choices_of, count_positions
from beliefnest.studies.power import Source, power_rows
from beliefnest.studies.power_sources import SIZES, recorded_sources
from beliefnest.studies.regression import Effect, Family, Kind, Regression, fit_rows
from beliefnest.studies.rows import PROBES
from beliefnest.studies.study_folder import StudyFolder
from beliefnest.studies.table import Table, variation_columns

if TYPE_CHECKING:  # pandas and matplotlib are optional, and imported when they are needed.
    import pandas
    from matplotlib.figure import Figure

__all__ = ["StudyResult"]

_COMPARED = (
    *("one", "other", "pairs", "variations", "both", "only_one", "only_other", "difference"),
)
"""Attributes of `Pairs` that are columns of `differences`."""


@dataclass(frozen=True)
class StudyResult:
    """Results in the folder of a study.

    Attributes:
        folder: Folder of the study.
    """

    folder: StudyFolder

    @classmethod
    def read(cls, path: str | Path) -> "StudyResult":
        """Return the results in a folder, of a study that has ended or not.

        Raises:
            InputError: The folder holds no study.
        """
        result = cls(StudyFolder.existing(path))
        # Read the plan now, so that a folder without a study is refused here.
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
        """Form of `frame`: a table of episodes, or of probes of scenarios."""
        return EPISODES if "tasks" in self._plan else PROBES

    @cached_property
    def rows(self) -> list[dict[str, Any]]:
        """Return the rows of `frame` as plain values."""
        return list(self.table.rows(self.folder, self._plan))

    @property
    def invalid(self) -> list[dict[str, Any]]:
        """Combinations that make no scenario, and why."""
        return list(self._plan["invalid"])

    @property
    def plan(self) -> dict[str, Any]:
        """Return the latest plan, as plain values."""
        return dict(self._plan)

    def frame(self) -> "pandas.DataFrame":
        """Return one row for each probe of each cell, or each episode, in the order of the plan.

        The same study gives the same rows, for any number of jobs. Wall times vary between runs,
        and are in `seconds` instead. Types are the plain ones of pandas, see `plain_frame`.

        Raises:
            MissingExtraError: pandas is not installed.
        """
        return plain_frame(self._typed())

    def _typed(self) -> dict[str, Typed]:
        kinds = self.table.kinds(variation_columns(self._plan))
        return {name: Typed([row[name] for row in self.rows], kind) for name, kind in kinds.items()}

    @property
    def columns(self) -> tuple[str, ...]:
        """Return the names of the columns of `frame`."""
        return tuple(self.table.kinds(variation_columns(self._plan)))

    @property
    def groups(self) -> tuple[str, ...]:
        """Return the default columns by which summaries group rows."""
        table = self.table
        return (*table.groups, *self._several(table.further_groups))

    def _several(self, columns: Iterable[str]) -> tuple[str, ...]:
        """Return those of some columns that have several values."""
        return tuple(name for name in columns if len({row.get(name) for row in self.rows}) > 1)

    def summary(self, by: Sequence[str] | str | None = None) -> "pandas.DataFrame":
        """Return for each group its accuracy with a 95 % interval, and counts of all outcomes.

        Rows of one variation are not independent. The interval is therefore Wilson's if each
        variation has one row in the group, otherwise the cluster bootstrap over variations. The
        column `interval` names the method, and `variations` the number of variations. For
        episodes there are also means with 95 % intervals by the same bootstrap.

        `accuracy` is over judged rows: rows with the outcome `error` are counted, not judged.

        Args:
            by: Columns of `frame` that define the groups; None: `groups`.

        Raises:
            InputError: A column does not exist.
            MissingExtraError: pandas is not installed.
        """
        names = self.checked(self.groups if by is None else by)
        counted = self.counted(names)
        columns = counted[0] if counted else names
        return plain_frame({name: Typed([row[name] for row in counted]) for name in columns})

    def counted(self, by: Sequence[str]) -> list[dict[str, Any]]:
        """Return the rows of `summary` as plain values."""
        return count_rows(self.rows, by, self.table.means)

    def paired(self, between: str, by: Sequence[str] = ()) -> list[tuple[tuple[Any, ...], Pairs]]:
        """Return the rows of `differences` as values: the group's values of `by`, and its pairs.

        Raises:
            InputError: The column does not identify rows.
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
        """Return the default columns that define the groups of a comparison."""
        same = (between, *self.table.same.get(between, ()))
        return self._several(name for name in self.table.apart if name not in same)

    def differences(
        self, between: str, by: Sequence[str] | str | None = None
    ) -> "pandas.DataFrame":
        """Return paired differences of accuracy between the values of a column.

        A pair are two rows that differ only in that column: all of scenario, condition, variation,
        model, template, repeat and probe are the same otherwise; for episodes task, instance,
        repeat and player. Intervals and tests assume that variations are independent, not pairs.

        Args:
            between: Column to compare, such as `model` or `condition`.
            by: Columns that define groups; each group has its own comparison. None: model,
                template and order of the question, or the player of episodes, if they have
                several values and are not compared themselves. An empty list: one comparison.

        Returns:
            A row for each two values: the columns of `by`; `one`, `other`; `pairs`; the number of
            independent `variations`; the number of pairs that are right with `both`, with
            `only_one` or with `only_other`; the `difference` with `low` and `high` (95 %: Bonett
            and Price with one pair in each variation, else the cluster bootstrap); `p` (exact
            permutation of levels within variations; with one pair in each, McNemar's exact test).

        Raises:
            InputError: The column does not exist, or no two rows differ in it alone.
            MissingExtraError: pandas is not installed.
        """
        found = self.compared(between, by)
        names = list(self.apart(between)) if by is None else self.checked(by)
        columns = [*names, *_COMPARED, "low", "high", "p"]
        return plain_frame({name: Typed([row[name] for row in found]) for name in columns})

    def compared(self, between: str, by: Sequence[str] | str | None = None) -> list[dict[str, Any]]:
        """Return the rows of `differences` as plain values; raise as it does."""
        self.checked(between)
        names = self.checked(self.apart(between) if by is None else by)
        compared = self.paired(between, names)
        levels = list(dict.fromkeys(row[between] for row in self.rows))
        if len(levels) > 1 and not compared:
            raise InputError(
                f"no two rows differ in {between!r} alone, which is {levels[0]!r}, {levels[1]!r}; "
                "compare groups that share no variations by `fit`"
            )
        return [
            {
                **dict(zip(names, values, strict=True)),
                **{name: getattr(pairs, name) for name in _COMPARED},
                "low": pairs.interval[0],
                "high": pairs.interval[1],
                "p": pairs.p,
            }
            for values, pairs in compared
        ]

    def fit(
        self,
        effects: Sequence[Effect] | str,
        kind: Kind = "gee",
        family: Family = "binomial",
    ) -> Regression:
        """Fit a regression of right answers, with variations as groups.

        Args:
            effects: Columns of `frame`, or tuples of columns that interact. All are categories;
                the first level of each is the reference.
            kind: `gee`: generalized estimating equations with robust standard errors. `mixed`: a
                random intercept for each variation.
            family: `binomial`: logit, estimates are log odds. `gaussian`: linear probability,
                estimates are differences of accuracies.

        Raises:
            InputError: A column does not exist, or the rows do not determine the model.
            MissingExtraError: statsmodels is not installed (`beliefnest[stats]`).
        """
        wanted: list[Effect] = [effects] if isinstance(effects, str) else list(effects)
        if not wanted:
            raise InputError("effects is empty; name at least one column")
        for each in wanted:
            self.checked(each if isinstance(each, str) else list(each))
        return fit_rows(self.rows, wanted, kind, family)

    def choices(self) -> list[dict[str, Any]]:
        """Return the answers to questions with options, see `choices_of`; copies are left out."""
        rows: dict[str, list[dict[str, Any]]] = {}
        for row in self.rows:
            rows.setdefault(row["cell"], []).append(row)
        found = ((own, self.folder.cell(name)) for name, own in rows.items())
        return [
            choice
            for own, cell in found
            if cell is not None and cell["error"] is None and own[0]["copy_of"] is None
            for choice in choices_of(own, cell)
        ]

    def positions(self, by: Sequence[str] | str | None = None) -> "pandas.DataFrame":
        """Return how often each position was chosen for each position of the right option.

        Args:
            by: Columns of `frame` that define the groups; None: the model, and template and order
                if they have several values.

        Returns:
            See `count_positions`.

        Raises:
            InputError: A column does not exist, or the study has no questions with options.
            MissingExtraError: pandas is not installed.
        """
        counted = self.counted_positions(self.checked(self.position_groups if by is None else by))
        return plain_frame({name: Typed([row[name] for row in counted]) for name in counted[0]})

    @property
    def position_groups(self) -> tuple[str, ...]:
        """Return the default columns of `positions`."""
        return (*self.table.groups[-1:], *self._several(self.table.further_groups))

    def counted_positions(self, by: Sequence[str]) -> list[dict[str, Any]]:
        """Return the rows of `positions` as plain values; raise InputError if there are none."""
        counted = count_positions(self.choices(), by)
        if not counted:
            raise InputError(
                f"{self.folder.path} has no answer to a question with options and one right option"
            )
        return counted

    def power_sources(
        self, between: str | None = None, by: Sequence[str] | None = None
    ) -> list[tuple[str, Source]]:
        """Return the groups and comparisons of recorded rows that `power` draws from.

        Raises:
            InputError: A column does not exist, or no row is judged.
        """
        names = self.checked(self.groups if by is None else by)
        column = self.default_between if between is None else self.checked(between)[0]
        compared = []
        if column is not None:
            apart = self.apart(column)
            for values, pairs in self.paired(column, apart):
                compared.append((list(zip(apart, values, strict=True)), column, pairs))
        return list(recorded_sources(self.rows, names, compared))

    @property
    def default_between(self) -> str | None:
        """Return the first column of the table's comparisons with several values; None: none."""
        return next(iter(self._several(self.table.compared)), None)

    def power(
        self,
        between: str | None = None,
        by: Sequence[str] | None = None,
        sizes: Sequence[int] = SIZES,
        simulations: int = 400,
        seed: int = 0,
    ) -> "pandas.DataFrame":
        """Simulate larger and smaller studies by drawing the recorded variations again.

        Args:
            between: Column to compare, as for `differences`; None: the first that varies.
            by: Columns that define the groups of accuracies; None: `groups`.
            sizes: Numbers of variations.
            simulations: Number of simulated studies of each size.
            seed: Seed; the same seed gives the same numbers.

        Returns:
            A row for each group or comparison (`of`) and size, see `Power`.

        Raises:
            InputError: A column does not exist, or a number is wrong.
            MissingExtraError: pandas is not installed.
        """
        rows = power_rows(self.power_sources(between, by), sizes, simulations, seed)
        return plain_frame({name: Typed([row[name] for row in rows]) for name in rows[0]})

    def seconds(self) -> "pandas.DataFrame":
        """Return the known wall times of cells, with the columns `cell` and `seconds`."""
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
            by: Columns; None: condition and model, or task and policy for episodes.
            size: Width and height in millimetres; None: as much as bars and texts need.

        Raises:
            InputError: A column does not exist.
            MissingExtraError: matplotlib is not installed.
        """
        from beliefnest.studies.accuracy_figure import plot_accuracy

        names = self.checked(self.table.groups[-2:] if by is None else by)
        if not names:
            raise InputError("by is empty; name at least one column to draw along")
        return plot_accuracy(count_rows(self.rows, names), names, size)

    def write_page(self, file: str | Path, by: Sequence[str] | str | None = None) -> Path:
        """Write the results as one HTML page that needs no network; `by` as for `summary`.

        Raises:
            InputError: A column does not exist, or the file cannot be written.
        """
        from beliefnest.studies.page import page_text

        path = Path(file)
        text = page_text(self, self.checked(self.groups if by is None else by))
        try:
            path.write_text(text, encoding="utf-8")
        except OSError as error:
            raise InputError(f"{path} cannot be written: {error.strerror}") from None
        return path

    def write_tables(self) -> tuple[Path, Path]:
        """Write `rows.csv` and `rows.parquet` into the folder, with the type of each column.

        In the CSV file, an apostrophe precedes texts that a spreadsheet would take as formulas.

        Raises:
            MissingExtraError: pyarrow is not installed; `rows.csv` is written.
        """
        csv, parquet = self.folder.path / "rows.csv", self.folder.path / "rows.parquet"
        columns = self._typed()
        write_csv(columns, csv)
        write_parquet(columns, parquet)
        return csv, parquet

    def checked(self, names: Sequence[str] | str) -> list[str]:
        """Return one or several names of columns as a list; raise InputError if one is unknown."""
        return checked_columns(names, self.columns)
