"""Files that the program writes: whole or as they were, and by one function only."""

import ast
import errno
import os
import resource
import stat
from collections.abc import Iterator
from pathlib import Path

import pytest

import beliefnest
from beliefnest.files import new_file, replace_file, replacing

SOURCES = Path(beliefnest.__file__).parent
WRITERS = {"write_text", "write_bytes", "copyfile"}
CALLED = {*WRITERS, "open"}
"""Names of functions that may write a file."""
APPENDING = {
    "llm/recorded_models.py": "appends a line to a recording",
    "plan/spending.py": "appends a line to a file of lines",
    "timeline/export.py": "writes into a new folder that gets its name at the end",
}
"""Files that open others for writing, and why these are not replaced."""


def modes(call: ast.Call) -> Iterator[str]:
    """Yield the texts that a call of `open` has in the place of a mode."""
    is_method = isinstance(call.func, ast.Attribute)
    places = [*call.args[0 if is_method else 1 :][:1], *(k.value for k in call.keywords)]
    for place in places:
        if isinstance(place, ast.Constant) and isinstance(place.value, str):
            yield place.value


def writes(tree: ast.AST) -> Iterator[int]:
    """Yield the lines that write a file by another function than `replace_file`."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        if name in WRITERS:
            yield node.lineno
        if name == "open" and any(
            set(mode) <= set("rwaxbt+") and set(mode) & set("wax+") for mode in modes(node)
        ):
            yield node.lineno


def test_every_file_is_written_by_the_function_that_replaces_it() -> None:
    found = {}
    for source in sorted(SOURCES.rglob("*.py")):
        name = source.relative_to(SOURCES).as_posix()
        if "node_modules" in name or name == "files.py":
            continue
        text = source.read_text(encoding="utf-8")
        # Parsing all modules takes seconds.
        lines = list(writes(ast.parse(text))) if any(each in text for each in CALLED) else []
        if lines:
            found[name] = lines
    unpacking = {"studies/archive.py"}  # into a temporary folder
    assert found.keys() - unpacking == APPENDING.keys(), found


@pytest.mark.parametrize(
    "code",
    [
        'Path("x").write_text("a")',
        'p.write_bytes(b"")',
        'open("x", "w")',
        'open("x", mode="wb")',
        'p.open("a")',
        'p.open(mode="x", encoding="utf-8")',
        "shutil.copyfile(a, b)",
    ],
)
def test_the_search_finds_what_it_looks_for(code: str) -> None:
    assert list(writes(ast.parse(code))) == [1]


def test_a_text_that_cannot_be_encoded_leaves_the_file_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "scenario.yaml"
    path.write_text("name: old\n", encoding="utf-8")
    with pytest.raises(UnicodeEncodeError):
        replace_file(path, "name: \ud83d\n")
    assert path.read_text(encoding="utf-8") == "name: old\n"
    assert list(tmp_path.iterdir()) == [path]


def test_a_full_disk_leaves_the_file_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "scenario.yaml"
    replace_file(path, "old")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, hard))
    try:
        with pytest.raises(OSError) as fault:
            replace_file(path, b"x" * 100_000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert fault.value.errno == errno.EFBIG
    assert path.read_text(encoding="utf-8") == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_block_that_raises_leaves_the_file_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    replace_file(path, "old")
    with pytest.raises(RuntimeError), replacing(path) as file:
        file.write(b"new")
        raise RuntimeError
    assert path.read_text(encoding="utf-8") == "old"
    with pytest.raises(RuntimeError), new_file(tmp_path / "new") as file:
        file.write(b"new")
        raise RuntimeError
    assert list(tmp_path.iterdir()) == [path]


def test_links_modes_and_devices_stay_what_they_are(tmp_path: Path) -> None:
    path, link = tmp_path / "file", tmp_path / "link"
    replace_file(path, "a")
    assert stat.S_IMODE(path.stat().st_mode) == 0o666 & ~_mask()
    path.chmod(0o640)
    link.symlink_to(path)
    replace_file(link, "b")
    assert link.is_symlink()
    assert path.read_text(encoding="utf-8") == "b"
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    replace_file(Path("/dev/null"), "c")
    assert stat.S_ISCHR(Path("/dev/null").stat().st_mode)


def _mask() -> int:
    mask = os.umask(0o022)
    os.umask(mask)
    return mask
