"""`beliefnest suite`: answer all questions of a file from nests, and print the scores."""

import re
import time
from collections.abc import Iterator, Mapping, Sequence

import msgspec

from beliefnest.cli.console import Printed, print_report, result_table
from beliefnest.cli.films import run_films
from beliefnest.cli.options import SuiteOptions
from beliefnest.cli.playing import playing, status_of, write_tables
from beliefnest.errors import InputError
from beliefnest.studies.suite_playing import play_suite
from beliefnest.suites import FILMS, story_reader
from beliefnest.suites.stories.cells import STORY_KIND, story_cells
from beliefnest.suites.stories.data import ReadStories, StoryItems, Unread
from beliefnest.suites.stories.suite import JudgedAnswer, Score, score, scores_by_order
from beliefnest.world.words import counted
from beliefnest.worlds.names import check_world

_ROWS = re.compile(r"(?P<first>[0-9]{1,7})(?:\s*-\s*(?P<last>[0-9]{1,7}))?")


def run_suite(options: SuiteOptions) -> int:
    """Play the stories, answer the questions, and print the scores.

    Returns:
        Exit status: 0 if everything was read and every answer is right, else 1.

    Raises:
        BeliefNestError: The input is wrong, or a world failed.
    """
    read = None if options.name == FILMS else story_reader(options.name)
    if options.limit is not None and options.limit < 1:
        raise InputError(f"--limit is {options.limit}; give 1 or more stories")
    check_world(options.world, servers=False)
    rows = None if options.rows is None else parse_rows(options.rows)
    if read is None:
        _check_films(options)
        return run_films(options, rows)
    read_stories = read(options.path, rows)
    if not isinstance(read_stories, ReadStories):
        raise InputError(
            f"the suite {options.name} read {type(read_stories).__name__}, no ReadStories; see "
            "docs/plugins.md"
        )
    stories = (read_stories.whole() if options.strict else read_stories.stories)[: options.limit]
    if not stories:
        read_stories.whole()
        raise InputError(f"{options.path} holds no rows; there is nothing to ask")
    if not any(each.items for each in stories):
        read_stories.whole()
        raise InputError(f"{options.path} asks no question; give each story some `questions`")
    started = time.perf_counter()
    setting = {
        "world": options.world,
        "seed": options.seed,
        "claims_from": options.claims_from,
    }
    with playing(f"{options.name} ({options.world})", options.out) as (folder, on_progress):
        result = play_suite(
            folder,
            STORY_KIND,
            story_cells(options.name, stories, setting),
            {
                "suites": [options.name],
                "data": str(options.path),
                "unread": sum(each.questions for each in read_stories.unread),
                **setting,
            },
            filter(None, [options.claims_from]),
            on_progress,
        )
        if options.out is not None:
            write_tables(result)
        rest = read_stories.unread, msgspec.convert(result.rows, list[JudgedAnswer])
        report = _report(options, stories, *rest, time.perf_counter() - started)
        parts = _parts(options, stories, *rest)
        print_report(report, parts, as_json=options.json)
        return status_of(result) or int(bool(read_stories.unread))


def _check_films(options: SuiteOptions) -> None:
    """Raise InputError if an option is not for films."""
    if options.world != "scripted":
        raise InputError(f"--world is {options.world}; films are acted out in the scripted world")
    if options.strict:
        raise InputError("--strict is for stories; a file of films is always read whole")
    if options.claims_from is not None:
        raise InputError("--claims-from is for stories; nobody says anything in films")


def parse_rows(text: str) -> frozenset[int]:
    """Return row numbers from a text such as `1-20,35`.

    Raises:
        InputError: The text does not have this form.
    """
    rows: set[int] = set()
    for part in text.split(","):
        match = _ROWS.fullmatch(part.strip())
        if match is None or int(match["first"]) > int(match["last"] or match["first"]):
            raise InputError(f"--rows has {part!r}; give numbers and ranges, such as 1-20,35")
        rows.update(range(int(match["first"]), int(match["last"] or match["first"]) + 1))
    return frozenset(rows)


def _needs_first(judged: Sequence[JudgedAnswer]) -> dict[int, Score]:
    scores = scores_by_order(judged, lambda each: each.needs_first)
    return {order: reached for order, reached in scores.items() if order > 0}


