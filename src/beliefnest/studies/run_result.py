"""Results in the folder of `beliefnest run`, in the form of a study's rows."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import msgspec

from beliefnest.errors import InputError
from beliefnest.files import read_regular
from beliefnest.llm.stored_exchange import Exchange, decode_exchange
from beliefnest.scenarios.record_forms import ExpectationForm, ProbeForm
from beliefnest.studies.cells import variation_id
from beliefnest.studies.forms import read_marked
from beliefnest.studies.plainframe import Typed
from beliefnest.studies.rows import PROBES

REPORT = "run.json"
FORM = "beliefnest run 1"
"""Mark of reports of this version."""
_OTHER = "name another folder"


class _RunForm(msgspec.Struct):
    run_dir: str
    probes: list[ProbeForm]
    expectations: list[ExpectationForm]


class _FailureForm(msgspec.Struct):
    condition: int | None
    model: str
    seed: int
    error: str
    outcome: str


class _ReportForm(msgspec.Struct):
    scenario: str
    status: str
    settings: dict[str, Any]
    runs: list[_RunForm]
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
class RunResult:
    """Results in a run folder.

    Attributes:
        folder: The run folder.
        report: Content of `run.json`.
    """

    folder: Path
    report: Mapping[str, Any]

    @classmethod
    def read(cls, folder: Path) -> "RunResult":
        """Return the results in a run folder; raise InputError as `read_report` does."""
        return cls(folder, read_report(folder))

    @cached_property
    def rows(self) -> list[dict[str, Any]]:
        """Return a row for each probe of each condition, with the columns of a study."""
        rows: list[dict[str, Any]] = []
        for number, run in enumerate(self.report["runs"], 1):
            cell = self._cell(f"run-{number}", run)
            rows += PROBES.rows_of(cell, {"error": None, **run, "run": ""}, ())
        for number, failure in enumerate(self.report["failures"], 1):
            cell = self._cell(f"failure-{number}", failure)
            there = failure["outcome"] != "error"
            kind = "ModelError" if there else "UnavailableModelError"
            found = {"error": failure["error"], "kind": kind}
            rows += PROBES.rows_of({**cell, "probes": self._probes}, found, ())
        return rows

    @property
    def _probes(self) -> list[Mapping[str, Any]]:
        """Return the probes of conditions without a result: those of a condition with one."""
        known = self.report["runs"][:1]
        keys = ("label", "path", "acts_in", "agent", "task", "expected")
        probes = known[0]["probes"] if known else [{"expected": {"unknown": True}}]
        return [{key: probe[key] for key in keys if key in probe} for probe in probes]

    def _cell(self, name: str, run: Mapping[str, Any]) -> dict[str, Any]:
        key = {
            "scenario": self.report["scenario"],
            "condition": run["condition"],
            "variation": {},
            "model": run["model"],
            "template": "",
            "repeat": 1 + run["seed"] - self.report["settings"]["seed"],
        }
        variation = variation_id(key["scenario"], {})
        return {
            **{"name": name, "seed": run["seed"], "key": key},
            **{"variation": variation, "probes": []},
        }

    def typed(self) -> dict[str, Typed]:
        """Return the columns of `rows`."""
        kinds = PROBES.kinds(())
        return {name: Typed([row[name] for row in self.rows], kind) for name, kind in kinds.items()}

    def exchanges(self) -> list[Exchange]:
        """Return all requests to models with their answers, in order.

        Raises:
            InputError: The file is damaged.
        """
        file = self.folder / "model.jsonl"
        if not file.is_file():
            return []
        found = []
        for number, line in enumerate(read_regular(file).splitlines(), 1):
            try:
                found.append(decode_exchange(line))
            except msgspec.MsgspecError as error:
                raise InputError(f"{file}:{number} is damaged: {error}; {_OTHER}") from None
        return found
