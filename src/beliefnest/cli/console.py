"""Where results and progress go: results to stdout, progress to stderr."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Column, Table

from beliefnest.cli.text import printable
from beliefnest.nest.face.nest import Progress as OnProgress

__all__ = ["folded", "print_table", "progress_on", "stdout"]

_PLAIN_WIDTH = 140
_NARROWEST = 20
_WORD = 12
"""Letters of a word that a column has to have room for."""


def stdout() -> Console:
    """Return the console for results: coloured on a terminal alone.

    It is as wide as the terminal, or as COLUMNS says, or else wide enough for a table.
    """
    terminal = sys.stdout.isatty()
    # Files get no codes, whatever the environment says of colours.
    return Console(width=_width(terminal=terminal), force_terminal=terminal)


def folded(table: Table) -> Table:
    """Return the same table, whose cells are folded and never cut, however little room there is."""
    for column in table.columns:
        column.overflow, column.no_wrap = "fold", False
    return table


def print_table(console: Console, table: Table) -> None:
    """Print a table; where its columns have no room for words, print each row as a list.

    Args:
        console: Where it is printed.
        table: The table; its cells are folded and never cut.
    """
    if sum(map(_least, table.columns)) + 3 * len(table.columns) <= console.width:
        console.print(folded(table))
        return
    if table.title is not None:
        console.print(table.title)
    for row in zip(*(column.cells for column in table.columns), strict=True):
        listed = Table.grid(padding=(0, 2, 0, 0))
        for column, cell in zip(table.columns, row, strict=True):
            listed.add_row(column.header, cell)
        console.print(folded(listed))
        console.print()


def _least(column: Column) -> int:
    """Return the columns of a terminal in which words of usual length are not broken."""
    texts = [str(each) for each in (column.header, *column.cells)]
    longest = max((len(word) for text in texts for word in text.split()), default=0)
    return min(longest, _WORD)


def _width(*, terminal: bool) -> int | None:
    """Columns; None: as many as the terminal has."""
    wanted = os.environ.get("COLUMNS", "")
    if wanted.isdecimal() and int(wanted) >= _NARROWEST:
        return int(wanted)
    return None if terminal else _PLAIN_WIDTH


@contextmanager
def progress_on(title: str) -> Iterator[OnProgress]:
    """Show what is being done on stderr: a bar on a terminal, a line each elsewhere."""
    # A notebook shows what a command writes, and is no terminal, whatever it says of itself.
    notebook = "JPY_PARENT_PID" in os.environ
    plain = notebook or not sys.stderr.isatty()
    console = Console(stderr=True, markup=False, force_terminal=not plain)
    title = printable(title)
    if plain:
        console.width = _width(terminal=False) or _PLAIN_WIDTH

        def say(what: str, done: int, total: int) -> None:
            # Of what is one step alone, or is not counted yet, there is nothing to count.
            count = f" ({done}/{total})" if total else ""
            console.print(f"{title}: {printable(what)}{count}", highlight=False)

        yield say
        return
    columns = (
        SpinnerColumn(),
        TextColumn(title, markup=False),
        BarColumn(bar_width=20),
        TextColumn("{task.description}", markup=False),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("starting the world", total=None)
        yield lambda what, done, total: bar.update(
            task, description=printable(what), completed=done, total=total or None
        )
