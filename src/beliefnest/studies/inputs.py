"""Inputs of a study, kept in its folder: scenarios, templates, files of policies and models.

With them, and with the recorded answers, the cells of the study can be played again on another
machine.
"""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

import msgspec

from beliefnest.episodes.policies import file_of_policy, text_of_policy
from beliefnest.episodes.task import Task
from beliefnest.episodes.tasks import is_task
from beliefnest.errors import BeliefNestError, InputError
from beliefnest.files import read_regular_text, replace_file
from beliefnest.prompts.templates import BUILT_IN_TEMPLATES, Template
from beliefnest.scenarios.document import Document
from beliefnest.scenarios.loading import condition_numbers
from beliefnest.scenarios.scenario import Scenario
from beliefnest.scenarios.sources import read_document
from beliefnest.scenarios.yaml_reading import templates_file

FOLDER = "inputs"


class InputIndex(msgspec.Struct, frozen=True):
    """Files of a study's inputs, by the names that cells have for them, relative to the folder.

    Attributes:
        scenarios: Files of scenarios, by name; built-in ones, too.
        tasks: Files of tasks and of scenarios played as tasks, by name; built-in tasks have none.
        templates: Files of prompt templates, by name; built-in ones have none.
        policies: Files of policies, by name of the policy.
        models: Files of scripted and replayed answers, by name of the model.
        study: The study's file; empty: the study was made in Python.
    """

    scenarios: dict[str, str] = {}
    tasks: dict[str, str] = {}
    templates: dict[str, str] = {}
    policies: dict[str, str] = {}
    models: dict[str, str] = {}
    study: str = ""


@dataclass
class Inputs:
    """Inputs of a study, collected before they are written.

    Attributes:
        texts: Text of each file, by its path relative to the study's folder.
        index: Names and paths.
    """

    texts: dict[str, str] = field(default_factory=dict)
    index: InputIndex = field(default_factory=InputIndex)

    def add_document(self, kind: str, name: str, document: Document) -> None:
        """Add a scenario or task, with the templates that it names.

        Args:
            kind: `scenarios` or `tasks`.
            name: Name in keys of cells.
            document: The document.
        """
        path = self._new(kind, f"{name}.yaml")
        self.texts[path] = document.text
        templates = _templates_of(document)
        if templates:
            beside = templates_file(Path(path)).as_posix()
            encoded = msgspec.json.encode(templates, order="sorted")
            self.texts[beside] = msgspec.json.format(encoded, indent=1).decode()
        getattr(self.index, kind)[name] = path

    def add_template(self, template: Template) -> None:
        """Add a template of the study, unless it is built in."""
        if template.name not in BUILT_IN_TEMPLATES:
            path = self._new("templates", PurePosixPath(template.name).name)
            self.texts[path] = template.text
            self.index.templates[template.name] = path

    def add_task(self, name: str) -> None:
        """Add a task, or a scenario that is played as a task, unless it is a built-in task.

        Raises:
            BeliefNestError: There is no such task, or its file cannot be read.
        """
        if is_task(name):
            return
        document = Task.scenario_document(name) or read_document(name)
        self.add_document("tasks", Task.load(name).name, document)

    def add_policies(self, names: Iterable[str]) -> None:
        """Add the files of policies, and of the models among them.

        Raises:
            InputError: A file cannot be read.
        """
        for name in names:
            text = text_of_policy(name)
            if text and name not in self.index.policies:
                file = file_of_policy(name) or f"{name.partition(':')[0]}.py"
                path = self._new("policies", PurePosixPath(file).name)
                self.texts[path] = text
                self.index.policies[name] = path

    def add_model(self, name: str) -> None:
        """Add the file of a scripted or replayed model; other models have none.

        Raises:
            InputError: The file cannot be read.
        """
        kind, _, file = name.partition(":")
        if kind in ("scripted", "replay") and name not in self.index.models:
            path = self._new("models", PurePosixPath(file).name)
            try:
                self.texts[path] = read_regular_text(Path(file))
            except (OSError, UnicodeDecodeError) as error:
                raise InputError(f"{file} cannot be read: {error}") from None
            self.index.models[name] = path

    def add_study(self, text: str) -> None:
        """Add the study's file."""
        path = f"{FOLDER}/study.yaml"
        self.texts[path] = text
        self.index = msgspec.structs.replace(self.index, study=path)

    def write(self, folder: Path) -> None:
        """Write all files below the study's folder."""
        for name, text in self.texts.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            replace_file(path, text)

    def _new(self, kind: str, name: str) -> str:
        """Return a path below the folder that no other input has."""
        safe = re.sub(r"[^A-Za-z0-9._-]+", "-", name).lstrip(".") or "file"
        paths = _candidates(f"{FOLDER}/{kind}", PurePosixPath(safe))
        return next(path for path in paths if path not in self.texts)


def _candidates(folder: str, name: PurePosixPath) -> Iterator[str]:
    yield f"{folder}/{name}"
    number = 2
    while True:
        yield f"{folder}/{name.stem}-{number}{name.suffix}"
        number += 1


def _templates_of(document: Document) -> dict[str, str]:
    """Return the texts of the templates that a scenario names under any condition."""
    templates: dict[str, str] = {}
    for condition in condition_numbers(document):
        try:
            templates.update(Scenario.varied(document, condition).templates)
        except BeliefNestError:
            # A task is no scenario and names no templates.
            continue
    return templates
