"""Suites: answer all questions of a file of stories, and score the answers."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from beliefnest.suites.stories.answer_check import data_fault
from beliefnest.suites.stories.data import BatteryItem, StoryItems
from beliefnest.suites.stories.explaining import explain_answer
from beliefnest.suites.stories.played_story import PlayedStory, StoryAnswer


@dataclass(frozen=True, slots=True)
class JudgedAnswer:
    """Answer to a question, compared with the expected one.

    Attributes:
        item: Question and expected answer.
        answer: Answer of the nest.
        needs_first: True if the expected answer differs from the nest's answer to the question
            without its first believer; False if there is no believer.
        tells: True if an agent tells something in the story.
        data_fault: How the expected answer contradicts its story; None: no contradiction found.
        explanation: Explanation of a wrong answer; else empty.
        unread: Reason why a model could not read an utterance of the story for claims; None: it
            read all of them, or there is no such model.
    """

    item: BatteryItem
    answer: StoryAnswer
    needs_first: bool
    tells: bool = False
    data_fault: str | None = None
    explanation: tuple[str, ...] = ()
    unread: str | None = None

    @property
    def ok(self) -> bool:
        """Return True if the answer is the expected one."""
        return self.answer.text == self.item.expected


@dataclass(frozen=True, slots=True)
class Score:
    """Score of some answers.

    Attributes:
        questions: Number of questions.
        right: Number of right answers.
    """

    questions: int
    right: int

    @property
    def accuracy(self) -> float | None:
        """Return the share of right answers, 0 to 1; None: there are no questions."""
        return self.right / self.questions if self.questions else None


def answer_story(
    asked: StoryItems, world: str = "scripted", seed: int = 0
) -> tuple[JudgedAnswer, ...]:
    """Play a story once and answer all its questions from one nest.

    Raises:
        BodyError: The world could not be started, or died.
        ProgramError: A bot could not do what a line says.
        UnknownNameError: The world does not exist.
    """
    questions = [item.question for item in asked.items]
    nested = [q for q in questions if q.believers]
    dropped = [replace(q, believers=q.believers[1:]) for q in nested]
    with PlayedStory.play(
        asked.story, world, seed, [*questions, *dropped], asked.knowing
    ) as played:
        answers = played.answer_all([*questions, *dropped])
        without = dict(zip(nested, answers[len(questions) :], strict=True))
        judged = []
        unread = next((p.error for p in played.nest.prompts() if p.answer is None), None)
        for item, answer in zip(asked.items, answers, strict=False):
            other = without.get(item.question)
            needs_first = other is not None and other.text != item.expected
            each = JudgedAnswer(item, answer, needs_first, asked.story.tells)
            if not each.ok:
                fault = data_fault(asked.story, item.question, item.expected)
                why = explain_answer(played, item.question, answer, item.expected)
                each = replace(each, data_fault=fault, explanation=why)
            judged.append(replace(each, unread=unread))
    return tuple(judged)


def score(judged: Iterable[JudgedAnswer]) -> Score:
    """Return the score of some answers."""
    verdicts = [each.ok for each in judged]
    return Score(len(verdicts), sum(verdicts))


def scores_by_order(
    judged: Sequence[JudgedAnswer], of: Callable[[JudgedAnswer], bool] = lambda _: True
) -> dict[int, Score]:
    """Return the score of each order of questions, over the answers that `of` selects."""
    orders = sorted({each.item.question.order for each in judged})
    return {
        order: score(each for each in judged if each.item.question.order == order and of(each))
        for order in orders
    }
