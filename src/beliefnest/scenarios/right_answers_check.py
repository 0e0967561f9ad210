"""Warnings about computed right answers: several at once, or others than the author intends."""

import re
import warnings
from collections.abc import Iterator, Sequence

from msgspec.structs import replace

from beliefnest.errors import ScenarioError
from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.believed import bare_words
from beliefnest.scenarios.content import Probe, ScenarioContent, ScenarioWarning
from beliefnest.scenarios.expected_answers import Answers
from beliefnest.scenarios.probing import naming_for, resolved
from beliefnest.scenarios.prose_check import warn_of_prose
from beliefnest.world.texts import quoted
from beliefnest.world.words import listed

_KIND = re.compile(r"\b(true|false)[- ]beliefs?\b", re.IGNORECASE)


def warn_of_scene(scenario: ScenarioContent) -> None:
    """Give the warnings about a scenario's file."""
    for each in scenario.warnings:
        warnings.warn(each, stacklevel=3)


def warn_of_answers(
    nest: Nest, scenario: ScenarioContent, probes: Sequence[Probe] | None = None
) -> None:
    """Warn of right answers that are several, not intended, or do not follow from the prose.

    Args:
        nest: The nest after the script.
        scenario: Its scenario.
        probes: Its probes with their right answers; None: compute them. Probes that have no right
            answer are left out then.
    """
    if probes is None:
        probes = tuple(_answered(nest, scenario.probes))
    warn_of_prose(nest, probes)
    for each in (*_several(probes), *_intended(nest, scenario, probes)):
        warnings.warn(each, stacklevel=3)


def _answered(nest: Nest, probes: Sequence[Probe]) -> Iterator[Probe]:
    for probe in probes:
        try:
            yield resolved(nest, probe)
        except ScenarioError:
            continue


def _computed(probes: Sequence[Probe]) -> Iterator[tuple[Probe, Answers]]:
    """Yield the questions whose right answers the nest computes."""
    for probe in probes:
        yield from ((probe, each) for each in probe.questions if each.believed is not None)


def _several(probes: Sequence[Probe]) -> Iterator[ScenarioWarning]:
    """Yield questions of which several options are right."""
    for probe, question in _computed(probes):
        if question.options and len(question.right) > 1 and question.believed is not None:
            right = listed([repr(each) for each in question.right])
            yield ScenarioWarning(
                f"{question.believed.where}probe {quoted(probe.label)} has {len(question.right)} "
                f"right answers, {right}: {question.believed.thing} is believed to be in each; "
                "list it under 'unique', or change the script",
                f"several {question.believed.where}",
            )


def _intended(
    nest: Nest, scenario: ScenarioContent, probes: Sequence[Probe]
) -> Iterator[ScenarioWarning]:
    """Yield probes and conditions of which author and nest say different things."""
    for probe in probes:
        if probe.intended and not any(_computed([probe])):
            yield ScenarioWarning(
                f"{probe.where}probe {quoted(probe.label)} is meant as {quoted(probe.intended)}, "
                "which is not checked, as no question of it has a computed right answer; write "
                "`right: {path: ..., item: ...}`",
                f"unchecked {probe.where}",
            )
    kinds: list[tuple[Probe, str]] = []
    for probe, question in _computed(probes):
        kind = _kind_of(nest, probe, question)
        right = listed([repr(each) for each in question.right], "or")
        said = probe.intended or _named(probe.label)
        computed = f"the computed right answer {right} is that of a {kind}"
        if kind and not said:
            kinds.append((probe, kind))
        if said and not _named(said):
            right_words = {tuple(bare_words(each)) for each in question.right}
            if {tuple(bare_words(said))} != right_words:
                yield _other(probe, said, f"the computed right answer is {right}")
        elif said and kind and _named(said) != kind:
            yield _other(probe, said, computed)
    said = _named(scenario.condition_description)
    if said and kinds and said not in [kind for _, kind in kinds]:
        probe, kind = kinds[0]
        yield ScenarioWarning(
            f"{probe.where}condition {scenario.condition} is described as "
            f"{quoted(scenario.condition_description.strip())}, and the right answer to probe "
            f"{quoted(probe.label)} is that of a {kind}; change the script or the description",
            f"described {probe.where}{scenario.condition}",
        )


def _other(probe: Probe, said: str, computed: str) -> ScenarioWarning:
    return ScenarioWarning(
        f"{probe.where}probe {quoted(probe.label)} is meant as {quoted(said)}, but {computed}; "
        "change the script, or what is intended",
        f"intended {probe.where}",
    )


def _named(text: str) -> str:
    """Return `true belief` or `false belief` if a text names just one of them; else nothing."""
    kinds = {each.lower() for each in _KIND.findall(text)}
    return f"{kinds.pop()} belief" if len(kinds) == 1 else ""


def _kind_of(nest: Nest, probe: Probe, question: Answers) -> str:
    """Return the kind of a belief: true if reality gives the same answer. Reality has none."""
    believed = question.believed
    if believed is None or nest[believed.path].path == "/":
        return ""
    try:
        real = replace(believed, path="/").answers(
            lambda path: nest[path].state, naming_for(nest, probe), question.options
        )
    except ScenarioError:
        return "false belief"  # Reality is none of the options.
    return "true belief" if set(real) == set(question.right) else "false belief"
