"""Files of stories with questions and expected answers."""

import json
import re
from collections.abc import Collection
from pathlib import Path

import msgspec

from beliefnest.errors import InputError
from beliefnest.files import decode_json, read_regular
from beliefnest.suites.stories.grammar import parse_all
from beliefnest.suites.stories.played_story import Knowing, check_question
from beliefnest.suites.stories.questions import Question, parse_question
from beliefnest.suites.stories.story import Story, story_of
from beliefnest.world.texts import quoted


class _Row(msgspec.Struct):
    """Row of a Hi-ToM file; other columns are ignored."""

    story: str
    question: str
    answer: str
    question_order: int | None = None


class _Published(msgspec.Struct):
    """Published file: an object with the rows under a key."""

    data: list[msgspec.Raw]


_EVERYTHING = Knowing()


class BatteryItem(msgspec.Struct, frozen=True):
    """Question and its expected answer.

    Attributes:
        row: Row in the file, from 1.
        question: The question.
        expected: Name of a container; None: the thing is believed to be in no container.
    """

    row: int
    question: Question
    expected: str | None


class StoryItems(msgspec.Struct, frozen=True):
    """Story and all its questions.

    Attributes:
        story: The story.
        items: Questions and expected answers.
        knowing: Rules by which agents learn of events that they do not see.
    """

    story: Story
    items: tuple[BatteryItem, ...]
    knowing: Knowing = _EVERYTHING


class Unread(msgspec.Struct, frozen=True):
    """Part of a file that could not be read.

    Attributes:
        where: File, and the row or line in it.
        faults: Reasons, each with the line or event of the story if it is about one.
        questions: Number of questions that are left out; 1 if that is unknown.
        joint: Text between `where` and a fault.
    """

    where: str
    faults: tuple[str, ...]
    questions: int = 1
    joint: str = ": "

    @property
    def lines(self) -> tuple[str, ...]:
        """Return each fault with its place."""
        return tuple(f"{self.where}{self.joint}{fault}" for fault in self.faults)


class ReadStories(msgspec.Struct, frozen=True):
    """Stories of a file, and the parts of it that could not be read."""

    stories: tuple[StoryItems, ...]
    unread: tuple[Unread, ...]

    def whole(self) -> tuple[StoryItems, ...]:
        """Return the stories if everything was read.

        Raises:
            InputError: A part could not be read; the message names it.
        """
        for each in self.unread:
            raise InputError(each.lines[0])
        return self.stories


def read_items(path: Path, rows: Collection[int] | None = None) -> ReadStories:
    """Read a Hi-ToM file; rows of the same story are grouped.

    Args:
        path: JSON file: an array of rows with `story`, `question`, `answer` and optionally
            `question_order`; or an object with that array under `data`.
        rows: Numbers of the rows to read, from 1; None: all.

    Raises:
        InputError: The file does not exist, is no array of rows, or lacks a row of `rows`.
    """
    try:
        text = read_regular(path)
        if text.lstrip()[:1] == b"{":
            every = decode_json(text, _Published).data
        else:
            every = decode_json(text, list[msgspec.Raw])
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}; give a JSON file") from None
    except msgspec.DecodeError as error:
        raise InputError(
            f"{path}, line {_line_of_fault(text)}: {error}; give an array of rows with 'story', "
            "'question' and 'answer', or an object with that array under 'data'"
        ) from None
    if rows is not None and not set(rows) <= set(range(1, len(every) + 1)):
        missing = min(set(rows) - set(range(1, len(every) + 1)))
        raise InputError(f"{path} has no row {missing}; it has rows 1 to {len(every)}")
    stories: dict[str, Story] = {}
    items: dict[str, list[BatteryItem]] = {}
    unread: list[Unread] = []
    for number, raw in enumerate(every, 1):
        if rows is not None and number not in rows:
            continue
        where = f"{path}, row {number}"
        try:
            row = decode_json(bytes(raw), _Row)
            lines_of_story = _told_in(row.story)
            if lines_of_story not in stories:
                lines, faults = parse_all(lines_of_story)
                if faults:
                    unread.append(Unread(where, tuple(map(str, faults))))
                    continue
                stories[lines_of_story] = story_of(lines)
            item = _item(number, row, stories[lines_of_story])
        except (InputError, msgspec.DecodeError) as error:
            unread.append(Unread(where, (str(error),)))
            continue
        items.setdefault(lines_of_story, []).append(item)
    ready = tuple(StoryItems(story, tuple(items[t])) for t, story in stories.items() if t in items)
    return ReadStories(ready, tuple(unread))


def _line_of_fault(text: bytes) -> int:
    """Return the line at which a text stops being JSON; 1: it is JSON of another form."""
    try:
        json.loads(text.rstrip())
    except json.JSONDecodeError as fault:
        return fault.lineno
    except (UnicodeDecodeError, RecursionError):
        pass
    return 1


_NUMBERED = re.compile(r"\s*\d+\W*\s")


def _told_in(text: str) -> str:
    """Return the story without the prompt before line 1 and without ends of chapters."""
    lines = text.splitlines()
    first = next((n for n, line in enumerate(lines) if _NUMBERED.match(line)), 0)
    return "\n".join(line for line in lines[first:] if line.strip(" *"))


def _item(number: int, row: _Row, story: Story) -> BatteryItem:
    question = parse_question(row.question)
    check_question(story, question)
    if row.question_order not in (None, question.order):
        raise InputError(
            f"{quoted(row.question)} is of order {question.order}, and question_order says "
            f"{row.question_order}"
        )
    return BatteryItem(number, question, row.answer)
