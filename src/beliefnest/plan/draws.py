"""Detection of cells whose result depends on their seed."""

from collections.abc import Iterable

from beliefnest.llm.resolve import can_vary
from beliefnest.scenarios.scenario import Scenario


def scenario_draws(scenario: Scenario, models: Iterable[str]) -> bool:
    """Return True if a scenario draws random numbers, apart from those of the world itself.

    Args:
        scenario: The scenario.
        models: Names of all models that the cell asks.
    """
    # The seed shuffles the options of a question.
    asked = (question for probe in scenario.probes for question in probe.questions)
    return (
        any(can_vary(model) for model in models)
        or any(question.options for question in asked)
        or script_draws(scenario)
    )


def script_draws(scenario: Scenario) -> bool:
    """Return True if a program of a scenario's script may draw random numbers."""
    steps = scenario.setting.script
    return any(may_draw(text) for step in steps for text in step.programs.values())


def may_draw(program: str) -> bool:
    """Return True if a program may draw random numbers; a mention in a text counts as well."""
    return "random" in program
