"""Playing the cells of a recorded study again, from its folder alone and without any model."""

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import msgspec
from msgspec.structs import replace

from beliefnest.episodes.policies import is_own_policy, policy_of_file
from beliefnest.episodes.task import Task
from beliefnest.episodes.tasks import is_task
from beliefnest.errors import BeliefNestError, InputError
from beliefnest.files import read_regular_text
from beliefnest.llm.budget import RunLimits
from beliefnest.plan.cells import Keyed
from beliefnest.plan.jobs import OnStudyProgress, run_cells
from beliefnest.plan.scenario_cells import LABEL, Cell, CellKey
from beliefnest.prompts.templates import BUILT_IN_TEMPLATES, Template, built_in_template
from beliefnest.scenarios.document import Document, YamlNode
from beliefnest.scenarios.sources import read_document
from beliefnest.studies.allocation import PARTICIPANT
from beliefnest.studies.archive import inside
from beliefnest.studies.cells import planned_cell
from beliefnest.studies.comparing import ERROR, PairedDifference, differing_contents, differing_rows
from beliefnest.studies.episode_cells import EpisodeCell, EpisodeKey, task_of_cell
from beliefnest.studies.foreign_code import Code, check_trust, code_of, functions_in
from beliefnest.studies.inputs import InputIndex
from beliefnest.studies.kinds import EPISODE_KIND
from beliefnest.studies.plainframe import csv_rows, read_csv_rows
from beliefnest.studies.study_folder import StudyFolder
from beliefnest.studies.study_record import StudyRecord
from beliefnest.studies.table import CellKind
from beliefnest.world.texts import quoted
from beliefnest.worlds.minecraft.launching import ahead


class Reproduction(msgspec.Struct, frozen=True):
    """Comparison of a recorded study, or run, with the same played again.

    Attributes:
        cells: Number of cells that were played again.
        left_out: Number of cells that had no result, which are not played again.
        rows: Number of recorded rows with a result.
        differences: All differences; empty if everything is equal.
    """

    cells: int
    left_out: int
    rows: int
    differences: tuple[PairedDifference, ...]

    @property
    def is_equal(self) -> bool:
        """Return True if there is no difference."""
        return not self.differences


def reproduce_study(
    folder: Path, again: Path, jobs: int, on_progress: OnStudyProgress, *, trust: bool = False
) -> Reproduction:
    """Play all cells of a study again that have a result, and compare rows and contents.

    Scenarios and templates are those in the folder's `inputs/`, and answers of models those in
    `answers/`. No model is asked.

    Args:
        folder: Folder of the study.
        again: Empty folder for the new results.
        jobs: Number of cells to play in parallel.
        on_progress: Function that receives the progress.
        trust: Run the Python code of the study's makers, if there is any.

    Raises:
        InputError: The folder holds no study, or not its inputs, or other inputs than those that
            its cells were played with; or there is code in it that is not trusted.
        BodyError: A worker process ended unexpectedly.
    """
    recorded = StudyRecord.read(folder)
    if recorded.folder.of == "run":
        raise InputError(f"{folder} holds a run; play it again with `beliefnest reproduce`")
    # Answers of people cannot be played again; their rows are compared with their cells.
    plan = recorded.folder.plan()
    contents = {cell["name"]: recorded.folder.cell(cell["name"]) for cell in plan["cells"]}
    ended = [
        cell
        for cell in plan["cells"]
        if (content := contents[cell["name"]]) is not None and content["error"] is None
    ]
    inputs = _Inputs.of(folder, plan)
    check_trust(inputs.code(), trust=trust)
    cells = [inputs.cell(cell, recorded.kind) for cell in ended]
    place = StudyFolder.open(again, recorded.kind)
    place.write_plan({**plan, "cells": ended})
    terms = replace(
        place.terms(RunLimits(None, None)),
        answers=(folder / "answers").absolute(),
        environment={},
        cache_mode="only",
    )
    run_cells(cells, place, terms, jobs, "loky", on_progress, ahead)
    for planned, cell in zip(ended, cells, strict=True):
        _restore(place, planned, cell.key.name, inputs.names)
    differences = [
        *differing_table(recorded),
        *_differing_cells(recorded, StudyRecord.read(again), ended),
    ]
    names = {cell["name"] for cell in ended}
    judged = sum(row["cell"] in names and row.get(PARTICIPANT) is None for row in recorded.rows)
    left_out = len(plan["cells"]) - len(ended)
    return Reproduction(len(ended), left_out, judged, tuple(differences))


