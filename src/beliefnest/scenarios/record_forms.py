"""Forms of the JSON files of runs and studies, checked when the files are read again.

The forms list only keys that are read; files of later versions may have further keys.
"""

from pathlib import Path
from typing import Any, TypeVar

import msgspec

from beliefnest.errors import InputError
from beliefnest.files import decode_json, os_errors_of, read_regular

T = TypeVar("T")
_Place = tuple[float, float, float]


class UsageForm(msgspec.Struct):
    """Usage of answers, as plain values."""

    requests: int
    input_tokens: int
    output_tokens: int
    cost: float | None


class ExpectationForm(msgspec.Struct):
    """Outcome of an expectation, as `expectation_json` writes it."""

    path: str
    label: str
    ok: bool
    why_not: str


class _Reply(msgspec.Struct):
    answer: Any


class ProbeForm(msgspec.Struct):
    """Outcome of a probe, as `probe_json` writes it."""

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
    inferred: dict[str, float] | None


def checked_form(content: object, form: type[Any], file: Path, remedy: str) -> None:
    """Refuse the content of a file if it has another form.

    Args:
        content: Plain values.
        form: Expected form.
        file: File of the content, for the message.
        remedy: What to do, for the end of the message.

    Raises:
        InputError: The content has another form; the message names the key.
    """
    try:
        msgspec.convert(content, form)
    except msgspec.ValidationError as error:
        raise InputError(f"{file} is damaged: {_plain(error)}; {remedy}") from None


def read_json(file: Path, remedy: str) -> dict[str, Any]:
    """Return the JSON object in a file.

    Raises:
        InputError: The file cannot be read, or holds something else.
    """
    try:
        with os_errors_of(file, "read", remedy):
            return decode_json(read_regular(file), dict[str, Any])
    except msgspec.MsgspecError as error:
        raise InputError(f"{file} is damaged: {_plain(error)}; {remedy}") from None


def read_lines(file: Path, form: type[T]) -> list[T]:
    """Return the content of a JSONL file's lines, without an incomplete last line.

    Raises:
        InputError: The file cannot be read, or a line has another form.
    """
    try:
        *whole, last = read_regular(file).split(b"\n")
    except FileNotFoundError:
        return []
    except OSError as error:
        raise InputError(f"{file} cannot be read: {error.strerror}") from None
    if last.endswith(b"}"):
        whole.append(last)
    records = []
    for number, line in enumerate(whole, 1):
        # A process that is killed while it writes leaves a part of a line.
        if not line.endswith(b"}"):
            continue
        try:
            records.append(decode_json(line, form))
        except msgspec.MsgspecError as error:
            raise InputError(f"{file}:{number} is damaged: {_plain(error)}; remove it") from None
    return records


def _plain(error: Exception) -> str:
    return str(error).replace("`", "'")
