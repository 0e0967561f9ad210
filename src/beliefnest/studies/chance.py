"""Detection of cells whose result depends on their seed."""

from collections.abc import Iterable, Mapping

from beliefnest.episodes.policies import draws_by_seed
from beliefnest.episodes.task import Task
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
        or _script_draws(scenario)
    )


def episode_draws(task: Task, policies: Mapping[str, str], texts: Iterable[str]) -> bool:
    """Return True if an episode draws random numbers, apart from its instance and the world.

    Args:
        task: Instance of the task; its own policies play agents that `policies` does not name.
        policies: Names of policies by agent.
        texts: Texts of the files that define these policies.
    """
    names = {**task.form.policies, **policies}.values()
    return (
        any(draws_by_seed(name) for name in names)
        or any(_may_draw(text) for text in texts)
        or _script_draws(task.scenario)
    )


def _script_draws(scenario: Scenario) -> bool:
    steps = scenario.setting.script
    return any(_may_draw(text) for step in steps for text in step.programs.values())


def _may_draw(program: str) -> bool:
    """Return True if a program may draw random numbers; a mention in a text counts as well."""
    return "random" in program
