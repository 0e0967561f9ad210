"""Files of stories with questions and expected answers."""

import re
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import msgspec

from beliefnest.errors import InputError
from beliefnest.files import decode_json, read_regular
from beliefnest.suites.stories.played_story import Knowing, check_question
from beliefnest.suites.stories.questions import Question, parse_question
from beliefnest.suites.stories.story import Story, read_story

__all__ = ["Item", "StoryItems", "read_items"]


class _Row(msgspec.Struct):
    """Row of a Hi-ToM file; other columns are ignored."""

    story: str
    question: str
    answer: str
    question_order: int | None = None


class _Published(msgspec.Struct):
    """Published file: an object with the rows under a key."""

    data: list[_Row]


_EVERYTHING = Knowing()


@dataclass(frozen=True, slots=True)
class Item:
    """Question and its expected answer.

    Attributes:
        row: Row in the file, from 1.
        question: The question.
        expected: Name of a container; None: the thing is believed to be in no container.
    """

    row: int
    question: Question
    expected: str | None


@dataclass(frozen=True, slots=True)
class StoryItems:
    """Story and all its questions.

    Attributes:
        story: The story.
        items: Questions and expected answers.
        knowing: Rules by which agents learn of events that they do not see.
    """

    story: Story
    items: tuple[Item, ...]
    knowing: Knowing = _EVERYTHING


def read_items(path: Path, rows: Collection[int] | None = None) -> tuple[StoryItems, ...]:
    """Return the stories of a Hi-ToM file; rows of the same story are grouped.

    Args:
        path: JSON file: an array of rows with `story`, `question`, `answer` and optionally
            `question_order`; or an object with that array under `data`.
        rows: Numbers of the rows to read, from 1; None: all.

    Raises:
        InputError: The file or a row does not exist, the file has another form, or a story or
            question cannot be parsed. The message names the row and the line of the story.
    """
    try:
        text = read_regular(path)
        if text.lstrip()[:1] == b"{":
            every = decode_json(text, _Published).data
        else:
            every = decode_json(text, list[_Row])
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}; give a JSON file") from None
    except msgspec.DecodeError as error:
        raise InputError(
            f"{path}: {error}; give an array of rows with 'story', 'question' and 'answer', or an "
            "object with that array under 'data'"
        ) from None
    if rows is not None and not set(rows) <= set(range(1, len(every) + 1)):
        missing = min(set(rows) - set(range(1, len(every) + 1)))
        raise InputError(f"{path} has no row {missing}; it has rows 1 to {len(every)}")
    stories: dict[str, Story] = {}
    items: dict[str, list[Item]] = {}
    for number, row in enumerate(every, 1):
        if rows is not None and number not in rows:
            continue
        with _named(f"{path}, row {number}"):
            told = _told_in(row.story)
            if told not in stories:
                stories[told] = read_story(told)
            item = _item(number, row, stories[told])
        items.setdefault(told, []).append(item)
    return tuple(StoryItems(story, tuple(items[told])) for told, story in stories.items())


_NUMBERED = re.compile(r"\s*\d+\W*\s")


def _told_in(text: str) -> str:
    """Return the story without the prompt before line 1 and without ends of chapters."""
    lines = text.splitlines()
    first = next((n for n, line in enumerate(lines) if _NUMBERED.match(line)), 0)
    return "\n".join(line for line in lines[first:] if line.strip(" *"))


def _item(number: int, row: _Row, story: Story) -> Item:
    question = parse_question(row.question)
    check_question(story, question)
    if row.question_order not in (None, question.order):
        raise InputError(
            f"{row.question!r} is of order {question.order}, and question_order says "
            f"{row.question_order}"
        )
    return Item(number, question, row.answer)


@contextmanager
def _named(where: str) -> Iterator[None]:
    try:
        yield
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
