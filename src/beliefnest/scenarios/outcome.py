"""Outcomes of scenarios, probes and expectations."""

from collections.abc import Mapping

import msgspec

from beliefnest.belief.view import State
from beliefnest.errors import InputError
from beliefnest.facts.kinds import StatedFact
from beliefnest.llm.messages import AnswerForm, Usage
from beliefnest.scenarios.content import Probe
from beliefnest.scenarios.expected import Judgement
from beliefnest.scenarios.inferring import Inferred
from beliefnest.scenarios.scenario import Scenario
from beliefnest.scenarios.trial import Trial
from beliefnest.world.paths import parse_path, path_text
from beliefnest.world.values import Point, Position
from beliefnest.worlds.protocol import Fault, ProgramResult


class Reply(msgspec.Struct, frozen=True):
    """Reply of a model to a question.

    Attributes:
        question: The question.
        options: Options in the order of the prompt; empty: an answer in words.
        prompt: Prompt as sent to the model.
        text: Complete text of the reply.
        answer: Parsed answer, one of `options` if there are any; None: no usable answer.
        reason: Reason in the model's words; empty: none given.
        outcome: `read`, or one of `judging.NOT_ANSWERED`.
        why_not: Why there is no usable answer; empty: there is one.
        asked_again: Number of times that the model was asked again.
        form: Form of the reply: `text`, `schema` or `tool`.
    """

    question: str
    options: tuple[str, ...]
    prompt: str
    text: str
    answer: str | None
    reason: str
    outcome: str = "read"
    why_not: str = ""
    asked_again: int = 0
    form: AnswerForm = "text"


class ProbeOutcome(msgspec.Struct, frozen=True):
    """Outcome of a probe: the model's answers, and what its program did.

    Attributes:
        probe: The probe.
        verdicts: Judgement of each expectation, in order.
        outcome: One of `judging.OUTCOMES`.
        usage: Tokens and cost of all answers.
        prompt: Prompt as sent to the model; empty if it was not asked for a program.
        answer: Complete text of the last answer.
        program: Program in the answer; empty if there is none.
        attempts: Number of requests for a program; errors were sent back in between.
        asked_again: Number of requests after answers that could not be read, for a program or to
            questions.
        trial: Run of the program; None if there is none.
        replies: Replies to questions.
        fault: Reason why there is no program to judge; empty if there is one, or if the model was
            not asked for one.
        inferred: Result of the inference; None: a model was asked.
    """

    probe: Probe
    verdicts: tuple[Judgement, ...]
    outcome: str
    usage: Usage
    prompt: str = ""
    answer: str = ""
    program: str = ""
    attempts: int = 0
    asked_again: int = 0
    trial: Trial | None = None
    replies: tuple[Reply, ...] = ()
    fault: str = ""
    inferred: Inferred | None = None

    @property
    def ok(self) -> bool | None:
        """Return True if all expectations hold; None: there are no expectations."""
        return all(each.ok for each in self.verdicts) if self.probe.expect else None

    @property
    def why_not(self) -> str:
        """Return what is not as expected, or why there is no result; empty if all is well."""
        if self.outcome == "ok":
            return ""
        reasons = [each.why_not for each in self.verdicts if not each.ok]
        if self.fault:
            reasons.append(self.fault)
        elif self.outcome in ("no_way", "program_failed", "error") and self.error is not None:
            reasons.append(str(self.error))
        return "; ".join(dict.fromkeys(reasons))

    @property
    def error(self) -> Fault | None:
        """Return the error of the program; None if it did not fail."""
        return None if self.trial is None else self.trial.result.error

    @property
    def result(self) -> ProgramResult:
        """Return the result of the program.

        Raises:
            InputError: There is no program.
        """
        if self.trial is None:
            raise InputError(f"the probe {self.probe.label!r} had no program; look at `outcome`")
        return self.trial.result

    @property
    def branch(self) -> str:
        """Return the branch on which the program ran; empty if there was no program."""
        return "" if self.trial is None else self.trial.branch

    @property
    def opened(self) -> tuple[Position, ...]:
        """Return the containers that the agent opened, in order."""
        return () if self.trial is None else self.trial.opened

    @property
    def arrived(self) -> Point | None:
        """Return the agent's place at the end; None if it was not there, or nothing was run."""
        return None if self.trial is None else self.trial.arrived

    @property
    def intended(self) -> Point | None:
        """Return the place that the program headed for (see `Trial.intended`); None: none."""
        return None if self.trial is None else self.trial.intended

    @property
    def ticks(self) -> int:
        """Return the number of ticks that the program ran."""
        return 0 if self.trial is None else self.trial.result.ticks


class ExpectationOutcome(msgspec.Struct, frozen=True):
    """Outcome of an expectation about a simulator.

    Attributes:
        expectation: The expectation.
        why_not: What the simulator believes instead; None: the expectation holds.
    """

    expectation: StatedFact
    why_not: str | None = None

    @property
    def ok(self) -> bool:
        """Return True if the expectation holds."""
        return self.why_not is None


class Outcome(msgspec.Struct, frozen=True):
    """Outcome of a scenario under one condition.

    Attributes:
        scenario: The scenario with its condition applied.
        seed: Seed of every random number.
        ticks: Length of the script in the real world.
        seconds: Wall time from the start of the world to the last judgement.
        reality: State of the real world after the script.
        beliefs: States of beliefs after the script, for every path that the scenario names.
        expectations: Outcome of each expectation of the scenario.
        probes: Outcome of each probe of the scenario.
        reading: Tokens and cost of extracting claims from utterances, if a model did that.
    """

    scenario: Scenario
    seed: int
    ticks: int
    seconds: float
    reality: State
    beliefs: Mapping[str, State]
    expectations: tuple[ExpectationOutcome, ...]
    probes: tuple[ProbeOutcome, ...]
    reading: Usage = msgspec.field(default_factory=Usage)

    def __repr__(self) -> str:
        number = self.scenario.condition
        name = self.scenario.name + ("" if number is None else f", condition {number}")
        facts = f"{sum(each.ok for each in self.expectations)} of {len(self.expectations)} beliefs"
        judged = [probe for probe in self.probes if probe.ok is not None]
        right = f"{sum(bool(probe.ok) for probe in judged)} of {len(judged)} predictions"
        return f"<{name}, {self.ticks} ticks: {facts} and {right} as expected>"

    def state(self, path: str) -> State:
        """Return the state of a simulator that the scenario names, after the script."""
        names = parse_path(path, self.scenario.setting.snapshot.agents)
        return self.beliefs[path_text(names)] if names else self.reality

    @property
    def usage(self) -> Usage:
        """Return the tokens and cost of all answers."""
        return sum((probe.usage for probe in self.probes), self.reading)

    @property
    def ok(self) -> bool:
        """Return True if everything is as expected."""
        return all(each.ok for each in self.expectations) and all(
            each.ok is not False for each in self.probes
        )

    @property
    def failures(self) -> tuple[str, ...]:
        """Return a line for each unmet expectation: its name, and what happened instead."""
        beliefs = [
            f"{each.expectation.label or each.expectation.simulator}: {each.why_not}"
            for each in self.expectations
            if not each.ok
        ]
        asked = [
            f"{probe.probe.label or f'probe {number}'} ({probe.outcome}): {probe.why_not}"
            for number, probe in enumerate(self.probes, start=1)
            if probe.ok is False
        ]
        return (*beliefs, *asked)
