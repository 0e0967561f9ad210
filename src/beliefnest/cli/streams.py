"""Standard streams that may be closed, at the start or while a command runs.

A closed stream loses what would have been shown there, and nothing else: the command goes on, and
its status and its files are those of any other run.
"""

import io
import os
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TextIO

if TYPE_CHECKING:  # There is no such module when the program runs.
    from _typeshed import ReadableBuffer

_STANDARD = (0, 1, 2)
_ERRORS = 2


class _LossyFile(io.FileIO):
    """Standard stream that drops everything once its reader is gone, or its disk is full."""

    def write(self, content: "ReadableBuffer", /) -> int:
        try:
            return super().write(content)
        except OSError as fault:
            # Processes started from now on, and libraries that write by themselves, find it open.
            hole = os.open(os.devnull, os.O_WRONLY)
            os.dup2(hole, self.fileno())
            os.close(hole)
            if not isinstance(fault, BrokenPipeError) and self.fileno() != _ERRORS:
                fault.filename = "the standard output"
                raise
            return len(memoryview(content).cast("B"))


def open_streams() -> None:
    """Open the standard streams that are closed, and let output outlive its readers.

    A run file that got the number of a closed stream would receive what is printed.
    """
    for number in _STANDARD:
        try:
            os.fstat(number)
        except OSError:
            # The smallest free number is this one.
            os.open(os.devnull, os.O_RDWR)
            os.set_inheritable(number, True)
    sys.stdin = sys.stdin or open(0, encoding="utf-8", closefd=False)  # noqa: SIM115 # for the whole process
    sys.stdout = _lossy(sys.stdout, 1)
    sys.stderr = _lossy(sys.stderr, _ERRORS)


def _lossy(stream: TextIO | None, number: int) -> TextIO:
    """Return a text stream to a standard stream, with the encoding of the present one."""
    if stream is not None:
        stream.flush()
    return io.TextIOWrapper(
        io.BufferedWriter(_LossyFile(number, "w", closefd=False)),
        encoding="utf-8" if stream is None else stream.encoding,
        errors="backslashreplace" if stream is None else stream.errors,
        line_buffering=number == _ERRORS or os.isatty(number),
    )


def print_warnings_as_lines() -> None:
    """Print warnings of this package as messages, once each, without a line of source."""
    usual = warnings.showwarning
    shown: set[str] = set()

    def show(
        message: Warning | str,
        category: type[Warning],
        filename: str,
        lineno: int,
        file: TextIO | None = None,
        line: str | None = None,
    ) -> None:
        if _is_own(category):
            subject = str(getattr(message, "subject", message))
            if subject not in shown:
                print(f"beliefnest: warning: {message}", file=sys.stderr)  # noqa: T201
            shown.add(subject)
        else:
            usual(message, category, filename, lineno, file, line)

    warnings.showwarning = show


@contextmanager
def noted_warnings() -> Iterator[dict[str, str]]:
    """Note the warnings of this package, by subject, to repeat them below results."""
    shown = warnings.showwarning
    noted: dict[str, str] = {}

    def show(message: Warning | str, category: type[Warning], *place: Any, **where: Any) -> None:
        if _is_own(category):
            noted.setdefault(str(getattr(message, "subject", message)), f"warning: {message}")
        shown(message, category, *place, **where)

    warnings.showwarning = show
    try:
        yield noted
    finally:
        warnings.showwarning = shown


def _is_own(category: type[Warning]) -> bool:
    return category.__module__.partition(".")[0] == __name__.partition(".")[0]
