"""Settings of requests to models that users choose for a run, a study or a policy."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, Self, get_args
from urllib.parse import parse_qsl, urlencode

import msgspec
from msgspec.structs import fields

from beliefnest.errors import InputError
from beliefnest.files import read_regular_text
from beliefnest.llm.budget import AnswerLimits
from beliefnest.llm.messages import Answer, Message, Model, Sampling, WrappedModel
from beliefnest.skills.manifests import SkillDetail

AskedForm = Literal["text", "structured"]
_NUMBERS = ("answer_seconds", "first_token_seconds", "max_output_tokens", "retry_unread")


class ModelSettings(msgspec.Struct, frozen=True):
    """Settings of requests to models; all of them are part of the identity of a cell.

    Attributes:
        answer_seconds: Longest silence in an answer, as `AnswerLimits.seconds`.
        first_token_seconds: Longest wait for an answer to begin.
        max_output_tokens: Greatest length of an answer; None: as long as the provider allows.
        system: System message in place of the built-in ones; None: the built-in ones.
        skills: Detail in which the built-in system message lists the skills.
        retry_unread: Number of times that a model is asked again, with the form of an answer said
            once more, after an answer that cannot be read.
        answer: Form of answers to questions with options: free text, or the structured form that
            the provider has (JSON by a schema, or the call of a tool).

    Raises:
        InputError: A value is not valid.
    """

    answer_seconds: float = AnswerLimits().seconds
    first_token_seconds: float = AnswerLimits().first_token_seconds
    max_output_tokens: int | None = None
    system: str | None = None
    skills: SkillDetail = "full"
    retry_unread: int = 0
    answer: AskedForm = "text"

    def __post_init__(self) -> None:
        for name in ("answer_seconds", "first_token_seconds"):
            value = getattr(self, name)
            is_number = isinstance(value, int | float) and not isinstance(value, bool)
            if not is_number or not 0 < value < math.inf:
                raise InputError(f"{name} is {value!r}; give seconds, more than 0")
        most = self.max_output_tokens
        if most is not None and (isinstance(most, bool) or not isinstance(most, int) or most < 1):
            raise InputError(f"max_output_tokens is {most!r}; give a whole number, at least 1")
        again = self.retry_unread
        if isinstance(again, bool) or not isinstance(again, int) or again < 0:
            raise InputError(f"retry_unread is {again!r}; give a whole number, at least 0")
        if self.skills not in get_args(SkillDetail):
            details = ", ".join(get_args(SkillDetail))
            raise InputError(f"skills is {self.skills!r}; give one of {details}")
        if self.answer not in get_args(AskedForm):
            forms = ", ".join(get_args(AskedForm))
            raise InputError(f"answer is {self.answer!r}; give one of {forms}")
        if self.system is not None and not isinstance(self.system, str):
            raise InputError(f"system is {self.system!r}; give a text")

    @classmethod
    def of_file(cls, system: str | Path | None, **values: Any) -> Self:
        """Return settings whose system message is in a file.

        Raises:
            InputError: The file cannot be read, is empty, or another value is not valid.
        """
        return cls(system=None if system is None else _system_text(system), **values)

    @classmethod
    def of_query(cls, query: str) -> Self:
        """Return the settings in the part of a policy's name after `?`, such as `skills=names`.

        Raises:
            InputError: There is no such setting, or its value is not valid.
        """
        names = {each.name for each in fields(cls)}
        values: dict[str, Any] = {}
        for name, text in parse_qsl(query, keep_blank_values=True):
            if name not in names:
                raise InputError(f"there is no setting {name!r}; give {', '.join(sorted(names))}")
            values[name] = _number(text) if name in _NUMBERS else text
        return cls.of_file(values.pop("system", None), **values)

    @classmethod
    def of_chosen(cls, chosen: Mapping[str, Any]) -> Self:
        """Return the settings among the recorded settings of a cell; others are ignored."""
        return cls(**{each.name: chosen[each.name] for each in fields(cls) if each.name in chosen})

    @property
    def chosen(self) -> dict[str, Any]:
        """Settings that differ from the defaults, by name."""
        values = {each.name: (getattr(self, each.name), each.default) for each in fields(self)}
        return {name: value for name, (value, default) in values.items() if value != default}

    @property
    def answer_limits(self) -> AnswerLimits:
        """Limits on the time of an answer."""
        return AnswerLimits(self.answer_seconds, self.first_token_seconds)

    def sampling(self, sampling: Sampling) -> Sampling:
        """Return sampling parameters with the limit on the length of an answer."""
        return replace(sampling, max_output_tokens=self.max_output_tokens)

    def around(self, model: Model) -> Model:
        """Return a model that gets the system message of these settings."""
        return model if self.system is None else WithSystem(model, self.system)


def query_of(system: Path | None, values: Mapping[str, Any]) -> str:
    """Return settings as `ModelSettings.of_query` reads them; empty: there are none."""
    named = {name: value for name, value in values.items() if value is not None}
    return urlencode(named | ({} if system is None else {"system": str(system)}), safe="/.")


class WithSystem(WrappedModel, frozen=True):
    """Model wrapper that sends another system message.

    Attributes:
        text: The system message.
    """

    text: str

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Ask the model with the other system message.

        Raises:
            ModelError: As of the wrapped model.
        """
        others = [message for message in messages if message.role != "system"]
        return self.model.answer((Message("system", self.text), *others), sampling)


def _system_text(file: str | Path) -> str:
    try:
        text = read_regular_text(Path(file))
    except (OSError, ValueError) as error:
        raise InputError(f"the system message {file} cannot be read: {error}") from None
    if not text.strip():
        raise InputError(f"the system message {file} is empty; write one, or leave it out")
    return text


def _number(text: str) -> float | int | str:
    try:
        value = float(text)
    except ValueError:
        return text
    return int(value) if value.is_integer() and text.lstrip("+-").isdecimal() else value
