"""Reader of numbers: the number that an answer gives to each of some names, line by line."""

import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from beliefnest.llm.messages import Finish
from beliefnest.llm.reading_answers import ReadingOutcome, ReadOutcome, is_refusal, withheld
from beliefnest.llm.statements import unfenced
from beliefnest.llm.thinking import separate_thinking

_BETWEEN = r"[\s_\"'\u2018\u2019)\]]*(?:[:=|\u2013\u2014]|-(?=\s))[\s_\"'(\[|]*"
_NUMBER = r"(?P<number>[-+]?\d+(?:[.,]\d+)?)"
_SEVERAL = re.compile(r"\s*(?:-|\u2013|\u2014|\bto\b|\bor\b|\band\b)\s*[-+]?\d", re.IGNORECASE)
"""Another number behind a number: a range, or a choice."""


@dataclass(frozen=True, slots=True)
class NumbersReading(ReadingOutcome):
    """Result of reading numbers.

    Attributes:
        numbers: Number by name, of all names that have one.
        missing: Names without one.
        outcome: `read`: every name has a number; otherwise as in `AnswerReading`.
        reason: Why numbers are missing; empty: none is.
        thinking: What the model thought before it answered.
        refused: True if the model would not answer.
    """

    numbers: Mapping[str, float]
    missing: tuple[str, ...]
    outcome: ReadOutcome
    reason: str = ""
    thinking: str = ""
    refused: bool = False


def read_numbers(
    text: str, names: Sequence[str], low: float, high: float, finish: Finish = "stop"
) -> NumbersReading:
    """Read the number of each name, from lines such as `NAME: 3`, a table or JSON.

    Of several lines about one name the last one counts. A range or a choice of numbers
    (`3 to 4`) is ambiguous. Thinking is never the answer, and an answer that a limit cut off is
    `cut`.

    Args:
        text: Complete text of the answer.
        names: The names.
        low: Least number.
        high: Greatest number.
        finish: Reason for the end of the answer.
    """
    said = separate_thinking(text)
    nothing = tuple(names)
    if finish == "length":
        return NumbersReading({}, nothing, "cut", "a limit cut the answer off", said.thinking)
    if finish == "content_filter":
        fault = withheld(said.text)
        return NumbersReading({}, nothing, "unread", fault, said.thinking, refused=True)
    if said.open:
        fault = "the answer is a thought without an end"
        return NumbersReading({}, nothing, "unread", fault, said.thinking)
    lines = [line for part in said.text.split("\n") for line in _parts(part)]
    by_name = {name: _last(_line_form(name), lines) for name in names}
    numbers = {
        name: value for name, value in by_name.items() if value is not None and low <= value <= high
    }
    unclear = [name for name, value in by_name.items() if value != value]  # noqa: PLR0124 - nan
    missing = tuple(name for name in names if name not in numbers)
    if not missing:
        return NumbersReading(numbers, (), "read", "", said.thinking)
    refused = not numbers and is_refusal(said.text)
    reason = (
        f"several numbers for {', '.join(unclear)}"
        if unclear
        else f"no number from {low:g} to {high:g} for {', '.join(missing)}"
    )
    outcome: ReadOutcome = "ambiguous" if unclear else "unread"
    return NumbersReading(numbers, missing, outcome, reason, said.thinking, refused)


def _parts(line: str) -> list[str]:
    """Return the plain parts of a line; an entry of JSON is a part of its own."""
    # Braces and bars are needed here; `plain_words` takes them away.
    plain = unicodedata.normalize("NFKC", re.sub(r"[*`]", "", unfenced(line)))
    return re.split(r"[{,]\s*(?=[\"'])", plain)


def _line_form(name: str) -> re.Pattern[str]:
    normal = unicodedata.normalize("NFKC", name)
    words = r"[\s_\"'\u2018\u2019]+".join(map(re.escape, normal.split()))
    return re.compile(rf"^[\W_]*(?:\d+[.)][\W_]*)?{words}{_BETWEEN}{_NUMBER}", re.IGNORECASE)


def _last(form: re.Pattern[str], lines: Sequence[str]) -> float | None:
    """Return the number in the last line of a form; nan: several; None: there is no such line."""
    value = None
    for line in lines:
        match = form.match(line)
        if match is not None:
            several = _SEVERAL.match(line, match.end())
            value = float("nan") if several else float(match["number"].replace(",", "."))
    return value
