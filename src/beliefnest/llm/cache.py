"""Cache of answers in a folder, so that a run can be repeated without the model."""

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import msgspec

from beliefnest.errors import ModelError
from beliefnest.files import read_regular, replace_file
from beliefnest.llm.messages import Answer, Message, Sampling, WrappedModel
from beliefnest.llm.stored_exchange import Exchange, decode_exchange, exchange_of, request_key

CacheMode = Literal["read", "only", "write", "off"]
"""Mode of the cache. `read`: use cached answers, ask for the others and store them. `only`:
use cached answers, and ask for no others. `write`: always ask, and store the answers. `off`:
neither use nor store answers."""


class CachedModel(WrappedModel, frozen=True):
    """Model wrapper with a cache folder, one file per request.

    Attributes:
        folder: Folder of the cache; created with the first answer.
        mode: `read`, `only` or `write`.
    """

    folder: Path
    mode: CacheMode

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Return the cached answer or ask the model.

        Raises:
            ModelError: The model failed, or a file of the cache is damaged or cannot be read or
                written.
        """
        path = self._path(messages, sampling)
        if self.mode in ("read", "only"):
            kept = _read(path)
            if kept is not None:
                return kept.answer
        answer = self.model.answer(messages, sampling)
        if self.mode != "off":
            exchange = exchange_of(self.name, messages, sampling, answer)
            _write(path, exchange)
        return answer

    def _path(self, messages: Sequence[Message], sampling: Sampling) -> Path:
        return self.folder / f"{request_key(self.name, messages, sampling)}.json"


def _read(path: Path) -> Exchange | None:
    try:
        return decode_exchange(read_regular(path))
    except FileNotFoundError:
        return None
    except msgspec.MsgspecError as error:
        raise ModelError(f"the cached answer {path} is damaged ({error}): delete it") from None
    except OSError as error:
        raise ModelError(f"the cached answer {path} cannot be read: {error}") from None


def _write(path: Path, exchange: Exchange) -> None:
    # As a whole: a run may be killed, and others may be reading.
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        replace_file(path, msgspec.json.encode(exchange))
    except OSError as error:
        raise ModelError(f"the answer cannot be stored in {path}: {error}") from None
