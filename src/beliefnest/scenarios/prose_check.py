"""Check that stories hold what the right answers of their questions rest on."""

import warnings
from collections.abc import Iterator, Sequence

from beliefnest.nest.face.nest import Nest
from beliefnest.prompts import built_in_template
from beliefnest.scenarios.believed import Believed, bare_words
from beliefnest.scenarios.content import Probe, ScenarioWarning
from beliefnest.scenarios.expected_answers import Answers
from beliefnest.scenarios.prose_reading import UnreadError, read_places
from beliefnest.world.paths import parse_path
from beliefnest.world.words import listed

__all__ = ["ProseWarning", "warn_of_prose"]

_STORY = "{{ branch | beginning }} {{ branch | story }}"


class ProseWarning(ScenarioWarning):
    """Warning that the right answer to a question does not follow from the text of its probe."""


def warn_of_prose(nest: Nest, probes: Sequence[Probe]) -> None:
    """Warn of each question whose computed answer does not follow from its story.

    Checked are questions about an item that the built-in template `story` puts to a narrator's
    story.

    Args:
        nest: The nest after the script.
        probes: Probes with their right answers.
    """
    told = built_in_template("story").text
    asked = [
        (number, probe, question, question.believed)
        for number, probe in enumerate(probes, 1)
        if probe.path == "/" and probe.template == told
        for question in probe.questions
        if question.believed is not None and question.believed.kind == "item"
    ]
    story = nest["/"].render(_STORY) if asked else ""
    for number, probe, question, believed in asked:
        name = repr(probe.label) if probe.label else str(number)
        for fault in _faults(nest, story, question, believed):
            subject = f"prose {believed.where}{name}"
            told = f"{believed.where}probe {name}: {fault}"
            warnings.warn(ProseWarning(told, subject), stacklevel=3)


def _faults(nest: Nest, story: str, question: Answers, believed: Believed) -> Iterator[str]:
    path = parse_path(believed.path, nest.agents)
    testimony = nest.setting.perception.testimony
    try:
        places = read_places(story, path, str(believed.thing), testimony)
    except UnreadError:
        return
    found = places or {believed.unknown}
    if {_key(each) for each in found} != {_key(each) for each in question.right}:
        right, read = (listed(sorted(map(repr, each)), "or") for each in (question.right, found))
        yield (
            f"the right answer {right} does not follow from the story, which says {read}; let the "
            "story show it, by what is seen or said, or ask otherwise"
        )


def _key(name: str) -> tuple[str, ...]:
    return tuple(bare_words(name))
