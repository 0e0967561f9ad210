"""Files of ToMi: numbered lines, and questions with answers after a tab (Le et al. 2019)."""

from collections.abc import Collection
from pathlib import Path

from beliefnest.errors import InputError
from beliefnest.files import os_errors_of, read_regular_text
from beliefnest.suites.stories.data import BatteryItem, ReadStories, StoryItems, Unread
from beliefnest.suites.stories.grammar import Line, parse_line
from beliefnest.suites.stories.played_story import check_question
from beliefnest.suites.stories.questions import parse_question
from beliefnest.suites.stories.story import Story, story_of
from beliefnest.world.texts import quoted

_FORM = "write the question, a tab, and the answer"


def read_tomi(path: Path, rows: Collection[int] | None = None) -> ReadStories:
    """Read a file of ToMi.

    A story begins at a line with the number 1. A line with a tab is a question: number, question,
    tab, answer; further columns are ignored. Rows are counted by lines of the file.

    Args:
        path: The file.
        rows: Lines of the questions to read, from 1; None: all.

    Raises:
        InputError: The file does not exist, or lacks a question at a line of `rows`.
    """
    try:
        with os_errors_of(path, "read", "give a text file"):
            text = read_regular_text(path)
    except UnicodeDecodeError as error:
        line = error.object.count(b"\n", 0, error.start) + 1
        raise InputError(f"{path}, line {line}: it is not UTF-8 text: {error.reason}") from None
    asked = [n for n, line in enumerate(text.split("\n"), 1) if "\t" in line]
    missing = sorted(set(rows or ()) - set(asked))
    if missing:
        raise InputError(f"{path}, line {missing[0]}: there is no question with a tab")
    stories: list[StoryItems] = []
    unread: list[Unread] = []
    for block in _blocks(text):
        story, faults = _read(path, block, rows)
        unread += faults
        if story is not None and story.items:
            stories.append(story)
    return ReadStories(tuple(stories), tuple(unread))


def _blocks(text: str) -> list[list[tuple[int, str]]]:
    """Return the lines of each story, with their numbers in the file."""
    blocks: list[list[tuple[int, str]]] = []
    for number, line in enumerate(text.split("\n"), 1):
        words = line.split(maxsplit=1)
        if words and (words[0] == "1" or not blocks):
            blocks.append([])
        if words:
            blocks[-1].append((number, line))
    return blocks


def _read(
    path: Path, block: list[tuple[int, str]], rows: Collection[int] | None
) -> tuple[StoryItems | None, list[Unread]]:
    asked = [
        (number, line)
        for number, line in block
        if "\t" in line and (rows is None or number in rows)
    ]
    if rows is not None and not asked:
        return None, []
    lines: list[Line] = []
    faults: list[str] = []
    first = next((number for number, line in block if "\t" in line), block[-1][0] + 1)
    for number, line in block:
        if "\t" in line:
            continue
        if number > first:
            what = "stands after a question; put the questions after the story"
            faults.append(f"line {number}: {quoted(line.strip())} {what}")
        try:
            lines.append(parse_line(number, line))
        except InputError as error:
            faults.append(str(error))
    story: Story | None = None
    if not faults:
        try:
            story = story_of(lines)
        except InputError as error:
            faults.append(str(error))
    if story is None:
        return None, [Unread(str(path), tuple(faults), max(1, len(asked)), joint=", ")]
    items: list[BatteryItem] = []
    unread: list[Unread] = []
    for number, line in asked:
        try:
            items.append(_item(number, line, story))
        except InputError as error:
            unread.append(Unread(f"{path}, line {number}", (str(error),)))
    if not asked:
        unread.append(Unread(f"{path}, line {block[-1][0]}", (f"has no question; {_FORM}",)))
    return StoryItems(story, tuple(items)), unread


def _item(number: int, line: str, story: Story) -> BatteryItem:
    asked, answer = (part.strip() for part in line.split("\t")[:2])
    first, _, rest = asked.partition(" ")
    question = parse_question(rest if first.isdecimal() else asked)
    check_question(story, question)
    if not answer:
        raise InputError(f"{quoted(asked)} has no answer; {_FORM}")
    return BatteryItem(number, question, answer)
