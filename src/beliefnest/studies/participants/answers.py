"""Answers of participants, as files of the page or of jsPsych hold them."""

import codecs
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec
from msgspec.structs import replace

from beliefnest.errors import InputError
from beliefnest.files import decode_json, os_errors_of, read_regular
from beliefnest.studies.sheets import decode_sheet, spoilt_number, spoilt_text
from beliefnest.world.texts import quoted

_TRIAL = "beliefnest-question"
"""Value of `trial_type` of our trials, which jsPsych writes as well."""
_START = "beliefnest-start"
"""Value of `trial_type` of the row that a page sends when a session begins."""
_NEEDED = ("participant", "cell", "question", "response")


_IDS = ("participant", "cell", "question", "study")
"""Columns of ids, which spreadsheets may take for numbers or dates."""


class PersonAnswer(msgspec.Struct, frozen=True):
    """Answer of one participant to one question.

    Attributes:
        where: File and row, for messages.
        participant: Id of the participant.
        cell: Name of the item.
        question: Id of the question.
        response: The answer.
        options: Options in the order in which the participant saw them.
        reason: Reason in the participant's words; empty: none.
        study: Hash of the page on which it was given; empty: not recorded.
        started: Time at which the session began; empty: not recorded.
        plain: The whole row, as it is in the file.
    """

    where: str
    participant: str
    cell: str
    question: str
    response: str
    options: tuple[str, ...]
    reason: str
    study: str
    started: str
    plain: Mapping[str, Any]

    @property
    def is_start(self) -> bool:
        """True for the row of a session's beginning, which answers nothing."""
        return not self.cell

    def fault(self, column: str, message: str) -> InputError:
        """Return an error that names file, row and column."""
        return InputError(f"{self.where}, column {column}: {message}")


def answer_files(paths: Iterable[Path]) -> list[Path]:
    """Return files, and for folders the CSV and JSON files in them, in the order of names.

    Raises:
        InputError: A folder has no such file.
    """
    files: list[Path] = []
    for path in paths:
        if not path.is_dir():
            files.append(path)
            continue
        inside = sorted(each for each in path.iterdir() if each.suffix in (".csv", ".json"))
        if not inside:
            raise InputError(f"{path} has no .csv or .json file with answers")
        files += inside
    return files


def read_answers(file: Path) -> list[PersonAnswer]:
    """Return the answers in a CSV or JSON file of the page or of jsPsych.

    The rows of beginnings of sessions are among them; trials of other plugins are left out.

    Raises:
        InputError: The file has another form; the message names file, row and column.
    """
    with os_errors_of(file, "read"):
        content = read_regular(file)
    if content.removeprefix(codecs.BOM_UTF8).lstrip().startswith(b"["):
        rows = _json_rows(file, content)
        spoilt = spoilt_number
    else:
        sheet = decode_sheet(content, str(file), _NEEDED)
        rows = [(f"{file}:{line}", row) for line, row in sheet.rows]
        spoilt = spoilt_text
    made = [
        _answer(where, row, spoilt)
        for where, row in rows
        if row.get("trial_type", _TRIAL) == _TRIAL
    ]
    made += [_start(where, row, spoilt) for where, row in rows if row.get("trial_type") == _START]
    if not made:
        raise InputError(f"{file} has no answers: no row has the trial_type {quoted(_TRIAL)}")
    return made


def first_sessions(answers: Iterable[PersonAnswer]) -> dict[str, str]:
    """Return the time at which each participant's first session began."""
    began: dict[str, str] = {}
    for answer in answers:
        first = began.setdefault(answer.participant, answer.started)
        began[answer.participant] = min(first, answer.started)
    return began


def with_pseudonyms(answers: Sequence[PersonAnswer]) -> list[PersonAnswer]:
    """Return answers with `p1`, `p2` and so on for ids, in the order in which sessions began."""
    began = first_sessions(answers)
    ordered = sorted(began, key=lambda participant: (began[participant], participant))
    names = {participant: f"p{number}" for number, participant in enumerate(ordered, 1)}
    return [
        replace(
            answer,
            participant=names[answer.participant],
            plain={
                # Parameters of the address may name persons, too.
                **{name: value for name, value in answer.plain.items() if name != "address"},
                "participant": names[answer.participant],
            },
        )
        for answer in answers
    ]


_Rows = list[tuple[str, Mapping[str, Any]]]


def _json_rows(file: Path, content: bytes) -> _Rows:
    try:
        rows = decode_json(content.removeprefix(codecs.BOM_UTF8), list[dict[str, Any]])
    except msgspec.MsgspecError as error:
        raise InputError(f"{file} is no JSON list of answers: {error}") from None
    return [(f"{file}, entry {number}", row) for number, row in enumerate(rows, 1)]


def _answer(where: str, row: Mapping[str, Any], spoilt: Callable[[str], str]) -> PersonAnswer:
    """Return the answer in a row; `spoilt` says what a spreadsheet has made of an id."""
    texts = {name: _text(where, row, name) for name in (*_NEEDED, "reason", "study", "started")}
    for name in _NEEDED[:-1]:
        if not texts[name]:
            raise InputError(f"{where}, column {name}: is empty; give the row as it was written")
    for name in _IDS:
        harm = spoilt(texts[name])
        if harm:
            raise InputError(
                f"{where}, column {name}: {quoted(texts[name])} is {harm}, which a spreadsheet has "
                "made "
                "of an id; give the file as it was written, without opening it in a spreadsheet"
            )
    return PersonAnswer(where=where, options=_options(where, row), plain=dict(row), **texts)


def _start(where: str, row: Mapping[str, Any], spoilt: Callable[[str], str]) -> PersonAnswer:
    """Return the beginning of a session as an answer to no question."""
    named = {"cell": "-", "question": "-", "response": ""}
    return replace(_answer(where, {**row, **named}, spoilt), cell="", question="")


def _text(where: str, row: Mapping[str, Any], name: str) -> str:
    value = row.get(name)
    if value is None:
        return ""
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise InputError(f"{where}, column {name}: is {quoted(value)}; it must be a text")
    return str(value).strip()


def _options(where: str, row: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the options of a row; in CSV files they are JSON."""
    value = row.get("options") or []
    try:
        listed = json.loads(value) if isinstance(value, str) else value
        return tuple(msgspec.convert(listed, Sequence[str]))
    except (ValueError, RecursionError, msgspec.ValidationError):
        raise InputError(
            f"{where}, column options: is {quoted(value)}; it must be a list of texts"
        ) from None
