"""What a run may spend on a model."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from beliefnest.errors import InputError, ModelError
from beliefnest.llm.failures import UnusableAnswerError
from beliefnest.llm.messages import Answer, Message, Model, Sampling, Usage

__all__ = ["MeteredModel", "RunLimits", "RunSpending", "tokens_of_free"]


_TOKENS = 1_000_000


@dataclass(frozen=True, slots=True)
class RunLimits:
    """What all answers of a run together may take; None: no limit.

    Attributes:
        tokens: Sent and received. The default guards against costs: it leaves out answers that
            cost nothing, as those of a server of one's own. Any other number counts all answers.
        cost: US dollars. Answers whose price is not known are held by `tokens` alone.
    """

    tokens: int | None = _TOKENS
    cost: float | None = 5.0

    def __post_init__(self) -> None:
        for name, value in (("max_tokens", self.tokens), ("max_cost", self.cost)):
            if value is not None and not value >= 0:
                raise InputError(f"{name} is {value!r}; give at least 0, or none for no limit")


@dataclass
class RunSpending:
    """What a run has spent so far, over all its models.

    Attributes:
        limits: What it may spend.
        spent: What it has spent; the cost counts known prices only.
        free: Tokens in it of answers that cost nothing.
    """

    limits: RunLimits = field(default_factory=RunLimits)
    spent: Usage = field(default_factory=Usage)
    free: int = 0

    def check(self) -> None:
        """Refuse a further request when nothing is left.

        Raises:
            ModelError: A limit is reached.
        """
        tokens, cost = self.limits.tokens, self.limits.cost
        used = self.spent.tokens - (self.free if tokens == _TOKENS else 0)
        if tokens is not None and used >= tokens:
            raise ModelError(
                f"the run has used {used:,} tokens and may use {tokens:,}; "
                "raise the limit to go on: --max-tokens, or max_tokens of a study"
            )
        if cost is not None and (self.spent.cost or 0.0) >= cost:
            raise ModelError(
                f"the run has cost {self.spent.cost:.2f} US dollars and may cost {cost:.2f}; "
                "raise the limit to go on: --max-cost, or max_cost of a study"
            )

    def add(self, usage: Usage) -> None:
        """Count what an answer took."""
        priced = Usage(usage.requests, usage.input_tokens, usage.output_tokens, usage.cost or 0.0)
        self.spent = self.spent + priced
        self.free += tokens_of_free(usage)


def tokens_of_free(usage: Usage) -> int:
    """Return the tokens of an answer that cost nothing; 0 for one that did, or may have."""
    return usage.tokens if usage.cost == 0 else 0


@dataclass(frozen=True)
class MeteredModel:
    """A model whose answers are counted against a budget; asked only while some is left."""

    model: Model
    budget: RunSpending

    @property
    def name(self) -> str:
        """Name of the model that is asked."""
        return self.model.name

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Ask, if the budget allows.

        Raises:
            ModelError: A limit of the run is reached, or the model failed.
        """
        self.budget.check()
        try:
            answer = self.model.answer(messages, sampling)
        except UnusableAnswerError as error:
            self.budget.add(error.usage)
            raise
        self.budget.add(answer.usage)
        return answer
