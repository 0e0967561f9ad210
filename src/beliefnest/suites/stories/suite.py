"""Suites: answer all questions of a file of stories, and score the answers."""

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import msgspec
from msgspec.structs import replace

from beliefnest.suites.stories.answer_check import data_fault
from beliefnest.suites.stories.data import StoryItems
from beliefnest.suites.stories.explaining import explain_answer
from beliefnest.suites.stories.played_story import PlayedStory


class JudgedAnswer(msgspec.Struct, frozen=True):
    """Answer to a question, compared with the expected one: a row of the table of a suite.

    Attributes:
        row: Row of the question in the file.
        order: Order of the question.
        claims: True if an agent tells something in the story.
        question: The question.
        expected: Expected answer, as in `BatteryItem`.
        path: Path of the simulator that answered; None: there is no answer.
        answer: Answer of the nest, as `StoryAnswer.text`.
        needs_first: True if the expected answer differs from the nest's answer to the question
            without its first believer; False if there is no believer.
        ok: True if the answer is the expected one; None: nobody was asked.
        outcome: Outcome in words, as in studies.
        why_not: Explanation of a wrong answer, in lines; else empty.
        wrong_in_data: How the expected answer contradicts its story; None: no contradiction found.
        unread: Reason why a model could not read an utterance of the story for claims; None: it
            read all of them, or there is no such model.
    """

    row: int
    order: int
    claims: bool
    question: str
    expected: str | None
    path: str | None
    answer: str | None
    needs_first: bool | None
    ok: bool | None
    outcome: str
    why_not: str = ""
    wrong_in_data: str | None = None
    unread: str | None = None


class Score(msgspec.Struct, frozen=True):
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
        unread = next((p.error for p in played.nest.prompts() if p.answer is None), None)
        judged = []
        for item, begun, answer in zip(asked.items, asked_in(asked), answers, strict=False):
            other = without.get(item.question)
            ok = answer.text == item.expected
            fault = None if ok else data_fault(asked.story, item.question, item.expected)
            why = () if ok else explain_answer(played, item.question, answer, item.expected)
            judged.append(
                JudgedAnswer(
                    **begun,
                    path=answer.path,
                    answer=answer.text,
                    needs_first=other is not None and other.text != item.expected,
                    ok=ok,
                    outcome="ok" if ok else "wrong",
                    why_not="\n".join(why),
                    wrong_in_data=fault,
                    unread=unread,
                )
            )
    return tuple(judged)


def asked_in(asked: StoryItems) -> list[dict[str, Any]]:
    """Return what is known of each row before a story is played."""
    return [
        {
            "row": item.row,
            "order": item.question.order,
            "claims": asked.story.tells,
            "question": item.question.text,
            "expected": item.expected,
        }
        for item in asked.items
    ]


def score(judged: Iterable[JudgedAnswer]) -> Score:
    """Return the score of some answers; those of which nobody was asked do not count."""
    verdicts = [each.ok for each in judged if each.ok is not None]
    return Score(len(verdicts), sum(verdicts))


def scores_by_order(
    judged: Sequence[JudgedAnswer], of: Callable[[JudgedAnswer], object] = lambda _: True
) -> dict[int, Score]:
    """Return the score of each order of questions, over the answers that `of` selects."""
    return {
        order: score(each for each in judged if each.order == order and of(each))
        for order in sorted({each.order for each in judged})
    }
