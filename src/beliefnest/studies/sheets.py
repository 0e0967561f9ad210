"""CSV files as spreadsheets of any region write them, and values that a spreadsheet has spoilt."""

import csv
import io
import itertools
import re
from collections import Counter
from collections.abc import Collection, Sequence
from pathlib import Path

import msgspec

from beliefnest.errors import InputError
from beliefnest.files import os_errors_of, read_regular
from beliefnest.world.texts import quoted

_DELIMITERS = (",", ";", "\t", "|")
_MONTHS = (
    "jan janv ene gen feb fev fév févr mar mär mrz märz mars apr avr abr mai may mag maj jun juin "
    "giu jul juil lug aug août ago agosto sep sept set okt oct ott out nov dez dec déc dic"
)
_NUMBER = re.compile(r"[+-]?\d+(?:[.,]\d+)?E[+-]\d+", re.IGNORECASE)
_DATE = re.compile(
    r"\d{1,2}[./]\d{1,2}[./]\d{2,4}|\d{4}-\d{2}-\d{2}(?: \d{2}:\d{2}(?::\d{2})?)?"
    r"|\d{1,2}:\d{2}:\d{2}"
    rf"|\d{{1,2}}[. -]{{0,2}}(?:{'|'.join(_MONTHS.split())})\.?(?:[ -]\d{{2,4}})?"
    rf"|(?:{'|'.join(_MONTHS.split())})\.?[ -]\d{{1,4}}",
    re.IGNORECASE,
)
_FAULT = re.compile(r"#[A-ZÄÖÜÉÀÇÑ/0]+[!?]?")
_MOST_CELLS = 8_000_000
"""Greatest number of cells of a file, also of those that are missing at the ends of rows."""
_DIGITS = 15
"""Digits that numbers of a spreadsheet keep."""