def _telling(judged: Sequence[JudgedAnswer], *, tells: bool) -> list[JudgedAnswer]:
    """Return the answers about stories with claims (`tells`), or about those without."""
    return [each for each in judged if each.claims is tells]


def _report(
    options: SuiteOptions,
    stories: Sequence[StoryItems],
    unread: Sequence[Unread],
    judged: Sequence[JudgedAnswer],
    seconds: float,
) -> dict[str, object]:
    return {
        "suite": options.name,
        "data": str(options.path),
        "world": options.world,
        "seed": options.seed,
        "stories": len(stories),
        "seconds": round(seconds, 3),
        "ok": all(each.ok for each in judged) and not unread,
        "unread_items": sum(each.questions for each in unread),
        "not_read": [{"faults": list(each.lines), "questions": each.questions} for each in unread],
        "notes": _notes(stories),
        "all": _score_json(score(judged)),
        "orders": _scores_json(scores_by_order(judged)),
        "without_claims": _scores_json(scores_by_order(_telling(judged, tells=False))),
        "with_claims": _scores_json(scores_by_order(_telling(judged, tells=True))),
        "first_believer_matters": _scores_json(_needs_first(judged)),
        "claims_from": options.claims_from,
        "unread": sorted({each.row for each in judged if each.unread is not None}),
        "wrong_in_data": [each.row for each in judged if each.wrong_in_data is not None],
        "misses": [_miss_json(each) for each in judged if not each.ok],
    }


def _notes(stories: Sequence[StoryItems]) -> list[str]:
    """Return remarks on lines of the stories, with the first row of the story."""
    return [
        f"row {asked.items[0].row if asked.items else 0}: {note}"
        for asked in stories
        for note in asked.story.notes
    ]


def _scores_json(scores: Mapping[int, Score]) -> dict[str, object]:
    return {str(order): _score_json(of_order) for order, of_order in scores.items()}


def _score_json(total: Score) -> dict[str, object]:
    return {"questions": total.questions, "right": total.right, "accuracy": total.accuracy}


def _miss_json(judged: JudgedAnswer) -> dict[str, object]:
    return {
        "row": judged.row,
        "order": judged.order,
        "question": judged.question,
        "path": judged.path,
        "answer": judged.answer,
        "expected": judged.expected,
        "claims": judged.claims,
        "wrong_in_data": judged.wrong_in_data,
        "explanation": judged.why_not.splitlines(),
    }


def _parts(
    options: SuiteOptions,
    stories: Sequence[StoryItems],
    not_read: Sequence[Unread],
    judged: Sequence[JudgedAnswer],
) -> Iterator[Printed]:
    title = f"{options.name}: {counted(len(stories), 'story')} in the {options.world} world"
    numbers = ("order", "questions", "right", "first believer matters", "right")
    table = result_table("claims", *numbers, title=title, right=numbers)
    for tells, word in ((False, "none"), (True, "some")):
        part = _telling(judged, tells=tells)
        matters = _needs_first(part)
        for order, of_order in scores_by_order(part).items():
            cells = (*_cells(of_order), *_cells(matters.get(order, Score(0, 0))))
            table.add_row(word, str(order), *cells)
    total = score(each for each in judged if each.needs_first)
    table.add_row("all", "all", *_cells(score(judged)), *_cells(total))
    yield table
    if not_read:
        count = counted(sum(each.questions for each in not_read), "question")
        yield f"not read and not counted: {count}"
    yield from (f"    {line}" for each in not_read for line in each.lines)
    yield from _notes(stories)
    unread = {each.row: each.unread for each in judged if each.unread is not None}
    for row, error in [*unread.items()][:1]:
        yield (
            f"{len(unread)} stories have utterances that could not be read for claims; "
            f"the first, row {row}: {error}"
        )
    for each in judged:
        if not each.ok:
            yield f"row {each.row}: {each.question}"
            faults = [] if each.wrong_in_data is None else [each.wrong_in_data]
            yield from (f"    {line}" for line in (*faults, *each.why_not.splitlines()))


def _cells(total: Score) -> tuple[str, str]:
    if total.accuracy is None:
        return "", ""
    return str(total.questions), f"{total.accuracy:.1%}"
