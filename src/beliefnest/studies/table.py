"""Form of the table of a kind of study: each column declared once."""

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, Literal

import msgspec

from beliefnest.llm.failures import NOT_ASKED
from beliefnest.plan.scenario_cells import LABEL, LIST
from beliefnest.scenarios.judging import OUTCOMES
from beliefnest.studies.allocation import PARTICIPANT
from beliefnest.studies.copies import rows_with_copies

if TYPE_CHECKING:
    from beliefnest.studies.study_folder import StudyFolder

_FAILED = "error"
_NO_ANSWER = "no_answer"
assert {_FAILED, _NO_ANSWER} <= set(OUTCOMES)

_NOT_ASKED = tuple(each.__name__ for each in NOT_ASKED)
"""Kinds of errors of cells whose model was not asked."""
_NO_ANSWER_KINDS = ("ModelError", "TransientModelError", "UnusableAnswerError")
"""Kinds of errors of cells whose model gave no answer."""

ColumnType = Literal["string", "int64", "float64", "bool"]
"""Type of a column in data frames and Parquet files."""


class RowSource(msgspec.Struct, frozen=True):
    """Plain values from which one row is read.

    Attributes:
        cell: Entry of the cell in the study's plan.
        found: Content of the cell's file.
        result: Result that the row is about; for a failed cell with `outcome` and `why_not`.
    """

    cell: Mapping[str, Any]
    found: Mapping[str, Any]
    result: Mapping[str, Any]


class Column(msgspec.Struct, frozen=True):
    """Column of a table.

    Attributes:
        name: Its name.
        kind: Its type.
        read: Function that returns the value in a row.
        shown: True if the page shows it.
        identifies: True if it is part of the identity of a row.
    """

    name: str
    kind: ColumnType
    read: Callable[[RowSource], Any]
    shown: bool = False
    identifies: bool = False


