"""Where results and progress go: results to stdout, progress to stderr."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from beliefnest.cli.text import printable
from beliefnest.nest.face.nest import Progress as OnProgress

__all__ = ["progress_on", "stdout"]

_PLAIN_WIDTH = 140


def stdout() -> Console:
    """The console for results; wide enough for a table where there is no terminal."""
    return Console(width=None if sys.stdout.isatty() else _PLAIN_WIDTH)


@contextmanager
def progress_on(title: str) -> Iterator[OnProgress]:
    """Show what is being done on stderr: a bar on a terminal, a line each elsewhere."""
    console = Console(stderr=True, markup=False)
    title = printable(title)
    if not console.is_terminal:
        console.width = _PLAIN_WIDTH

        def say(what: str, done: int, total: int) -> None:
            console.print(f"{title}: {printable(what)} ({done}/{total})", highlight=False)

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
            task, description=printable(what), completed=done, total=total
        )
