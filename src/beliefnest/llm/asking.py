"""Requests for a program, repeated with an error report until the program passes a check."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from beliefnest.errors import InputError, ModelError
from beliefnest.llm.failures import excerpt
from beliefnest.llm.messages import Answer, Message, Model, Sampling, Usage
from beliefnest.llm.reading_programs import ProgramReading, read_program

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
        reading: Reading of the answer.
        complaint: Fault of the answer; None if there is none.
    """

    messages: tuple[Message, ...]
    answer: Answer
    reading: ProgramReading
    complaint: str | None

    @property
    def program(self) -> str | None:
        """Program in the answer; None if there is none."""
        return self.reading.program


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

    @property
    def asked_again(self) -> int:
        """Number of answers without a program after which the model was asked again."""
        return asked_again(self.attempts)


def asked_again(attempts: Sequence[Round]) -> int:
    """Return the number of answers without a program after which the model was asked again."""
    return sum(each.program is None for each in attempts[:-1])


class NoUsableProgramError(ModelError):
    """No round gave a program that passed the check.

    Attributes:
        attempts: All rounds.
        outcome: Outcome in rows: that of the last answer without a program (`unread`, `cut`,
            `ambiguous` or `refused`); `program_failed` if it has one.
    """

    def __init__(self, message: str, attempts: tuple[Round, ...]) -> None:
        super().__init__(message)
        self.attempts = attempts
        reading = attempts[-1].reading
        self.outcome = reading.row_outcome if reading.program is None else "program_failed"


def ask_for_program(
    model: Model,
    prompt: Prompt,
    check: Check,
    attempts: int = 3,
    *,
    system: str | None = None,
    sampling: Sampling | None = None,
    retry_unread: int = 0,
    on_round: Callable[[Round], None] = lambda _: None,
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
        retry_unread: Number of further rounds after answers without a program.
        on_round: Function that receives each round when its answer is known.

    Raises:
        InputError: `attempts` is below 1.
        ModelError: The model failed.
        NoUsableProgramError: No round gave a program that passed.
    """
    if attempts < 1:
        raise InputError(f"attempts is {attempts}; it must be at least 1")
    rounds: list[Round] = []
    while len(rounds) < attempts + min(retry_unread, _without(rounds)):
        messages = _messages(prompt, system, rounds)
        answer = model.answer(messages, sampling or Sampling())
        reading = read_program(answer.text, answer.finish)
        program = reading.program
        complaint = reading.reason if program is None else check(program)
        rounds.append(Round(messages, answer, reading, complaint))
        on_round(rounds[-1])
        if program is not None and complaint is None:
            return ProgramAnswer(program, tuple(rounds))
    raise NoUsableProgramError(
        f"{model.name} gave no usable program in {_times(len(rounds))}: {rounds[-1].complaint}",
        tuple(rounds),
    )


def _without(rounds: Sequence[Round]) -> int:
    """Return the number of answers without a program."""
    return sum(each.program is None for each in rounds)


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
