"""Answers to a question by rules that need no belief, or a belief of a lower order only."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

from beliefnest.errors import ScenarioError
from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.expected_answers import Answers
from beliefnest.scenarios.naming import Naming
from beliefnest.world.paths import parse_path, path_text


def shortcuts(
    nest: Nest, asked: Answers, naming: Naming, options: Sequence[str], text: str
) -> dict[str, str | None]:
    """Return what each shortcut answers, see `ItemRecord.shortcuts`.

    Args:
        nest: The nest at the tick of the question.
        asked: The question with its right answers.
        naming: Names by which answers are given.
        options: Options in the order in which they are asked.
        text: The story.
    """
    return {**dict(_lower_orders(nest, asked, naming)), **dict(_mentions(options, text))}


def _lower_orders(nest: Nest, asked: Answers, naming: Naming) -> Iterator[tuple[str, str | None]]:
    believed = asked.believed
    if believed is None:
        return
    agents = parse_path(believed.path, nest.agents)
    answers: list[str | None] = []
    for order in range(len(agents) + 1):
        path = path_text(agents[len(agents) - order :])
        try:
            options = replace(believed, path=path).answers(
                lambda each: nest[each].state, naming, asked.options
            )
        except ScenarioError:
            # The belief gives no option, or all.
            options = ()
        # Of the names of an answer in words, the first is the best.
        answers.append(options[0] if len(options) == 1 or (options and not asked.options) else None)
    yield "reality", answers[0]
    for order, answer in enumerate(answers[:-1]):
        yield f"order_{order}", answer
    if agents:
        yield "lower_order", answers[-2]


def _mentions(options: Sequence[str], text: str) -> Iterator[tuple[str, str | None]]:
    """Yield the options that a text mentions first, last and most often."""
    if not options:
        return
    places = mentions(options, text)
    yield "first", _greatest(places, lambda starts: -starts[0])
    yield "last", _greatest(places, lambda starts: starts[-1])
    yield "most", _greatest(places, len)


def _greatest(places: Mapping[str, list[int]], key: Callable[[list[int]], int]) -> str | None:
    """Return the option whose mentions have the greatest key; None: none or several have it."""
    ranked = sorted(places, key=lambda option: -key(places[option]))
    several = [each for each in ranked if key(places[each]) == key(places[ranked[0]])]
    return ranked[0] if len(several) == 1 else None


def mentions(options: Sequence[str], text: str) -> dict[str, list[int]]:
    """Return where a text mentions options, as numbers of characters, by option.

    Where one option is part of another, such as `chest` of `left chest`, the longest counts.
    """
    ordered = sorted(options, key=len, reverse=True)
    any_option = "|".join(re.escape(each).replace("_", "[ _]") for each in ordered)
    starts: dict[str, list[int]] = {}
    for match in re.finditer(rf"(?<!\w)(?:{any_option})(?!\w)", text, re.IGNORECASE):
        name = match[0].replace(" ", "_").casefold()
        option = next(each for each in ordered if each.replace(" ", "_").casefold() == name)
        starts.setdefault(option, []).append(match.start())
    return starts
