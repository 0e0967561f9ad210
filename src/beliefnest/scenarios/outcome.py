"""What came of a scenario under one condition."""

from collections.abc import Mapping
from dataclasses import dataclass

from beliefnest.belief.view import State
from beliefnest.bodies.protocol import ProgramResult
from beliefnest.llm.messages import Usage
from beliefnest.scenarios.content import Expectation, Probe
from beliefnest.scenarios.scenario import Scenario
from beliefnest.world.paths import parse_path, path_text
from beliefnest.world.values import Point, Position

__all__ = ["ExpectationOutcome", "Outcome", "ProbeOutcome"]


@dataclass(frozen=True, slots=True)
class ProbeOutcome:
    """What a model answered to a probe, and what its program did.

    Attributes:
        probe: What was asked.
        prompt: The prompt as the model got it.
        answer: The whole answer.
        program: The program in it.
        branch: The branch that it ran on.
        attempts: How often the model was asked; faults were sent back in between.
        usage: What all its answers took.
        result: What became of the program.
        opened: The containers that the agent opened, in order.
        arrived: Where the agent stood in the end; None if it was not there.
        ok: Whether the outcome was as expected; None: nothing was expected.
    """

    probe: Probe
    prompt: str
    answer: str
    program: str
    branch: str
    attempts: int
    usage: Usage
    result: ProgramResult
    opened: tuple[Position, ...]
    arrived: Point | None
    ok: bool | None


@dataclass(frozen=True, slots=True)
class ExpectationOutcome:
    """Whether a simulator holds what was expected of it."""

    expectation: Expectation
    ok: bool


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
    """

    scenario: Scenario
    seed: int
    ticks: int
    seconds: float
    reality: State
    beliefs: Mapping[str, State]
    expectations: tuple[ExpectationOutcome, ...]
    probes: tuple[ProbeOutcome, ...]

    def __repr__(self) -> str:
        number = self.scenario.condition
        name = self.scenario.name + ("" if number is None else f", condition {number}")
        held = f"{sum(each.ok for each in self.expectations)} of {len(self.expectations)} beliefs"
        judged = [probe for probe in self.probes if probe.ok is not None]
        right = f"{sum(bool(probe.ok) for probe in judged)} of {len(judged)} predictions"
        return f"<{name}, {self.ticks} ticks: {held} and {right} as expected>"

    def state(self, path: str) -> State:
        """The state of a simulator that the scenario names, after the script."""
        names = parse_path(path, self.scenario.setting.snapshot.agents)
        return self.beliefs[path_text(names)] if names else self.reality

    @property
    def usage(self) -> Usage:
        """What all answers of the model took."""
        return sum((probe.usage for probe in self.probes), Usage())

    @property
    def ok(self) -> bool:
        """Whether everything was as expected."""
        return all(each.ok for each in self.expectations) and all(
            each.ok is not False for each in self.probes
        )
