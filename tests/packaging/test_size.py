"""The check of the size of the code counts lines and refuses growth without a reason."""

import pytest
from tools.size import main, sizes

PYTHON = '''\
"""A module.

Its text goes on.
"""

import os  # counts


class A:
    """A class."""

    field: int = 0
    """A field."""

    # a comment
    text = """two
lines"""
'''
JAVASCRIPT = """\
/**
 * A comment.
 */
import a from "a"; // counts

// another
const text = `two
lines`; /* the
end */
"""


@pytest.fixture
def root(tmp_path):
    """Folder with 5 lines of Python and 3 of JavaScript, and with files that do not count."""
    for name, text in {
        "src/a/b/c/d.py": PYTHON,
        "src/a/b/d.js": JAVASCRIPT,
        "src/a/tests/test_it.py": PYTHON,
        "src/node_modules/d.js": JAVASCRIPT,
        "src/a/empty.py": "",
        "src/a/notes.md": "words",
    }.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path


@pytest.fixture
def checked(root, capsys):
    """Return a function: table and arguments to status and messages."""

    def check(rows, *arguments):
        (root / "table.csv").write_text(f"folder,lines,reason\n{rows}\n")
        status = main(list(arguments), root, root / "table.csv")
        return status, capsys.readouterr().out

    return check


def test_comments_docstrings_tests_and_bundles_do_not_count(root):
    assert sizes(root) == {"src/a/b": 8}


@pytest.mark.parametrize(
    ("row", "status", "message"),
    [
        ("src/a/b,8,", 0, "8 lines of code in 1 folders"),
        ("src/a/b,7,", 1, "src/a/b: 8 lines of code, of at most 7"),
        ("src/a/b,9,", 1, "src/a/b: 8 lines of code, but the table allows 9"),
        ("src/c,9,", 1, "src/a/b: 8 lines of code, of at most 0"),
        ("src/a/b,8,\nsrc/gone,1,", 1, "src/gone: 0 lines of code, but the table allows 1"),
    ],
)
def test_a_size_must_fit_its_limit(checked, row, status, message):
    found = checked(row)
    assert found[0] == status
    assert message in found[1]


def test_a_folder_may_be_a_little_below_its_limit(checked, root):
    (root / "src/a/b/long.py").write_text("x = 1\n" * 92)
    assert checked("src/a/b,102,")[0] == 0
    assert checked("src/a/b,103,")[0] == 1


@pytest.mark.parametrize("arguments", [(), ("why",), ("why", "src/c"), ("", "src/a/b")])
def test_no_limit_rises_without_a_reason_and_its_folder(checked, root, arguments):
    assert checked("src/a/b,7,", "--write", *arguments)[0] == 1
    assert "src/a/b,7," in (root / "table.csv").read_text()


def test_a_limit_rises_with_a_reason(checked, root):
    table = root / "table.csv"
    assert checked("src/a/b,7,", "--write", "it has a door, too", "src/a/b")[0] == 0
    assert table.read_text() == 'folder,lines,reason\nsrc/a/b,8,"it has a door, too"\n'


def test_a_limit_falls_without_one_and_keeps_its_reason(checked, root):
    assert checked("src/a/b,20,doors\nsrc/gone,3,", "--write")[0] == 0
    assert (root / "table.csv").read_text() == "folder,lines,reason\nsrc/a/b,8,doors\n"
