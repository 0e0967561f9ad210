"""Trial of the tests of a day: each must find faults that a table seeds in a copy of the source.

Usage: `python -m tests.faults [NAME ...] [--jobs 2] [--found FILE]`. A fault that no test finds,
and one whose text is no longer in the source, is a failure. `--found` writes the test that found
each.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import SimpleQueue

import msgspec

ROOT = Path(__file__).parents[2]
TABLE = Path(__file__).with_name("table.toml")
PACKAGE = Path("src", "beliefnest")
BUILT = ("_bundle", "_page", "worlds/minecraft/node/node_modules")
"""Parts of the package that are not in the repository; copies borrow them."""
FAILED, INTERRUPTED = 1, 2
"""Exit statuses of pytest: a test failed; a module could not be imported."""


class Fault(msgspec.Struct, forbid_unknown_fields=True):
    """Row of the table.

    Attributes:
        name: Unique name.
        file: Path in the package.
        old: Text that occurs in the file once.
        new: Faulty text in its place.
        tests: Arguments of pytest, tried one after the other until a test fails.
    """

    name: str
    file: str
    old: str
    new: str
    tests: list[str]


def faults() -> list[Fault]:
    """Return the table."""
    return msgspec.convert(tomllib.loads(TABLE.read_text())["fault"], list[Fault])


def copy_to(folder: Path) -> Path:
    """Copy the files of the repository as they are now; return the folder of the copy."""
    names = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split("\0")
    for name in filter(None, names):
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name)
    for name in BUILT:
        (folder / PACKAGE / name).symlink_to(ROOT / PACKAGE / name)
    return folder


def finder_of(fault: Fault, copy: Path) -> str:
    """Return the test that finds a fault in a copy; an empty text: none does."""
    file = copy / PACKAGE / fault.file
    whole = file.read_text() if file.exists() else ""
    if whole.count(fault.old) != 1:
        return f"not tried: {fault.file} has its text {whole.count(fault.old)} times, not once"
    file.write_text(whole.replace(fault.old, fault.new))
    try:
        found = next(filter(None, (_first_failure(tests, copy) for tests in fault.tests)), "")
    finally:
        file.write_text(whole)
    if found and _first_failure(found, copy):
        return f"not tried: {found} fails without the fault, too"
    return found


def _first_failure(tests: str, copy: Path) -> str:
    ended = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-x", "-n", "0", "-p", "no:cacheprovider", tests],
        cwd=copy,
        env={**os.environ, "PYTHONPATH": f"{copy / 'src'}{os.pathsep}{copy / 'benchmarks'}"},
        capture_output=True,
        text=True,
        check=False,
    )
    if ended.returncode not in (FAILED, INTERRUPTED):
        return ""
    named = re.search(r"^(?:FAILED|ERROR) (\S.*?)(?: - .*)?$", ended.stdout, re.MULTILINE)
    return named[1] if named else f"{tests}: {ended.stdout[-300:]}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Try all faults, or those that are named; return 1 if one is not found."""
    parser = argparse.ArgumentParser(description="Try whether the tests find seeded faults.")
    parser.add_argument("names", nargs="*")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--found", type=Path, help="file for the test that finds each fault")
    wanted = parser.parse_args(arguments)
    tried = [each for each in faults() if not wanted.names or each.name in wanted.names]
    copies: SimpleQueue[Path] = SimpleQueue()
    found: dict[str, str] = {}

    def attempt(fault: Fault) -> None:
        copy = copies.get()
        try:
            found[fault.name] = finder_of(fault, copy)
            print(fault.name, found[fault.name] or "NOT FOUND", sep=": ", flush=True)  # noqa: T201
        finally:
            copies.put(copy)

    with tempfile.TemporaryDirectory(prefix="faults-") as folder:
        for number in range(wanted.jobs):
            copies.put(copy_to(Path(folder, str(number))))
        with ThreadPoolExecutor(wanted.jobs) as pool:
            list(pool.map(attempt, tried))
    if wanted.found:
        lines = (f"{each.name}\t{found[each.name]}\n" for each in tried)
        wanted.found.write_text("".join(lines))
    missed = [name for name, by in found.items() if not by or by.startswith("not tried")]
    print(f"{len(tried) - len(missed)} of {len(tried)} faults found; missed: {missed}")  # noqa: T201
    return int(bool(missed))


if __name__ == "__main__":
    sys.exit(main())
