"""Why the nest answers as it does, as lines of text."""

from beliefnest.belief.entries import Basis
from beliefnest.scenarios.stories.playing import Answer, PlayedStory
from beliefnest.scenarios.stories.questions import Question

__all__ = ["explain_answer"]


def explain_answer(
    played: PlayedStory, question: Question, answer: Answer, expected: str
) -> tuple[str, ...]:
    """What each simulator on the way to the belief asked for holds, and since when.

    Args:
        played: The story, played.
        question: What was asked.
        answer: What the nest said.
        expected: Name of the container expected.
    """
    said = "in no container" if answer.text is None else f"in the {answer.text}"
    lines = [f"the {question.thing} is {said} in {answer.path}, expected the {expected}"]
    for depth in range(question.order + 1):
        believers = question.believers[:depth]
        if depth and believers[-1] == question.believers[depth - 2 : depth - 1]:
            continue
        found = played.answer(
            Question(believers, question.thing, question.at_beginning, question.text)
        )
        lines.append(_holds(played, found))
    return tuple(lines)


def _holds(played: PlayedStory, found: Answer) -> str:
    if found.place is None or found.basis is None:
        return f"{found.path} holds the {found.thing} in no container at tick {found.tick}"
    return (
        f"{found.path} holds the {found.thing} in the {found.place.container} of the "
        f"{found.place.room}, {_since(played, found.basis)}"
    )


def _since(played: PlayedStory, basis: Basis) -> str:
    ground = str(basis.source) if basis.event is None else f"{basis.source} ({basis.event})"
    text = f"{ground} last at tick {basis.observed_at}"
    number = played.line_at(basis.observed_at)
    if number is None:
        return f"{text}, before line 1"
    line = played.story.lines[number]
    return f"{text}, during line {line.number}: {line.text}"