class Table(msgspec.Struct, frozen=True):
    """Form of a table. The columns of variations stand between `first` and `columns`.

    Attributes:
        results: Function that yields the results of a cell, one for each row, from its entry in
            the plan and its file.
        first: Columns before those of variations.
        columns: Other columns.
        groups: Default columns by which summaries group rows.
        further_groups: Columns that are added to `groups` if they have several values.
        compared: Columns whose values the page compares in pairs.
        apart: Default columns that define the groups of comparisons.
        same: Columns that carry the same information. Rows that are compared by one of them may
            differ in the others.
        means: Columns whose means are in summaries; True: means over successes only.
    """

    results: Callable[[Mapping[str, Any], Mapping[str, Any]], Iterable[Mapping[str, Any]]]
    first: tuple[Column, ...]
    columns: tuple[Column, ...]
    groups: tuple[str, ...]
    further_groups: tuple[str, ...]
    compared: tuple[str, ...]
    apart: tuple[str, ...]
    same: Mapping[str, tuple[str, ...]] = msgspec.field(default_factory=dict)
    means: Mapping[str, bool] = msgspec.field(default_factory=dict)

    def kinds(self, varied: Iterable[str]) -> dict[str, ColumnType | None]:
        """Return the type of each column, by name; None: a column of variations."""
        return {
            **{column.name: column.kind for column in self.first},
            **dict.fromkeys(varied),
            **{column.name: column.kind for column in self.columns},
        }

    @property
    def identity(self) -> tuple[str, ...]:
        """Names of the columns that identify a row, besides those of variations."""
        return tuple(each.name for each in (*self.first, *self.columns) if each.identifies)

    @property
    def shown(self) -> tuple[str, ...]:
        """Names of the columns that the page shows after `first` and those of variations."""
        return tuple(each.name for each in self.columns if each.shown)

    def rows(self, folder: "StudyFolder", plan: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
        """Yield the rows of the cells of a plan, see `rows_with_copies`."""
        varied = variation_columns(plan)

        return rows_with_copies(folder, plan, lambda cell, done: self.rows_of(cell, done, varied))

    def planned(self, plan: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
        """Yield the rows that a plan will have, without results.

        Of cells that differ only by a seed on which nothing depends, the first one has rows.
        """
        varied = variation_columns(plan)
        seen: set[str] = set()
        for cell in plan["cells"]:
            if cell["alike"] is None or cell["alike"] not in seen:
                seen.add(cell["alike"] or cell["name"])
                yield from self.rows_of(cell, {"error": "not played"}, varied)

    def rows_of(
        self, cell: Mapping[str, Any], content: Mapping[str, Any], varied: Iterable[str]
    ) -> Iterator[dict[str, Any]]:
        """Yield the rows of one cell.

        Args:
            cell: Entry of the cell in the plan.
            content: Content of the cell's file.
            varied: Names of the columns of variations.
        """
        variation = _varied(cell)
        for result in self.results(cell, content):
            source = RowSource(cell, content, result)
            yield {
                **{column.name: column.read(source) for column in self.first},
                **{name: plain_value(variation.get(name)) for name in varied},
                **{column.name: column.read(source) for column in self.columns},
            }


class CellKind(msgspec.Struct, frozen=True):
    """Kind of cells.

    Attributes:
        name: Name in the plan: what is played.
        plan: Form of plans.
        cell: Form of the files of cells with a result.
        table: Form of the table.
        subject: Part of a cell's key that names what is played. Plans list all under its plural.
        players: Key of plans that lists who is asked or plays.
        player: Word for one of them, and its plural.
    """

    name: str
    plan: type[Any]
    cell: type[Any]
    table: Table
    subject: str
    players: str = "models"
    player: tuple[str, str] = ("model", "models")


def lost(content: Mapping[str, Any], *, is_judged: bool) -> dict[str, Any]:
    """Return what the rows of a cell without a result hold.

    No rate leaves out a cell in which a model was asked, or a world failed.

    Args:
        content: Content of the cell's file, with `error`; without `kind`, the cell was not played.
        is_judged: True if there is an expectation, which then is not met.
    """
    kind = content.get("kind")
    # Nobody was asked in a cell that was not played, or whose model is not there.
    asked = kind is not None and kind not in _NOT_ASKED
    return {
        "ok": False if asked and is_judged else None,
        "outcome": _NO_ANSWER if kind in _NO_ANSWER_KINDS else _FAILED,
        "why_not": content["error"],
    }


def of_key(name: str) -> Callable[[RowSource], Any]:
    """Return the reader of a part of the cell's key."""
    return lambda source: source.cell["key"][name]


def of_result(
    name: str, form: Callable[[Any], Any] = lambda value: value
) -> Callable[[RowSource], Any]:
    """Return the reader of a part of the result, in a form; None if the result lacks it."""
    return lambda source: form(source.result.get(name))


def variation_columns(plan: Mapping[str, Any]) -> list[str]:
    """Return the names of the columns of variations, in the order of the plan.

    The column `label` follows them if groups of scenarios have labels, `list` if the design has
    lists, and `participant` if people answered.
    """
    return list(dict.fromkeys(name for cell in plan["cells"] for name in _varied(cell)))


def _varied(cell: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of a cell's variation, its label, list and participant, if it has them."""
    key = cell["key"]
    labels = {LABEL: cell[LABEL]} if LABEL in cell else {}
    lists = {LIST: cell[LIST]} if LIST in cell else {}
    people = {PARTICIPANT: key[PARTICIPANT]} if PARTICIPANT in key else {}
    return {**key["variation"], **labels, **lists, **people}


def plain_value(value: Any) -> Any:
    """Return a value as one cell of a table: places as `x,y,z`, other structures as JSON."""
    if isinstance(value, list) and value and all(isinstance(n, int | float) for n in value):
        return place_text(value)
    return json.dumps(value, sort_keys=True) if isinstance(value, list | dict) else value


def place_text(place: list[float] | None) -> str | None:
    """Return a place as `x,y,z`; None: no place."""
    return None if place is None else ",".join(f"{part:g}" for part in place)
