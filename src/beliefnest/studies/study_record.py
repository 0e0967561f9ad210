"""Recorded study or run: its rows, and statistics of them as plain values."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Self

from beliefnest.errors import InputError
from beliefnest.studies.checking import checked_columns
from beliefnest.studies.counting import Pairs, count_rows, paired_rows
from beliefnest.studies.guessing import mean_chance
from beliefnest.studies.plainframe import Typed
from beliefnest.studies.positions import choices_of, count_positions
from beliefnest.studies.power import VariationSource
from beliefnest.studies.power_sources import recorded_sources
from beliefnest.studies.row_filter import RowFilter
from beliefnest.studies.study_folder import StudyFolder
from beliefnest.studies.table import CellKind, Table, variation_columns

COMPARED = (
    *("one", "other", "pairs", "variations", "both", "only_one", "only_other", "difference"),
)
"""Attributes of `Pairs` that are columns of comparisons."""


@dataclass(frozen=True)
class StudyRecord:
    """Recorded results in the folder of a study or run.

    Attributes:
        folder: The folder.
        kept: Condition that all rows hold; None: all rows of the study.
    """

    folder: StudyFolder
    kept: RowFilter | None = None

    @classmethod
    def read(cls, path: str | Path) -> Self:
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
        """Return the latest plan; cells that people answered follow those of models."""
        plan = self.folder.plan()
        return {**plan, "cells": [*plan["cells"], *self.folder.people()]}

    @property
    def kind(self) -> CellKind:
        """Return the kind of the cells."""
        return self.folder.kind

    @property
    def table(self) -> Table:
        """Return the form of `frame`."""
        return self.kind.table

    @cached_property
    def rows(self) -> list[dict[str, Any]]:
        """Return the rows of `frame` as plain values."""
        rows = self._every_row
        return rows if self.kept is None else self.kept.kept(rows)

    @cached_property
    def _every_row(self) -> list[dict[str, Any]]:
        return list(self.table.rows(self.folder, self._plan))

    def where(self, condition: str) -> Self:
        """Return the results of the rows that hold a condition.

        Statistics, figures and the page of what is returned are about these rows. Its tables in
        files, supplement and methods are those of the whole study.

        Args:
            condition: The condition, such as `order == 2 and condition != "3"`; see `RowFilter`.

        Raises:
            InputError: The text is no condition, names an unknown column, or no row holds it.
        """
        filtered = replace(self, kept=RowFilter.parse(condition, self.columns))
        filtered.rows  # noqa: B018 - refuse a condition that no row holds
        return filtered

    @property
    def whole(self) -> Self:
        """Return the results of all rows."""
        return self if self.kept is None else replace(self, kept=None)

    @cached_property
    def failed(self) -> dict[str, str]:
        """Reasons of tried cells without a result, by name; they are tried again."""
        cells = {cell["name"]: self.folder.cell(cell["name"]) for cell in self._plan["cells"]}
        return {n: each["error"] for n, each in cells.items() if each and each["error"] is not None}

    @property
    def invalid(self) -> list[dict[str, Any]]:
        """Combinations that make no scenario, and why."""
        return list(self._plan["invalid"])

    @property
    def plan(self) -> dict[str, Any]:
        """Return the latest plan, as plain values."""
        return dict(self._plan)

    def typed(self) -> dict[str, Typed]:
        """Return the columns of `frame` with their types."""
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

    def compared(self, between: str, by: Sequence[str] | str | None = None) -> list[dict[str, Any]]:
        """Return the rows of `differences` as plain values; raise as it does."""
        self.checked(between)
        names = list(self.apart(between)) if by is None else self.grouping(by, (between,))
        compared = self.paired(between, names)
        levels = list(dict.fromkeys(row[between] for row in self.rows))

        def chance(values: Sequence[Any], level: object) -> float | None:
            alike = dict(zip((*names, between), (*values, level), strict=True))
            own = [row for row in self.rows if all(row.get(n) == v for n, v in alike.items())]
            return mean_chance([row for row in own if row["ok"] is not None])

        if len(levels) > 1 and not compared:
            raise InputError(
                f"no two rows differ in {between!r} alone, which is {levels[0]!r}, {levels[1]!r}; "
                "compare groups that share no variations by a regression (`fit`, or --effect)"
            )
        return [
            {
                **dict(zip(names, values, strict=True)),
                **{name: getattr(pairs, name) for name in COMPARED},
                "low": pairs.interval[0],
                "high": pairs.interval[1],
                "p": pairs.p,
                "chance_one": chance(values, pairs.one),
                "chance_other": chance(values, pairs.other),
            }
            for values, pairs in compared
        ]

    def choices(self) -> list[dict[str, Any]]:
        """Return the answers to questions with options, see `choices_of`; copies are left out."""
        rows: dict[str, list[dict[str, Any]]] = {}
        for row in self._every_row:
            rows.setdefault(row["cell"], []).append(row)
        cells_of_rows = ((own, self.folder.cell(name)) for name, own in rows.items())
        choices = [
            choice
            for own, cell in cells_of_rows
            if cell is not None and cell["error"] is None and own[0]["copy_of"] is None
            for choice in choices_of(own, cell)
        ]
        return choices if self.kept is None else [each for each in choices if self.kept.holds(each)]

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
    ) -> list[tuple[str, VariationSource]]:
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

    def grouping(self, by: Sequence[str] | str, used: Sequence[str]) -> list[str]:
        """Return columns of groups; raise InputError if one is unknown, or is one of `used`."""
        names = self.checked(by)
        for name in used:
            if name in names:
                raise InputError(
                    f"{name} cannot be compared, or be an effect, within groups of the same "
                    f"{name}; leave it out of `by`, or out of what is compared"
                )
        return names

    def checked(self, names: Sequence[str] | str) -> list[str]:
        """Return one or several names of columns as a list; raise InputError if one is unknown."""
        return checked_columns(names, self.columns)
