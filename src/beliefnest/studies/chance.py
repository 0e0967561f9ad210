"""Whether a cell's seed bears on what comes of it."""

from collections.abc import Iterable, Mapping

from beliefnest.episodes.policies import draws_by_seed
from beliefnest.episodes.task import Task
from beliefnest.llm.resolve import is_of_provider
from beliefnest.scenarios.scenario import Scenario

__all__ = ["episode_draws", "scenario_draws"]


def scenario_draws(scenario: Scenario, models: Iterable[str]) -> bool:
    """Return True if anything in a scenario is drawn, but for what the world itself draws.

    Args:
        scenario: The scenario.
        models: Names of all models that are asked.
    """
    # The options of a question are shuffled by the seed.
    asked = (question for probe in scenario.probes for question in probe.questions)
    return (
        any(is_of_provider(model) for model in models)
        or any(question.options for question in asked)
        or _script_draws(scenario)
    )


def episode_draws(task: Task, policies: Mapping[str, str], texts: Iterable[str]) -> bool:
    """Whether anything in an episode is drawn, but for its instance and what the world draws.

    Args:
        task: The instance, whose own policies play those that `policies` does not name.
        policies: By agent, who plays it.
        texts: What these policies are read from.
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
    """Return True if a program may draw; one that only speaks of it is taken to."""
    return "random" in program
