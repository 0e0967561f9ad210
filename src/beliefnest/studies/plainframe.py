"""Tables with plain types: data frames of pandas, CSV and Parquet."""

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

import msgspec

from beliefnest.errors import MissingExtraError
from beliefnest.files import replace_file, replacing
from beliefnest.studies.sheets import read_sheet
from beliefnest.world.texts import formula_free

if TYPE_CHECKING:  # pandas and pyarrow are optional, and imported when a table is made.
    import pandas
    import pyarrow


class Typed(msgspec.Struct, frozen=True):
    """Values of a column.

    Attributes:
        values: The values; None: missing.
        kind: `string`, `bool`, `int64` or `float64`; None: inferred from the values.
    """

    values: Sequence[Any]
    kind: str | None = None

    @property
    def found_kind(self) -> str:
        """Return the kind, inferred if None; `string` if the values are mixed or all missing."""
        if self.kind is not None:
            return self.kind
        types = {type(value) for value in self.values if value is not None}
        if types == {bool}:
            return "bool"
        if types == {int}:
            return "int64"
        return "float64" if types and types <= {int, float} else "string"


def plain_frame(columns: Mapping[str, Typed]) -> "pandas.DataFrame":
    """Make a data frame of plain types: `object` for texts, `bool`, `int64`, `float64`.

    A missing text is None. Plain `bool` and `int64` have no missing value. So
    a column with missing values is `float64`: NaN if missing, 1 and 0 for True and False.

    Raises:
        MissingExtraError: pandas is not installed.
    """
    library = _pandas()
    series = {name: _plain(column) for name, column in columns.items()}
    frame: pandas.DataFrame = library.DataFrame(
        {name: library.Series(values, dtype=kind) for name, (values, kind) in series.items()},
        columns=list(columns),
    )
    return frame


def _plain(column: Typed) -> tuple[Sequence[Any], str]:
    kind = column.found_kind
    if kind == "string":
        return _texts(column), "object"
    if any(value is None for value in column.values):
        kind = "float64"
    values = [float("nan") if value is None else value for value in column.values]
    return values, kind


def _texts(column: Typed) -> list[str | None]:
    # Values of mixed types become texts.
    return [value if value is None else str(value) for value in column.values]


def write_csv(columns: Mapping[str, Typed], file: Path) -> None:
    """Write a table as CSV; a missing value is an empty cell.

    An apostrophe precedes texts that a spreadsheet would take as formulas.
    """
    replace_file(file, csv_text(columns))


def _write_csv(columns: Mapping[str, Typed], out: TextIO) -> None:
    cells = [
        _texts(column) if column.found_kind == "string" else column.values
        for column in columns.values()
    ]
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(map(formula_free, columns))
    for row in zip(*cells, strict=True):
        writer.writerow(formula_free(v) if isinstance(v, str) else v for v in row)


def csv_text(columns: Mapping[str, Typed]) -> str:
    """Return a table as `write_csv` writes it."""
    written = io.StringIO(newline="")
    _write_csv(columns, written)
    return written.getvalue()


def csv_rows(columns: Mapping[str, Typed]) -> list[dict[str, str]]:
    """Return the rows of a table as `write_csv` writes them, each value as text."""
    return list(csv.DictReader(io.StringIO(csv_text(columns), newline="")))


def read_csv_rows(file: Path, columns: Mapping[str, Typed]) -> list[dict[str, str]]:
    """Return the rows of a CSV file, each value as text.

    A decimal comma becomes a point, as `write_csv` writes it.

    Args:
        file: The file.
        columns: Table that the file is compared with.

    Raises:
        InputError: The file cannot be read, or is no CSV.
    """
    sheet = read_sheet(file)
    rows = [row for _, row in sheet.rows]
    if sheet.delimiter == ",":
        return rows
    decimals = {name for name, each in columns.items() if each.found_kind == "float64"}
    return [
        {name: v.replace(",", ".") if name in decimals else v for name, v in row.items()}
        for row in rows
    ]


def write_parquet(columns: Mapping[str, Typed], file: Path) -> None:
    """Write a table as Parquet; whole numbers stay whole even if some are missing.

    Raises:
        MissingExtraError: pyarrow is not installed.
    """
    try:
        import pyarrow
        from pyarrow import parquet
    except ModuleNotFoundError:
        raise MissingExtraError("Parquet files need pyarrow", "study") from None
    # Write no pandas metadata: with it, pandas would read back types that are not plain.
    table = pyarrow.table({name: _arrow(column) for name, column in columns.items()})
    with replacing(file) as out:
        parquet.write_table(table, out)


def _arrow(column: Typed) -> "pyarrow.Array":
    import pyarrow

    kind = column.found_kind
    values = _texts(column) if kind == "string" else column.values
    return pyarrow.array(values, pyarrow.type_for_alias(kind))


def _pandas() -> Any:
    try:
        import pandas
    except ModuleNotFoundError:
        raise MissingExtraError("data frames of studies need pandas", "study") from None
    return pandas
