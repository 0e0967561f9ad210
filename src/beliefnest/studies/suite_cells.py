"""Cells of suites, and their table."""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from types import NoneType
from typing import Any, Generic, TypeVar, get_args

import msgspec

from beliefnest.plan.cells import Key, variation_id
from beliefnest.studies.forms import CellsPlan, PlannedCell
from beliefnest.studies.table import CellKind, Column, ColumnType, Table, lost, of_key, of_result

RowT = TypeVar("RowT")
_COLUMNS: Mapping[type, ColumnType] = {
    str: "string",
    int: "int64",
    float: "float64",
    bool: "bool",
}


@dataclass(frozen=True, slots=True)
class SuiteKey(Key):
    """Identity of a cell of a suite.

    Attributes:
        suite: Name of the suite.
        content: Hash of what is played.
        setting: Settings that affect the result; `seed`: seed of all random numbers.
        variation: Nothing: a suite varies nothing.
    """

    suite: str
    content: str
    setting: Mapping[str, Any]
    variation: Mapping[str, Any] = field(default_factory=dict)

    @property
    def seed(self) -> int:
        """Return the seed of all random numbers of the cell."""
        return int(self.setting["seed"])

    def planned(self, independent: object, rows: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
        """Return the entry of the cell in a plan.

        Args:
            independent: Value that is the same for rows that depend on each other.
            rows: What is known of each row before the cell is played.
        """
        return {
            "name": self.name,
            "key": self.content_json(),
            "seed": self.seed,
            "variation": variation_id(self.suite, independent),
            "alike": None,
            "rows": list(rows),
        }


class _SuiteKeyForm(msgspec.Struct):
    suite: str
    variation: dict[str, Any]


class _SuiteCellForm(PlannedCell):
    key: _SuiteKeyForm
    rows: list[dict[str, Any]]


class _SuitePlan(CellsPlan):
    cells: list[_SuiteCellForm]


class _PlayedRows(msgspec.Struct, Generic[RowT]):
    error: None
    rows: list[RowT]


def suite_kind(
    name: str,
    row: type,
    groups: tuple[str, ...],
    *,
    is_judged: bool,
    means: Sequence[str] = (),
    identity: Collection[str] = (),
) -> CellKind:
    """Return the kind of the cells of a suite.

    Args:
        name: Its name.
        row: Form of a row, whose fields are columns of the table.
        groups: Default columns by which summaries group rows.
        is_judged: True if rows are right or wrong.
        means: Columns whose means are in summaries.
        identity: Columns that tell the rows of a suite apart; rows are compared by one of them.
    """

    def results(cell: Mapping[str, Any], content: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
        if content["error"] is None:
            yield from content["rows"]
            return
        for each in cell["rows"]:
            yield {**each, **lost(content, is_judged=is_judged)}

    table = Table(
        results=results,
        first=(Column("suite", "string", of_key("suite"), identifies=True),),
        columns=(
            Column("variation", "string", lambda source: source.cell["variation"], shown=True),
            *_columns(row, identity),
            Column("seed", "int64", lambda source: source.cell["seed"]),
            Column("cell", "string", lambda source: source.cell["name"]),
            Column("copy_of", "string", of_result("copy_of")),
        ),
        groups=groups,
        further_groups=(),
        compared=(),
        apart=(),
        means=dict.fromkeys(means, False),
    )
    # The form of a row is known only here, which mypy takes for no type.
    return CellKind(name, _SuitePlan, _PlayedRows[row], table, subject="suite")  # type: ignore[valid-type]


def _columns(form: type, identity: Collection[str]) -> Iterator[Column]:
    for each in msgspec.structs.fields(form):
        (kind,) = {*(get_args(each.type) or (each.type,))} - {NoneType}
        read, is_part = of_result(each.name), each.name in identity
        yield Column(each.name, _COLUMNS[kind], read, shown=True, identifies=is_part)
