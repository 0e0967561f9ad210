"""The folder of a run: what is in it, and how it is written so that it is always readable."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from beliefnest.errors import InputError
from beliefnest.scenarios.outcome import ProbeOutcome
from beliefnest.scenarios.scenario import Scenario

__all__ = ["PICTURE", "STORE", "ConditionFolder", "RunFolder", "recorded_scenario", "store_in"]

STORE = "run.bn"
PICTURE = "picture.png"
_REPORT = "run.json"
_RESULT = "result.json"
_SCENARIO = "scenario.yaml"
_CONDITION = "condition-"


@dataclass(frozen=True, slots=True)
class ConditionFolder:
    """The part of a run folder that belongs to one condition."""

    path: Path

    @property
    def store(self) -> Path:
        """The timelines."""
        return self.path / STORE

    @property
    def picture(self) -> Path:
        """The picture of the decisive moment."""
        return self.path / PICTURE

    def write_result(self, result: Mapping[str, object]) -> None:
        """Write what came of the condition."""
        _write(self.path / _RESULT, _json(result))

    def write_probe(self, outcome: ProbeOutcome) -> None:
        """Write what a model was asked, what it answered, and the program in it."""
        folder = self.path / outcome.branch.replace(" ", "-")
        folder.mkdir(exist_ok=True)
        _write(folder / "prompt.txt", outcome.prompt)
        _write(folder / "answer.txt", outcome.answer)
        _write(folder / "program.js", outcome.program)


@dataclass(frozen=True, slots=True)
class RunFolder:
    """A run folder."""

    path: Path

    @staticmethod
    def create(wanted: Path | None, name: str, now: datetime) -> "RunFolder":
        """Make the folder of a run.

        Args:
            wanted: The folder; None: `runs/NAME-DATE-TIME` in the current one.
            name: Name of the scenario.
            now: The time, for the name.

        Raises:
            InputError: It cannot be made, or holds something already.
        """
        path = (
            wanted if wanted is not None else _unused(Path("runs"), f"{name}-{now:%Y%m%d-%H%M%S}")
        )
        try:
            path.mkdir(parents=True, exist_ok=True)
            if any(path.iterdir()):
                raise InputError(f"{path} is not empty; name another folder with --out")
            _write(path / _REPORT, _json({"scenario": name, "status": "running", "runs": []}))
        except OSError as error:
            raise InputError(f"the run folder {path} cannot be written: {error.strerror}") from None
        return RunFolder(path)

    def condition(self, number: int | None) -> ConditionFolder:
        """Make the folder of a condition; None: of a scenario that has none."""
        path = self.path / ("run" if number is None else f"{_CONDITION}{number}")
        path.mkdir()
        return ConditionFolder(path)

    @property
    def picture(self) -> Path:
        """The picture of all conditions."""
        return self.path / PICTURE

    def write_report(self, report: Mapping[str, object]) -> None:
        """Write the whole report anew."""
        _write(self.path / _REPORT, _json(report))

    def write_scenario(self, text: str) -> None:
        """Keep the scenario as it was run."""
        _write(self.path / _SCENARIO, text)

    def write_summary(self, text: str) -> None:
        """Write the table as text."""
        _write(self.path / "summary.txt", text)


def store_in(run: Path) -> Path:
    """The store of a run: itself, in its folder, or in the only condition's folder.

    Raises:
        InputError: There is none, or there are several.
    """
    run = run.absolute()
    if run.is_file():
        return run
    if (run / STORE).is_file():
        return run / STORE
    found = sorted(run.glob(f"*/{STORE}"))
    if len(found) == 1:
        return found[0]
    if found:
        names = ", ".join(str(store.parent) for store in found)
        raise InputError(f"{run} holds several runs; name one of {names}")
    raise InputError(f"there is no run at {run}: it is no run folder and no {STORE} file")


def recorded_scenario(store: Path) -> Scenario:
    """The scenario that a store in a run folder was recorded from, under its condition.

    Raises:
        InputError: The store does not lie in a run folder.
        ScenarioError: The scenario kept there is not readable by this version.
    """
    file = store.parents[1] / _SCENARIO
    if not file.is_file():
        raise InputError(f"{store} does not lie in a run folder: there is no {file}")
    _, sign, number = store.parent.name.partition(_CONDITION)
    return Scenario.load(str(file), int(number) if sign and number.isdecimal() else None)


def _unused(parent: Path, name: str) -> Path:
    candidates = [parent / name, *(parent / f"{name}-{number}" for number in range(2, 100))]
    return next((path for path in candidates if not path.exists()), candidates[-1])


def _json(value: Mapping[str, object]) -> str:
    return json.dumps(value, indent=2) + "\n"


def _write(path: Path, text: str) -> None:
    """Replace a file as a whole, so that whoever reads it never finds half of it."""
    draft = path.with_name(path.name + ".part")
    draft.write_text(text, encoding="utf-8")
    draft.replace(path)
