"""Forms of a study's files, used to check files that are read."""

from pathlib import Path
from typing import Annotated, Any

import msgspec

from beliefnest.episodes.measures import Measures
from beliefnest.errors import InputError
from beliefnest.scenarios.record_forms import (
    ExpectationForm,
    ProbeForm,
    UsageForm,
    checked_form,
    read_json,
)
from beliefnest.studies.inputs import InputIndex


class FailedCell(msgspec.Struct):
    """Content of the file of a cell without a result."""

    error: str
    kind: str


class _StudyProbe(ProbeForm, kw_only=True):
    seconds: float


class PlayedScenario(msgspec.Struct):
    """Content of the file of a cell whose scenario was played."""

    error: None
    seed: int
    ticks: int
    expectations: list[ExpectationForm]
    probes: list[_StudyProbe]
    run: str


class _TableForm(msgspec.Struct):
    cells: dict[str, str]
    notes: list[str]


class PlayedCondition(msgspec.Struct):
    """Content of the file of a cell of a run, as `outcome_json` writes it."""

    error: None
    condition: int | None
    model: str
    seed: int
    ok: bool
    ticks: int
    seconds: float
    reality: dict[str, Any]
    beliefs: dict[str, dict[str, Any]]
    expectations: list[ExpectationForm]
    probes: list[ProbeForm]
    failures: list[str]
    usage: UsageForm
    run: str
    run_dir: str
    table: _TableForm


class PlayedEpisode(msgspec.Struct):
    """Content of the file of a cell whose episode was played."""

    error: None
    seed: int
    why_not: str
    measures: Measures
    run: str


class _ScenarioKey(msgspec.Struct):
    scenario: str
    condition: int | None
    variation: dict[str, Any]
    model: str
    template: str
    repeat: int


class _TaskKey(msgspec.Struct):
    task: str
    condition: int | None
    variation: dict[str, Any]
    player: str
    order: str | int | None
    instance: int
    repeat: int


class _PlannedProbe(msgspec.Struct):
    label: str
    path: str
    acts_in: str
    agent: str
    task: str
    expected: dict[str, Any] | None


class PlannedCell(msgspec.Struct):
    """Entry of a cell in a plan."""

    name: str
    seed: int
    key: Any
    variation: str
    alike: str | None


class _PlannedScenario(PlannedCell):
    key: _ScenarioKey
    probes: list[_PlannedProbe]


class _PlannedEpisode(PlannedCell):
    key: _TaskKey


class _Invalid(msgspec.Struct):
    scenario: str
    condition: int | None
    variation: dict[str, Any]
    why: str


class CellsPlan(msgspec.Struct):
    """Plan of cells of any kind."""

    cells: list[Any]
    invalid: list[_Invalid]
    versions: dict[str, str]


class ScenariosPlan(CellsPlan):
    """Plan of a study of scenarios."""

    cells: list[_PlannedScenario]
    inputs: InputIndex


class _RunSetting(msgspec.Struct):
    conditions: list[int]
    world: str
    models: list[str]
    repeat: int
    seed: int
    attempts: int
    temperature: float | None


class _RunKey(_ScenarioKey):
    setting: _RunSetting


class _PlannedCondition(_PlannedScenario):
    key: _RunKey


class RunPlan(CellsPlan):
    """Plan of a run."""

    status: str
    world: str
    models: list[str]
    cells: Annotated[list[_PlannedCondition], msgspec.Meta(min_length=1)]


class _PersonKey(_ScenarioKey):
    participant: str


class _PlannedPerson(_PlannedScenario, kw_only=True):
    key: _PersonKey


class _Sessions(msgspec.Struct):
    began: int
    complete: int
    partial: int
    unanswered: int
    repeated: int
    excluded: dict[str, int]


class PeopleForm(msgspec.Struct):
    """Entries of cells that participants answered."""

    cells: list[_PlannedPerson]
    sessions: dict[str, _Sessions]


class EpisodesPlan(CellsPlan):
    """Plan of a study of episodes."""

    cells: list[_PlannedEpisode]
    tasks: Any
    inputs: InputIndex


class PlanKind(msgspec.Struct):
    """Kind that any plan names."""

    kind: str


class SecondsForm(msgspec.Struct):
    """Line with the wall time of a cell."""

    cell: str
    seconds: float


def read_marked(file: Path, mark: str, form: type[Any], remedy: str) -> dict[str, Any]:
    """Return the JSON object in a file of this version.

    Args:
        file: The file.
        mark: Value of its key `form`, which names the kind of file and the version of its form.
        form: Expected form.
        remedy: What to do if the file is damaged, for the end of the message.

    Raises:
        InputError: The file cannot be read, is damaged, or was written by another version.
    """
    content = read_json(file, remedy)
    if content.get("form") != mark:
        raise InputError(
            f"{file} was written by another version of beliefnest, and this one reads {mark!r}; "
            "start again in a new folder, or use the version that wrote it"
        )
    checked_form(content, form, file, remedy)
    return content
