"""Check that stories hold what the right answers of their questions rest on."""

import warnings
from collections.abc import Iterator, Sequence
from typing import Literal

from beliefnest.belief.view import State
from beliefnest.nest.face.nest import Nest
from beliefnest.prompts import built_in_template
from beliefnest.scenarios.believed import Believed, bare_words, content_names
from beliefnest.scenarios.content import Probe, ScenarioWarning
from beliefnest.scenarios.expected_answers import Answers
from beliefnest.scenarios.prose_reading import (
    UnreadError,
    read_contents,
    read_last_seen,
    read_places,
)
from beliefnest.world.paths import parse_path
from beliefnest.world.values import Position
from beliefnest.world.words import listed, titled, with_the

_ELSEWHERE = "another place"
"""Place of somebody who walked to no named place, in stories."""

_STORY = "{{ branch | beginning }} {{ branch | story }}"

ProseVerdict = Literal["follows", "differs", "unread"]
"""Relation of a right answer to what the text alone says; `unread`: the reader cannot tell."""


class ProseWarning(ScenarioWarning):
    """Warning that a right answer does not follow from the text of its probe, or is not checked."""


def warn_of_prose(nest: Nest, probes: Sequence[Probe]) -> None:
    """Warn of each question whose computed answer does not follow from its story.

    Checked are questions about an item, an agent, a container or a sign that the built-in template
    `story` puts to a narrator's story. Questions about a block are named: stories tell who opens a
    door, but not who sees it, so that no reader of the text can check them.

    Args:
        nest: The nest after the script.
        probes: Probes with their right answers.
    """
    story = built_in_template("story").text
    for number, probe in enumerate(probes, 1):
        name = repr(probe.label) if probe.label else str(number)
        for question in probe.questions if probe.template == story else ():
            _, fault = check_prose(nest, probe, question)
            if fault and question.believed is not None:
                where = question.believed.where
                warning = ProseWarning(f"{where}probe {name}: {fault}", f"prose {where}{name}")
                warnings.warn(warning, stacklevel=3)


def check_prose(nest: Nest, probe: Probe, question: Answers) -> tuple[ProseVerdict, str]:
    """Compare a right answer with what a reader of the narrator's story alone would answer.

    Args:
        nest: The nest at the tick of the question.
        probe: Its probe.
        question: The question with its right answers.

    Returns:
        The verdict, and a sentence about what is wrong or not checked; empty: nothing.
    """
    believed = question.believed
    if believed is None or probe.path != "/":
        return "unread", ""
    right = {_key(each) for each in question.right}
    if believed.kind == "block":
        answer = listed(sorted(map(repr, question.right)), "or")
        return "unread", (
            f"it is not checked that the right answer {answer} follows from the story, which does "
            "not tell who sees a block; read the story, or ask about an item"
        )
    try:
        read = _read(nest, nest["/"].render(_STORY), believed)
    except UnreadError:
        return "unread", ""
    named = {each for names in read for each in names}
    says = {_key(each) for each in named}
    if believed.kind == "item":
        follows = says == right
    else:
        # A place may have several names, of which the options have another one than the story.
        options = {_key(each) for each in question.options}
        is_named = believed.kind == "agent" and not named <= {_ELSEWHERE, believed.unknown}
        follows = bool(says & right) or (is_named and bool(options) and not says & options)
    if follows:
        return "follows", ""
    said, best = (
        listed(sorted(map(repr, each)), "or")
        for each in (question.right, {names[0] for names in read})
    )
    return "differs", (
        f"the right answer {said} does not follow from the story, which says {best}; let the "
        "story show it, by what is seen or said, or ask otherwise"
    )


def _read(nest: Nest, story: str, believed: Believed) -> Sequence[tuple[str, ...]]:
    """Return the answers that a story tells, each with all its names.

    Raises:
        UnreadError: The story does not make it clear.
    """
    perception = nest.setting.perception
    path, trust = parse_path(believed.path, nest.agents), perception.testimony
    if perception.containers == "transparent" and believed.kind in ("item", "container"):
        raise UnreadError("the story does not tell what is seen in containers")
    match believed.kind, believed.thing:
        case "item", str(item):
            return [(each,) for each in read_places(story, path, item, trust) or {believed.unknown}]
        case "container", (int(), int(), int()) as at:
            states = [nest[each].state for each in ("/", believed.path)]
            items = {item for each in states for item in _items(each)}
            content = read_contents(story, path, _name(nest, at), sorted(items), trust)
            # Stories seldom make clear if somebody knows that a container is empty.
            return [content_names(content) if content else (believed.unknown, *content_names(()))]
        case "agent", str(name):
            if perception.negative_evidence:
                raise UnreadError("the story does not tell which empty places are seen")
            seen = read_last_seen(story, path, titled(name), trust)
        case _, (int(), int(), int()) as at:
            seen = read_last_seen(story, path, _name(nest, at), trust)
        case _:
            raise AssertionError(believed.kind)
    return [(seen, "blank") if seen == "nothing" else (seen or believed.unknown,)]


def _name(nest: Nest, at: Position) -> str:
    """Return the words of a narrator for a thing.

    Raises:
        UnreadError: It has no name of its own.
    """
    names = nest["/"].names
    if at not in names or list(names.values()).count(names[at]) > 1:
        raise UnreadError(str(at))
    return with_the(names[at])


def _items(state: State) -> Iterator[str]:
    """Yield the names of all items of a state that agents or containers have."""
    for container in state.containers.values():
        yield from container.items
    for agent in state.agents.values():
        yield from agent.inventory


def _key(name: str) -> tuple[str, ...]:
    return tuple(bare_words(name))