class Sheet(msgspec.Struct, frozen=True):
    """Content of a CSV file.

    Attributes:
        columns: Names of the columns.
        rows: Number of the line at which each row ends, and its cells by column. Rows without
            content are left out, and missing cells are empty.
        delimiter: The delimiter.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[int, dict[str, str]], ...]
    delimiter: str


def read_sheet(file: Path, needed: Sequence[str] = ()) -> Sheet:
    """Return the content of a CSV file; raise InputError as `decode_sheet`, or if it is none."""
    with os_errors_of(file, "read"):
        content = read_regular(file)
    return decode_sheet(content, str(file), needed)


def decode_sheet(content: bytes, where: str, needed: Sequence[str] = ()) -> Sheet:
    """Return the content of a CSV file: commas, semicolons or tabs, in any Unicode encoding.

    Args:
        content: Bytes of the file.
        where: Name of the file, for messages.
        needed: Columns that it must have.

    Raises:
        InputError: The file is no CSV, or lacks a column.
    """
    text = _decoded(content, where)
    _check_cells(where, text.count("\n") + max(map(text.count, _DELIMITERS)))
    skipped = 0
    first, _, rest = text.partition("\n")
    delimiters: Sequence[str] = _DELIMITERS
    # Excel reads this line, and some programs write it.
    match = re.match(r'"?sep=(.)"?;*$', first)
    if match is not None:
        delimiters, text, skipped = (match[1],), rest, 1
    header = max((_header(text, each) for each in delimiters), key=lambda h: _fit(h[1], needed))
    delimiter, columns = header
    missing = [name for name in needed if name not in columns]
    if missing:
        raise InputError(
            f"{where}:{1 + skipped} has no column {quoted(missing[0])}; give the file as it was "
            "written"
        )
    twice = [name for name, count in Counter(columns).items() if name and count > 1]
    if twice:
        raise InputError(f"{where}:{1 + skipped} has the column {quoted(twice[0])} twice; keep one")
    # An open quotation mark would swallow the rows after it.
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, strict=True)
    rows: list[tuple[int, dict[str, str]]] = []
    try:
        next(reader, None)
        for cells in reader:
            line = reader.line_num + skipped
            if not any(cell.strip() for cell in cells):
                continue
            if any(cell.strip() for cell in cells[len(columns) :]):
                raise InputError(
                    f"{where}:{line} has {len(cells)} cells, but the first line has "
                    f"{len(columns)} columns; quote cells that contain {quoted(delimiter)}"
                )
            _check_cells(where, len(columns) * len(rows))
            filled = [*cells, *[""] * (len(columns) - len(cells))]
            rows.append((line, dict(zip(columns, filled, strict=False))))
    except csv.Error as error:
        raise InputError(f"{where}:{reader.line_num + skipped} cannot be read: {error}") from None
    return Sheet(columns, tuple(rows), delimiter)


def _check_cells(where: str, count: int) -> None:
    if count > _MOST_CELLS:
        raise InputError(f"{where} has more than {_MOST_CELLS:,} cells; divide it")


def _decoded(content: bytes, where: str) -> str:
    """Return the text of a file with Unix line ends and without a byte order mark."""
    head = content[:400]
    if content.startswith((b"PK\x03\x04", b"\xd0\xcf\x11\xe0")):
        raise InputError(f"{where} is a workbook of a spreadsheet; save its sheet as CSV UTF-8")
    if content.startswith((b"\xff\xfe\0\0", b"\0\0\xfe\xff")):
        encoding = "utf-32"
    elif content.startswith((b"\xff\xfe", b"\xfe\xff")):
        encoding = "utf-16"
    elif b"\0" in head:
        # Of Latin letters in UTF-16, every second byte is 0.
        encoding = "utf-16-le" if head[1::2].count(0) > head[::2].count(0) else "utf-16-be"
    else:
        encoding = "utf-8-sig"
    try:
        text = content.decode(encoding)
    except UnicodeDecodeError:
        if encoding != "utf-8-sig" or not _is_western(content):
            raise InputError(
                f"{where} is not UTF-8; save it in the spreadsheet as CSV UTF-8, or give the file "
                "as it was written"
            ) from None
        text = content.decode("cp1252")
    return text.replace("\r\n", "\n").replace("\r", "\n").removeprefix("\ufeff")


def _is_western(content: bytes) -> bool:
    """Return True if bytes are text of Windows-1252: single letters with accents within words."""
    high = [number for number, byte in enumerate(content) if byte >= 0x80]
    letters = all(
        content[number] >= 0xC0 or content[number] in b"\x80\x84\x93\x94\x96\xdf" for number in high
    )
    beside = sum(other - one == 1 for one, other in itertools.pairwise(high))
    return letters and beside * 4 <= len(high)


def _header(text: str, delimiter: str) -> tuple[str, tuple[str, ...]]:
    try:
        cells = next(csv.reader(io.StringIO(text, newline=""), delimiter=delimiter), [])
    except csv.Error:
        cells = []
    names = [cell.strip() for cell in cells]
    # Spreadsheets leave empty columns at the end.
    while names and not names[-1]:
        names.pop()
    return delimiter, tuple(names)


def _fit(columns: Collection[str], needed: Collection[str]) -> tuple[int, int]:
    return sum(name in columns for name in needed), len(columns)


def spoilt_number(text: str) -> str:
    """Return how a spreadsheet has made a number of an id; empty: it has not."""
    if _NUMBER.fullmatch(text):
        return "a number in scientific notation"
    if re.fullmatch(rf"\d{{{_DIGITS + 1},}}", text) and not text[_DIGITS:].strip("0"):
        return f"a number of which only {_DIGITS} digits are kept"
    return ""


def spoilt_text(text: str) -> str:
    """Return what a spreadsheet has made of an id in a CSV file; empty: nothing."""
    if _DATE.fullmatch(text):
        return "a date or time"
    if _FAULT.fullmatch(text):
        return "an error of a formula"
    if re.fullmatch(r"\d+[.,]0+", text):
        return "a number with decimals"
    return spoilt_number(text)
