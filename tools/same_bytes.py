"""Comparison of all that two versions of the program write for the built-in scenarios.

Usage, with each version in turn (or with PYTHONPATH on its folder `src`):

    python tools/same_bytes.py write FOLDER
    python tools/same_bytes.py compare BEFORE AFTER

`write` plays each built-in scenario in the embedded and in the scripted world, and writes the
run folder, the tables of all beliefs to depth 2, the page, and pictures of two beliefs. `compare`
writes each file that differs, with its first difference, and ends with status 1 if there is one.
Seconds, the version of the package and run files (a database; its content is in the tables) are
left out.
"""

import argparse
import itertools
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

WORLDS = ("embedded", "scripted")
SEED = "1"
SHOWN = 120
"""Characters of each side of a difference that are printed."""

CHANGING = re.compile(
    rb'"(seconds|version|beliefnest|started|finished|created)": *("[^"]*"|[0-9.e+-]+)'
    rb"|beliefnest [0-9]+\.[0-9]+\.[0-9]+(\.dev[0-9]+)?(\+[0-9a-z.]+)?"
)
"""Values that differ from run to run or from version to version."""

SECONDS = re.compile(rb" +[0-9]+\.[0-9]{2}(?=[ \n])")
"""Seconds in the tables that commands print, with the spaces before them."""


def write(folder: Path, names: Sequence[str]) -> None:
    """Write everything for some scenarios, or for all built-in ones."""
    from beliefnest.scenarios.sources import builtin_names

    folder.mkdir(parents=True)
    for name, world in itertools.product(names or builtin_names(), WORLDS):
        place = f"{name}-{world}"
        told = command(folder, "run", name, "--world", world, "--seed", SEED, "--out", place)
        (folder / f"{place}.txt").write_text(told, encoding="utf-8")
        for store in sorted((folder / place).glob("**/run.bn")):
            show(folder, store.parent.relative_to(folder))


def show(folder: Path, run: Path) -> None:
    """Write tables, page and pictures of one run; `run` is relative to the folder."""
    text = command(folder, "show", str(run), "--json")
    names = sorted(json.loads(text)["agents"])
    nested = (f"/{a}/{b}" for a, b in itertools.permutations(names, 2))
    paths = ["/", *(f"/{name}" for name in names), *nested]
    options = [word for path in paths for word in ("--path", path)]
    command(folder, "export", str(run), "--out", str(run / "tables"), *options)
    command(folder, "show", str(run), "--html", str(run / "page.html"))
    for path in (paths[0], paths[-1]):
        file = "belief" + path.replace("/", "-")
        told = command(folder, "show", str(run), "--path", path, "--svg", str(run / f"{file}.svg"))
        (folder / run / f"{file}.txt").write_text(told, encoding="utf-8")


def command(folder: Path, *words: str) -> str:
    """Run a command of the program in a folder, and return its output and its exit status."""
    whole = [sys.executable, "-m", "beliefnest", *words]
    wide = {**os.environ, "COLUMNS": "150"}
    done = subprocess.run(whole, cwd=folder, capture_output=True, text=True, check=False, env=wide)
    if words[0] == "show" and "--json" in words:
        return done.stdout
    return f"{done.stdout}\n{done.stderr}\nexit status {done.returncode}\n"


def differences(before: Path, after: Path) -> Iterator[tuple[str, str]]:
    """Yield each file that differs between two folders, and its first difference."""
    files = sorted({each for folder in (before, after) for each in files_in(folder)})
    for name in files:
        if not (before / name).exists() or not (after / name).exists():
            yield name, f"only in {before if (before / name).exists() else after}"
        else:
            old, new = (lasting(at / name) for at in (before, after))
            if old != new:
                yield name, first_difference(old, new)


def files_in(folder: Path) -> Iterator[str]:
    """Yield the files of a folder that are compared, relative to it."""
    for file in folder.rglob("*"):
        if file.is_file() and file.suffix != ".bn":
            yield str(file.relative_to(folder))


def lasting(file: Path) -> bytes:
    """Return the content of a file without values that differ from run to run."""
    content = CHANGING.sub(b"", file.read_bytes())
    if file.suffix == ".txt":
        content = re.sub(rb" +(?=\n)", b"", SECONDS.sub(b"", content))
    return content


def first_difference(old: bytes, new: bytes) -> str:
    """Return the first place where two texts differ, with what stands there in both."""
    pairs = enumerate(zip(old, new, strict=False))
    at = next((number for number, (a, b) in pairs if a != b), min(len(old), len(new)))
    first = max(0, at - 30)
    return f"at byte {at}: {old[first : at + SHOWN]!r} -> {new[first : at + SHOWN]!r}"


def main() -> int:
    """Write or compare, as the command line says; return the exit status."""
    parser = argparse.ArgumentParser(description="Compare all that two versions write.")
    parts = parser.add_subparsers(dest="what", required=True)
    writing = parts.add_parser("write", help="write everything for the built-in scenarios")
    writing.add_argument("folder", type=Path)
    writing.add_argument("names", nargs="*", help="scenarios; default: all built-in ones")
    comparing = parts.add_parser("compare", help="compare two folders")
    comparing.add_argument("before", type=Path)
    comparing.add_argument("after", type=Path)
    given = parser.parse_args()
    if given.what == "write":
        write(given.folder, given.names)
        return 0
    count = len({*files_in(given.before), *files_in(given.after)})
    found = list(differences(given.before, given.after))
    for name, difference in found:
        sys.stdout.write(f"{name}\n  {difference}\n")
    sys.stdout.write(f"{len(found)} of {count} files differ\n")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
