"""Audit of published text sets: labels that their own story contradicts, or does not determine."""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import msgspec
from msgspec.structs import replace

from beliefnest.errors import InputError
from beliefnest.files import read_regular
from beliefnest.suites.stories.answer_check import is_told_of
from beliefnest.suites.stories.data import BatteryItem, ReadStories, StoryItems, Unread
from beliefnest.suites.stories.own import read_own
from beliefnest.suites.stories.played_story import Knowing
from beliefnest.suites.stories.suite import JudgedAnswer, answer_story
from beliefnest.suites.stories.tables import read_table
from beliefnest.suites.stories.tomi import read_tomi

_CONTENTS: Mapping[str, Callable[[Knowing], Knowing]] = {
    "agents see what is in a container only when it is opened": lambda knowing: replace(
        knowing, containers="opaque"
    ),
}
_CLAIMS: Mapping[str, Callable[[Knowing], Knowing]] = {
    "hearers believe what they hear": lambda knowing: replace(knowing, testimony="accept"),
    "nobody believes what is said": lambda knowing: replace(knowing, testimony="none"),
    "speakers believe what they say": lambda knowing: replace(knowing, sincere=True),
}
"""Assumptions under which a label may be right, in words, and the rules that they change."""


class Finding(msgspec.Struct, frozen=True):
    """Label that does not follow from its story.

    Attributes:
        row: Row or line in the file, from 1.
        question: The question.
        label: The published answer.
        answer: Answer that follows from the story; None: unknown, or in no container.
        why: Reason.
        is_wrong: True if the label contradicts the story; False if it is undetermined.
        assumption: Assumption under which the label is right; None: none of those tried.
    """

    row: int
    question: str
    label: str | None
    answer: str | None
    why: tuple[str, ...]
    is_wrong: bool
    assumption: str | None


class Audit(msgspec.Struct, frozen=True):
    """Result of an audit.

    Attributes:
        items: Number of items that were read and answered.
        wrong: Labels that contradict their story.
        undetermined: Labels that are right under an assumption that the text does not make, and
            those of which the story says nothing.
        unread: Parts of the file that could not be read, with the sentences.
    """

    items: int
    wrong: tuple[Finding, ...]
    undetermined: tuple[Finding, ...]
    unread: tuple[Unread, ...]


def read_published(path: Path) -> ReadStories:
    """Read a file in the form of ToMi, of stories of one's own, or of a table.

    Raises:
        InputError: The file cannot be read, or is of a set of items.
    """
    try:
        start = read_regular(path)[:100_000].decode("utf-8", "replace").lstrip()
    except OSError:
        # The reader says why.
        return read_table(path)
    first = start.partition("\n")[0]
    if first.startswith("{") and '"events"' in first:
        return read_own(path)
    if first.startswith("{") and all(f'"{each}":' in first for each in ("skeleton", "right")):
        raise InputError(
            f"{path} is of a set that `beliefnest items` wrote, and its answers are computed; "
            "check it by `beliefnest items STUDY -o SET --verify`"
        )
    numbered = first.startswith(("1 ", "1\t"))
    return read_tomi(path) if numbered and "\t" in start else read_table(path)


def audit(
    batch: ReadStories, on_story: Callable[[str, int, int], None] = lambda what, done, total: None
) -> Audit:
    """Play stories, and compare their labels with what follows from them.

    Args:
        batch: The stories.
        on_story: Function that receives the progress.

    Raises:
        BeliefNestError: The world failed.
    """
    findings: list[Finding] = []
    for number, asked in enumerate(batch.stories):
        on_story(f"story {number + 1}", number, len(batch.stories))
        findings += _of_story(asked)
    items = sum(len(each.items) for each in batch.stories)
    wrong = tuple(each for each in findings if each.is_wrong)
    return Audit(items, wrong, tuple(each for each in findings if not each.is_wrong), batch.unread)


def _of_story(asked: StoryItems) -> Iterator[Finding]:
    """Yield a finding for each label of a story that is not the answer of the nest."""
    answers = zip(asked.items, answer_story(asked), strict=True)
    missed = [(item, each) for item, each in answers if not each.ok]
    if not missed:
        return
    others = dict(_otherwise(asked, [each for _, each in missed]))
    for item, each in missed:
        fault = each.wrong_in_data
        assumption = others.get(each.row) or _unsaid(asked, item, each)
        yield Finding(
            row=each.row,
            question=each.question,
            label=each.expected,
            answer=each.answer,
            why=tuple(each.why_not.splitlines()) if fault is None else (fault,),
            is_wrong=fault is not None or assumption is None,
            assumption=assumption,
        )


def _unsaid(asked: StoryItems, item: BatteryItem, missed: JudgedAnswer) -> str | None:
    """Return what a label may rest on that the text leaves open; None: nothing."""
    question, label = item.question, item.expected
    is_place = not (question.door or question.sign)
    if is_place and label not in {None, *(place.container for place in asked.story.places)}:
        return None
    if is_told_of(asked.story, question):
        return "another rule of what hearers believe"
    return "something that the story does not say" if missed.answer is None else None


def _otherwise(asked: StoryItems, missed: list[JudgedAnswer]) -> Iterator[tuple[int, str]]:
    """Yield rows whose label is right under another assumption, and that assumption."""
    rows = {each.row for each in missed}
    items = tuple(each for each in asked.items if each.row in rows)
    for words, change in {**_CONTENTS, **(_CLAIMS if asked.story.tells else {})}.items():
        changed = replace(asked, items=items, knowing=change(asked.knowing))
        yield from ((each.row, words) for each in answer_story(changed) if each.ok)
