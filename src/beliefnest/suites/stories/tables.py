"""Files of questions in the forms that others publish: rows of story, question and answer.

Read are JSON (a list, or an object with the list), JSON lines and CSV. Names of columns are those
of Hi-ToM, BigToM, OpenToM and of data sets of Inspect; a file without names has story, question,
right answer and wrong answers, as BigToM has them.
"""

import csv
import re
from collections.abc import Iterator, Mapping, Sequence
from io import StringIO
from pathlib import Path
from typing import Any

import msgspec

from beliefnest.errors import InputError
from beliefnest.files import decode_json, read_regular_text
from beliefnest.suites.stories.data import BatteryItem, ReadStories, StoryItems, Unread
from beliefnest.suites.stories.grammar import Line, parse_clauses
from beliefnest.suites.stories.played_story import check_question
from beliefnest.suites.stories.questions import Question, parse_question
from beliefnest.suites.stories.story import Story, story_of
from beliefnest.world.texts import quoted

_STORY = ("story", "narrative", "plot", "context", "passage", "scenario", "input")
_QUESTION = ("question", "query", "input")
_ANSWER = (
    *("answer", "target", "label", "gold", "correct", "correct_answer", "right_answer"),
    *("true_answer", "true answer", "gold_answer", "expected"),
)
_OPTIONS = ("choices", "options")
_LISTS = ("data", "rows", "items", "examples")
_BARE = ("story", "question", "answer")
_SENTENCE = re.compile(r"(?<=[.!?])\s+(?=[A-Z0-9“\"])")
_LETTER = re.compile(r"\(?([A-Z])[).:]?(?:\s.*)?", re.DOTALL)
_NUMBER = re.compile(r"^\(?[A-Za-z0-9][).:]\s+")
_REASON = re.compile(r",?\s+(?:because|since|rather than|instead of)\s|(?:,|\band)\s+not\s", re.I)
"""Start of a reason or of what is meant not, after the main clause of an answer."""
_TURN = re.compile(
    r"\b(?:so|but|yet|however|therefore|hence|thus|(?:is|will) not)\b|[;.:?!]\s*\w", re.IGNORECASE
)
"""Sign of a further clause, which may give another answer."""
_PLAIN = re.compile(
    "will|would|ll|is|s|looks?|looking|search|searches|go|goes|checks?|opens?|find|thinks?|"
    "believes?|expects|says|answer|she|he|they|it|her|his|their|you|that|to|be|for|first|still|"
    "inside|into|at|on|of|from|where|put|left|same"
)
"""Words of answers beside the container that change nothing of it."""

_Row = Mapping[str, Any]


def read_table(path: Path) -> ReadStories:
    """Read a file of rows; a row that cannot be read is left out, with the reason.

    Raises:
        InputError: The file cannot be read, or has no rows.
    """
    try:
        text = read_regular_text(path)
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path} cannot be read: {error}; give a text file") from None
    stories: dict[str, Story] = {}
    items: dict[str, list[BatteryItem]] = {}
    unread: list[Unread] = []
    for number, row in enumerate(_rows(path, text), 1):
        where = f"{path}, row {number}"
        try:
            story_text, asked, answer = _parts(row)
            if story_text not in stories:
                lines, faults = _lines(story_text)
                if faults:
                    unread.append(Unread(where, tuple(faults)))
                    continue
                stories[story_text] = story_of(lines)
            question = parse_question(asked)
            check_question(stories[story_text], question)
            expected = _expected(answer, stories[story_text], question)
        except InputError as error:
            unread.append(Unread(where, (str(error),)))
            continue
        items.setdefault(story_text, []).append(BatteryItem(number, question, expected))
    with_items = tuple(StoryItems(stories[each], tuple(asked)) for each, asked in items.items())
    return ReadStories(with_items, tuple(unread))


def _rows(path: Path, text: str) -> Iterator[_Row]:
    """Yield the rows of a file as mappings."""
    start = text.lstrip()[:1]
    if not start:
        raise InputError(f"{path} is empty; give rows as JSON, JSON lines or CSV")
    if start in "[{":
        for value in _json_values(path, text):
            if not isinstance(value, dict):
                raise InputError(f"{path} has {quoted(value)} in place of a row with names")
            several = value.get("questions")
            asked = several if isinstance(several, list) else [{}]
            yield from ({**value, **each} for each in asked if isinstance(each, dict))
        return
    first = text.partition("\n")[0]
    mark = max(",;\t", key=first.count)
    table = list(csv.reader(StringIO(text), delimiter=mark))
    names = [each.strip().casefold() for each in table[0]] if table else []
    headed = any(name in names for name in _STORY) and any(name in names for name in _ANSWER)
    for cells in table[1:] if headed else table:
        yield dict(zip(names if headed else _BARE, cells, strict=False))


def _json_values(path: Path, text: str) -> Sequence[Any]:
    try:
        lines = [line for line in text.splitlines() if line.strip()]
        if len(lines) > 1 and all(line.lstrip().startswith("{") for line in lines):
            return [decode_json(line, dict) for line in lines]
        value = decode_json(text, object)
    except msgspec.DecodeError as error:
        raise InputError(
            f"{path} is no JSON: {error}; give rows as JSON, JSON lines or CSV"
        ) from None
    if isinstance(value, dict):
        lists = [each for name in _LISTS if isinstance(each := value.get(name), list)]
        return lists[0] if lists else [value]
    return value if isinstance(value, list) else []


