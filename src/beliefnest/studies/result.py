"""Results of a study: data frames, regressions, a figure, a page, a supplement."""

import os
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from beliefnest.errors import InputError
from beliefnest.files import os_errors_of, replace_file
from beliefnest.studies.archive import write_zip
from beliefnest.studies.bundling import bundled
from beliefnest.studies.counting import count_rows
from beliefnest.studies.fits import Family
from beliefnest.studies.methods import MethodsForm, methods_text
from beliefnest.studies.plainframe import Typed, plain_frame, write_csv, write_parquet
from beliefnest.studies.power import power_rows
from beliefnest.studies.power_sources import SIZES
from beliefnest.studies.regression import Effect, FitKind, Regression, fit_rows
from beliefnest.studies.reproducing import Reproduction, reproduce_study
from beliefnest.studies.study_record import COMPARED, StudyRecord

if TYPE_CHECKING:  # pandas and matplotlib are optional, and imported when they are needed.
    import pandas
    from matplotlib.figure import Figure


class StudyResult(StudyRecord):
    """Results in the folder of a study."""

    def frame(self) -> "pandas.DataFrame":
        """Return one row for each probe of each cell, or each episode, in the order of the plan.

        The same study gives the same rows, for any number of jobs. Wall times vary between runs,
        and are in `seconds` instead. Types are the plain ones of pandas, see `plain_frame`.

        Raises:
            MissingExtraError: pandas is not installed.
        """
        return plain_frame(self.typed())

    def summary(self, by: Sequence[str] | str | None = None) -> "pandas.DataFrame":
        """Return for each group its accuracy with a 95 % interval, and counts of all outcomes.

        Rows of one variation are not independent. The interval is therefore Wilson's if each
        variation has one row in the group, otherwise the cluster bootstrap over variations; with
        answers of people the pigeonhole bootstrap over variations and participants. The
        column `interval` names the method, and `variations` the number of variations. For
        episodes there are also means with 95 % intervals by the same bootstrap.

        `accuracy` is over all rows with an expectation: those without an answer or a result are
        not right.

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
            and Price with one pair in each variation, else the cluster bootstrap; with people the
            pigeonhole bootstrap); `p` (exact
            permutation of levels within variations; with one pair in each, McNemar's exact test);
            `chance_one` and `chance_other`, accuracies of blind guesses with each value.

        Raises:
            InputError: The column does not exist, or no two rows differ in it alone.
            MissingExtraError: pandas is not installed.
        """
        compared = self.compared(between, by)
        names = list(self.apart(between)) if by is None else self.checked(by)
        columns = [*names, *COMPARED, "low", "high", "p", "chance_one", "chance_other"]
        return plain_frame({name: Typed([row[name] for row in compared]) for name in columns})

    def fit(
        self, effects: Sequence[Effect] | str, kind: FitKind = "gee", family: Family = "binomial"
    ) -> Regression:
        """Fit a regression of right answers, with variations as groups.

        Args:
            effects: Columns of `frame`, or tuples of columns that interact. All are categories;
                the first level of each is the reference.
            kind: `gee`: generalized estimating equations with robust standard errors. `mixed`: a
                random intercept for each variation.
            family: `binomial`: logit, estimates are log odds. `gaussian`: linear probability,
                estimates are differences of accuracies.

        Returns:
            The regression. If the rows do not determine it, `sound` is False, `note` says why, and
            `substitute` and `counts` hold what these rows do say.

        Raises:
            InputError: A column does not exist.
            MissingExtraError: statsmodels is not installed (`beliefnest[stats]`).
        """
        ((_, fitted),) = self.fits(effects, kind, family, by=())
        return fitted

    def fits(
        self,
        effects: Sequence[Effect] | str,
        kind: FitKind = "gee",
        family: Family = "binomial",
        by: Sequence[str] | str = (),
    ) -> list[tuple[dict[str, Any], Regression]]:
        """Fit a regression in each group of rows.

        Args:
            effects: As for `fit`.
            kind: As for `fit`.
            family: As for `fit`.
            by: Columns of `frame` that define the groups; empty: one group of all rows.

        Returns:
            The group's values of `by`, by name, and its regression.

        Raises:
            InputError: A column does not exist, or is both an effect and in `by`.
            MissingExtraError: statsmodels is not installed (`beliefnest[stats]`).
        """
        wanted: list[Effect] = [effects] if isinstance(effects, str) else list(effects)
        if not wanted:
            raise InputError("effects is empty; name at least one column")
        parts = [[each] if isinstance(each, str) else list(each) for each in wanted]
        groups = self.grouping(by, [name for each in parts for name in self.checked(each)])
        rows: dict[tuple[Any, ...], list[dict[str, Any]]] = {} if groups else {(): self.rows}
        for row in self.rows if groups else ():
            rows.setdefault(tuple(row.get(name) for name in groups), []).append(row)
        return [
            (dict(zip(groups, values, strict=True)), fit_rows(own, wanted, kind, family))
            for values, own in rows.items()
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
        self, by: Sequence[str] | str | None = None, size: tuple[float, float] | None = None
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
        with os_errors_of(path, "written"):
            replace_file(path, text)
        return path

    def bundle(self, file: str | Path, *, runs: bool = False) -> Path:
        """Write the supplement: a ZIP file with which `beliefnest reproduce` plays all cells again.

        Args:
            file: The ZIP file; the same study gives the same bytes.
            runs: Include the recorded run files.

        Raises:
            InputError: A file contains a key or password that is set on this machine, or the file
                cannot be written.
        """
        path = Path(file)
        write_zip(bundled(self.whole, os.environ, runs=runs), path)
        return path

    def methods(self, form: MethodsForm = "markdown") -> str:
        """Return the paragraph for a methods section, which contains recorded facts only.

        Args:
            form: `markdown` or `latex`.

        Raises:
            InputError: The format does not exist, or a file of the folder is damaged.
        """
        return methods_text(self.whole, form)

    def reproduce(self, jobs: int = 1, *, trust: bool = False) -> Reproduction:
        """Play all cells with a result again, without any model, and compare all rows.

        Args:
            jobs: Number of cells to play in parallel.
            trust: Run the Python code of policies and judging functions, if there is any.

        Raises:
            InputError: The folder does not have the inputs of the study, or has code and is not
                trusted; the message lists the code.
            BodyError: A worker process ended unexpectedly.
        """
        with tempfile.TemporaryDirectory() as again:
            return reproduce_study(
                self.folder.path, Path(again), jobs, lambda progress: None, trust=trust
            )

    def write_tables(self) -> tuple[Path, Path]:
        """Write `rows.csv` and `rows.parquet` into the folder, with the type of each column.

        In the CSV file, an apostrophe precedes texts that a spreadsheet would take as formulas.

        Raises:
            MissingExtraError: pyarrow is not installed; `rows.csv` is written.
        """
        csv, parquet = self.folder.path / "rows.csv", self.folder.path / "rows.parquet"
        columns = self.whole.typed()
        write_csv(columns, csv)
        write_parquet(columns, parquet)
        return csv, parquet
