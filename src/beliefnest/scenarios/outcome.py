"""What came of a scenario under one condition."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from beliefnest.belief.view import State
from beliefnest.bodies.protocol import Fault, ProgramResult
from beliefnest.errors import InputError
from beliefnest.llm.messages import Usage
from beliefnest.scenarios.content import Probe
from beliefnest.scenarios.expected import Expectation
from beliefnest.scenarios.judging import Judgement
from beliefnest.scenarios.scenario import Scenario
from beliefnest.scenarios.trial import Trial
from beliefnest.world.paths import parse_path, path_text
from beliefnest.world.values import Point, Position

__all__ = ["ExpectationOutcome", "Outcome", "ProbeOutcome", "Reply"]


@dataclass(frozen=True, slots=True)
class Reply:
    """What a model answered to a question.

    Attributes:
        question: What was asked.
        options: What it could choose from, in the order of the prompt; empty: words.
        prompt: The prompt as the model got it.
        text: The whole answer.
        answer: What it answered, one of `options` if there are any; None: nothing of use.
        reason: Why, in its words; empty if it did not say.
    """

    question: str
    options: tuple[str, ...]
    prompt: str
    text: str
    answer: str | None
    reason: str


@dataclass(frozen=True, slots=True)
class ProbeOutcome:
    """What a model answered to a probe, and what its program did.

    Attributes:
        probe: What was asked.
        verdicts: One for each thing that was expected, in that order.
        outcome: One of `judging.OUTCOMES`.
        usage: What all its answers took.
        prompt: The prompt as the model got it; empty if it was asked for no program.
        answer: The whole answer.
        program: The program in it; empty if there is none.
        attempts: How often the model was asked for a program; faults were sent back in between.
        trial: What the program did; None if there is none.
        replies: What it answered to questions.
        fault: Why there is no program to judge; empty if there is one, or none was asked for.
    """

    probe: Probe
    verdicts: tuple[Judgement, ...]
    outcome: str
    usage: Usage
    prompt: str = ""
    answer: str = ""
    program: str = ""
    attempts: int = 0
    trial: Trial | None = None
    replies: tuple[Reply, ...] = ()
    fault: str = ""

    @property
    def ok(self) -> bool | None:
        """True if all came out as expected; None: nothing was expected."""
        return all(each.ok for each in self.verdicts) if self.probe.expect else None

    @property
    def why_not(self) -> str:
        """What is not as expected, or why nothing came of it; empty if all is well."""
        if self.outcome == "ok":
            return ""
        told = [each.why_not for each in self.verdicts if not each.ok]
        if self.fault:
            told.append(self.fault)
        elif self.outcome in ("no_way", "program_failed", "error") and self.error is not None:
            told.append(str(self.error))
        return "; ".join(dict.fromkeys(told))

    @property
    def error(self) -> Fault | None:
        """Why the program failed; None if it did not."""
        return None if self.trial is None else self.trial.result.error

    @property
    def result(self) -> ProgramResult:
        """What became of the program.

        Raises:
            InputError: There was no program.
        """
        if self.trial is None:
            raise InputError(f"the probe {self.probe.label!r} had no program; look at `outcome`")
        return self.trial.result

    @property
    def branch(self) -> str:
        """The branch that the program ran on; empty if there was none."""
        return "" if self.trial is None else self.trial.branch

    @property
    def opened(self) -> tuple[Position, ...]:
        """The containers that the agent opened, in order."""
        return () if self.trial is None else self.trial.opened

    @property
    def arrived(self) -> Point | None:
        """Where the agent stood in the end; None if it was not there, or nothing was run."""
        return None if self.trial is None else self.trial.arrived

    @property
    def intended(self) -> Point | None:
        """What the program made for (see `Trial.intended`); None: nothing."""
        return None if self.trial is None else self.trial.intended

    @property
    def ticks(self) -> int:
        """How long the program ran."""
        return 0 if self.trial is None else self.trial.result.ticks


@dataclass(frozen=True, slots=True)
class ExpectationOutcome:
    """Whether a simulator holds what was expected of it.

    Attributes:
        expectation: What was expected.
        why_not: What it holds instead; None: just that.
    """

    expectation: Expectation
    why_not: str | None = None

    @property
    def ok(self) -> bool:
        """True if it holds that."""
        return self.why_not is None


@dataclass(frozen=True)
class Outcome:
    """What came of a scenario under one condition.

    Attributes:
        scenario: The scenario under that condition.
        seed: What drove every random number.
        ticks: Length of the script in the real world.
        seconds: Wall time from the start of the world to the last judgement.
        reality: The real world after the script.
        beliefs: Path to belief after the script, for every path the scenario names.
        expectations: One for each of the scenario's.
        probes: One for each of the scenario's.
        reading: What it took to have what was said read for claims, if a model did that.
    """

    scenario: Scenario
    seed: int
    ticks: int
    seconds: float
    reality: State
    beliefs: Mapping[str, State]
    expectations: tuple[ExpectationOutcome, ...]
    probes: tuple[ProbeOutcome, ...]
    reading: Usage = field(default_factory=Usage)

    def __repr__(self) -> str:
        number = self.scenario.condition
        name = self.scenario.name + ("" if number is None else f", condition {number}")
        held = f"{sum(each.ok for each in self.expectations)} of {len(self.expectations)} beliefs"
        judged = [probe for probe in self.probes if probe.ok is not None]
        right = f"{sum(bool(probe.ok) for probe in judged)} of {len(judged)} predictions"
        return f"<{name}, {self.ticks} ticks: {held} and {right} as expected>"

    def state(self, path: str) -> State:
        """Return the state of a simulator that the scenario names, after the script."""
        names = parse_path(path, self.scenario.setting.snapshot.agents)
        return self.beliefs[path_text(names)] if names else self.reality

    @property
    def usage(self) -> Usage:
        """What all answers took."""
        return sum((probe.usage for probe in self.probes), self.reading)

    @property
    def ok(self) -> bool:
        """True if everything was as expected."""
        return all(each.ok for each in self.expectations) and all(
            each.ok is not False for each in self.probes
        )

    @property
    def failures(self) -> tuple[str, ...]:
        """What is not as expected, one line each: what it is called, and what came instead."""
        held = [
            f"{each.expectation.label or each.expectation.path}: {each.why_not}"
            for each in self.expectations
            if not each.ok
        ]
        asked = [
            f"{probe.probe.label or f'probe {number}'} ({probe.outcome}): {probe.why_not}"
            for number, probe in enumerate(self.probes, start=1)
            if probe.ok is False
        ]
        return (*held, *asked)
