"""Explanations of the nest's answers, as lines of text."""

from beliefnest.belief.grounds import Basis
from beliefnest.suites.stories.played_story import PlayedStory, StoryAnswer
from beliefnest.suites.stories.questions import Question
from beliefnest.suites.stories.story import HandOver, Place
from beliefnest.world.signs import sign_words


def explain_answer(
    played: PlayedStory, question: Question, answer: StoryAnswer, expected: str | None
) -> tuple[str, ...]:
    """Explain the state of each simulator on the path of a question: since when, and why.

    Args:
        played: The story after it was played.
        question: The question.
        answer: Answer of the nest.
        expected: Name of the expected container; None: no container.
    """
    if question.door is not None or question.sign is not None:
        return _block(played, question, answer, expected)
    said = "in no container" if answer.text is None else f"in the {answer.text}"
    wanted = "in no container" if expected is None else f"the {expected}"
    lines = [f"the {question.thing} is {said} in {answer.path}, expected {wanted}"]
    for depth in range(question.order + 1):
        believers = question.believers[:depth]
        if depth > 1 and believers[-1] == believers[-2]:
            continue
        answer_of_nest = played.answer(
            Question(believers, question.thing, question.at_beginning, question.text)
        )
        lines.append(_holds(played, answer_of_nest))
    return (*lines, *_perceptions(played, question, answer, expected))


def _block(
    played: PlayedStory, question: Question, answer: StoryAnswer, expected: str | None
) -> tuple[str, ...]:
    """Explain an answer about a door or a sign."""
    if question.door is not None:
        what, place = f"the door of the {question.door} is", played.plan.doors[question.door]
        there, wanted = (text or "unknown" for text in (answer.text, expected))
    else:
        room = str(question.sign)
        what, place = f"the sign of the {room} says", played.plan.signs[room]
        there, wanted = map(_saying, (answer.text, expected))
    line = f"{what} {there} in {answer.path}, expected {wanted}"
    return (line, *played.asked(question).explain(block=place).lines)


def _saying(text: str | None) -> str:
    return "what is unknown" if text is None else f'"{sign_words(text)}"' if text else "nothing"


def _perceptions(
    played: PlayedStory, question: Question, answer: StoryAnswer, expected: str | None
) -> list[str]:
    """Return the nest's explanations of the answered and the expected container."""
    first = played.story.things[question.thing]
    rooms = played.story.rooms if isinstance(first, HandOver) else (first.room,)
    wanted = [] if expected is None else [Place(room, expected) for room in rooms]
    places_named = (answer.place, *wanted)
    places = dict.fromkeys(p for p in places_named if p is not None and p in played.plan.places)
    simulator = played.asked(question)
    lines = []
    for place in places:
        position = played.plan.places[place]
        item = played.plan.items[question.thing]
        lines.append(
            f"the {place.container}, a barrel at {position}; {item} is the {answer.thing}:"
        )
        lines += simulator.explain(container=position).lines
    return lines


def _holds(played: PlayedStory, answer: StoryAnswer) -> str:
    if answer.place is None or answer.basis is None:
        return f"{answer.path} holds the {answer.thing} in no container at tick {answer.tick}"
    return (
        f"{answer.path} holds the {answer.thing} in the {answer.place.container} of the "
        f"{answer.place.room}, {_since(played, answer.basis)}"
    )


def _since(played: PlayedStory, basis: Basis) -> str:
    ground = str(basis.source) if basis.event is None else f"{basis.source} ({basis.event})"
    text = f"{ground} last at tick {basis.observed_at}"
    number = played.line_at(basis.observed_at)
    if number is None:
        return f"{text}, before line 1"
    line = played.story.lines[number]
    return f"{text}, during {line.place}: {line.text}"
