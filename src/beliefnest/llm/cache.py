"""Answers kept in a folder by exact request, so that a run can be repeated without the model."""

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import msgspec

from beliefnest.errors import ModelError
from beliefnest.files import read_regular
from beliefnest.llm.exchange import Exchange, decode_exchange, encode_exchange, request_key
from beliefnest.llm.messages import Answer, Message, Model, Sampling

__all__ = ["CacheMode", "CachedModel"]

CacheMode = Literal["read", "write", "off"]
"""`read`: use what is there, ask and keep what is not; `write`: ask always and keep;
`off`: neither."""


@dataclass(frozen=True)
class CachedModel:
    """A model whose answers are kept in a folder, one file a request.

    Attributes:
        model: Asked for what the folder does not hold.
        folder: Made when the first answer is kept.
        mode: `read` or `write`.
    """

    model: Model
    folder: Path
    mode: CacheMode

    @property
    def name(self) -> str:
        """Name of the model that is asked."""
        return self.model.name

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Return the kept answer, or the model's.

        Raises:
            ModelError: The model failed, or a file of the folder is damaged or cannot be
                read or written.
        """
        path = self.folder / f"{request_key(self.name, messages, sampling)}.json"
        if self.mode == "read":
            kept = _read(path)
            if kept is not None:
                return Answer(kept.text, kept.usage, cached=True)
        answer = self.model.answer(messages, sampling)
        if self.mode != "off":
            exchange = Exchange(self.name, tuple(messages), sampling, answer.text, answer.usage)
            _write(path, exchange)
        return answer


def _read(path: Path) -> Exchange | None:
    try:
        return decode_exchange(read_regular(path))
    except FileNotFoundError:
        return None
    except msgspec.MsgspecError as error:
        raise ModelError(f"the kept answer {path} is damaged ({error}): delete it") from None
    except OSError as error:
        raise ModelError(f"the kept answer {path} cannot be read: {error}") from None


def _write(path: Path, exchange: Exchange) -> None:
    """Write whole or not at all: a run may be killed at any time, and others may be reading."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
            file.write(encode_exchange(exchange))
        Path(file.name).replace(path)
    except OSError as error:
        raise ModelError(f"the answer cannot be kept in {path}: {error}") from None
