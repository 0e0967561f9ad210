"""Model wrapper that repeats a request after a temporary failure."""

from collections.abc import Sequence
from dataclasses import dataclass

from beliefnest.errors import ModelError
from beliefnest.llm.clock import Clock
from beliefnest.llm.failures import TransientModelError
from beliefnest.llm.messages import Answer, Message, Model, Sampling

__all__ = ["RetryPolicy", "RetryingModel"]


@dataclass(frozen=True, slots=True)
class RetryPolicy:
    """Number and timing of repeated requests.

    Attributes:
        attempts: Greatest number of requests in all.
        first_wait: Seconds before the second request; doubles with each further request.
        longest_wait: Longest wait in seconds. If a provider asks for more, the request fails.
    """

    attempts: int = 5
    first_wait: float = 0.5
    longest_wait: float = 60.0

    def wait_before(self, attempt: int, retry_after: float | None) -> float:
        """Return the seconds to wait before request number `attempt`, counted from 1."""
        backoff = min(self.first_wait * 2.0 ** (attempt - 2), self.longest_wait)
        return max(backoff, retry_after or 0.0)


@dataclass(frozen=True)
class RetryingModel:
    """Model that repeats requests after rate limits, server faults and lost connections."""

    model: Model
    policy: RetryPolicy
    clock: Clock

    @property
    def name(self) -> str:
        """Name of the wrapped model."""
        return self.model.name

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Ask until there is an answer or the policy gives up.

        Raises:
            ModelError: The failure is permanent, or all attempts failed.
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
