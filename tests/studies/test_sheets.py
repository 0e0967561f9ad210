"""CSV files of spreadsheets of any region, and ids that a spreadsheet has spoilt."""

import pytest

from beliefnest.errors import InputError
from beliefnest.studies.plainframe import Typed, read_csv_rows
from beliefnest.studies.sheets import decode_sheet, spoilt_number, spoilt_text

ROWS = [["name", "answer", "note"], ["ann", "grün; ja", 'a "b"'], ["bob", "1,5", "x\ny"]]
EXPECTED = [dict(zip(ROWS[0], row, strict=True)) for row in ROWS[1:]]


def written(delimiter, end):
    """Return the rows as text, all cells in quotation marks."""
    cells = [[f'"{each}"' for each in (cell.replace('"', '""') for cell in row)] for row in ROWS]
    return end.join(delimiter.join(row) for row in cells) + end


@pytest.mark.parametrize("delimiter", [",", ";", "\t", "|"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_any_delimiter_encoding_and_line_end_is_read(delimiter, end):
    text = written(delimiter, end)
    forms = {
        "utf-8": text.encode(),
        "utf-8-sig": text.encode("utf-8-sig"),
        "utf-16": text.encode("utf-16"),
        "utf-16-le": text.encode("utf-16-le"),
        "utf-16-be": text.encode("utf-16-be"),
        "utf-16-be with a mark": b"\xfe\xff" + text.encode("utf-16-be"),
        "utf-32": text.encode("utf-32"),
        "cp1252": text.encode("cp1252"),
        "with sep=": f"sep={delimiter}{end}{text}".encode(),
    }
    for name, content in forms.items():
        for needed in ((), ("name", "note")):
            sheet = decode_sheet(content, "a.csv", needed)
            assert [row for _, row in sheet.rows] == EXPECTED, name
            assert sheet.delimiter == delimiter


def test_rows_without_content_and_empty_columns_are_left_out():
    sheet = decode_sheet(b"a;b;;\n1;2;;\n;;;\n3\n\n", "a.csv")
    assert sheet.columns == ("a", "b")
    assert sheet.rows == ((2, {"a": "1", "b": "2"}), (4, {"a": "3", "b": ""}))


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"a,b\n1,2,3\n", "a.csv:2 has 3 cells, but the first line has 2 columns"),
        (b"a,c\n1,2\n", "a.csv:1 has no column 'b'"),
        (b"", "has no column 'a'"),
        (b"a,b,a\n1,2,3\n", "has the column 'a' twice"),
        (b"a,b\n\xe3\xf0\xf3\xf8\xe0,\xe4\xe0\n", "is not UTF-8; save it"),
        (b"\xff\xfea\x00,\xd8", "is not UTF-8; save it"),
        (b"PK\x03\x04\0\0", "a.csv is a workbook of a spreadsheet; save its sheet as CSV"),
        (b'a,b\n1,"2\n3,4\n', "a.csv:3 cannot be read: unexpected end of data"),
    ],
)
def test_what_is_no_table_is_refused_with_its_line(content, told):
    with pytest.raises(InputError, match=told):
        decode_sheet(content, "a.csv", ("a", "b"))


@pytest.mark.parametrize(
    "text",
    [
        *("5E+23", "5e+23", "1.23457E+15", "1,23457E+15", "-2E-05", "5,10000000000000000E+23"),
        *("01. Mrz", "1. Mär 24", "01-Mar", "Mar-01", "Mar 24", "3. Jan", "12-Dez-2024", "1-août"),
        *("01.03.2024", "3/1/2024", "2024-03-01", "2024-03-01 00:00:00", "01:02:00"),
        *("#NAME?", "#ZAHL!", "#DIV/0!", "#NV", "#N/A", "12345.0", "12345,00"),
        "1234567890123450000",
    ],
)
def test_spoilt_ids_are_found(text):
    assert spoilt_text(text)


@pytest.mark.parametrize(
    "text",
    [
        *(
            "5f2a9c1e7d3b4a6f8c0d1e2f",
            "5e23",
            "12E4",
            "p1",
            "ann",
            "may",
            "Mar",
            "jan2",
            "7",
            "007",
        ),
        *("1.1", "3-4", "1234567890123456", "123456789012345678", "100000000000000", "x5E+23"),
        *("ann 12", "12 bob", "a#1", "v58b154ef01", "699d0e5b625a18a8", "2024", ""),
    ],
)
def test_proper_ids_are_not_refused(text):
    assert not spoilt_text(text)
    assert not spoilt_number(text)


def test_decimal_commas_of_numbers_become_points(tmp_path):
    file = tmp_path / "rows.csv"
    file.write_text("place;cost\n1,2;0,5\n", encoding="utf-8")
    columns = {"place": Typed(["1,2"], "string"), "cost": Typed([0.5], "float64")}
    assert read_csv_rows(file, columns) == [{"place": "1,2", "cost": "0.5"}]
