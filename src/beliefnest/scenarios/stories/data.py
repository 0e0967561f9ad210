"""Files of stories with questions and the answers expected."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import msgspec

from beliefnest.errors import InputError
from beliefnest.files import decode_json, read_regular
from beliefnest.scenarios.stories.playing import check_question
from beliefnest.scenarios.stories.questions import Question, parse_question
from beliefnest.scenarios.stories.story import Story, read_story

__all__ = ["Item", "StoryItems", "read_items"]


class _Row(msgspec.Struct):
    """A row as Hi-ToM has them; its other columns play no part."""

    story: str
    question: str
    answer: str
    question_order: int | None = None


@dataclass(frozen=True, slots=True)
class Item:
    """A question and the answer that is expected.

    Attributes:
        row: Its row in the file, from 1.
        question: What is asked.
        expected: Name of a container.
    """

    row: int
    question: Question
    expected: str


@dataclass(frozen=True, slots=True)
class StoryItems:
    """A story and all that is asked about it."""

    story: Story
    items: tuple[Item, ...]


def read_items(path: Path) -> tuple[StoryItems, ...]:
    """The stories of a JSON file, an array of rows; rows of the same story are put together.

    Args:
        path: A file of rows with `story`, `question`, `answer` and, if it likes,
            `question_order`.

    Raises:
        InputError: There is no such file, it is of another form, or a story or a question
            cannot be understood; the message names the row, and the line of the story.
    """
    try:
        rows = decode_json(read_regular(path), list[_Row])
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}; give a JSON file") from None
    except msgspec.DecodeError as error:
        raise InputError(
            f"{path}: {error}; give an array of rows with 'story', 'question' and 'answer'"
        ) from None
    stories: dict[str, Story] = {}
    items: dict[str, list[Item]] = {}
    for number, row in enumerate(rows, 1):
        with _named(f"{path}, row {number}"):
            if row.story not in stories:
                stories[row.story] = read_story(row.story)
            item = _item(number, row, stories[row.story])
        items.setdefault(row.story, []).append(item)
    return tuple(StoryItems(story, tuple(items[text])) for text, story in stories.items())


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
