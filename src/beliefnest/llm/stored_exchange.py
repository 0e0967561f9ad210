"""Stored form of a request and its answer, for the cache and for recordings."""

import hashlib
from collections.abc import Sequence

import msgspec

from beliefnest.files import decode_json
from beliefnest.llm.messages import Answer, AnswerForm, Finish, Message, Sampling, Usage


class Exchange(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """A request to a model and its answer; it never contains a key.

    Attributes:
        model: Name of the model, as `PROVIDER:MODEL`.
        messages: Messages of the request.
        sampling: Sampling parameters.
        text: Text of the answer.
        usage: Resources that the answer used.
        date: Day of the answer, as in `Answer`.
        finish: Reason for its end, as in `Answer`.
        form: Form that the request asked for, as in `Answer`.
    """

    model: str
    messages: tuple[Message, ...]
    sampling: Sampling
    text: str
    usage: Usage
    date: str = ""
    finish: Finish = "stop"
    form: AnswerForm = "text"

    @property
    def answer(self) -> Answer:
        """Return the answer as one that needed no request."""
        return Answer(
            self.text, self.usage, cached=True, date=self.date, finish=self.finish, form=self.form
        )


def request_key(model: str, messages: Sequence[Message], sampling: Sampling) -> str:
    """Return a hash of a request; it changes with any change of text, model or sampling."""
    request = msgspec.json.encode([model, list(messages), sampling])
    return hashlib.sha256(request).hexdigest()


def exchange_of(
    model: str, messages: Sequence[Message], sampling: Sampling, answer: Answer
) -> Exchange:
    """Return the stored form of a request and its answer."""
    return Exchange(
        model,
        tuple(messages),
        sampling,
        answer.text,
        answer.usage,
        answer.date,
        answer.finish,
        answer.form,
    )


def decode_exchange(line: bytes) -> Exchange:
    """Decode an exchange from its line.

    Raises:
        msgspec.MsgspecError: The line is not an exchange.
    """
    return decode_json(line, Exchange)
