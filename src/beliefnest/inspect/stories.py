"""Tasks of suites: stories in words with questions; the answer is a container."""

from pathlib import Path

from anyio.to_thread import run_sync
from inspect_ai import Task
from inspect_ai.dataset import Sample
from inspect_ai.scorer import Score, Scorer, scorer
from inspect_ai.solver import TaskState

from beliefnest.errors import InputError
from beliefnest.inspect.metrics import CLUSTER, metrics_by
from beliefnest.inspect.task_parts import answer_scorer, score_of, several_files, task_of
from beliefnest.llm.messages import Finish
from beliefnest.llm.reading_answers import read_answer
from beliefnest.plan.cells import variation_id
from beliefnest.suites import story_reader
from beliefnest.suites.stories.data import BatteryItem, StoryItems
from beliefnest.suites.stories.explaining import explain_answer
from beliefnest.suites.stories.played_story import PlayedStory

NOWHERE = "in none of them"
"""Answer option for a thing that is in no container."""


def suite_task(suite: str, file: str | list[str], limit: int | None) -> Task:
    """Return the task of a suite; each question is a sample.

    Args:
        suite: `hi-tom`, `tomi` or `stories`.
        file: Files of stories, questions and answers, as for `beliefnest suite`.
        limit: Greatest number of stories of each file; None for all.

    Raises:
        InputError: The file is missing or has another form.
    """
    files = several_files(file)
    samples = [
        _sample(suite, each, place, number, asked, item, "" if len(files) == 1 else Path(each).stem)
        for each in files
        for place, asked in enumerate(story_reader(suite)(Path(each)).whole()[:limit])
        for number, item in enumerate(asked.items)
    ]
    if not samples:
        raise InputError(f"{', '.join(files)} has no questions")
    return task_of(suite, samples, story_answer())


def _options(asked: StoryItems) -> list[str]:
    return [*dict.fromkeys(place.container for place in asked.story.places), NOWHERE]


def _sample(
    suite: str,
    file: str,
    place: int,
    number: int,
    asked: StoryItems,
    item: BatteryItem,
    prefix: str,
) -> Sample:
    lines = [line.text for line in asked.story.lines]
    options = _options(asked)
    prompt = "\n".join(
        [
            "Read the story and answer the question about it.",
            "",
            *lines,
            "",
            f"Question: {item.question.text}",
            f"Options: {', '.join(options)}",
            "",
            "End with a line of its own: `Answer:` and one of the options.",
        ]
    )
    return Sample(
        input=prompt,
        target=item.expected or NOWHERE,
        choices=None,
        id="-".join(filter(None, [prefix, str(place + 1), str(number + 1)])),
        metadata={
            "suite": suite,
            "file": str(Path(file).absolute()),
            "story": place,
            "item": number,
            "order": item.question.order,
            "options": options,
            "chance": 1 / len(options),
            CLUSTER: variation_id(Path(file).stem, place),
        },
    )


@scorer(metrics=metrics_by("order"))
def story_answer() -> Scorer:
    """Score an answer by the expected container; explain the belief of the nest."""

    async def score(state: TaskState, answer: str, finish: Finish) -> Score:
        reading = read_answer(answer, state.metadata["options"], finish)
        ok = reading.option == state.target.text
        outcome = reading.row_outcome
        if outcome == "read":
            outcome = "ok" if ok else "wrong"
        lines = await run_sync(_explanation, dict(state.metadata))
        head = [f"{outcome}: {reading.reason}"] if reading.reason else [outcome]
        return score_of(
            ok=ok, answer=reading.option, lines=[*head, "", *lines], metadata={"outcome": outcome}
        )

    return answer_scorer(score)


def _explanation(sample: dict[str, object]) -> tuple[str, ...]:
    """Return the nest's answer to a question and the reasons for it, in lines."""
    stories = story_reader(str(sample["suite"]))(Path(str(sample["file"]))).whole()
    asked = stories[int(str(sample["story"]))]
    item = asked.items[int(str(sample["item"]))]
    with PlayedStory.play(asked.story, asked=[item.question], knowing=asked.knowing) as played:
        answer = played.answer(item.question)
        return explain_answer(played, item.question, answer, item.expected or NOWHERE)
