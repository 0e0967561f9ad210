"""Items of a set as Parquet, whose bytes depend on the version of pyarrow, and content does not."""

import importlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec

from beliefnest.errors import MissingExtraError
from beliefnest.files import replacing
from beliefnest.studies.items.item_set import ItemSet
from beliefnest.studies.items.record import ItemRecord

_AS_JSON = ("factors", "shortcuts")


def write_parquet_of(items: ItemSet, folder: Path) -> None:
    """Write the items of each part beside their JSONL file, as `items.parquet`.

    Raises:
        MissingExtraError: pyarrow is not installed.
    """
    for part, own in items.parts.items():
        table, parquet = _table(own), _pyarrow("pyarrow.parquet")
        with replacing(_file(folder, part)) as out:
            parquet.write_table(table, out)


def parquet_differences(items: ItemSet, folder: Path) -> list[str]:
    """Return a line for each Parquet file of a folder whose content is not that of the set.

    Raises:
        MissingExtraError: There is one, and pyarrow is not installed.
    """
    files = {part: _file(folder, part) for part in items.parts}
    there = {part: file for part, file in files.items() if file.is_file()}
    differing = []
    for part, file in there.items():
        try:
            same = _pyarrow("pyarrow.parquet").read_table(file).equals(_table(items.parts[part]))
        except (OSError, ValueError):  # Errors of pyarrow are of these two kinds.
            same = False
        if not same:
            differing.append(f"{file.relative_to(folder).as_posix()}: holds other items")
    return differing


def _file(folder: Path, part: str) -> Path:
    return (folder if part == "public" else folder / part) / "items.parquet"


def _table(items: Sequence[ItemRecord]) -> Any:
    # Factors differ from family to family, so that they are JSON here.
    rows = [
        msgspec.to_builtins(each)
        | {name: msgspec.json.encode(getattr(each, name)).decode() for name in _AS_JSON}
        for each in items
    ]
    return _pyarrow("pyarrow").Table.from_pylist(rows)


def _pyarrow(module: str) -> Any:
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError:
        raise MissingExtraError("Parquet files need pyarrow", "parquet") from None
