"""User-written stories: JSON lines of events and questions (format: docs/batteries.md)."""

from collections.abc import Collection
from pathlib import Path

import msgspec

from beliefnest.errors import InputError
from beliefnest.files import decode_json, read_regular
from beliefnest.perception.options import ContainerMode, Testimony
from beliefnest.suites.stories.data import Item, StoryItems
from beliefnest.suites.stories.faults import form_fault
from beliefnest.suites.stories.grammar import (
    Agent,
    Entered,
    Exited,
    Line,
    Located,
    Moved,
    Opened,
    Told,
    UseDoor,
    Wait,
    Whispered,
    Write,
    parse_line,
)
from beliefnest.suites.stories.played_story import Knowing, check_question
from beliefnest.suites.stories.questions import Question, parse_question
from beliefnest.suites.stories.story import Story, story_of

__all__ = ["read_own"]

_Event = Entered | Exited | Located | Moved | Opened | UseDoor | Write | Told | Whispered | Wait


class _Asked(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Question: a sentence, or `believers` with `thing`, `door` or `sign`."""

    answer: str | None
    question: str | None = None
    believers: list[Agent] = []
    thing: str | None = None
    door: str | None = None
    sign: str | None = None
    at_beginning: bool = False


class _OwnStory(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Line of the file: one story."""

    events: list[str | _Event]
    questions: list[_Asked]
    name: str = ""
    containers: ContainerMode = "transparent"
    testimony: Testimony = "informed"
    sincere: bool = False


def read_own(path: Path, rows: Collection[int] | None = None) -> tuple[StoryItems, ...]:
    """Return the stories of a JSONL file, one story per line.

    Args:
        path: The file.
        rows: Numbers of the lines to read, from 1; None: all.

    Raises:
        InputError: The file or a line does not exist, a line has another form, or a story or
            question cannot be parsed. The message names the line and the event.
    """
    try:
        lines = read_regular(path).splitlines()
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}; give JSON lines") from None
    missing = sorted(set(rows or ()) - set(range(1, len(lines) + 1)))
    if missing:
        raise InputError(f"{path} has no line {missing[0]}; it has lines 1 to {len(lines)}")
    stories = []
    for number, line in enumerate(lines, 1):
        if not line.strip() or (rows is not None and number not in rows):
            continue
        try:
            stories.append(_story(number, decode_json(line, _OwnStory)))
        except msgspec.DecodeError as error:
            words = form_fault(error, _OwnStory, _Event)
            raise InputError(f"{path}, line {number}: {words}") from None
        except InputError as error:
            raise InputError(f"{path}, line {number}: {error}") from None
    return tuple(stories)


def _story(number: int, told: _OwnStory) -> StoryItems:
    """Return a story; its events are its lines."""
    story = story_of([_line(at, event) for at, event in enumerate(told.events, 1)])
    items = [Item(number, _question(asked), asked.answer) for asked in told.questions]
    for item in items:
        check_question(story, item.question)
        _check_answer(story, item)
    knowing = Knowing(told.containers, told.testimony, told.sincere)
    return StoryItems(story, tuple(items), knowing)


def _line(number: int, event: str | _Event) -> Line:
    if not isinstance(event, str):
        return Line(number, msgspec.json.encode(event).decode(), event, "event")
    return parse_line(number, event, "event")


def _question(asked: _Asked) -> Question:
    asks = (asked.question, asked.thing, asked.door, asked.sign)
    parts = [part for part in asks if part is not None]
    if len(parts) != 1 or (asked.question is not None and asked.believers):
        raise InputError(
            f"the question {parts!r} must have one of: 'question', a sentence; 'believers' and "
            "'thing'; 'believers' and 'door' or 'sign', the name of its room"
        )
    if asked.question is not None:
        return parse_question(asked.question)
    names = " ".join(f"{name} thinks" for name in asked.believers)
    what = f"the {asked.thing} is in"
    if asked.thing is None:
        what = f"the door of the {asked.door} is"
    if asked.sign is not None:
        what = f"the sign of the {asked.sign} says"
    text = f"{names} {what} ...".strip()
    believers, thing = tuple(asked.believers), asked.thing or ""
    return Question(believers, thing, asked.at_beginning, text, asked.door, asked.sign)


def _check_answer(story: Story, item: Item) -> None:
    if item.expected is None:
        return
    names = {place.container for place in story.places}
    there = {"open", "shut"} if item.question.door is not None else names
    if item.question.sign is not None:
        there = {act.text for act in story.acts if isinstance(act, Write)} | {""}
    if item.expected not in there:
        raise InputError(
            f"{item.question.text!r}: {item.expected!r} is no possible answer; answers are "
            f"{', '.join(map(repr, sorted(there)))}, and null for unknown"
        )
