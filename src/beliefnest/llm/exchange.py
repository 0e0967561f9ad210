"""One question and its answer as stored: in the cache and in recordings."""

import hashlib
from collections.abc import Sequence

import msgspec

from beliefnest.files import decode_json
from beliefnest.llm.messages import Message, Sampling, Usage

__all__ = ["Exchange", "decode_exchange", "encode_exchange", "request_key"]


class Exchange(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What was asked of which model, and what it answered; never a key.

    Attributes:
        model: Name of the model, as `PROVIDER:MODEL`.
        messages: What was asked.
        sampling: How the answer was drawn.
        text: The answer.
        usage: What it took.
    """

    model: str
    messages: tuple[Message, ...]
    sampling: Sampling
    text: str
    usage: Usage


def request_key(model: str, messages: Sequence[Message], sampling: Sampling) -> str:
    """Return a name for exactly this request: the same text, model and sampling, nothing else."""
    request = msgspec.json.encode([model, list(messages), sampling])
    return hashlib.sha256(request).hexdigest()


def encode_exchange(exchange: Exchange) -> bytes:
    """Return an exchange as one line of JSON, without the line's end."""
    return msgspec.json.encode(exchange)


def decode_exchange(line: bytes) -> Exchange:
    """Return an exchange from its line.

    Raises:
        msgspec.MsgspecError: The line is not an exchange.
    """
    return decode_json(line, Exchange)
