"""Messages to a language model, and its answers."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, Protocol

import msgspec

from beliefnest.world.texts import visible

Role = Literal["system", "user", "assistant"]

AnswerForm = Literal["text", "schema", "tool"]
"""Form of an answer: free text, JSON by a schema, or the arguments of a tool."""

Finish = Literal["stop", "length", "content_filter"]
"""Reason for the end of an answer. `stop`: the model ended it. `length`: a limit cut it off.
`content_filter`: the model or its provider refused."""


@dataclass(frozen=True, slots=True)
class Message:
    """One message of a conversation.

    Hidden characters of the text are escaped, whoever wrote it: a model reads the text that a
    person would see.
    """

    role: Role
    text: str

    def __post_init__(self) -> None:
        object.__setattr__(self, "text", visible(self.text))


@dataclass(frozen=True, slots=True)
class Sampling:
    """Sampling parameters; None leaves the choice to the provider.

    Attributes:
        temperature: Sampling temperature; 0 asks for the likeliest answer.
        seed: Seed, for providers that can repeat an answer.
        max_output_tokens: Greatest length of an answer; None: as long as the provider allows.
    """

    temperature: float | None = 0.0
    seed: int | None = None
    max_output_tokens: int | None = None


@dataclass(frozen=True, slots=True)
class ChoiceSampling(Sampling):
    """Sampling parameters of an answer in the provider's structured form.

    Attributes:
        options: Options, one of which the answer must name.
    """

    options: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Usage:
    """Resources that requests used.

    Attributes:
        requests: Number of requests that reached a provider.
        input_tokens: Number of tokens sent.
        output_tokens: Number of tokens received.
        cost: Cost in US dollars; None if a price is unknown.
    """

    requests: int = 0
    input_tokens: int = 0
    output_tokens: int = 0
    cost: float | None = 0.0

    @property
    def tokens(self) -> int:
        """Number of tokens sent and received."""
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
    """A model's answer.

    Attributes:
        text: Full text.
        usage: Resources that this answer used.
        cached: True if the answer comes from a cache without a request.
        date: Day of the answer (UTC, YYYY-MM-DD); empty: not known, or the same on every day.
        finish: Reason for its end. The text of a cut or refused answer may be empty.
        form: Form that the request asked for: free text, JSON by a schema, or the call of a tool.
    """

    text: str
    usage: Usage = field(default_factory=Usage)
    cached: bool = False
    date: str = ""
    finish: Finish = "stop"
    form: AnswerForm = "text"


class Model(Protocol):
    """A chat model."""

    @property
    def name(self) -> str:
        """Name under which `resolve_model` finds this model; runs record it."""

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Answer a conversation.

        Raises:
            ModelError: The model is not available or gave no answer, or the run reached a limit.
        """


class WrappedModel(msgspec.Struct, frozen=True):
    """Part of a model that asks another one, under the same name.

    Attributes:
        model: The model to ask.
    """

    model: Model

    @property
    def name(self) -> str:
        """Name of the wrapped model."""
        return self.model.name
