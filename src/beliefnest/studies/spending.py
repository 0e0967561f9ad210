"""What a study may spend and has spent, over all its workers."""

import json
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

from filelock import FileLock

from beliefnest.llm.budget import RunLimits, RunSpending, tokens_of_free
from beliefnest.llm.messages import Usage
from beliefnest.scenarios.record_forms import UsageForm, read_lines
from beliefnest.studies.store import append_line

__all__ = ["SharedBudget", "spent_in"]


@dataclass
class SharedBudget(RunSpending):
    """A budget that workers share by a file: each answer is a line in it.

    Requests under way at the same moment are all let through, as none of them has been counted
    yet: a limit is passed by no more than what the workers were asking then.

    Attributes:
        file: Where answers are counted.
    """

    file: Path = field(default=Path("spent.jsonl"))

    def check(self) -> None:
        """Refuse a further request when nothing is left; ModelError says so."""
        self.spent = spent_in(self.file)
        self.free = sum(map(tokens_of_free, _answers(self.file)))
        super().check()

    def add(self, usage: Usage) -> None:
        """Count what an answer took."""
        line = {
            "requests": usage.requests,
            "input_tokens": usage.input_tokens,
            "output_tokens": usage.output_tokens,
            "cost": usage.cost,
        }
        with FileLock(f"{self.file}.lock"):
            append_line(self.file, json.dumps(line))

    @classmethod
    def of(cls, limits: RunLimits, file: Path) -> "SharedBudget":
        """Return the budget of a study whose answers are counted in a file."""
        return cls(limits=limits, file=file)


def spent_in(file: Path) -> Usage:
    """Return what is counted in a file; the cost of known prices only."""
    return sum((replace(each, cost=each.cost or 0.0) for each in _answers(file)), Usage())


def _answers(file: Path) -> Iterator[Usage]:
    """Yield what each answer took that is counted in a file."""
    for noted in read_lines(file, UsageForm):
        yield Usage(noted.requests, noted.input_tokens, noted.output_tokens, noted.cost)
