"""Execution of samples: each sample is one request of one probe, judged in its own nest."""

import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import msgspec

from beliefnest.llm.messages import Answer, Finish, Message, Sampling
from beliefnest.nest.face.nest import Nest
from beliefnest.scenarios.content import Probe
from beliefnest.scenarios.expected_answers import Answers
from beliefnest.scenarios.outcome import ProbeOutcome
from beliefnest.scenarios.probing import Asking, run_probe
from beliefnest.scenarios.scenario import Scenario
from beliefnest.scenarios.sources import read_document
from beliefnest.studies.variation import Variation
from beliefnest.worlds.by_name import Worlds

_ONCE = Asking(attempts=1)


def requests_of(scenario: Scenario) -> list[Probe]:
    """Return the probes of a scenario, split so that each makes a single request.

    Probes without expectations are left out.
    """
    requests = []
    for probe in scenario.probes:
        if not probe.asks_model:
            continue
        expected = tuple(each for each in probe.expect if not isinstance(each, Answers))
        if expected:
            requests.append(replace(probe, expect=expected))
        requests += [replace(probe, expect=(question,)) for question in probe.questions]
    return requests


class JudgedOutcome(msgspec.Struct, frozen=True):
    """A judged answer.

    Attributes:
        outcome: Outcome of the probe.
        grounds: Lines that explain the belief about the expected containers.
    """

    outcome: ProbeOutcome
    grounds: tuple[str, ...]


@dataclass
class _Listener:
    """Model that records its requests and always gives the same answer."""

    text: str
    finish: Finish = "stop"
    name: str = "inspect"
    asked: list[tuple[Message, ...]] = field(default_factory=list)

    def answer(self, messages: Sequence[Message], sampling: Sampling) -> Answer:
        """Record the request and return the fixed answer."""
        self.asked.append(tuple(messages))
        return Answer(self.text, finish=self.finish)


class ScenarioStage:
    """Plays scenarios in worlds that stay open; threads take turns."""

    def __init__(self) -> None:
        self._turn = threading.Lock()
        # Worlds need no clean-up here: their processes end with this one.
        self._worlds = Worlds(0)

    def prompt(self, sample: Mapping[str, Any]) -> tuple[Message, ...]:
        """Return the messages that a model gets for a sample.

        Args:
            sample: Metadata of the sample: scenario, condition, variation, world, seed, request.

        Raises:
            BeliefNestError: The scenario cannot be played.
        """
        listener = _Listener("")
        self._run(sample, listener)
        return listener.asked[0]

    def judged(
        self, sample: Mapping[str, Any], answer: str, finish: Finish = "stop"
    ) -> JudgedOutcome:
        """Judge an answer: run its program in the belief, or compare its words.

        Raises:
            BeliefNestError: The scenario cannot be played.
        """
        return self._run(sample, _Listener(answer, finish))

    def _run(self, sample: Mapping[str, Any], listener: _Listener) -> JudgedOutcome:
        document, number = read_document(sample["scenario"]), sample["request"]
        scenario = Variation(sample["variation"]).scenario(document, sample["condition"])
        probe, seed = requests_of(scenario)[number - 1], sample["seed"]
        with self._turn, Nest.open(scenario, sample["world"], None, seed, self._worlds) as nest:
            nest.play()
            outcome = run_probe(nest, number, probe, listener, seed, _ONCE)
            return JudgedOutcome(outcome, tuple(_grounds(nest, probe)))


def _grounds(nest: Nest, probe: Probe) -> list[str]:
    belief = nest[probe.path]
    places = dict.fromkeys(each.explained for each in probe.expect if each.explained is not None)
    return [line for place in places for line in belief.explain(container=place).lines]
