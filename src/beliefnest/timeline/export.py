"""Export of a journal as tables: a folder of JSON lines or Parquet files.

Each file is one table of `tables.TABLES`. Both formats have the same columns.
"""

import importlib
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from itertools import chain
from pathlib import Path
from typing import Any, Literal, Protocol

import msgspec

from beliefnest.errors import InputError, StoreError
from beliefnest.timeline.export_tables import (
    IF_ANY,
    TABLES,
    BeliefRow,
    ColumnForm,
    TableRow,
    belief_row,
    entry_rows,
    snapshot_rows,
    timeline_row,
)
from beliefnest.timeline.journal import TimelineKey
from beliefnest.timeline.store import Journal
from beliefnest.world.frames import Snapshot
from beliefnest.world.registry import Registry

ExportForm = Literal["jsonl", "parquet"]
FORMATS: tuple[ExportForm, ...] = ("jsonl", "parquet")

_ROW_GROUP = 50_000
"""Number of rows that are written to a Parquet file at a time."""


class _Table(Protocol):
    """File of one table, open for writing."""

    def write(self, values: Mapping[str, Any]) -> None:
        """Append a row."""

    def close(self) -> None:
        """Write the remaining rows and close the file."""


def export(
    journal: Journal,
    format: ExportForm,
    out: Path,
    *,
    registry: Registry,
    first: Snapshot | None = None,
    timelines: Iterable[TimelineKey] | None = None,
    beliefs: Iterable[BeliefRow] = (),
    notes: Iterable[TableRow] = (),
) -> Mapping[str, int]:
    """Write a journal into a new folder, completely or not at all.

    Args:
        journal: Journal to write.
        format: "jsonl", or "parquet", which needs the extra `beliefnest[parquet]`.
        out: Output folder; it must not exist or must be empty.
        registry: Names of the blocks.
        first: State before the first entry of the timelines that have no base.
        timelines: Keys of the timelines to write; None for all.
        beliefs: States of nodes, in output order.
        notes: Rows of the other tables: the run, programs, prompts.

    Returns:
        Number of rows by table.

    Raises:
        InputError: The format is unknown, its library is missing, or the folder is not empty.
        BranchError: A key names no timeline.
        StoreError: The journal cannot be read or the folder cannot be written.
    """
    opener = _opener(format)
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise InputError(f"{out} exists already; remove it or choose another folder")
    rows = chain(
        notes, _timeline_rows(journal, registry, first, timelines), map(belief_row, beliefs)
    )
    try:
        with _folder_in_place_of(out) as folder:
            return _written(rows, folder, opener)
    except OSError as fault:
        raise StoreError(
            f"{out} cannot be written ({fault.strerror or fault}); check the path and the disk"
        ) from fault


def _timeline_rows(
    journal: Journal,
    registry: Registry,
    first: Snapshot | None,
    timelines: Iterable[TimelineKey] | None,
) -> Iterator[TableRow]:
    chosen = [i.key for i in journal.timelines()] if timelines is None else list(timelines)
    for key in chosen:
        info = journal.info(key)
        yield timeline_row(info)
        if info.base is None and first is not None:
            yield from snapshot_rows(key, first, registry)
        for number, entry in enumerate(journal.entries(key, 0, info.entries)):
            yield from entry_rows(key, number, entry, registry)


def _written(
    rows: Iterable[TableRow], folder: Path, opener: Callable[[Path, str], _Table]
) -> dict[str, int]:
    counts = {name: 0 for name in TABLES if name not in IF_ANY}
    with ExitStack() as stack:
        tables: dict[str, _Table] = {}

        def begin(name: str) -> None:
            tables[name] = opener(folder, name)
            stack.callback(tables[name].close)

        for name in counts:
            begin(name)
        for name, values in rows:
            if name not in tables:
                begin(name)
            tables[name].write(values)
            counts[name] = counts.get(name, 0) + 1
    return counts


@contextmanager
def _folder_in_place_of(out: Path) -> Iterator[Path]:
    """Yield a temporary folder that replaces `out` on success and is removed on error."""
    out.parent.mkdir(parents=True, exist_ok=True)
    folder = Path(tempfile.mkdtemp(prefix=f".{out.name}-", dir=out.parent))
    try:
        yield folder
        folder.chmod(0o755)
        folder.replace(out)
    except BaseException:
        shutil.rmtree(folder)
        raise


def _opener(format: str) -> Callable[[Path, str], _Table]:
    if format == "jsonl":
        return _JsonLines
    if format == "parquet":
        try:
            arrow = importlib.import_module("pyarrow")
            parquet = importlib.import_module("pyarrow.parquet")
        except ImportError as fault:
            raise InputError(
                "Parquet needs pyarrow: pip install 'beliefnest[parquet]', or export as jsonl"
            ) from fault
        return lambda folder, name: _Parquet(arrow, parquet, folder, name)
    raise InputError(f"unknown format {format!r}; choose {' or '.join(FORMATS)}")


class _JsonLines:
    """JSON lines file with one object for each row."""

    def __init__(self, folder: Path, name: str) -> None:
        self._file = (folder / f"{name}.jsonl").open("wb")
        self._columns = tuple(TABLES[name])

    def write(self, values: Mapping[str, Any]) -> None:
        """Append a row."""
        self._file.write(_json({column: values[column] for column in self._columns}) + b"\n")

    def close(self) -> None:
        """Close the file."""
        self._file.close()


class _Parquet:
    """Parquet file; columns of objects hold JSON text."""

    def __init__(self, arrow: Any, parquet: Any, folder: Path, name: str) -> None:
        self._columns = TABLES[name]
        self._arrow = arrow
        types: Mapping[ColumnForm, Any] = {
            "text": arrow.string(),
            "integer": arrow.int64(),
            "number": arrow.float64(),
            "boolean": arrow.bool_(),
            "object": arrow.string(),
        }
        self._schema = arrow.schema([(c, types[kind]) for c, kind in self._columns.items()])
        self._file = parquet.ParquetWriter(folder / f"{name}.parquet", self._schema)
        self._rows: list[dict[str, Any]] = []

    def write(self, values: Mapping[str, Any]) -> None:
        """Append a row."""
        self._rows.append(
            {
                column: _json(values[column]).decode()
                if kind == "object" and values[column] is not None
                else values[column]
                for column, kind in self._columns.items()
            }
        )
        if len(self._rows) >= _ROW_GROUP:
            self._flush()

    def close(self) -> None:
        """Write the remaining rows and close the file."""
        self._flush()
        self._file.close()

    def _flush(self) -> None:
        if self._rows:
            self._file.write_table(self._arrow.Table.from_pylist(self._rows, schema=self._schema))
            self._rows = []


def _json(value: object) -> bytes:
    try:
        return msgspec.json.encode(value)
    except (TypeError, msgspec.MsgspecError) as fault:
        raise InputError(f"a row holds a value that JSON cannot represent: {fault}") from fault
