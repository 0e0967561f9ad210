"""Requests for a program, repeated with an error report until the program passes a check."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from beliefnest.errors import InputError, ModelError
from beliefnest.llm.extract import NoProgramError, extract_program
from beliefnest.llm.failures import excerpt
from beliefnest.llm.messages import Answer, Finish, Message, Model, Sampling, Usage

__all__ = [
    "Check",
    "NoUsableProgramError",
    "ProgramAnswer",
    "Prompt",
    "Round",
    "ask_for_program",
]

Check = Callable[[str], str | None]
"""Function that returns the fault of a program in words for the model, or None."""

Prompt = str | Callable[[str | None, str | None], str]
"""A prompt, or a function that renders it from the code and the error of the previous round."""


@dataclass(frozen=True, slots=True)
class Round:
    """One round: a request and its answer.

    Attributes:
        messages: Messages of the request.
        answer: The answer.
        program: Program in the answer; None if there is none.
        complaint: Fault of the answer; None if there is none.
    """

    messages: tuple[Message, ...]
    answer: Answer
    program: str | None
    complaint: str | None


@dataclass(frozen=True, slots=True)
class ProgramAnswer:
    """A program that passed the check.

    Attributes:
        program: JavaScript source.
        attempts: All rounds; the last one is good.
    """

    program: str
    attempts: tuple[Round, ...]

    @property
    def usage(self) -> Usage:
        """Resources that all rounds used."""
        return sum((attempt.answer.usage for attempt in self.attempts), Usage())


_UNFINISHED: Mapping[Finish, str] = {
    "length": "the answer was cut off at its greatest length",
    "content_filter": "the model refused to answer",
}


class NoUsableProgramError(ModelError):
    """No round gave a program that passed the check.

    Attributes:
        attempts: All rounds.
    """

    def __init__(self, message: str, attempts: tuple[Round, ...]) -> None:
        super().__init__(message)
        self.attempts = attempts


def ask_for_program(
    model: Model,
    prompt: Prompt,
    check: Check,
    attempts: int = 3,
    *,
    system: str | None = None,
    sampling: Sampling | None = None,
) -> ProgramAnswer:
    """Ask a model for a program until one passes a check.

    Args:
        model: Model to ask.
        prompt: Text of the prompt, or a function. With a text, faults are sent back as further
            messages of one conversation. A function receives the code and the error of the
            previous round (None at first), and each round is a new conversation, as with the
            paper's template.
        check: Check of a program.
        attempts: Greatest number of rounds, at least 1.
        system: Message before the prompt, such as instructions for the answer.
        sampling: Sampling parameters.

    Raises:
        InputError: `attempts` is below 1.
        ModelError: The model failed.
        NoUsableProgramError: No round gave a program that passed.
    """
    if attempts < 1:
        raise InputError(f"attempts is {attempts}; it must be at least 1")
    rounds: list[Round] = []
    while len(rounds) < attempts:
        messages = _messages(prompt, system, rounds)
        answer = model.answer(messages, sampling or Sampling())
        program, complaint = _judge(answer, check)
        rounds.append(Round(messages, answer, program, complaint))
        if program is not None and complaint is None:
            return ProgramAnswer(program, tuple(rounds))
    raise NoUsableProgramError(
        f"{model.name} gave no usable program in {_times(attempts)}: {rounds[-1].complaint}",
        tuple(rounds),
    )


def _judge(answer: Answer, check: Check) -> tuple[str | None, str | None]:
    """Return the program of an answer and its fault."""
    if answer.finish != "stop":
        return None, _UNFINISHED[answer.finish]
    try:
        program = extract_program(answer.text)
    except NoProgramError as error:
        return None, str(error)
    return program, check(program)


def _messages(prompt: Prompt, system: str | None, rounds: list[Round]) -> tuple[Message, ...]:
    first = () if system is None else (Message("system", system),)
    last = rounds[-1] if rounds else None
    if callable(prompt):
        code, error = (None, None) if last is None else (last.program, last.complaint)
        return (*first, Message("user", prompt(code, error)))
    if last is None:
        return (*first, Message("user", prompt))
    text = last.answer.text if last.program else excerpt(last.answer.text)
    # Providers refuse empty messages.
    said = Message("assistant", text or "(no text)")
    return (*last.messages, said, Message("user", _feedback(last)))


def _feedback(attempt: Round) -> str:
    fault = "There is a fault in this program" if attempt.program else "There is no program in this"
    return (
        f"{fault}: {attempt.complaint}\n\n"
        "Answer with the whole corrected program in one fenced ```javascript block."
    )


def _times(attempts: int) -> str:
    return "one attempt" if attempts == 1 else f"{attempts} attempts"
