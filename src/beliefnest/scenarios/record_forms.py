"""The form of what runs and studies keep as JSON, checked when it is read again.

Only keys that are read are named; a file of a later version may hold more.
"""

from pathlib import Path
from typing import Any, TypeVar

import msgspec

from beliefnest.errors import InputError
from beliefnest.files import decode_json, read_regular

__all__ = ["ExpectationForm", "ProbeForm", "UsageForm", "checked_form", "read_json", "read_lines"]

T = TypeVar("T")
_Place = tuple[float, float, float]


class UsageForm(msgspec.Struct):
    """What answers took, as `usage_json` writes it."""

    requests: int
    input_tokens: int
    output_tokens: int
    cost: float | None


class ExpectationForm(msgspec.Struct):
    """An expectation, as `expectation_json` writes it."""

    path: str
    label: str
    ok: bool
    why_not: str


class _Reply(msgspec.Struct):
    answer: Any


class ProbeForm(msgspec.Struct):
    """A probe, as `probe_json` writes it."""

    label: str
    path: str
    acts_in: str
    agent: str
    task: str
    program: str
    attempts: int
    usage: UsageForm
    intended: _Place | None
    opened: list[_Place]
    arrived: _Place | None
    replies: list[_Reply]
    expected: dict[str, Any] | None
    ok: bool | None
    outcome: str
    why_not: str
    ticks: int


def checked_form(content: object, form: type[Any], file: Path, remedy: str) -> None:
    """Refuse the content of a file that has another form.

    Args:
        content: Plain values.
        form: What they have to be.
        file: Where they stand.
        remedy: What to do, for the end of the message.

    Raises:
        InputError: They are something else; the message names the key.
    """
    try:
        msgspec.convert(content, form)
    except msgspec.ValidationError as error:
        raise InputError(f"{file} is damaged: {_plain(error)}; {remedy}") from None


def read_json(file: Path, remedy: str) -> dict[str, Any]:
    """Return the JSON object in a file.

    Raises:
        InputError: It cannot be read, or holds something else.
    """
    try:
        return decode_json(read_regular(file), dict[str, Any])
    except OSError as error:
        raise InputError(f"{file} cannot be read: {error.strerror}; {remedy}") from None
    except msgspec.MsgspecError as error:
        raise InputError(f"{file} is damaged: {_plain(error)}; {remedy}") from None


def read_lines(file: Path, form: type[T]) -> list[T]:
    """Return what the lines of a JSONL file hold, without a last one that was cut off.

    Raises:
        InputError: It cannot be read, or a line has another form.
    """
    try:
        *whole, last = read_regular(file).split(b"\n")
    except FileNotFoundError:
        return []
    except OSError as error:
        raise InputError(f"{file} cannot be read: {error.strerror}") from None
    if last.endswith(b"}"):
        whole.append(last)
    found = []
    for number, line in enumerate(whole, 1):
        # A process that was ended while it wrote leaves a part of a line.
        if not line.endswith(b"}"):
            continue
        try:
            found.append(decode_json(line, form))
        except msgspec.MsgspecError as error:
            raise InputError(f"{file}:{number} is damaged: {_plain(error)}; remove it") from None
    return found


def _plain(error: Exception) -> str:
    return str(error).replace("`", "'")
