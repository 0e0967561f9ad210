"""Every block of code of the papers is run by a test that is named here, or read by what reads it.

Commands are read as the command line reads them, and not carried out: many want a key, a server
or a person. Those that lead from an empty folder to a result are carried out by the tests of the
tutorial and of the guides, and every command by the tests of `cli`.
"""

import json
import re
import shlex
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest
import typer
import yaml

from beliefnest.cli.app import app
from beliefnest.episodes.tasks import task_names
from beliefnest.scenarios.sources import builtin_names

ROOT = Path(__file__).parents[2]
PAPERS = (
    "README.md",
    "CONTRIBUTING.md",
    "docs/*.md",
    "docs/tasks/*.md",
    "docs/days/*.md",
    "docs/reference/*.md",
)
COMMAND = typer.main.get_command(app)
RUN_BY = {
    ("README.md", "python"): "docs/test_docs.py",
    ("README.md", "bibtex"): "packaging/test_citation.py",
    ("benchmark.md", "python"): "docs/test_benchmark_page.py",
    ("claims.md", "python"): "docs/test_claims_page.py",
    ("coming-from-mineflayer.md", "python"): "docs/test_nest_pages.py",
    ("episodes.md", "python"): "docs/test_episodes_page.py",
    ("explain.md", "python"): "docs/test_explain_page.py",
    ("export.md", "jsonl"): "timeline/test_trace.py",
    ("filters.md", "jinja"): "prompts/test_rendering.py",
    ("filters.md", "python"): "docs/test_nest_pages.py",
    ("frames.md", "python"): "frames/test_tables.py",
    ("items.md", "python"): "docs/test_items_page.py",
    ("imagine.md", "python"): "docs/test_imagine_page.py",
    ("inspect.md", "python"): "inspect/test_tasks.py",
    ("large-worlds.md", "python"): "docs/test_nest_pages.py",
    ("looking.md", "python"): "docs/test_looking_page.py",
    ("minds.md", "python"): "docs/test_minds_page.py",
    ("models.md", "python"): "llm/test_docs.py",
    ("participants.md", "javascript"): "docs/test_participants_page.py",
    ("participants.md", "python"): "docs/test_participants_page.py",
    ("people.md", "javascript"): "worlds/servers/test_people.py",
    ("people.md", "python"): "worlds/servers/test_people.py",
    ("pettingzoo.md", "python"): "env/test_environment.py",
    ("plugins.md", "python"): "packaging/test_plugins.py",
    ("programs.md", "python"): "docs/test_nest_pages.py",
    ("psychologist.md", "python"): "docs/test_psychologist_page.py",
    ("python.md", "python"): "docs/test_nest_pages.py",
    ("scenarios.md", "python"): "docs/test_docs.py",
    ("scripted-world.md", "python"): "docs/test_nest_pages.py",
    ("servers.md", "python"): "worlds/servers/test_realtime.py",
    ("skills.md", "js"): "skills/test_examples.py",
    ("studies.md", "python"): "docs/test_studies_page.py",
    ("supplement.md", "python"): "docs/test_supplement_page.py",
    ("teaming.md", "python"): "docs/test_teaming_page.py",
    ("timelines.md", "python"): "docs/test_nest_pages.py",
    ("train.md", "python"): "examples/test_train_an_agent.py",
    ("tutorial.md", "python"): "docs/test_tutorial.py",
    ("visiting.md", "python"): "visits/test_layout.py",
}
"""Page and language to the test that runs its blocks."""
SHELLS = {"bash", "console", "sh"}
READ = {"json": json.loads, "toml": tomllib.loads, "yaml": yaml.safe_load}
SHOWN = {"text"}
"""Languages of output, which the tests that produce it compare."""


def blocks() -> Iterator[tuple[Path, str, str]]:
    for pattern in PAPERS:
        for page in sorted(ROOT.glob(pattern)):
            text = page.read_text(encoding="utf-8")
            for language, code in re.findall(r"^ *```(\w*)\n(.*?)^ *```$", text, re.M | re.S):
                yield page, language, code


def commands(program: str) -> Iterator[tuple[str, list[str]]]:
    for page, language, code in blocks():
        for line in code.splitlines() if language in SHELLS else ():
            for part in line.removeprefix("$ ").split("&&"):
                if part.split()[:1] == [program]:
                    yield page.name, shlex.split(part, comments=True)[1:]


def test_every_block_is_run_or_read() -> None:
    run = {
        (page.name, language)
        for page, language, _ in blocks()
        if language not in SHELLS | READ.keys() | SHOWN
    }
    assert run == set(RUN_BY)
    for (page, _), test in RUN_BY.items():
        text = (ROOT / "tests" / test).read_text(encoding="utf-8")
        assert page in text, f"{test} does not read {page}"


@pytest.mark.parametrize("language", READ)
def test_data_is_of_its_form(language: str) -> None:
    found = [code for _, each, code in blocks() if each == language]
    assert found
    for code in found:
        lines = code.splitlines() if code.count('\n{"') else [code]
        for line in lines:
            READ[language](line)


def test_commands_and_their_options_are_those_there_are() -> None:
    ours = list(commands("beliefnest"))
    assert len(ours) > 30
    for page, (name, *arguments) in ours:
        command = COMMAND.commands[name]
        context = command.context_class(command, info_name=name)
        command.parse_args(context, arguments)
        assert not context.args, f"{page}: {name} {arguments}"


def test_tasks_for_inspect_are_those_there_are() -> None:
    named = {name.replace("-", "_") for name in (*builtin_names(), *task_names())}
    asked = [words for _, words in commands("inspect")]
    assert asked
    for verb, task, *_ in asked:
        assert verb == "eval"
        assert task.removeprefix("beliefnest/") in named | {
            *("scenario", "episode", "hi_tom", "minds", "films"),
        }
