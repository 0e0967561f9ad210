"""`beliefnest list`: names of installed scenarios, tasks, suites, templates and the like."""

import json
import sys

from rich import box
from rich.table import Table

from beliefnest.cli.console import print_table, stdout
from beliefnest.cli.terminal_text import say
from beliefnest.episodes.tasks import builtin_tasks
from beliefnest.llm.resolve import model_names
from beliefnest.prompts.templates import BUILT_IN_TEMPLATES, built_in_template
from beliefnest.scenarios.outline import builtin_outline
from beliefnest.scenarios.sources import builtin_names
from beliefnest.suites import SUITES
from beliefnest.worlds.names import WORLDS
from beliefnest.worlds.servers.address import SCHEME


def print_installed(*, as_json: bool) -> None:
    """Print all names that commands accept, by kind."""
    scenarios = [builtin_outline(name) for name in builtin_names()]
    if as_json:
        content = {
            "scenarios": [
                {
                    "name": scenario.name,
                    "description": scenario.description,
                    "conditions": {str(n): text for n, text in scenario.conditions.items()},
                }
                for scenario in scenarios
            ],
            "tasks": list(builtin_tasks()),
            "suites": list(SUITES),
            "templates": list(BUILT_IN_TEMPLATES),
            "worlds": list(WORLDS),
            "models": list(model_names()),
        }
        sys.stdout.write(json.dumps(content, indent=2) + "\n")
        return
    table = Table(box=box.SIMPLE_HEAVY)
    table.add_column("scenario", no_wrap=True)
    table.add_column("condition", justify="right")
    table.add_column("about")
    for scenario in scenarios:
        table.add_row(scenario.name, "", scenario.description)
        for number, text in scenario.conditions.items():
            table.add_row("", str(number), text)
    console = stdout()
    print_table(console, table)
    further = {
        "tasks": builtin_tasks(),
        "suites": SUITES,
        "templates": tuple(BUILT_IN_TEMPLATES),
        "worlds": (*WORLDS, f"{SCHEME}://HOST:PORT"),
        "models": model_names(),
    }
    for what, names in further.items():
        console.print(f"{what}: {', '.join(names)}", highlight=False)


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
