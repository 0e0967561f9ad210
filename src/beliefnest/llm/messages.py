"""What is said to a language model and what it answers."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, Protocol

from beliefnest.world.texts import visible

__all__ = ["Answer", "Message", "Model", "Role", "Sampling", "Usage"]

Role = Literal["system", "user", "assistant"]


@dataclass(frozen=True, slots=True)
class Message:
    """One message of a conversation.

    Hidden characters of its text are written out, whoever wrote it: a model reads what a person
    would see.
    """

    role: Role
    text: str

    def __post_init__(self) -> None:
        object.__setattr__(self, "text", visible(self.text))


@dataclass(frozen=True, slots=True)
class Sampling:
    """How an answer is drawn; None leaves it to the provider.

    Attributes:
        temperature: 0 for the likeliest answer.
        seed: For providers that can repeat an answer.
        max_output_tokens: Longest answer.
    """

    temperature: float | None = 0.0
    seed: int | None = None
    max_output_tokens: int | None = 4096


@dataclass(frozen=True, slots=True)
class Usage:
    """What requests took.

    Attributes:
        requests: Number of requests that reached a provider.
        input_tokens: Tokens sent.
        output_tokens: Tokens received.
        cost: US dollars; None where a price is not known.
    """

    requests: int = 0
    input_tokens: int = 0
    output_tokens: int = 0
    cost: float | None = 0.0

    @property
    def tokens(self) -> int:
        """Tokens sent and received."""
        return self.input_tokens + self.output_tokens

    def __add__(self, other: "Usage") -> "Usage":
        unknown = self.cost is None or other.cost is None
        return Usage(
            self.requests + other.requests,
            self.input_tokens + other.input_tokens,
            self.output_tokens + other.output_tokens,
            None if unknown else (self.cost or 0.0) + (other.cost or 0.0),
        )


@dataclass(frozen=True, slots=True)
class Answer:
    """What a model answered.

    Attributes:
        text: The whole text.
        usage: What this answer took.
        cached: Whether it comes from a cache, and no request was made.
    """

    text: str
    usage: Usage = field(default_factory=Usage)
    cached: bool = False


class Model(Protocol):
    """A chat model."""

    @property
    def name(self) -> str:
        """The name that `resolve_model` gives this model for; recorded in runs."""

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Answer a conversation.

        Raises:
            ModelError: The model is not available, refused, gave no text, or a limit of
                the run was reached.
        """
