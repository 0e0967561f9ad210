"""What every cell of a study is played with."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from beliefnest.llm.budget import RunLimits
from beliefnest.llm.resolve import Connection
from beliefnest.studies.spending import SharedBudget

__all__ = ["Terms"]


@dataclass(frozen=True, slots=True)
class Terms:
    """What every cell of a study is played with.

    Attributes:
        answers: Folder of kept answers.
        ledger: File in which spending is counted.
        runs: Folder of recorded runs; None: nothing is recorded.
        limits: What the whole study may spend.
        owner: Process with which those that play end; None: they have lives of their own.
        environment: Where models are and their keys; None: the worker's own environment.
    """

    answers: Path
    ledger: Path
    runs: Path | None
    limits: RunLimits
    owner: int | None = None
    environment: Mapping[str, str] | None = None

    @property
    def surroundings(self) -> Mapping[str, str]:
        """Where models are and their keys."""
        return os.environ if self.environment is None else self.environment

    def connection(self) -> Connection:
        """What is put around models."""
        budget = SharedBudget.of(self.limits, self.ledger)
        return Connection(budget=budget, cache=self.answers)

    def store(self, cell: str) -> Path | None:
        """Where a cell is recorded, without what an earlier try left there; None: nowhere."""
        if self.runs is None:
            return None
        self.runs.mkdir(parents=True, exist_ok=True)
        for left in self.runs.glob(f"{cell}.bn*"):
            left.unlink()
        return self.runs / f"{cell}.bn"
