"""Accounts of probes in words: what happened, how it is judged, and what the belief rests on."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from beliefnest.cli.pictures import container_name, place_text, titled
from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.expected import (
    Answers,
    Arrives,
    Believes,
    Holds,
    Infers,
    Intends,
    Judge,
    Opens,
    Says,
    Stands,
    Takes,
)
from beliefnest.scenarios.judging import Judgement
from beliefnest.scenarios.outcome import Outcome, ProbeOutcome
from beliefnest.scenarios.scenario import Scenario
from beliefnest.viewer.page.words import event_text, is_lid
from beliefnest.world.values import Position

__all__ = ["accounts"]

_GROUNDS = {
    Answers: "the model's answer to the question",
    Intends: "what the program makes for",
    Takes: "what the agent takes out of containers",
    Says: "what the agent says",
    Believes: "what is believed once the program has ended",
    Judge: "a function of the scenario",
}
"""Grounds of judgements, by kind of expectation; `_judged` words the other kinds itself."""

_MOST = 40
"""Greatest number of events listed for a probe; earlier ones are left out."""


def accounts(nest: Nest, outcome: Outcome) -> list[dict[str, list[str]]]:
    """Return `happened`, `judged` and `why` for each probe, each as a list of lines.

    Args:
        nest: The nest after the probes, still open.
        outcome: Outcome of the condition.
    """
    return [
        {
            "happened": _happened(probe, outcome.scenario.labels),
            "judged": [_judged(probe, each, outcome.scenario) for each in probe.verdicts]
            or ["Nothing was expected; it is only recorded."],
            "why": _why(nest, probe, outcome),
        }
        for probe in outcome.probes
    ]


def _happened(probe: ProbeOutcome, labels: Mapping[Position, str]) -> list[str]:
    if probe.trial is None:
        return [probe.fault] if probe.fault else []
    told = [
        f"tick {tick}: {event_text(event, labels)}"
        for tick, event in probe.result.happened
        if not is_lid(event)
    ]
    lines = told[-_MOST:]
    if len(told) > _MOST:
        lines.insert(0, f"{len(told) - _MOST} earlier events are left out")
    result = probe.result
    began = probe.trial.state.tick - result.ticks
    ended = "ended well" if result.ok else f"failed: {result.error}"
    span = f"it ran from tick {began} to tick {began + result.ticks}"
    return [*lines, f"the program {ended}; {span}"]


def _judged(outcome: ProbeOutcome, judged: Judgement, scenario: Scenario) -> str:
    """Return a sentence that says on what grounds an expectation holds or does not."""
    agent, expect = titled(outcome.probe.agent), judged.expected
    verdict = "as expected" if judged.ok else "not as expected"
    if isinstance(expect, Opens):
        wanted = container_name(expect.container, scenario)
        opened = "none"
        if outcome.opened:
            opened = f"the {container_name(outcome.opened[0], scenario)}"
        return (
            f"Judged by the container that {agent} opens first, in the world and not in the "
            f"model's words: it is {opened}, expected was the {wanted}; that is {verdict}."
        )
    if isinstance(expect, Arrives):
        where, far = "nowhere", ""
        if outcome.arrived is not None:
            where = place_text(outcome.arrived, scenario)
            far = f", {math.dist(outcome.arrived, expect.place):.1f} blocks from there"
        return (
            f"Judged by where {agent} stands in the end: {where}; expected was "
            f"{place_text(expect.place, scenario)}, within {expect.within:g} blocks{far}; "
            f"that is {verdict}."
        )
    told = "" if judged.ok else f": {judged.why_not}"
    if isinstance(expect, Infers):
        return f"Judged by the posterior mean of {expect.factor}; that is {verdict}{told}."
    return f"Judged by {_GROUNDS[type(expect)]}; that is {verdict}{told}."


def _why(nest: Nest, outcome: ProbeOutcome, run: Outcome) -> list[str]:
    """Explain the facts in the probed belief that the scenario states expectations about."""
    belief = nest.at(run.reality.tick)[outcome.probe.path]
    lines: list[str] = []
    about: list[Any] = [
        each.expectation.content
        for each in run.expectations
        if nest[each.expectation.path].path == belief.path
    ]
    containers = [each.container for each in about if isinstance(each, Holds)]
    containers += [each.container for each in outcome.probe.expect if isinstance(each, Opens)]
    for container in dict.fromkeys(containers):
        lines += str(belief.explain(container=container)).splitlines()
    for agent in _agents(about):
        lines += str(belief.explain(agent=agent)).splitlines()
    return lines


def _agents(about: Sequence[Any]) -> list[str]:
    return list(dict.fromkeys(each.agent for each in about if isinstance(each, Stands)))
