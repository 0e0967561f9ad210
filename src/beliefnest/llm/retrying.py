"""A model that is asked again when a failure may pass."""

from collections.abc import Sequence
from dataclasses import dataclass

from beliefnest.errors import ModelError
from beliefnest.llm.clock import Clock
from beliefnest.llm.failures import TransientModelError
from beliefnest.llm.messages import Answer, Message, Model, Sampling

__all__ = ["RetryPolicy", "RetryingModel"]


@dataclass(frozen=True, slots=True)
class RetryPolicy:
    """How often and when a request is made again.

    Attributes:
        attempts: Requests in all.
        first_wait: Seconds before the second request; doubles each time.
        longest_wait: Seconds; a provider that asks for more is not waited for.
    """

    attempts: int = 5
    first_wait: float = 0.5
    longest_wait: float = 60.0

    def wait_before(self, attempt: int, retry_after: float | None) -> float:
        """Return seconds to wait before request number `attempt`, which counts from 1."""
        backoff = min(self.first_wait * 2.0 ** (attempt - 2), self.longest_wait)
        return max(backoff, retry_after or 0.0)


@dataclass(frozen=True)
class RetryingModel:
    """Asks another model again after rate limits, server faults and dropped connections."""

    model: Model
    policy: RetryPolicy
    clock: Clock

    @property
    def name(self) -> str:
        """Name of the model that is asked."""
        return self.model.name

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Ask until there is an answer or the policy ends.

        Raises:
            ModelError: The model failed for good, or once more than the policy allows.
        """
        attempt = 1
        while True:
            try:
                return self.model.answer(messages, sampling)
            except TransientModelError as error:
                attempt += 1
                wait = self.policy.wait_before(attempt, error.retry_after)
                if attempt > self.policy.attempts:
                    raise ModelError(f"{error}; gave up after {attempt - 1} requests") from None
                if wait > self.policy.longest_wait:
                    raise ModelError(
                        f"{error} and asks to wait {wait:g} s; try again after that"
                    ) from None
            self.clock.wait(wait)
