"""Terms of a plan: what all its cells share."""

import os
from collections.abc import Mapping
from pathlib import Path

import msgspec

from beliefnest.llm.budget import AnswerLimits, RunLimits
from beliefnest.llm.cache import CacheMode
from beliefnest.llm.messages import Model
from beliefnest.llm.model_settings import ModelSettings
from beliefnest.llm.resolve import Connection, can_vary, is_free, open_model
from beliefnest.plan.spending import SharedBudget
from beliefnest.prompts import Renderer
from beliefnest.worlds.by_name import Worlds


class Terms(msgspec.Struct, frozen=True):
    """Settings that all cells of a plan share.

    Attributes:
        answers: Folder of cached answers.
        ledger: File with the usage of each answer.
        runs: Folder of recorded runs; None: no recording.
        limits: Limits of tokens and cost of the whole plan.
        environment: Variables with addresses and keys of models; None: the worker's environment.
        cache_mode: Use of the cached answers.
        record: File to which every exchange with a model is appended; None: no recording.
        models: Models that all cells share, by name; those of other names are opened for each cell.
    """

    answers: Path
    ledger: Path
    runs: Path | None
    limits: RunLimits
    environment: Mapping[str, str] | None = None
    cache_mode: CacheMode = "read"
    record: Path | None = None
    models: Mapping[str, Model] = msgspec.field(default_factory=dict)

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
            budget=SharedBudget(self.limits, file=self.ledger),
            answer_limits=answer_limits or AnswerLimits(),
            cache=self.answers,
            cache_mode=self.cache_mode,
            record=self.record,
        )

    def model(self, name: str, settings: ModelSettings) -> Model:
        """Return the model that a cell asks.

        Raises:
            BeliefNestError: There is no such model, or the limits are reached. The caller asks
                for the model first, so that no script is played in vain.
        """
        if name not in self.models and can_vary(name):
            budget = self.connection().budget
            budget.check(is_free=is_free(name, self.surroundings))
        return self.reader(name, settings)

    def reader(self, name: str, settings: ModelSettings) -> Model:
        """Return the model that extracts claims from utterances; raise as `open_model` does."""
        if name in self.models:
            return self.models[name]
        return open_model(name, self.surroundings, self.connection(settings.answer_limits))

    def store(self, cell: str) -> Path | None:
        """Return the run file of a cell, after deleting an earlier try's; None: no recording."""
        if self.runs is None:
            return None
        self.runs.mkdir(parents=True, exist_ok=True)
        for left in self.runs.glob(f"{cell}.bn*"):
            left.unlink()
        return self.runs / f"{cell}.bn"


class PlayStage(msgspec.Struct, frozen=True):
    """PlayStage on which a worker plays its cells.

    Attributes:
        terms: Terms of the plan.
        worlds: Worlds that stay open between cells.
        renderer: Renderer of prompts.
    """

    terms: Terms
    worlds: Worlds
    renderer: Renderer
