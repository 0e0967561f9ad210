"""Check of the size of the code against the table `size.csv`, folder by folder.

Usage: `python tools/size.py`; `python tools/size.py --write` lowers the figures to the lines of
today; `python tools/size.py --write REASON FOLDER ...` also raises those of some folders.

Lines of code are those with something other than comments and docstrings. Tests, bundles and
packages of others do not count.
"""

import argparse
import csv
import sys
import tokenize
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from tree_sitter import Language, Node, Parser
from tree_sitter_javascript import language

ROOT = Path(__file__).parent.parent
TABLE = ROOT / "tools" / "size.csv"
SOURCES = ("benchmarks", "examples", "packages", "src", "tools")
SKIPPED = {"node_modules", "_bundle", "_page", "build", "dist", "test", "tests"}
PARTS = 3
"""Greatest number of folders in a name of the table, such as `src/beliefnest/belief`."""
MOST_SPARE = 0.02
"""Greatest part of a figure by which a folder may stay below it."""
LAYOUT = {
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENDMARKER,
    tokenize.ENCODING,
}


class Limit(NamedTuple):
    """Row of the table.

    Attributes:
        lines: Greatest number of lines of code.
        reason: Cause of the last rise, or nothing.
    """

    lines: int
    reason: str = ""


def python_size(path: Path) -> int:
    """Return the number of lines of code of a Python file."""
    rows: set[int] = set()
    statement: list[tokenize.TokenInfo] = []
    with path.open("rb") as file:
        for token in tokenize.tokenize(file.readline):
            if token.type != tokenize.NEWLINE:
                statement += [] if token.type in LAYOUT else [token]
                continue
            if [part.type for part in statement] != [tokenize.STRING]:
                rows.update(*(range(part.start[0], part.end[0] + 1) for part in statement))
            statement = []
    return len(rows)


def javascript_size(path: Path) -> int:
    """Return the number of lines of code of a JavaScript file."""
    tree = Parser(Language(language())).parse(path.read_bytes())
    rows: set[int] = set()
    nodes: list[Node] = [tree.root_node]
    while nodes:
        node = nodes.pop()
        nodes += node.children
        if not node.children and node.type != "comment":
            rows.update(range(node.start_point.row, node.end_point.row + 1))
    return len(rows)


SIZES = {".py": python_size, ".js": javascript_size, ".mjs": javascript_size}


def sizes(root: Path) -> dict[str, int]:
    """Return the lines of code of each folder, at most three folders deep."""
    lines: Counter[str] = Counter()
    for path in (path for source in SOURCES for path in (root / source).rglob("*.*")):
        inside = path.relative_to(root)
        if path.suffix in SIZES and SKIPPED.isdisjoint(inside.parts):
            folder = Path(*inside.parent.parts[:PARTS]).as_posix()
            lines[folder] += SIZES[path.suffix](path)
    return {folder: size for folder, size in lines.items() if size}


def read_table(path: Path) -> dict[str, Limit]:
    """Return the limits by folder."""
    with path.open(encoding="utf-8", newline="") as file:
        return {
            row["folder"]: Limit(int(row["lines"]), row["reason"]) for row in csv.DictReader(file)
        }


def write_table(path: Path, limits: Mapping[str, Limit]) -> None:
    """Write the limits, sorted by folder."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["folder", *Limit._fields])
        writer.writerows((folder, *limit) for folder, limit in sorted(limits.items()))


def too_large(lines: Mapping[str, int], limits: Mapping[str, Limit]) -> list[str]:
    """Return a message for each folder with more lines than its limit."""
    return [
        f"{folder}: {size} lines of code, of at most {most}. Look for what you can take away; "
        f'if it needs more, call `python tools/size.py --write "REASON" {folder}`'
        for folder, size in sorted(lines.items())
        if size > (most := limits.get(folder, Limit(0)).lines)
    ]


def too_lax(lines: Mapping[str, int], limits: Mapping[str, Limit]) -> list[str]:
    """Return a message for each folder whose limit is more than 2 % too high."""
    return [
        f"{folder}: {size} lines of code, but the table allows {limit.lines}. "
        "Call `python tools/size.py --write` to lower it"
        for folder, limit in sorted(limits.items())
        if (size := lines.get(folder, 0)) < limit.lines * (1 - MOST_SPARE)
    ]


def limits_of_today(
    lines: Mapping[str, int], limits: Mapping[str, Limit], reason: str
) -> dict[str, Limit]:
    """Return a table without room: a raised limit has the reason of today, others keep theirs."""
    return {
        folder: Limit(size, reason if size > before.lines else before.reason)
        for folder, size in lines.items()
        for before in [limits.get(folder, Limit(0))]
    }


def main(arguments: list[str] | None = None, root: Path = ROOT, table: Path = TABLE) -> int:
    """Check or write the table; return the exit status."""
    parser = argparse.ArgumentParser(description="Check the size of the code against a table.")
    parser.add_argument(
        "--write", nargs="?", const="", metavar="REASON", help="write the table; why it rises"
    )
    parser.add_argument("folders", nargs="*", help="folders that need more, for this reason")
    options = parser.parse_args(arguments)
    raised = options.folders if options.write else []
    lines, limits = sizes(root), read_table(table)
    messages = too_large({name: n for name, n in lines.items() if name not in raised}, limits)
    if options.write is None:
        messages += too_lax(lines, limits)
    elif not messages:
        write_table(table, limits_of_today(lines, limits, options.write))
    sys.stdout.writelines(f"{message}\n" for message in messages)
    sys.stdout.write(f"{sum(lines.values())} lines of code in {len(lines)} folders\n")
    return 1 if messages else 0


if __name__ == "__main__":
    sys.exit(main())
