"""Courses in words, and ratings of an agent's desires and beliefs from 1 to 7.

The words describe one simulator: its known floor, and the perceived places of the agent.
"""

from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from math import floor

import msgspec

from beliefnest.belief.view import State
from beliefnest.llm.messages import Finish
from beliefnest.llm.reading_numbers import NumbersReading, read_numbers
from beliefnest.minds.mind_model import Alternative, MindModel
from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.inferring import Inferred, Inferring
from beliefnest.suites.films.film import ABOUT, JudgedPart
from beliefnest.world.registry import Registry
from beliefnest.world.values import Position

_LOWEST, _HIGHEST = 1.0, 7.0
_WORDS: Mapping[JudgedPart, str] = {
    "desires": "desire",
    "beliefs": "belief",
    "locations": "location",
}
_FACTORS: Mapping[JudgedPart, str] = {
    "desires": "utility",
    "beliefs": "credence",
    "locations": "actual",
}

Ratings = Mapping[tuple[JudgedPart, str], float]


class Comparison(msgspec.Struct, frozen=True):
    """Ratings beside exact inference.

    Attributes:
        pairs: By kind, inferred and rated value of each name: ratings of desires from 1 to 7,
            shares of beliefs and locations.
        missing: Questions without a rating from 1 to 7.
    """

    pairs: Mapping[JudgedPart, Sequence[tuple[float, float]]]
    missing: tuple[str, ...]

    @property
    def error(self) -> float:
        """Mean absolute error as a share of the scale, from 0; 1: a rating is missing."""
        if self.missing:
            return 1.0
        spans = {"desires": _HIGHEST - _LOWEST}
        errors = [
            abs(inferred - rated) / spans.get(about, 1.0)
            for about, pairs in self.pairs.items()
            for inferred, rated in pairs
        ]
        return sum(errors) / len(errors)


def asked_of(model: MindModel) -> list[tuple[JudgedPart, str]]:
    """Return what is asked about a model: desires, beliefs, and locations the observer doubts."""
    asked: list[tuple[JudgedPart, str]] = [("desires", goal) for goal in model.goals]
    if model.doubt is not None:
        asked += [("beliefs", name) for name in model.alternative_names]
        if model.observer_doubts:
            asked += [("locations", name) for name in model.alternative_names]
    return asked


def read_ratings(text: str, model: MindModel, finish: Finish = "stop") -> NumbersReading:
    """Read the ratings from 1 to 7 in an answer, by question, such as `desire korean`."""
    asked = [_question(about, name) for about, name in asked_of(model)]
    return read_numbers(text, asked, _LOWEST, _HIGHEST, finish)


def ratings_in(reading: NumbersReading, model: MindModel) -> Ratings:
    """Return the ratings that were read, by kind and name."""
    return {
        (about, name): reading.numbers[_question(about, name)]
        for about, name in asked_of(model)
        if _question(about, name) in reading.numbers
    }


def _question(about: JudgedPart, name: str) -> str:
    return f"{_WORDS[about]} {name}"


def compared(ratings: Ratings, model: MindModel, inferred: Inferred) -> Comparison:
    """Put ratings beside what is inferred.

    Utilities are put on the scale by the lowest and the highest one that is considered. Ratings of
    beliefs and locations become shares: less 1, and summing to 1.
    """
    asked = asked_of(model)
    missing = tuple(_question(about, name) for about, name in asked if (about, name) not in ratings)
    pairs: dict[JudgedPart, list[tuple[float, float]]] = {}
    low, high = float(model.utility_rows.min()), float(model.utility_rows.max())
    for about in () if missing else ABOUT:
        rated = {name: ratings[kind, name] for kind, name in asked if kind == about}
        means = {name: inferred.means[f"{_FACTORS[about]}.{name}"] for name in rated}
        if about == "desires":
            span = (high - low) or 1.0
            scale = (_HIGHEST - _LOWEST) / span
            means = {name: _LOWEST + scale * (mean - low) for name, mean in means.items()}
        else:
            rated = _shares(rated)
        if rated:
            pairs[about] = [(means[name], rated[name]) for name in rated]
    return Comparison(pairs, missing)


def _shares(ratings: Mapping[str, float]) -> dict[str, float]:
    total = sum(rating - _LOWEST for rating in ratings.values())
    if total == 0:
        return dict.fromkeys(ratings, 1 / len(ratings)) if ratings else {}
    return {name: (rating - _LOWEST) / total for name, rating in ratings.items()}


def rating_prompt(nest: Nest, path: str, infer: Inferring) -> str:
    """Return the prompt: the floor, the goals, what is in doubt, the course, and the questions.

    Args:
        nest: The course played.
        path: The simulator whose view is told.
        infer: The agent, and what may be wanted and believed.
    """
    model, state = infer.model, nest[path].state
    agent = model.agent
    sightings = list(_sightings(nest, path, infer))
    level = next((cell[1] for _, cell in sightings if cell is not None), state.box.low[1] + 1)
    parts = [
        f"You watched {agent} walk. Judge what {agent} wants, and what {agent} believed at first.",
        "",
        f"The floor from above, x to the right from {state.box.low[0]}, z downwards from "
        f"{state.box.low[2]}. A point is free floor, # a wall that also hides what is behind it, "
        "~ a place without floor, ? unknown.",
        "",
        *_plan(state, level),
        "",
        f"Things that {agent} may want:",
        *(f"- {goal}: {_goal_words(model, goal, state)}" for goal in model.goals),
    ]
    if model.doubt is not None:
        parts += [
            "",
            f"At first {agent} cannot tell which of these is the case, and finds out only by "
            f"seeing. {agent} knows everything else.",
            *(f"- {each.name}: {_edits_words(each)}" for each in model.alternatives),
            _actual_words(model, state),
        ]
    parts += ["", f"Where you saw {agent}, as (x, z):", *_course_lines(sightings)]
    if infer.ended:
        parts.append(f"Then {agent} took what is where {agent} was.")
    parts += ["", *_questions(model)]
    return "\n".join(parts)


