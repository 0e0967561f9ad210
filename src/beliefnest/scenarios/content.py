"""Content of a scenario: its setting, probes, and expectations."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from beliefnest.facts.kinds import StatedFact
from beliefnest.nest.past.setting import Setting
from beliefnest.prompts.rendering import check_variables
from beliefnest.prompts.templates import Template, built_in_template
from beliefnest.scenarios.expected import Expected
from beliefnest.scenarios.expected_answers import Answers
from beliefnest.scenarios.inferring import Inferring
from beliefnest.scenarios.rules import EpisodeEntry
from beliefnest.timeline.run_records import Senses
from beliefnest.world.values import Position

PROGRAM_VARIABLES = ("task", "instructed")
"""Variables of templates of requests for programs, as `probing` sets them."""

QUESTION_VARIABLES = ("task", "question", "options", "reason", "places")
"""Variables of templates of questions, as `questioning` sets them."""


class ScenarioWarning(UserWarning):
    """Warning about a scenario, which changes no result.

    Attributes:
        subject: Kind and place of what it is about; studies say it once for each subject.
    """

    def __init__(self, message: str, subject: str = "") -> None:
        super().__init__(message, subject)
        self.subject = subject or message

    def __str__(self) -> str:
        return str(self.args[0])


@dataclass(frozen=True, slots=True)
class Probe:
    """Request to a model, with a prompt from one belief.

    The model's program runs in a simulator and is judged there. If only answers are expected, the
    model is not asked for a program. A probe that infers asks no model.

    Attributes:
        path: Path of the belief from which the prompt is rendered.
        acts_in: Path of the simulator in which the program runs.
        agent: Name of the agent that runs the program.
        task: Task of the agent, for the model.
        expect: Expectations, all of which must hold; empty: the outcome is only recorded.
        template: Text of the prompt template; None: the paper's template.
        label: Name for tables.
        timeout_ticks: Ticks of 50 ms after which the program fails.
        senses: Source of what the program reads: the world, or its agent's percepts.
        infer: Inference from `path`, which takes the place of the request; None: none.
        intended: Intended right answer, `true belief` or `false belief`; empty: none is said.
        template_name: Name of the template for messages.
        where: Start of a message about the probe: file, line and key.
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
    infer: Inferring | None = None
    intended: str = ""
    template_name: str = field(default="template", compare=False)
    where: str = field(default="", compare=False)

    def template_or(self, usual: str) -> Template:
        """Return the prompt template; if none is named, a built-in one."""
        if self.template is None:
            return built_in_template(usual)
        return Template(self.template_name, self.template)

    def check_template(self) -> None:
        """Refuse a variable of the template that a request of the probe does not set.

        Raises:
            TemplateError: There is one, or the template cannot be parsed.
        """
        if self.template is not None and self.asks_for_program:
            check_variables(self.template_or(""), PROGRAM_VARIABLES)
        if self.template is not None and self.questions:
            check_variables(self.template_or(""), QUESTION_VARIABLES)

    @property
    def questions(self) -> tuple[Answers, ...]:
        """Return the questions of the probe."""
        return tuple(each for each in self.expect if isinstance(each, Answers))

    @property
    def asks_for_program(self) -> bool:
        """Return True if the model is asked for a program."""
        if self.infer is not None:
            return False
        return not self.expect or len(self.questions) < len(self.expect)

    @property
    def asks_model(self) -> bool:
        """Return True if a model is asked for anything."""
        return self.infer is None

    @property
    def asked(self) -> str:
        """Return the request in words."""
        if self.infer is not None:
            return f"what {self.infer.model.agent} wants, and believed at first"
        return self.task or " ".join(each.question for each in self.questions)


@dataclass(frozen=True)
class ScenarioContent:
    """Content of a scenario under one of its conditions, if it has any.

    Attributes:
        setting: Setting from which a nest starts, including the script.
        description: Description of the scenario.
        reported_by: Source of the expectations, such as a paper; empty: the scenario's author.
        condition: Number of the condition; None: the scenario as written, without overrides.
        condition_description: Description of the condition.
        conditions: Descriptions of all conditions, by number.
        probes: Probes in order.
        expectations: Expectations about simulators after the script.
        rules: Goals of the agents and rules of play; None: the scenario has none.
        written: The content as plain values, with parameters and condition applied; empty if only
            the setting is known.
        source: Name of the source for messages.
        text: Text of the file; empty if the scenario was built in code.
        templates: Texts of the templates that probes name, by name.
        warnings: Warnings about the file; nothing was played for them.
    """

    setting: Setting
    description: str = ""
    reported_by: str = ""
    condition: int | None = None
    condition_description: str = ""
    conditions: Mapping[int, str] = field(default_factory=dict)
    probes: tuple[Probe, ...] = ()
    expectations: tuple[StatedFact, ...] = ()
    rules: EpisodeEntry | None = None
    written: Mapping[str, Any] = field(default_factory=dict)
    source: str = "scenario"
    text: str = ""
    templates: Mapping[str, str] = field(default_factory=dict)
    warnings: tuple[ScenarioWarning, ...] = ()

    @property
    def name(self) -> str:
        """Return the short name of the scenario."""
        return self.setting.name

    @property
    def labels(self) -> Mapping[Position, str]:
        """Return the labels of containers, by position."""
        return self.setting.labels
