"""Terms of a study: the settings that all its cells share."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from beliefnest.llm.budget import RunLimits
from beliefnest.llm.cache import CacheMode
from beliefnest.llm.remote import AnswerLimits
from beliefnest.llm.resolve import Connection
from beliefnest.studies.spending import SharedBudget


@dataclass(frozen=True, slots=True)
class Terms:
    """Settings that all cells of a study share.

    Attributes:
        answers: Folder of cached answers.
        ledger: File with the usage of each answer.
        runs: Folder of recorded runs; None: no recording.
        limits: Limits of tokens and cost of the whole study.
        environment: Variables with addresses and keys of models; None: the worker's environment.
        cache_mode: Use of the cached answers.
    """

    answers: Path
    ledger: Path
    runs: Path | None
    limits: RunLimits
    environment: Mapping[str, str] | None = None
    cache_mode: CacheMode = "read"

    @property
    def surroundings(self) -> Mapping[str, str]:
        """Return the variables with addresses and keys of models."""
        return os.environ if self.environment is None else self.environment

    def connection(self, answer_limits: AnswerLimits | None = None) -> Connection:
        """Return the connection to models, with budget and cache.

        Args:
            answer_limits: Limits on one answer; None: the default ones.
        """
        return Connection(
            budget=SharedBudget.of(self.limits, self.ledger),
            answer_limits=answer_limits or AnswerLimits(),
            cache=self.answers,
            cache_mode=self.cache_mode,
        )

    def store(self, cell: str) -> Path | None:
        """Return the run file of a cell, after deleting an earlier try's; None: no recording."""
        if self.runs is None:
            return None
        self.runs.mkdir(parents=True, exist_ok=True)
        for left in self.runs.glob(f"{cell}.bn*"):
            left.unlink()
        return self.runs / f"{cell}.bn"
