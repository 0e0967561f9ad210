"""Model of a policy whose spending an episode counts and limits."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import msgspec

from beliefnest.episodes.decided import Spent
from beliefnest.errors import ModelError

if TYPE_CHECKING:  # Models take long to import, and few policies ask one.
    from beliefnest.llm.messages import Answer, Message, Model, Sampling, Usage


class CountedModel(msgspec.Struct, frozen=True):
    """Model wrapper that reports the usage of each answer, even of unusable ones.

    Attributes:
        model: The model to ask.
        check: Function that raises ModelError if nothing more may be spent.
        spend: Function that receives the spending of a request.
    """

    model: "Model"
    check: Callable[[], None]
    spend: Callable[[Spent], None]

    @property
    def name(self) -> str:
        """Name of the wrapped model."""
        return self.model.name

    def answer(self, messages: "Sequence[Message]", sampling: "Sampling") -> "Answer":
        """Ask the model.

        Raises:
            ModelError: The model failed, or a limit of the episode is reached.
        """
        self.check()
        try:
            answer = self.model.answer(messages, sampling)
        except ModelError as error:
            usage: Usage | None = getattr(error, "usage", None)
            if usage is not None:
                self.spend(_spent(usage))
            raise
        self.spend(_spent(answer.usage))
        return answer


def _spent(usage: "Usage") -> Spent:
    return Spent(usage.requests, usage.tokens, usage.cost)
