"""Accounts of probes in words: what happened, how it is judged, and what the belief rests on."""

from collections.abc import Mapping

from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.outcome import Outcome, ProbeOutcome
from beliefnest.world.event_words import happens, is_lid
from beliefnest.world.values import Position
from beliefnest.world.words import titled

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
            "judged": [
                each.expected.account(
                    each, probe, outcome.scenario.setting, titled(probe.probe.agent)
                )
                for each in probe.verdicts
            ]
            or ["Nothing was expected; it is only recorded."],
            "why": _why(nest, probe, outcome),
        }
        for probe in outcome.probes
    ]


def _happened(probe: ProbeOutcome, labels: Mapping[Position, str]) -> list[str]:
    if probe.trial is None:
        return [probe.fault] if probe.fault else []
    events = [
        f"tick {tick}: {happens(event, labels)}"
        for tick, event in probe.result.happened
        if not is_lid(event)
    ]
    lines = events[-_MOST:]
    if len(events) > _MOST:
        lines.insert(0, f"{len(events) - _MOST} earlier events are left out")
    result = probe.result
    began = probe.trial.state.tick - result.ticks
    ended = "ended well" if result.ok else f"failed: {result.error}"
    span = f"it ran from tick {began} to tick {began + result.ticks}"
    return [*lines, f"the program {ended}; {span}"]


def _why(nest: Nest, outcome: ProbeOutcome, run: Outcome) -> list[str]:
    """Explain the facts in the probed belief that the scenario states expectations about."""
    belief = nest.at(run.reality.tick)[outcome.probe.path]
    lines: list[str] = []
    about = [
        each.expectation.fact
        for each in run.expectations
        if nest[each.expectation.simulator].path == belief.path
    ]
    places = [each.store for each in about if each.store is not None]
    places += [each.explained for each in outcome.probe.expect if each.explained is not None]
    for container in dict.fromkeys(places):
        lines += belief.explain(container=container).lines
    for agent in dict.fromkeys(each.placed for each in about if each.placed is not None):
        lines += belief.explain(agent=agent).lines
    return lines
