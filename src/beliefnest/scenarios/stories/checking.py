"""Whether an answer that is expected contradicts the very story that it is about.

Held against the nest's answers, and sharing nothing with them but what really happens: in a
story in which nobody tells anything, some agents know together where a thing is, and know that
of each other, whenever all of them and the thing are in one room. Nothing else tells them.
"""

from collections.abc import Iterator

from beliefnest.scenarios.stories.questions import Question
from beliefnest.scenarios.stories.story import Come, Go, Move, Place, Story

__all__ = ["data_fault"]


def data_fault(story: Story, question: Question, expected: str | None) -> str | None:
    """What in the story an expected answer contradicts; None: nothing, or it cannot be told.

    Args:
        story: The story.
        question: What is asked.
        expected: Name of the container that is said to be the answer.
    """
    if story.tells or question.at_beginning or question.thing not in story.things:
        return None
    thing = question.thing
    last: tuple[int, Place] | None = None
    shown = False
    for number, rooms, place in _states(story, thing):
        if all(rooms.get(name) == place.room for name in question.believers):
            if last is None or last[1] != place:
                last = (number, place)
            shown = shown or place.container == expected
    if last is None or last[1].container == expected:
        return None
    line = story.lines[last[0]]
    who = " and ".join(dict.fromkeys(question.believers))
    there = f" while {who} {'are' if ' and ' in who else 'is'} there" if who else ""
    never = "" if shown else f"; it is never in the {expected}{there}"
    return (
        f"wrong in the data: from {line.place} ({line.text}) on the {thing} is in the "
        f"{last[1].container} of the {last[1].room}{there}, and nothing after that is known to "
        f"them{never}"
    )


def _states(story: Story, thing: str) -> Iterator[tuple[int, dict[str, str | None], Place]]:
    """After every line, its index, the room each agent is in, and where the thing is."""
    rooms: dict[str, str | None] = {}
    place = story.things[thing]
    for number, act in enumerate(story.acts):
        match act:
            case Come(agents, room):
                rooms |= dict.fromkeys(agents, room)
            case Go(agents):
                rooms |= dict.fromkeys(agents)
            case Move(_, moved, _, target) if moved == thing:
                place = target
            case _:
                pass
        yield number, rooms, place