def _parts(row: _Row) -> tuple[str, str, list[str]]:
    """Return story, question and answers of a row; several answers are meant as one."""
    asked = _first(row, _QUESTION)
    if isinstance(asked, dict):
        # OpenToM has the answer beside the question.
        row = {**row, **asked}
    story_text = "\n".join(_texts(row, "story", _STORY))
    question = "\n".join(_texts(row, "question", _QUESTION))
    answers, options = _texts(row, "answer", _ANSWER), _first(row, _OPTIONS)
    if story_text == question:
        story_text, question = _last_question(story_text)
    if isinstance(options, list):
        answers = [_of_letter(each, options) for each in answers]
    return story_text.strip(), question.strip(), answers


def _of_letter(answer: str, options: Sequence[Any]) -> str:
    """Return the option of a letter; another answer stays."""
    letter = _LETTER.fullmatch(answer.strip())
    place = -1 if letter is None else ord(letter[1]) - ord("A")
    return str(options[place]) if 0 <= place < len(options) else answer


def _texts(row: _Row, what: str, names: Sequence[str]) -> list[str]:
    """Return the texts of a column; of a chat, the words of the user.

    Raises:
        InputError: The row has no such column, or no text in it.
    """
    value = _first(row, names)
    if isinstance(value, list) and all(isinstance(each, dict) for each in value):
        value = [each.get("content") for each in value if each.get("role", "user") == "user"]
    texts = [value] if isinstance(value, str) else value
    if not isinstance(texts, list) or not texts or not all(isinstance(t, str) for t in texts):
        raise InputError(
            f"has no text of the {what}, which is read from {', '.join(names)}; columns are "
            f"{', '.join(map(str, row))}"
        )
    if not all(each.strip() for each in texts):
        raise InputError(f"has an empty {what}; write it, or leave the row out")
    return texts


def _first(row: _Row, names: Sequence[str]) -> Any:
    low = {str(name).casefold(): value for name, value in row.items()}
    return next((low[name] for name in names if name in low), None)


def _last_question(text: str) -> tuple[str, str]:
    """Return a text without its last question, and the question."""
    sentences = _sentences(text)
    asked = [number for number, each in enumerate(sentences) if each.endswith("?")]
    if not asked:
        raise InputError(f"{quoted(text)} asks no question; end it with one")
    return " ".join(sentences[: asked[-1]]), sentences[asked[-1]]


def _sentences(text: str) -> list[str]:
    return [each for line in text.splitlines() for each in _SENTENCE.split(line.strip()) if each]


def _lines(text: str) -> tuple[list[Line], list[str]]:
    """Return the sentences of a story, and what cannot be read."""
    lines: list[Line] = []
    faults: list[str] = []
    for number, sentence in enumerate(_sentences(text), 1):
        # A number stands alone before its sentence if it has a full stop.
        if re.fullmatch(r"\d+[.:)]?", sentence) or not sentence.strip(" *"):
            continue
        try:
            lines += parse_clauses(number, sentence, "sentence")
        except InputError as error:
            faults.append(str(error))
    return lines, faults


def _expected(answers: Sequence[str], story: Story, question: Question) -> str | None:
    """Return the one answer of a row, as the story names it.

    Raises:
        InputError: Answers name several places, or none without doubt.
    """
    rooms = {_bare(room): room for room in story.rooms}
    for room in (rooms[_bare(each)] for each in answers if _bare(each) in rooms):
        raise InputError(f"has the answer {quoted(room)}, a room; give the container in it")
    if question.door is not None or question.sign is not None:
        named = dict.fromkeys(a.strip().casefold() if question.door else a for a in answers)
    else:
        named = dict.fromkeys(_named(each.strip(), story, question) for each in answers)
    if len(named) > 1:
        raise InputError(f"has several answers, {', '.join(map(quoted, named))}; give one")
    return next(iter(named))


def _named(answer: str, story: Story, question: Question) -> str:
    """Return the container that the main clause of an answer names.

    Raises:
        InputError: It names none or several, or has words that may change what it says.
    """
    main, *rest = _REASON.split(answer, maxsplit=1)
    words = f" {_bare(_NUMBER.sub('', main))} "
    names_of_containers = {_bare(place.container): place.container for place in story.places}
    mentioned = [each for each in names_of_containers if f" {each} " in words]
    # Of `red box` and `box`, the longer name is meant.
    whole = [a for a in mentioned if not any(a != b and f" {a} " in f" {b} " for b in mentioned)]
    names = " ".join([*whole, *map(_bare, (*story.rooms, *question.believers, question.thing))])
    others = {*words.split()} - {*names.split()}
    if len(whole) != 1 or not all(map(_PLAIN.fullmatch, others)) or any(map(_TURN.search, rest)):
        raise InputError(
            f"has the answer {quoted(answer)}, which does not name one container of the story "
            "without doubt; write its name alone"
        )
    return names_of_containers[whole[0]]


def _bare(name: str) -> str:
    words = re.findall(r"\w+", name.replace("_", " ").casefold())
    small = {"the", "a", "an", "in", "is", "it", "s"}
    return " ".join(each for each in words if each not in small)
