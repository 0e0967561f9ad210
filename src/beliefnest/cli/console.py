"""Consoles of the commands: results go to stdout, progress goes to stderr."""

import json
import os
import sys
from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rich.box import SIMPLE_HEAVY
from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderableType
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.segment import Segment
from rich.table import Column, Table
from rich.text import Text

from beliefnest.cli.terminal_text import printable

if TYPE_CHECKING:  # Importing nests takes long, and many commands need none.
    from beliefnest.nest.acting.script import OnProgress

Printed = Table | Text | str
"""Part of a report: a table, words to wrap, or a line to leave whole."""

_LINES = 20
"""Greatest number of lines of progress where there is no terminal."""
_PLAIN_WIDTH = 140
_PIPE_WIDTH = 280
_NARROWEST = 20
_WORD = 12
"""Letters of a word that every column of a terminal must have room for."""


class _SafeConsole(Console):
    """Console that escapes control characters of all texts, also of those in tables and names."""

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterable[Segment]:
        """Yield the segments of something to print; only the console's own may be controls."""
        for segment in super().render(renderable, options):
            is_own = segment.control is not None
            yield segment if is_own else segment._replace(text=printable(segment.text))


def stdout() -> Console:
    """Return the console for results, with colours only on a terminal.

    Its width is COLUMNS if set, else the width of the terminal, else enough for a table.
    """
    terminal = sys.stdout.isatty()
    # Files get no colour codes, even if environment variables ask for colours.
    return _SafeConsole(width=_width(terminal=terminal), force_terminal=terminal)


def folded(table: Table) -> Table:
    """Make all columns of a table fold their text instead of cutting it, and return the table.

    Control characters in its texts are escaped.
    """
    for column in table.columns:
        column.overflow, column.no_wrap = "fold", False
        # Widths are those of the escaped texts.
        column.header = _shown(column.header)
        column._cells[:] = map(_shown, column._cells)
    return table


def _shown(cell: RenderableType) -> RenderableType:
    return printable(cell) if isinstance(cell, str) else cell


def result_table(*headings: str, title: str | None = None, right: Collection[str] = ()) -> Table:
    """Return a table without rows, with the look of all reports.

    Args:
        headings: Headings of the columns.
        title: Title above the table; None: no title.
        right: Headings of the columns of numbers, which are aligned at the right.
    """
    table = Table(title=title, title_justify="left", box=SIMPLE_HEAVY)
    for heading in headings:
        table.add_column(heading, justify="right" if heading in right else "left")
    return table


def report_text(parts: Iterable[Printed]) -> str:
    """Return a report as text for stdout.

    Args:
        parts: Its parts; texts are no markup.
    """
    console = stdout()
    with console.capture() as captured:
        for part in parts:
            if isinstance(part, Table):
                print_table(console, part)
            elif isinstance(part, Text):
                console.print(part)
            else:
                console.print(part, markup=False, emoji=False, highlight=False, soft_wrap=True)
    return captured.get()


def print_report(report: object, parts: Iterable[Printed], *, as_json: bool) -> None:
    """Print results: as a JSON value, or as a report (see `report_text`)."""
    sys.stdout.write(json.dumps(report, indent=2) + "\n" if as_json else report_text(parts))


def print_table(console: Console, table: Table) -> None:
    """Print a table, or each row as a list if the columns are too narrow for words.

    In a pipe without COLUMNS, no word of a table is broken, and there is room for wide ones.

    Args:
        console: Console to print to.
        table: The table; its cells are folded and never cut.
    """
    piped = not (console.is_terminal or _wanted_width())
    room, longest = (_PIPE_WIDTH, _PIPE_WIDTH) if piped else (console.width, _WORD)
    least = [min(_longest_word(column), longest) for column in table.columns]
    if sum(least) + 3 * len(least) <= room:
        for column, width in zip(folded(table).columns, least, strict=True):
            column.min_width = width if piped else None
        console.print(table, crop=not piped)
        return
    if table.title is not None:
        console.print(table.title)
    for row in zip(*(column.cells for column in table.columns), strict=True):
        listed = Table.grid(padding=(0, 2, 0, 0))
        for column, cell in zip(table.columns, row, strict=True):
            listed.add_row(column.header, cell)
        console.print(folded(listed))
        console.print()


def _longest_word(column: Column) -> int:
    """Return the width in characters of the longest word of a column."""
    texts = [str(each) for each in (column.header, *column.cells)]
    return max((cell_len(word) for text in texts for word in text.split()), default=0)


def _width(*, terminal: bool) -> int | None:
    """Return the width of a console in characters; None: the width of the terminal."""
    return _wanted_width() or (None if terminal else _PLAIN_WIDTH)


def _wanted_width() -> int | None:
    wanted = os.environ.get("COLUMNS", "")
    return int(wanted) if wanted.isdecimal() and int(wanted) >= _NARROWEST else None


@contextmanager
def progress_on(title: str) -> "Iterator[OnProgress]":
    """Show progress on stderr: a bar on a terminal, else a line, for every twentieth of a total."""
    # The output of a command in a notebook is no terminal, even if it claims to be one.
    notebook = "JPY_PARENT_PID" in os.environ
    plain = notebook or not sys.stderr.isatty()
    console = _SafeConsole(stderr=True, markup=False, force_terminal=not plain)
    title = printable(title)
    if plain:
        console.width = _width(terminal=False) or _PLAIN_WIDTH

        parts: set[tuple[int, int]] = set()
        last = 0

        def say(what: str, done: int, total: int) -> None:
            nonlocal last
            if done < last:  # Another phase, perhaps with the same total.
                parts.clear()
            last = done
            # A total of 0 means that steps are not counted.
            part = total, _LINES * done // total if total else -1
            if part in parts and total > _LINES:
                return
            parts.add(part)
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
