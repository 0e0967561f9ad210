"""Models that give answers from a file: written by hand, or recorded in an earlier run."""

from collections import defaultdict, deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec

from beliefnest.errors import ModelError
from beliefnest.files import decode_json, read_regular
from beliefnest.llm.exchange import Exchange, decode_exchange, encode_exchange
from beliefnest.llm.failures import excerpt
from beliefnest.llm.messages import Answer, Message, Model, Sampling

__all__ = ["FileRecordingModel", "ReplayModel", "ScriptedModel", "load_replay", "load_script"]

_Question = tuple[Message, ...]


@dataclass
class ScriptedModel:
    """Gives the answers of a script in their order, whatever is asked.

    Attributes:
        name: `scripted:FILE`.
        answers: What is left of the script.
    """

    name: str
    answers: deque[str]

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Return the next answer.

        Raises:
            ModelError: The script has ended.
        """
        if not self.answers:
            raise ModelError(f"{self.name} has no answer left; add one to the file")
        return Answer(self.answers.popleft())


@dataclass
class ReplayModel:
    """Gives the recorded answers to the same questions.

    A question that was asked several times gets its answers in the order of the recording.

    Attributes:
        name: `replay:FILE`.
        recorded: Question to the answers that are left.
    """

    name: str
    recorded: Mapping[_Question, deque[Exchange]]

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Return the next recorded answer to this question.

        Raises:
            ModelError: The recording has none (left).
        """
        left = self.recorded.get(tuple(messages))
        if not left:
            known = "no answer" if left is None else "no further answer"
            last = messages[-1].text if messages else ""
            raise ModelError(
                f"{self.name} has {known} to this prompt; it differs from the recorded ones, "
                f"or the run does. The prompt ends: {excerpt(last[-200:])}"
            )
        exchange = left.popleft()
        return Answer(exchange.text, exchange.usage, cached=True)


@dataclass(frozen=True)
class FileRecordingModel:
    """A model whose exchanges are appended to a file, one JSON object a line."""

    model: Model
    file: Path

    @property
    def name(self) -> str:
        """Name of the model that is asked."""
        return self.model.name

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Ask and record.

        Raises:
            ModelError: The model failed, or the file cannot be written.
        """
        answer = self.model.answer(messages, sampling)
        exchange = Exchange(self.name, tuple(messages), sampling, answer.text, answer.usage)
        try:
            self.file.parent.mkdir(parents=True, exist_ok=True)
            with self.file.open("ab") as file:
                file.write(encode_exchange(exchange) + b"\n")
        except OSError as error:
            raise ModelError(f"the recording {self.file} cannot be written: {error}") from None
        return answer


def load_script(name: str, path: Path) -> ScriptedModel:
    """Return a scripted model from a JSON file: a list of answers.

    Raises:
        ModelError: The file cannot be read or is not a list of texts.
    """
    try:
        answers = decode_json(_content(name, path), list[str])
    except msgspec.MsgspecError as error:
        raise ModelError(f"{path} is not a JSON list of answers: {error}") from None
    return ScriptedModel(name, deque(answers))


def load_replay(name: str, path: Path) -> ReplayModel:
    """Return a replaying model from the file that a `FileRecordingModel` wrote.

    Raises:
        ModelError: The file cannot be read, or a line is not an exchange.
    """
    recorded: defaultdict[_Question, deque[Exchange]] = defaultdict(deque)
    for number, line in enumerate(_content(name, path).splitlines(), start=1):
        try:
            exchange = decode_exchange(line)
        except msgspec.MsgspecError as error:
            raise ModelError(f"{path}, line {number}, is not a recorded answer: {error}") from None
        recorded[exchange.messages].append(exchange)
    return ReplayModel(name, dict(recorded))


def _content(name: str, path: Path) -> bytes:
    try:
        return read_regular(path)
    except OSError as error:
        raise ModelError(f"{name}: the file cannot be read: {error}") from None
