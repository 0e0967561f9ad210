"""Folder of `beliefnest run`, read as that of a study: its report as a plan and cells."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Literal

import msgspec

from beliefnest.errors import InputError
from beliefnest.files import read_regular
from beliefnest.llm.stored_exchange import Exchange, decode_exchange
from beliefnest.plan.cells import variation_id
from beliefnest.scenarios.record_forms import ExpectationForm, ProbeForm, UsageForm
from beliefnest.studies.forms import read_marked
from beliefnest.studies.kinds import SCENARIO_KIND, CellKind

REPORT = "run.json"
FORM = "beliefnest run 1"
"""Mark of reports of this version."""
_OTHER = "name another folder"


class _TableForm(msgspec.Struct):
    cells: dict[str, str]
    notes: list[str]


class ResultForm(msgspec.Struct):
    """Form of the result of a condition, as `outcome_json` writes it."""

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
    run_dir: str
    table: _TableForm


class _FailureForm(msgspec.Struct):
    condition: int | None
    model: str
    seed: int
    error: str
    kind: str
    outcome: str


class _SettingsForm(msgspec.Struct):
    conditions: list[int]
    world: str
    models: list[str]
    repeat: int
    seed: int
    attempts: int
    temperature: float | None


class _ReportForm(msgspec.Struct):
    scenario: str
    status: str
    settings: _SettingsForm
    runs: list[ResultForm]
    failures: list[_FailureForm]
    versions: dict[str, str]


def read_report(folder: Path, remedy: str = _OTHER) -> dict[str, Any]:
    """Return the report in a run folder.

    Args:
        folder: The run folder.
        remedy: What to do if the report is damaged, for the end of the message.

    Raises:
        InputError: The report cannot be read, is damaged, or was written by another version.
    """
    return read_marked(folder / REPORT, FORM, _ReportForm, remedy)


@dataclass(frozen=True)
class ReportedRun:
    """Run folder, see `ResultFolder`.

    Attributes:
        path: The run folder.
        report: Content of `run.json`.
    """

    of: ClassVar[Literal["run"]] = "run"
    kind: ClassVar[CellKind] = SCENARIO_KIND
    path: Path
    report: Mapping[str, Any]

    def plan(self) -> dict[str, Any]:
        """Return settings and cells: one for each condition of each model and repeat."""
        settings = self.report["settings"]
        return {
            **settings,
            "repeats": settings["repeat"],
            "scenarios": [self.report["scenario"]],
            "variations": {},
            "versions": self.report["versions"],
            "cells": [planned for planned, _ in self._cells.values()],
            "invalid": [],
        }

    def cell(self, name: str) -> dict[str, Any]:
        """Return the result of a condition, or why there is none."""
        return self._cells[name][1]

    def people(self) -> list[dict[str, Any]]:
        """Return nothing: no participant answers a run."""
        return []

    def sessions(self) -> dict[str, dict[str, Any]]:
        """Return nothing, see `people`."""
        return {}

    @cached_property
    def _cells(self) -> dict[str, tuple[dict[str, Any], dict[str, Any]]]:
        """Return the entry of each cell in the plan, and its content, by name."""
        cells = {}
        for number, run in enumerate(self.report["runs"], 1):
            name = f"run-{number}"
            cells[name] = (self._planned(name, run, []), {"error": None, **run, "run": ""})
        for number, failure in enumerate(self.report["failures"], 1):
            name = f"failure-{number}"
            cells[name] = (self._planned(name, failure, self._probes), dict(failure))
        return cells

    @property
    def _probes(self) -> list[dict[str, Any]]:
        """Return the probes of conditions without a result: those of a condition with one."""
        first_runs = self.report["runs"][:1]
        keys = ("label", "path", "acts_in", "agent", "task", "expected")
        probes = first_runs[0]["probes"] if first_runs else [{"expected": {"unknown": True}}]
        return [{key: probe[key] for key in keys if key in probe} for probe in probes]

    def _planned(
        self, name: str, run: Mapping[str, Any], probes: list[dict[str, Any]]
    ) -> dict[str, Any]:
        scenario = self.report["scenario"]
        key = {
            "scenario": scenario,
            "condition": run["condition"],
            "variation": {},
            "model": run["model"],
            "template": "",
            "repeat": 1 + run["seed"] - self.report["settings"]["seed"],
        }
        return {
            "name": name,
            "seed": run["seed"],
            "key": key,
            "variation": variation_id(scenario, {}),
            "alike": None,
            "probes": probes,
        }

    def exchanges(self) -> list[Exchange]:
        """Return all requests to models with their answers, in order.

        Raises:
            InputError: The file is damaged.
        """
        file = self.path / "model.jsonl"
        if not file.is_file():
            return []
        exchanges = []
        for number, line in enumerate(read_regular(file).splitlines(), 1):
            try:
                exchanges.append(decode_exchange(line))
            except msgspec.MsgspecError as error:
                raise InputError(f"{file}:{number} is damaged: {error}; {_OTHER}") from None
        return exchanges
