"""Ledger of a plan: what its answers cost, shared by all its workers."""

import json
import os
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

from filelock import FileLock

from beliefnest.llm.budget import RunSpending, tokens_of_free
from beliefnest.llm.messages import Usage
from beliefnest.scenarios.record_forms import UsageForm, read_lines


@dataclass
class SharedBudget(RunSpending):
    """Budget that workers share through a file with a line for each answer.

    Concurrent requests all pass the check, as none of them is counted yet. The plan can therefore
    exceed a limit by at most one request of each worker.

    Attributes:
        file: File with the usage of each answer.
    """

    file: Path = field(default=Path("spent.jsonl"))

    def check(self, *, is_free: bool = False) -> None:
        """Raise ModelError if the limits are reached; a free request may use what is left."""
        self.spent = spent_in(self.file)
        self.free = sum(map(tokens_of_free, _answers(self.file)))
        super().check(is_free=is_free)

    def add(self, usage: Usage) -> None:
        """Count the usage of an answer."""
        with FileLock(f"{self.file}.lock"):
            append_line(self.file, json.dumps(asdict(usage)))


def spent_in(file: Path) -> Usage:
    """Return the total usage in a file; its cost includes only answers with known prices."""
    return sum((replace(each, cost=each.cost or 0.0) for each in _answers(file)), Usage())


def _answers(file: Path) -> Iterator[Usage]:
    """Yield the usage of each answer in a file."""
    for noted in read_lines(file, UsageForm):
        yield Usage(noted.requests, noted.input_tokens, noted.output_tokens, noted.cost)


def append_line(file: Path, line: str) -> None:
    """Append a line to a file; begin a new line if the last one is incomplete."""
    with file.open("ab+") as opened:
        size = opened.seek(0, os.SEEK_END)
        opened.seek(max(0, size - 1))
        begin = b"\n" if opened.read(1) not in (b"", b"\n") else b""
        opened.write(begin + line.encode() + b"\n")
