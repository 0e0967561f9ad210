"""Answers to a question by rules that need no belief, or a belief of a lower order only."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence

from msgspec.structs import replace

from beliefnest.errors import ScenarioError
from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.believed import Believed
from beliefnest.scenarios.expected_answers import Answers
from beliefnest.scenarios.naming import Naming
from beliefnest.scenarios.prose_reading import story_sentences
from beliefnest.world.paths import parse_path, path_text
from beliefnest.world.words import titled

_SAID = re.compile(r"\b(?:said|thought|whispered to [^“]*): “")


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
    return {
        **dict(_lower_orders(nest, asked, naming)),
        **dict(_mentions(options, text)),
        **dict(_events(nest, asked, naming, options, text)),
    }


def _lower_orders(nest: Nest, asked: Answers, naming: Naming) -> Iterator[tuple[str, str | None]]:
    believed = asked.believed
    if believed is None:
        return
    agents = parse_path(believed.path, nest.agents)

    def answer_at(path: Sequence[str]) -> str | None:
        try:
            options = replace(believed, path=path_text(path)).answers(
                lambda each: nest[each].state, naming, asked.options
            )
        except ScenarioError:
            # The belief gives no option, or all.
            return None
        # Of the names of an answer in words, the first is the best.
        return options[0] if len(options) == 1 or (options and not asked.options) else None

    answers = [answer_at(agents[len(agents) - order :]) for order in range(len(agents) or 1)]
    yield "reality", answers[0]
    if agents:
        yield from ((f"order_{order}", answer) for order, answer in enumerate(answers))
        yield "lower_order", answers[-1]
    if len(agents) > 1:
        yield "outermost", answer_at(agents[:1])


def _mentions(options: Sequence[str], text: str) -> Iterator[tuple[str, str | None]]:
    """Yield the options that a text mentions first, last and most often."""
    if not options:
        return
    places = mentions(options, text)
    yield "first", _greatest(places, lambda starts: -starts[0])
    yield "last", _greatest(places, lambda starts: starts[-1])
    yield "most", _greatest(places, len)


def _events(
    nest: Nest, asked: Answers, naming: Naming, options: Sequence[str], text: str
) -> Iterator[tuple[str, str | None]]:
    """Yield the options of events that a story tells: acts, and words about what is asked for."""
    believed = asked.believed
    if not options or believed is None:
        return
    wanted = names_asked_for(believed, naming)
    events: list[tuple[str, str]] = []
    leavings: list[str | None] = []
    for sentence in story_sentences(text.partition("\n\n")[2]):
        said = _SAID.search(sentence)
        is_about = said is None or any(w in sentence[said.end() :].casefold() for w in wanted)
        if " could no longer see " in sentence:
            leavings.append(events[-1][1] if events else None)
        elif is_about and " could now see " not in sentence:
            named = [*mentions(options, sentence)]
            events += [(sentence, each) for each in named if len(named) == 1]
    every = [option for _, option in events]
    believers = parse_path(believed.path, nest.agents)
    own = [o for s, o in events if believers and s.startswith(f"{titled(believers[-1])} ")]
    yield "first_event", next(iter(every), None)
    yield "last_event", next(reversed(every), None)
    yield "most_event", _greatest({each: [every.count(each)] for each in every}, lambda n: n[0])
    yield "first_leaving", next(iter(leavings), None)
    yield "last_leaving", next(reversed(leavings), None)
    yield "own_event", next(reversed(own), None)


def names_asked_for(believed: Believed, naming: Naming) -> list[str]:
    """Return the names of the thing that a question is about, in small letters."""
    at = believed.thing
    things = [at] if isinstance(at, str) else [naming.objects.get(at), naming.written.get(at)]
    return [each.replace("_", " ").casefold() for each in things if each]


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
