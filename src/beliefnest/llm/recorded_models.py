"""Models whose answers come from a file: written by hand, or recorded in an earlier run."""

from collections import defaultdict, deque
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec

from beliefnest.errors import InputError, ModelError
from beliefnest.files import decode_json, read_regular
from beliefnest.llm.failures import excerpt
from beliefnest.llm.messages import Answer, Message, Sampling, WrappedModel
from beliefnest.llm.stored_exchange import Exchange, decode_exchange, exchange_of

_Question = tuple[Message, ...]


@dataclass
class ScriptedModel:
    """Model that gives the answers of a script in order, whatever the request is.

    Attributes:
        name: `scripted:FILE`.
        answers: Remaining answers.
    """

    name: str
    answers: deque[str]

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Return the next answer.

        Raises:
            ModelError: There are no more answers.
        """
        if not self.answers:
            raise ModelError(f"{self.name} has no answer left; add one to the file")
        return Answer(self.answers.popleft())


@dataclass
class ReplayModel:
    """Model that gives the recorded answers to the same requests.

    A request that was recorded several times gets its answers in the order of the recording.

    Attributes:
        name: `replay:FILE`.
        recorded: Remaining answers by request.
    """

    name: str
    recorded: Mapping[_Question, deque[Exchange]]

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Return the next recorded answer to this request.

        Raises:
            ModelError: The recording has none, or none left.
        """
        left = self.recorded.get(tuple(messages))
        if not left:
            lacking = "no answer" if left is None else "no further answer"
            last = messages[-1].text if messages else ""
            raise ModelError(
                f"{self.name} has {lacking} to this prompt; it differs from the recorded ones, "
                f"or the run does. The prompt ends: {excerpt(last[-200:])}"
            )
        return left.popleft().answer


class FileRecordingModel(WrappedModel, frozen=True):
    """Model wrapper that appends exchanges to a file, one JSON object per line."""

    file: Path

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Ask the model and record the exchange.

        Raises:
            ModelError: The model failed, or the file cannot be written.
        """
        answer = self.model.answer(messages, sampling)
        exchange = exchange_of(self.name, messages, sampling, answer)
        try:
            self.file.parent.mkdir(parents=True, exist_ok=True)
            with self.file.open("ab") as file:
                file.write(msgspec.json.encode(exchange) + b"\n")
        except OSError as error:
            raise ModelError(f"the recording {self.file} cannot be written: {error}") from None
        return answer


def load_script(name: str, path: Path) -> ScriptedModel:
    """Load a scripted model from a JSON file: a list of answers.

    Raises:
        ModelError: The file cannot be read.
        InputError: It is not a list of texts.
    """
    try:
        answers = decode_json(_content(name, path), list[str])
    except msgspec.MsgspecError as error:
        raise InputError(f"{path} is not a JSON list of answers: {error}") from None
    return ScriptedModel(name, deque(answers))


def load_replay(name: str, path: Path) -> ReplayModel:
    """Load a replaying model from the file of a `FileRecordingModel`.

    Raises:
        ModelError: The file cannot be read.
        InputError: A line is not an exchange.
    """
    exchanges = []
    for number, line in enumerate(_content(name, path).splitlines(), start=1):
        try:
            exchanges.append(decode_exchange(line))
        except msgspec.MsgspecError as error:
            raise InputError(f"{path}, line {number}, is not a recorded answer: {error}") from None
    return replaying(name, exchanges)


def replaying(name: str, exchanges: Iterable[Exchange]) -> ReplayModel:
    """Return a model that gives the answers of exchanges, in their order."""
    recorded: defaultdict[_Question, deque[Exchange]] = defaultdict(deque)
    for exchange in exchanges:
        recorded[exchange.messages].append(exchange)
    return ReplayModel(name, dict(recorded))


def _content(name: str, path: Path) -> bytes:
    try:
        return read_regular(path)
    except OSError as error:
        raise ModelError(f"{name}: the file cannot be read: {error}") from None
