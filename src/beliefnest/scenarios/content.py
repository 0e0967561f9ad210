"""What a scenario says: its setting, what models are asked, what simulators are to hold."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from beliefnest.nest.past.setting import Senses, Setting
from beliefnest.scenarios.expected import Answers, Expectation, Expected
from beliefnest.scenarios.rules import EpisodeEntry
from beliefnest.world.values import Position

__all__ = ["Probe", "ScenarioContent"]


@dataclass(frozen=True, slots=True)
class Probe:
    """A model is asked from one belief; its program runs in a simulator and is judged there.

    If answers alone are expected, it is asked for no program.

    Attributes:
        path: The belief that the prompt is rendered from.
        acts_in: The simulator that the program runs in.
        agent: The agent that runs it.
        task: What the model is asked to make the agent do.
        expect: What is expected, all of it together; empty: the outcome is only recorded.
        template: Text of the prompt template; None: the paper's.
        label: A name for tables.
        timeout_ticks: Ticks of 50 ms after which the program has failed.
        senses: What the program reads.
    """

    path: str
    acts_in: str
    agent: str
    task: str
    expect: tuple[Expected, ...] = ()
    template: str | None = None
    label: str = ""
    timeout_ticks: int = 1200
    senses: Senses = "world"

    @property
    def questions(self) -> tuple[Answers, ...]:
        """The questions that are asked."""
        return tuple(each for each in self.expect if isinstance(each, Answers))

    @property
    def asks_for_program(self) -> bool:
        """True if the model is asked for a program."""
        return not self.expect or len(self.questions) < len(self.expect)


@dataclass(frozen=True)
class ScenarioContent:
    """What a scenario says under one of its conditions if it has any.

    Attributes:
        setting: What a nest starts from, the script included.
        description: What it is about.
        reported_by: Who reported what is expected; empty: the author of the scenario.
        condition: Number of the condition it is under; None: as written, no overrides.
        condition_description: What is special about the condition.
        conditions: All conditions it could be loaded under: number to description.
        probes: What models are asked, in order.
        expectations: What simulators are to hold after the script.
        rules: What agents are after round after round, and how they play; None: not said.
        written: All of it as plain values, its parameters and its condition in place; empty if
            only the setting is known.
        source: Where it comes from, for messages.
        text: The text of its file; empty if it was built in code.
        templates: Texts of the templates that its probes name, by the name written there.
    """

    setting: Setting
    description: str = ""
    reported_by: str = ""
    condition: int | None = None
    condition_description: str = ""
    conditions: Mapping[int, str] = field(default_factory=dict)
    probes: tuple[Probe, ...] = ()
    expectations: tuple[Expectation, ...] = ()
    rules: EpisodeEntry | None = None
    written: Mapping[str, Any] = field(default_factory=dict)
    source: str = "scenario"
    text: str = ""
    templates: Mapping[str, str] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Its short name."""
        return self.setting.name

    @property
    def labels(self) -> Mapping[Position, str]:
        """What people call the containers."""
        return self.setting.labels
