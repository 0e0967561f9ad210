"""Errors of models: short messages without secrets that say what to do."""

from beliefnest.errors import ModelError
from beliefnest.llm.messages import Usage
from beliefnest.world.texts import on_one_line

_LONGEST_EXCERPT = 300


class TransientModelError(ModelError):
    """A temporary failure: a rate limit, an overloaded server, a lost connection.

    Attributes:
        retry_after: Seconds that the provider asked to wait; None if it named none.
    """

    def __init__(self, message: str, retry_after: float | None = None) -> None:
        super().__init__(message)
        self.retry_after = retry_after


class UnavailableModelError(ModelError):
    """A failure that lasts until the user does something: no server, a wrong key, no credit.

    Whoever asks many questions stops at the first of these.
    """


class LimitReachedError(ModelError):
    """A limit of the whole run is reached, so that no model is asked any more."""


class UnusableAnswerError(ModelError):
    """An answer that cannot be used: malformed, or never finished.

    Attributes:
        usage: Resources that it used nevertheless.
    """

    def __init__(self, message: str, usage: Usage) -> None:
        super().__init__(message)
        self.usage = usage


NOT_ASKED = (UnavailableModelError, LimitReachedError)
"""Errors after which a model was not asked. All others mean that no answer came."""


def excerpt(text: str) -> str:
    """Return the beginning of a text, on one line, for a message."""
    line = on_one_line(text[: 2 * _LONGEST_EXCERPT])
    cut = len(text) > 2 * _LONGEST_EXCERPT or len(line) > _LONGEST_EXCERPT
    return f"{line[:_LONGEST_EXCERPT]}..." if cut else line