def code_in_study(folder: Path) -> list[Code]:
    """Return the Python code that playing a study again runs.

    Raises:
        InputError: The folder holds no study, or not its inputs.
    """
    return list(_Inputs.of(folder, StudyRecord.read(folder).folder.plan()).code())


def _restore(
    place: StudyFolder, planned: Mapping[str, Any], played: str, names: Mapping[str, str]
) -> None:
    """Give a new result the name and key of the recorded one, and its names of files."""
    content = place.cell(played)
    assert content is not None
    if played != planned["name"]:
        (place.cells / f"{played}.json").unlink()
    renamed = _renamed(content, names)
    place.write_cell(planned["name"], {**renamed, "key": planned["key"], "seed": planned["seed"]})


def _renamed(value: Any, names: Mapping[str, str]) -> Any:
    """Return plain values with each name replaced by another, wherever it stands in a text."""
    if isinstance(value, str):
        for new, old in names.items():
            value = value.replace(new, old)
        return value
    if isinstance(value, list):
        return [_renamed(each, names) for each in value]
    if isinstance(value, dict):
        return {key: _renamed(each, names) for key, each in value.items()}
    return value


def differing_table(recorded: StudyRecord) -> Iterator[PairedDifference]:
    """Yield differences of `rows.csv` from the cells beside it."""
    file = recorded.folder.path / "rows.csv"
    if file.is_file():
        # The first row is line 2, below the header.
        yield from differing_rows(
            read_csv_rows(file, recorded.typed()),
            csv_rows(recorded.typed()),
            lambda number: f"rows.csv:{number + 1}",
        )


def _differing_cells(
    recorded: StudyRecord, again: StudyRecord, ended: Sequence[Mapping[str, Any]]
) -> Iterator[PairedDifference]:
    """Yield differences of each cell: of its rows, or, if these are equal, of its content."""
    rows: dict[str, tuple[list[dict[str, Any]], list[dict[str, Any]]]]
    rows = {cell["name"]: ([], []) for cell in ended}
    for side, result in enumerate((recorded, again)):
        for row in result.rows:
            if row["cell"] in rows:
                own = {name: value for name, value in row.items() if name != PARTICIPANT}
                rows[row["cell"]][side].append({**own, "run": ""})
    for name, (before, after) in rows.items():
        where = f"cells/{name}.json"
        failed = again.folder.cell(name)
        if failed is not None and failed["error"] is not None:
            yield PairedDifference(where, ERROR, None, failed["error"])
            continue
        pairs = list(differing_rows(before, after, partial("{}, probe {}".format, where)))
        yield from pairs or differing_contents(recorded.folder.cell(name), failed, where, ("run",))


