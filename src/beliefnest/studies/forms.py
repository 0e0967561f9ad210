"""Forms of a study's files, used to check files that are read."""

from typing import Any

import msgspec

from beliefnest.episodes.measures import Measures
from beliefnest.scenarios.record_forms import ExpectationForm, ProbeForm


class _Failed(msgspec.Struct):
    error: str


class _StudyProbe(ProbeForm, kw_only=True):
    seconds: float


class _Played(msgspec.Struct):
    error: None
    seed: int
    ticks: int
    expectations: list[ExpectationForm]
    probes: list[_StudyProbe]
    run: str = ""


class _Episode(msgspec.Struct):
    error: None
    seed: int
    why_not: str
    measures: Measures
    run: str = ""


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


class _PlannedScenario(msgspec.Struct):
    name: str
    seed: int
    key: _ScenarioKey
    probes: list[_PlannedProbe]
    alike: str | None = None


class _PlannedEpisode(msgspec.Struct):
    name: str
    seed: int
    key: _TaskKey
    alike: str | None = None


class _Invalid(msgspec.Struct):
    scenario: str
    condition: int | None
    variation: dict[str, Any]
    why: str


class _ScenariosPlan(msgspec.Struct):
    cells: list[_PlannedScenario]
    invalid: list[_Invalid]


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
    excluded: dict[str, int] = {}


class PeopleForm(msgspec.Struct):
    """Entries of cells that participants answered."""

    cells: list[_PlannedPerson]
    sessions: dict[str, _Sessions] = {}


class _EpisodesPlan(msgspec.Struct):
    cells: list[_PlannedEpisode]
    invalid: list[_Invalid]
    tasks: Any


class SecondsForm(msgspec.Struct):
    """Line with the wall time of a cell."""

    cell: str
    seconds: float


def cell_form(content: dict[str, Any]) -> type[Any]:
    """Return the form that the content of a cell's file must have."""
    if content.get("error") is not None:
        return _Failed
    return _Episode if "measures" in content else _Played


def plan_form(content: dict[str, Any]) -> type[Any]:
    """Return the form that a study's plan must have."""
    return _EpisodesPlan if "tasks" in content else _ScenariosPlan
