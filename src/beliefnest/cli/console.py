"""Where results and progress go: results to stdout, progress to stderr."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Table

from beliefnest.cli.text import printable
from beliefnest.nest.face.nest import Progress as OnProgress

__all__ = ["folded", "progress_on", "stdout"]

_PLAIN_WIDTH = 140
_NARROWEST = 20


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