def _questions(model: MindModel) -> list[str]:
    agent = model.agent
    meant = {
        "desires": f"desire: how much {agent} wants it, from 1 (not at all) to 7 (very much)",
        "beliefs": f"belief: how likely {agent} took it to be at first, from 1 (certainly not) to "
        "7 (certainly)",
        "locations": "location: how likely it is the case, from 1 (certainly not) to 7 (certainly)",
    }
    asked = asked_of(model)
    kinds = [about for about in ABOUT if any(kind == about for kind, _ in asked)]
    return [
        "Rate each of these by a number from 1 to 7:",
        *(f"- {meant[about]}" for about in kinds),
        "",
        "Answer with these lines, each with your number after the colon:",
        *(f"{_WORDS[about]} {name}:" for about, name in asked),
    ]


def _sightings(nest: Nest, path: str, infer: Inferring) -> Iterator[tuple[int, Position | None]]:
    """Yield each tick with the agent's cell; None: it was out of sight."""
    last = nest.tick if infer.until is None else infer.until
    for tick in range(infer.since, last + 1):
        believed = nest.at(tick)[path].state.agents[infer.model.agent]
        feet = believed.position if believed.current else None
        yield tick, None if feet is None else (floor(feet[0]), floor(feet[1]), floor(feet[2]))


def _course_lines(sightings: Sequence[tuple[int, Position | None]]) -> list[str]:
    lines = []
    for cell, group in groupby(sightings, key=lambda each: each[1]):
        ticks = [tick for tick, _ in group]
        when = f"tick {ticks[0]}" if len(ticks) == 1 else f"ticks {ticks[0]} to {ticks[-1]}"
        where = "out of your sight" if cell is None else f"({cell[0]}, {cell[2]})"
        lines.append(f"{when}: {where}")
    return lines


def _plan(state: State, level: int) -> list[str]:
    """Return the floor at a height, a row for each z."""
    low, high = state.box.low, state.box.high
    registry = Registry.load()

    def solid(x: int, y: int, z: int) -> bool | None:
        if not low[1] <= y <= high[1]:
            return False
        text = state.blocks[x, y, z]
        return None if text is None else bool(registry.boxes(registry.state_id(text)))

    def sign(x: int, z: int) -> str:
        body = [solid(x, level, z), solid(x, level + 1, z)]
        below = solid(x, level - 1, z)
        if True in body:
            return "#"
        if None in body or below is None:
            return "?"
        return "." if below else "~"

    return [
        "".join(sign(x, z) for x in range(low[0], high[0] + 1)) for z in range(low[2], high[2] + 1)
    ]


def _goal_words(model: MindModel, goal: str, state: State) -> str:
    wanted = model.goal_values[goal]
    if wanted.at is not None:
        return f"to be at {_place(wanted.at)}"
    if wanted.item is not None:
        return f"to take {wanted.item}"
    assert wanted.block is not None
    doubted = {place for each in model.alternatives for place in each.blocks}
    places = [at for at in state.blocks.named(frozenset([wanted.block])) if at not in doubted]
    where = " and ".join(map(_place, places))
    return f"to stand on {wanted.block}{f', which is at {where}' if places else ''}"


def _edits_words(alternative: Alternative) -> str:
    parts = [f"{text} at {_place(at)}" for at, text in alternative.blocks.items()]
    parts += [
        f"{', '.join(f'{n} {name}' for name, n in items.items()) or 'nothing'} in the container at "
        f"{_place(at)}"
        for at, items in alternative.containers.items()
    ]
    parts += [
        f"{agent} at ({feet[0]:g}, {feet[2]:g})" for agent, feet in alternative.agents.items()
    ]
    return ", ".join(parts)


def _actual_words(model: MindModel, state: State) -> str:
    """Return the observer's knowledge about the doubt."""
    if isinstance(model.actual, str) and model.actual != "unknown":
        return f"In fact it is {model.actual}."
    if model.observer_doubts:
        weights = model.actual_weights or {}
        left = [name for name, weight in weights.items() if weight > 0]
        return f"You do not know either which it is: {' or '.join(left)}."
    possible = [each.name for each in model.alternatives if _agrees(each, state)]
    return f"As far as you know, it is {' or '.join(possible) or 'none of them'}."


def _agrees(alternative: Alternative, state: State) -> bool:
    """Return False if an observer holds something else in a doubted block or container."""
    registry = Registry.load()
    for at, text in alternative.blocks.items():
        block = state.blocks[at]
        if block is not None and block != registry.text(registry.state_id(text)):
            return False
    for at, items in alternative.containers.items():
        container = state.containers.get(at)
        if container is not None and container.complete and dict(container.items) != dict(items):
            return False
    return True


def _place(at: Position) -> str:
    return f"({at[0]}, {at[2]})"
