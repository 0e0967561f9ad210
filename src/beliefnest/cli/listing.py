"""`beliefnest list`: names of installed scenarios, tasks, suites, templates and the like."""

import json
from collections.abc import Iterator, Sequence
from importlib.resources import files

from rich.text import Text

from beliefnest.cli.console import print_report, result_table
from beliefnest.cli.terminal_text import say
from beliefnest.episodes.tasks import task_names
from beliefnest.importing import hidden_entries, installed_names, told_entry
from beliefnest.llm.named_models import model_names
from beliefnest.prompts.templates import BUILT_IN_TEMPLATES, built_in_template
from beliefnest.suites import FILMS, suite_names
from beliefnest.worlds.names import server_forms, world_names


def print_installed(commands: Sequence[str], *, as_json: bool) -> None:
    """Print all names that commands accept, by kind; `commands` are the names of the commands."""
    # Written by `make outlines`: reading the scenarios themselves took half the time of `list`.
    scenarios = json.loads((files("beliefnest.scenarios") / "outlines.json").read_bytes())
    content = {
        "scenarios": scenarios,
        "tasks": list(task_names()),
        "suites": list(suite_names()),
        "templates": list(BUILT_IN_TEMPLATES),
        "worlds": list(world_names()),
        "models": list(model_names()),
        "hidden": list(_hidden(commands)),
    }
    table = result_table("scenario", "condition", "about", right=("condition",))
    for scenario in scenarios:
        table.add_row(scenario["name"], "", scenario["description"])
        for number, text in scenario["conditions"].items():
            table.add_row("", number, text)
    further = {
        "tasks": task_names(),
        "suites": suite_names(),
        "templates": tuple(BUILT_IN_TEMPLATES),
        "worlds": (*world_names(), *server_forms()),
        "models": model_names(),
    }
    lines = (Text(f"{what}: {', '.join(names)}") for what, names in further.items())
    print_report(content, [table, *lines, *_hidden(commands)], as_json=as_json)


def _hidden(commands: Sequence[str]) -> Iterator[str]:
    """Yield a line for each part of another package that has a name of this package's own.

    A filter of such a name is an error of its first use.
    """
    for what, names in (
        ("command", commands),
        ("kind", ()),
        ("model", [each.partition(":")[0] for each in model_names()]),
        ("policy", _policies() if installed_names("beliefnest.policies") else ()),
        ("server", ()),
        ("suite", (FILMS,)),
        ("task", ()),
        ("world", ()),
    ):
        group = "beliefnest.policies" if what == "policy" else f"beliefnest.{what}s"
        for entry in hidden_entries(group, names):
            yield (
                f"{told_entry(entry, what)} is not used: BeliefNest has a {what} of this name; "
                "rename the one of the package"
            )


def _policies() -> list[str]:
    """Return the first words of policies' names; they import NumPy, and the list is to be quick."""
    from beliefnest.episodes.policies import POLICIES

    return [each.partition(":")[0] for each in POLICIES]


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
