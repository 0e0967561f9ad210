"""Model wrapper that repeats a request after a temporary failure."""

import contextlib
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta

from beliefnest.errors import ModelError
from beliefnest.llm.clock import Clock
from beliefnest.llm.failures import TransientModelError, UnavailableModelError
from beliefnest.llm.messages import Answer, Message, Sampling, WrappedModel

TellWait = Callable[[str], None]
"""Function that tells the user a line about a long wait."""

_BETWEEN_LINES = 60.0
"""Seconds of a wait from one line about it to the next."""


def tell_on_stderr(line: str) -> None:
    """Write a line to standard error, if it is open."""
    if sys.stderr is not None:
        with contextlib.suppress(OSError, ValueError):
            sys.stderr.write(f"{line}\n")
            sys.stderr.flush()


@dataclass(frozen=True, slots=True)
class RetryPolicy:
    """Number and timing of repeated requests.

    Attributes:
        attempts: Greatest number of requests in all, apart from those after a wait that the
            provider asked for.
        first_wait: Seconds before the second request; doubles with each further request.
        longest_wait: Longest wait in seconds that nobody asked for.
        longest_quota: Longest wait in seconds that a provider may ask for, over all requests for
            one answer. If it asks for more, the model counts as unavailable.
    """

    attempts: int = 5
    first_wait: float = 0.5
    longest_wait: float = 60.0
    longest_quota: float = 86_400.0

    def wait_before(self, attempt: int, retry_after: float | None) -> float:
        """Return the seconds to wait before request number `attempt`, counted from 1."""
        doublings = min(attempt - 2, 60)
        backoff = min(self.first_wait * 2.0**doublings, self.longest_wait)
        return max(backoff, retry_after or 0.0)


class RetryingModel(WrappedModel, frozen=True):
    """Model that repeats requests after rate limits, server faults and lost connections.

    Attributes:
        policy: Number and timing of the requests.
        clock: Clock that waits.
        tell: Function that receives a line about each wait that the provider asked for.
    """

    policy: RetryPolicy
    clock: Clock
    tell: TellWait = tell_on_stderr

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Ask until there is an answer or the policy gives up.

        Raises:
            UnavailableModelError: No request can succeed, or the provider asks to wait too long.
            ModelError: This request cannot succeed, or all attempts failed.
        """
        requests, unasked, waited = 0, 0, 0.0
        while True:
            try:
                return self.model.answer(messages, sampling)
            except TransientModelError as error:
                requests += 1
                wait = self.policy.wait_before(requests + 1, error.retry_after)
                if error.retry_after is None:
                    unasked += 1
                    if unasked >= self.policy.attempts:
                        raise ModelError(f"{error}; gave up after {requests} requests") from None
                    self.clock.wait(wait)
                    continue
                waited += wait
                if waited > self.policy.longest_quota:
                    raise UnavailableModelError(
                        f"{error} and asks to wait {wait:,.0f} s; try again after that"
                    ) from None
                message = str(error)
            self._wait_for_quota(message, wait)

    def _wait_for_quota(self, why: str, seconds: float) -> None:
        """Wait as long as the provider asked for, with a line of progress each minute."""
        until = datetime.now().astimezone() + timedelta(seconds=seconds)
        left = seconds
        while left > 0:
            self.tell(f"{why}; waiting {left:,.0f} s as it asks, until {until:%H:%M:%S}")
            step = min(left, _BETWEEN_LINES)
            self.clock.wait(step)
            left -= step
