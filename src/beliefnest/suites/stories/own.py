"""User-written stories: JSON lines of events and questions (format: docs/batteries.md)."""

from collections.abc import Collection
from pathlib import Path
from typing import Any

import msgspec

from beliefnest.errors import InputError
from beliefnest.files import decode_json, os_errors_of, read_regular
from beliefnest.perception.options import ContainerMode, Testimony
from beliefnest.scenarios.document import key_words
from beliefnest.scenarios.form_faults import FormError, converted
from beliefnest.suites.stories.data import BatteryItem, ReadStories, StoryItems, Unread
from beliefnest.suites.stories.grammar import Agent, Line, StoryEvent, Write, parse_line
from beliefnest.suites.stories.played_story import Knowing, check_question
from beliefnest.suites.stories.questions import Question, parse_question
from beliefnest.suites.stories.story import Story, story_of
from beliefnest.world.texts import quoted


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

    events: list[str | StoryEvent]
    questions: list[_Asked]
    name: str = ""
    containers: ContainerMode = "transparent"
    testimony: Testimony = "informed"
    sincere: bool = False


def read_own(path: Path, rows: Collection[int] | None = None) -> ReadStories:
    """Read a JSONL file, one story per line.

    A story with an event that cannot be read is left out as a whole; of the questions, those that
    cannot be read.

    Args:
        path: The file.
        rows: Numbers of the lines to read, from 1; None: all.

    Raises:
        InputError: The file does not exist, or lacks a line of `rows`.
    """
    with os_errors_of(path, "read", "give JSON lines"):
        lines = read_regular(path).splitlines()
    missing = sorted(set(rows or ()) - set(range(1, len(lines) + 1)))
    if missing:
        raise InputError(f"{path} has no line {missing[0]}; it has lines 1 to {len(lines)}")
    stories: list[StoryItems] = []
    unread: list[Unread] = []
    for number, line in enumerate(lines, 1):
        if not line.strip() or (rows is not None and number not in rows):
            continue
        where = f"{path}, line {number}"
        try:
            own_story = converted(decode_json(line, Any), _OwnStory)
        except msgspec.DecodeError as error:
            unread.append(Unread(where, (str(error),)))
            continue
        except FormError as fault:
            unread.append(Unread(where, (_form_fault(fault),)))
            continue
        story, faults = _story(number, own_story)
        if story is not None:
            stories.append(story)
            unread += [Unread(where, (fault,)) for fault in faults]
        else:
            unread.append(Unread(where, faults, max(1, len(own_story.questions))))
    return ReadStories(tuple(stories), tuple(unread))


def _form_fault(fault: FormError) -> str:
    """Return a message that says where a story has a wrong form, and what is allowed there."""
    match fault.path:
        case ("events", int(number), *rest):
            where = f"event {number + 1}: {key_words(tuple(rest))}"
        case path:
            where = key_words(path)
    return f"{where}{fault.what}{fault.hint}"


def _story(number: int, own_story: _OwnStory) -> tuple[StoryItems | None, tuple[str, ...]]:
    """Return a story, whose events are its lines, and what cannot be read of its questions.

    None: the events cannot be read, for the reasons beside it.
    """
    lines: list[Line] = []
    faults: list[str] = []
    for at, event in enumerate(own_story.events, 1):
        try:
            lines.append(_line(at, event))
        except InputError as error:
            faults.append(str(error))
    if faults:
        return None, tuple(faults)
    try:
        story = story_of(lines)
    except InputError as error:
        return None, (str(error),)
    items: list[BatteryItem] = []
    for asked in own_story.questions:
        try:
            item = BatteryItem(number, _question(asked), asked.answer)
            check_question(story, item.question)
            _check_answer(story, item)
        except InputError as error:
            faults.append(str(error))
        else:
            items.append(item)
    knowing = Knowing(own_story.containers, own_story.testimony, own_story.sincere)
    return StoryItems(story, tuple(items), knowing), tuple(faults)


def _line(number: int, event: str | StoryEvent) -> Line:
    if not isinstance(event, str):
        return Line(number, msgspec.json.encode(event).decode(), event, "event")
    return parse_line(number, event, "event")


def _question(asked: _Asked) -> Question:
    asks = (asked.question, asked.thing, asked.door, asked.sign)
    parts = [part for part in asks if part is not None]
    if len(parts) != 1 or (asked.question is not None and asked.believers):
        raise InputError(
            f"the question {quoted(parts)} must have one of: 'question', a sentence; 'believers' "
            "and 'thing'; 'believers' and 'door' or 'sign', the name of its room"
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


def _check_answer(story: Story, item: BatteryItem) -> None:
    if item.expected is None:
        return
    names = {place.container for place in story.places}
    there = {"open", "shut"} if item.question.door is not None else names
    if item.question.sign is not None:
        there = {act.text for act in story.acts if isinstance(act, Write)} | {""}
    if item.expected not in there:
        raise InputError(
            f"{quoted(item.question.text)}: {quoted(item.expected)} is no possible answer; answers "
            f"are {', '.join(map(repr, sorted(there)))}, and null for unknown"
        )