class _Inputs(msgspec.Struct, frozen=True):
    """Inputs in the folder of a study.

    Attributes:
        folder: Folder of the study.
        index: Names and files.
        documents: Documents of scenarios and tasks, by name.
        names: Names with files of this folder in them, and the recorded names.
        policies: Names of all policies of the cells.
    """

    folder: Path
    index: InputIndex
    documents: Mapping[str, Document]
    names: Mapping[str, str]
    policies: frozenset[str]

    @classmethod
    def of(cls, folder: Path, plan: Mapping[str, Any]) -> "_Inputs":
        """Return the inputs of a plan; raise InputError if the folder does not have them."""
        index = msgspec.convert(plan["inputs"], InputIndex)
        documents = {
            name: _document(inside(folder, file))
            for name, file in {**index.scenarios, **index.tasks}.items()
        }
        named = (index.scenarios, index.tasks, index.templates, index.policies, index.models)
        for file in (file for files in named for file in files.values()):
            inside(folder, file)
        for document in documents.values():
            check_templates(document)
        root = folder.absolute()
        moved = {
            **{
                policy_of_file(name, root / file): name
                for name, file in index.policies.items()
                if policy_of_file(name, Path("x")) != name
            },
            **{f"{name.partition(':')[0]}:{root / f}": name for name, f in index.models.items()},
        }
        policies = frozenset(
            name for cell in plan["cells"] for name in cell["key"].get("policies", {}).values()
        )
        return cls(folder, index, documents, moved, policies)

    def cell(self, planned: Mapping[str, Any], kind: CellKind) -> Keyed:
        """Return a cell to play, from its entry in the plan.

        Raises:
            InputError: The inputs are not those that the cell was played with.
        """
        key = dict(planned["key"])
        try:
            label = planned.get(LABEL, "")
            made = self._episode(key) if kind is EPISODE_KIND else self._probes(key, label)
        except (BeliefNestError, KeyError, TypeError) as error:
            raise InputError(
                f"{self.folder}: the cell {planned['name']} cannot be made from the inputs: {error}"
            ) from None
        return made

    def _probes(self, key: dict[str, Any], label: str) -> Cell:
        recorded = CellKey(**key)
        if recorded.scenario not in self.documents:
            raise InputError(f"its scenario {quoted(recorded.scenario)} is not among the inputs")
        cell = planned_cell(recorded, self.documents[recorded.scenario], self._template(recorded))
        if cell.key.content != recorded.content:
            raise InputError(
                f"{self.index.scenarios[recorded.scenario]}, or a template, has changed since the "
                "cell was played"
            )
        own = dataclasses.replace(recorded, model=self._here(recorded.model))
        return replace(cell, key=own, label=label)

    def _template(self, key: CellKey) -> Template | None:
        if not key.template:
            return None
        if key.template in BUILT_IN_TEMPLATES:
            return built_in_template(key.template)
        if key.template not in self.index.templates:
            raise InputError(f"its template {quoted(key.template)} is not among the inputs")
        file = self.folder / self.index.templates[key.template]
        try:
            return Template(key.template, read_regular_text(file))
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"{file} cannot be read: {error}") from None

    def _episode(self, key: dict[str, Any]) -> EpisodeCell:
        recorded = EpisodeKey(**key)
        source = recorded.task
        if recorded.task in self.index.tasks:
            source = str(self.folder / self.index.tasks[recorded.task])
        elif not is_task(recorded.task):
            raise InputError(f"its task {quoted(recorded.task)} is not among the inputs")
        document = None if is_task(source) else Task.scenario_document(source)
        task = task_of_cell(recorded, source, document)
        policies = {agent: self._here(name) for agent, name in recorded.policies.items()}
        return EpisodeCell(dataclasses.replace(recorded, policies=policies), task, draws=True)

    def code(self) -> Iterator[Code]:
        """Yield the Python code that playing the cells runs."""
        for name, file in self.index.policies.items():
            if is_own_policy(name):
                yield code_of(self._here(name), file, name)
        for name in sorted(self.policies):
            if name not in self.index.policies and is_own_policy(name):
                yield code_of(self._here(name), "", name)
        for document in self.documents.values():
            for name in functions_in(document.root):
                yield code_of(name)

    def _here(self, name: str) -> str:
        """Return the name of a policy or model with its file in this folder."""
        for new, old in self.names.items():
            if name == old or name.startswith(f"model:{old}:"):
                return name.replace(old, new)
        return name


def _document(file: Path) -> Document:
    try:
        return read_document(str(file))
    except BeliefNestError as error:
        raise InputError(f"an input of the study cannot be read: {error}") from None


def check_templates(document: Document) -> None:
    """Refuse a document of a supplement that names a template outside of it.

    Raises:
        InputError: A template is neither built in nor kept with the document.
    """
    names = {*BUILT_IN_TEMPLATES, *document.templates}
    for name in _templates_in(document.root):
        if name not in names:
            raise InputError(
                f"{document.source} names the template {quoted(name)}, which the supplement does "
                "not hold"
            )


def _templates_in(node: YamlNode) -> Iterator[str]:
    if isinstance(node.value, dict):
        for key, child in node.value.items():
            if key == "template" and isinstance(child.value, str):
                yield child.value
            yield from _templates_in(child)
    elif isinstance(node.value, list):
        for child in node.value:
            yield from _templates_in(child)
