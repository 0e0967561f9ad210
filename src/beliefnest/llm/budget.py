"""Limits on one answer, and on the tokens and the cost of a run."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from beliefnest.errors import InputError
from beliefnest.llm.failures import LimitReachedError, UnusableAnswerError
from beliefnest.llm.messages import Answer, Message, Sampling, Usage, WrappedModel

_TOKENS = 1_000_000


@dataclass(frozen=True, slots=True)
class AnswerLimits:
    """Limits on one answer.

    Attributes:
        seconds: Longest silence after the first token; each token starts the count again.
        first_token_seconds: Longest time from the request to the first token. A server may have to
            load its model, and reads the whole prompt before it answers.
        characters: Length, with thinking, at which an answer is cut off. No model writes as much;
            this bounds the memory that a faulty server can use.
        silent_bytes: Greatest number of bytes between two tokens.
    """

    seconds: float = 120.0
    first_token_seconds: float = 600.0
    characters: int = 4_000_000
    silent_bytes: int = 2**26


@dataclass(frozen=True, slots=True)
class RunLimits:
    """Limits on the sum of all answers of a run; None means no limit.

    Attributes:
        tokens: Greatest number of tokens sent and received. The default value protects against
            costs and therefore ignores answers that cost nothing, such as those of your own
            server. Any other value counts all answers.
        cost: Greatest cost in US dollars; 0 admits models that are known to cost nothing. Answers
            without a known price count for `tokens` only.
    """

    tokens: int | None = _TOKENS
    cost: float | None = 5.0

    def __post_init__(self) -> None:
        for name, value in (("max_tokens", self.tokens), ("max_cost", self.cost)):
            if value is not None and not value >= 0:
                raise InputError(f"{name} is {value!r}; give at least 0, or none for no limit")


@dataclass
class RunSpending:
    """Tokens and cost that a run has used so far, over all its models.

    Attributes:
        limits: Limits of the run.
        spent: Sum over all answers; its cost includes known prices only.
        free: Tokens among them that cost nothing.
    """

    limits: RunLimits = field(default_factory=RunLimits)
    spent: Usage = field(default_factory=Usage)
    free: int = 0

    def check(self, *, is_free: bool = False) -> None:
        """Refuse a further request if a limit is reached.

        Args:
            is_free: True if the request is known to cost nothing.

        Raises:
            ModelError: A limit is reached.
        """
        tokens, cost = self.limits.tokens, self.limits.cost
        used = self.spent.tokens - (self.free if tokens == _TOKENS else 0)
        if tokens is not None and used >= tokens:
            raise LimitReachedError(
                f"the run has used {used:,} tokens and may use {tokens:,}; "
                "raise the limit to go on: --max-tokens, or max_tokens of a study"
            )
        paid = self.spent.cost or 0.0
        if cost is not None and (paid > cost or (paid == cost and not is_free)):
            raise LimitReachedError(
                f"the run has cost {paid:.2f} US dollars and may cost {cost:.2f}; "
                "raise the limit to go on: --max-cost, or max_cost of a study"
            )

    def add(self, usage: Usage) -> None:
        """Add the usage of an answer."""
        priced = Usage(usage.requests, usage.input_tokens, usage.output_tokens, usage.cost or 0.0)
        self.spent = self.spent + priced
        self.free += tokens_of_free(usage)


def tokens_of_free(usage: Usage) -> int:
    """Return the tokens of an answer that cost nothing; 0 if it cost something, or may have."""
    return usage.tokens if usage.cost == 0 else 0


class MeteredModel(WrappedModel, frozen=True):
    """Model wrapper that counts answers against a budget and stops when it is used up.

    Attributes:
        budget: Limits of the run and its usage so far.
        is_free: True if the model is known to cost nothing.
    """

    budget: RunSpending
    is_free: bool = False

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Ask the model if the budget allows it.

        Raises:
            ModelError: A limit of the run is reached, or the model failed.
        """
        self.budget.check(is_free=self.is_free)
        try:
            answer = self.model.answer(messages, sampling)
        except UnusableAnswerError as error:
            self.budget.add(error.usage)
            raise
        self.budget.add(answer.usage)
        return answer
