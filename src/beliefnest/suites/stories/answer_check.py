"""Check of expected answers against their story, to find errors in data files.

The check is independent of the nest, and uses only real events. Where nobody says anything of a
thing, agents learn the place of a thing only when they are in a room with it. If all believers of a
question are in that room together, each also knows that the others know the place.
"""

from collections.abc import Iterator

from beliefnest.suites.stories.questions import Question
from beliefnest.suites.stories.story import Come, Go, HandOver, Move, Place, Story, Take, Tell


def data_fault(story: Story, question: Question, expected: str | None) -> str | None:
    """Return how an expected answer contradicts the story; None: no contradiction is found.

    Args:
        story: The story.
        question: The question.
        expected: Name of the container in the expected answer.
    """
    thing = question.thing
    if is_told_of(story, question) or question.at_beginning or thing not in story.things:
        return None
    start = story.things[thing]
    if isinstance(start, HandOver) or any(isinstance(act, Take) for act in story.acts):
        return None
    last: tuple[int, Place] | None = None
    shown = False
    for number, rooms, place in _states(story, thing, start):
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


def is_told_of(story: Story, question: Question) -> bool:
    """Return True if the answer may rest on what somebody says of the thing."""
    tells = (act for act in story.acts if isinstance(act, Tell))
    return bool(question.believers) and any(act.thing == question.thing for act in tells)


def _states(
    story: Story, thing: str, place: Place
) -> Iterator[tuple[int, dict[str, str | None], Place]]:
    """Yield after every line: its index, the room of each agent, and the place of the thing."""
    rooms: dict[str, str | None] = dict(story.present)
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
