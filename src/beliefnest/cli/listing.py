"""`beliefnest list`: names of installed scenarios, tasks, suites, templates and the like."""

from rich.text import Text

from beliefnest.cli.console import print_report, result_table
from beliefnest.cli.terminal_text import say
from beliefnest.episodes.tasks import task_names
from beliefnest.llm.resolve import model_names
from beliefnest.prompts.templates import BUILT_IN_TEMPLATES, built_in_template
from beliefnest.scenarios.outline import builtin_outline
from beliefnest.scenarios.sources import builtin_names
from beliefnest.suites import suite_names
from beliefnest.worlds.names import server_forms, world_names


def print_installed(*, as_json: bool) -> None:
    """Print all names that commands accept, by kind."""
    scenarios = [builtin_outline(name) for name in builtin_names()]
    content = {
        "scenarios": [
            {
                "name": scenario.name,
                "description": scenario.description,
                "conditions": {str(n): text for n, text in scenario.conditions.items()},
            }
            for scenario in scenarios
        ],
        "tasks": list(task_names()),
        "suites": list(suite_names()),
        "templates": list(BUILT_IN_TEMPLATES),
        "worlds": list(world_names()),
        "models": list(model_names()),
    }
    table = result_table("scenario", "condition", "about", right=("condition",))
    for scenario in scenarios:
        table.add_row(scenario.name, "", scenario.description)
        for number, text in scenario.conditions.items():
            table.add_row("", str(number), text)
    further = {
        "tasks": task_names(),
        "suites": suite_names(),
        "templates": tuple(BUILT_IN_TEMPLATES),
        "worlds": (*world_names(), *server_forms()),
        "models": model_names(),
    }
    lines = (Text(f"{what}: {', '.join(names)}") for what, names in further.items())
    print_report(content, [table, *lines], as_json=as_json)


def print_template(name: str | None) -> None:
    """Print the text of a built-in prompt template; without a name, the names of all.

    Raises:
        TemplateError: There is no built-in template of that name.
    """
    if name is None:
        for each, description in BUILT_IN_TEMPLATES.items():
            say(f"{each:14}{description}\n")
        return
    say(built_in_template(name).text.rstrip("\n") + "\n")
