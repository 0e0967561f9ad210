"""Benchmark of text stories in the scripted world, with questions of order 0 to 4."""

import random
import time
from collections.abc import Iterator, Sequence

from beliefnest.suites.stories import PlayedStory, Question, read_story
from beliefnest_benchmarks.figures import Metric

__all__ = ["measure"]

_STORIES = 100
_CAST = ("Ada", "Ben", "Cleo", "Dan", "Eve")
_BOXES = ("tin", "jar", "trunk", "shelf")


def measure() -> Sequence[Metric]:
    """Return the time to parse, play and answer stories of one to three chapters."""
    chance = random.Random(0)
    texts = [_story(chance, 1 + number % 3) for number in range(_STORIES)]
    _answer(texts[0], chance)
    started = time.perf_counter()
    for text in texts:
        _answer(text, chance)
    seconds = time.perf_counter() - started
    return [Metric("stories, orders 0 to 4", _STORIES / seconds, "1/s", 50.0, at_least=True)]


def _story(chance: random.Random, chapters: int) -> str:
    return "\n".join(line for number in range(chapters) for line in _chapter(chance, number))


def _chapter(chance: random.Random, number: int) -> Iterator[str]:
    """Yield the lines of a chapter: all agents enter, some move the thing, all leave in turn."""
    cast = chance.sample(_CAST, len(_CAST) if number == 0 else chance.choice([3, 4]))
    room, thing, boxes = f"room{number}", f"thing{number}", [f"{b}{number}" for b in _BOXES]
    everyone = f"{', '.join(cast[:-1])} and {cast[-1]}"
    yield f"{everyone} entered the {room}."
    yield f"The {thing} is in the {chance.choice(boxes)}."
    for agent in cast:
        if chance.random() < 0.6:
            yield f"{agent} moved the {thing} to the {chance.choice(boxes)}."
        else:
            yield f"{agent} made no movements and stayed in the {room} for 1 minute."
        yield f"{agent} exited the {room}."
    yield f"{everyone} entered the waiting_room."


def _answer(text: str, chance: random.Random) -> None:
    believers = tuple(chance.sample(_CAST, 4))
    questions = [Question(believers[4 - order :], "thing0", False, "") for order in range(5)]
    with PlayedStory.play(read_story(text), asked=questions) as played:
        played.answer_all(questions)
