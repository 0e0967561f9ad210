"""The folder of a run; each file in it is replaced as a whole, so that it is always readable."""

import json
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from datetime import datetime
from itertools import chain, count
from pathlib import Path

import msgspec

from beliefnest.cli.report import report_json
from beliefnest.errors import InputError
from beliefnest.files import make_folder, os_errors_of, read_regular_text, replace_file
from beliefnest.locking import holding, is_lock
from beliefnest.nest.past.versions import own_versions
from beliefnest.plan.cells import Keyed
from beliefnest.scenarios.outcome import ProbeOutcome
from beliefnest.scenarios.record_forms import read_json
from beliefnest.scenarios.scenario import Scenario
from beliefnest.scenarios.yaml_reading import templates_file
from beliefnest.studies.kinds import RUN_KIND
from beliefnest.studies.study_folder import StudyFolder
from beliefnest.timeline.lock import writer_lock

STORE = "run.bn"
PICTURE = "picture.png"
PAGE = "report.html"
_REPORT = "run.json"
_SCENARIO = "scenario.yaml"
_ANSWERS = "answers"
_MOST_NAMED = 10
_OTHER = "name another folder"


class ConditionFolder(msgspec.Struct, frozen=True):
    """Folder of one condition in a run folder."""

    path: Path

    @property
    def store(self) -> Path:
        """Run file with the timelines."""
        return self.path / STORE

    @property
    def picture(self) -> Path:
        """PNG picture of the moment when the script has ended."""
        return self.path / PICTURE

    @property
    def picture_svg(self) -> Path:
        """SVG file of the same picture, for the report."""
        return self.path / "picture.svg"

    def begin(self) -> None:
        """Make an empty folder; delete what an interrupted run left in it.

        Raises:
            StoreError: Another process writes to the run file in it.
        """
        if self.path.exists():
            # The lock goes with the folder.
            lock = writer_lock(self.store)
            try:
                shutil.rmtree(self.path)
            finally:
                lock.release()
        self.path.mkdir(parents=True)

    def write_probe(self, number: int, outcome: ProbeOutcome) -> None:
        """Write the prompts and answers of a probe, and the program in the answer."""
        folder = self.path / f"probe-{number}"
        folder.mkdir(exist_ok=True)
        if outcome.probe.asks_for_program:
            replace_file(folder / "prompt.txt", outcome.prompt)
            replace_file(folder / "answer.txt", outcome.answer)
            replace_file(folder / "program.js", outcome.program)
        for place, reply in enumerate(outcome.replies, start=1):
            replace_file(folder / f"question-{place}.txt", reply.prompt)
            replace_file(folder / f"reply-{place}.txt", reply.text)


class RunFolder(msgspec.Struct, frozen=True):
    """Folder of a run: that of its results, with pictures, report and page."""

    path: Path

    @staticmethod
    @contextmanager
    def open(wanted: Path | None, now: datetime, name: str) -> Iterator["RunFolder"]:
        """Make the folder of a run, or open that of an interrupted run, and hold it meanwhile.

        Args:
            wanted: The folder; None: `runs/NAME-DATE-TIME` in the current folder.
            now: Time for the name.
            name: Name of the scenario.

        Raises:
            InputError: The folder cannot be made, or is in use.
        """
        path = wanted or _made(Path("runs"), f"{name}-{now:%Y%m%d-%H%M%S}")
        with holding(path):
            yield RunFolder(path)

    def begin(
        self, settings: Mapping[str, object], scenario: Scenario, cells: Sequence[Keyed]
    ) -> None:
        """Write what a new folder begins with, or check that an older one may be continued.

        Args:
            settings: Settings of the run; an interrupted run continues only with the same ones.
            scenario: Scenario of the run. Its file and the templates it names are copied into the
                folder; an interrupted run continues only if they have not changed.
            cells: Cells of the run.

        Raises:
            InputError: The folder cannot be written, or holds something else.
        """
        with os_errors_of(f"the run folder {self.path}", "written"):
            # A run that repeats another one may begin with a folder of cached answers alone.
            if any(each.name != _ANSWERS and not is_lock(each) for each in self.path.iterdir()):
                _check_same(self.path, settings, scenario)
                return
            self.results.cells.mkdir()
            self.write_plan(settings, scenario.name, cells, "running", own_versions())
            report = report_json(scenario.name, settings, "running", [], [])
            self.write_report({**report, "versions": own_versions()})
            replace_file(self.path / _SCENARIO, scenario.text)
            if scenario.templates:
                replace_file(templates_file(self.path / _SCENARIO), _json(scenario.templates))

    def write_plan(
        self,
        settings: Mapping[str, object],
        scenario: str,
        cells: Sequence[Keyed],
        status: str,
        versions: Mapping[str, str],
    ) -> None:
        """Write the plan of the run, with its status and the versions of programs."""
        plan = {
            **settings,
            "status": status,
            "repeats": settings["repeat"],
            "scenarios": [scenario],
            "variations": {},
            "versions": dict(versions),
            "cells": [cell.plain() for cell in cells],
            "invalid": [],
        }
        self.results.write_plan(plan)

    @property
    def results(self) -> StudyFolder:
        """Plan and results of the cells, as those of a study."""
        return StudyFolder(self.path, RUN_KIND)

    @property
    def picture(self) -> Path:
        """PNG picture of all conditions."""
        return self.path / PICTURE

    def write_report(self, report: Mapping[str, object]) -> None:
        """Replace the report."""
        replace_file(self.path / _REPORT, _json(report))

    def write_page(self, text: str) -> None:
        """Write the HTML page of the run."""
        replace_file(self.path / PAGE, text)

    def write_summary(self, text: str) -> None:
        """Write the table as text."""
        replace_file(self.path / "summary.txt", text)


def store_in(run: Path) -> Path:
    """Return the run file of a run.

    Args:
        run: The run file itself, its folder, or a run folder with only one condition.

    Raises:
        InputError: There is no run file, or there are several.
    """
    run = run.absolute()
    if run.is_file():
        return run
    if (run / STORE).is_file():
        return run / STORE
    stores = _below(run)
    if len(stores) == 1:
        return stores[0]
    if stores:
        each = [str(store.parent if store.name == STORE else store) for store in stores]
        more = f" and {len(each) - _MOST_NAMED} more" if len(each) > _MOST_NAMED else ""
        names = ", ".join(each[:_MOST_NAMED])
        raise InputError(f"{run} holds several runs; name one of {names}{more}")
    raise _no_store(run)


def stores_in(run: Path) -> tuple[Path, ...]:
    """Return all run files of a run or of a study.

    Args:
        run: A run file, or a folder with run files in it.

    Raises:
        InputError: There is no run file.
    """
    stores = (run,) if run.is_file() else _below(run)
    if not stores:
        raise _no_store(run)
    return stores


def _below(folder: Path) -> tuple[Path, ...]:
    """Return the run files in a folder, including those of a study's cells."""
    return tuple(sorted({*folder.rglob(STORE), *folder.glob("runs/*.bn")}))


def _no_store(run: Path) -> InputError:
    if (run / "cells").is_dir() and not (run / _REPORT).is_file():
        return InputError(
            f"{run} holds a study whose runs were not recorded; run it again with --record in a "
            f"new folder, to which you copy {run / _ANSWERS} so that no model is asked again"
        )
    return InputError(f"there is no run at {run}; give a run folder or a {STORE} file")


def kept_scenario_file(out: Path | None, wanted: str) -> Path | None:
    """Return the scenario file that a run folder keeps, to continue without the original file.

    Args:
        out: The run folder; None: there is none.
        wanted: The scenario named on the command line.

    Returns:
        The kept file; None if the folder keeps none, or another scenario.
    """
    if out is None or not (out / _SCENARIO).is_file() or not wanted.endswith((".yaml", ".yml")):
        return None
    try:
        written = read_regular_text(Path(wanted))
    except FileNotFoundError:
        return out / _SCENARIO
    except (OSError, UnicodeDecodeError):
        return None
    return out / _SCENARIO if written == (out / _SCENARIO).read_text(encoding="utf-8") else None


def _made(parent: Path, name: str) -> Path:
    """Make and return a new folder; another run may have begun in the same second."""
    make_folder(parent)
    with os_errors_of(f"the run folder {parent}", "written"):
        for each in chain([name], (f"{name}-{number}" for number in count(2))):
            with suppress(FileExistsError):
                (parent / each).mkdir()
                break
    return parent / each


def _check_same(path: Path, settings: Mapping[str, object], scenario: Scenario) -> None:
    """Raise InputError if a folder holds another run, or a run that has ended."""
    if not any((path / name).exists() for name in ("cells", _REPORT)):
        raise InputError(f"{path} is not empty; name another folder with --out")
    results = StudyFolder.existing(path)
    if results.kind is not RUN_KIND:
        raise InputError(f"{path} holds a study; name another folder with --out")
    plan = results.plan()
    if plan["status"] == "done":
        raise InputError(f"{path} holds a run that has ended; name another folder with --out")
    kept, templates = path / _SCENARIO, templates_file(path / _SCENARIO)
    # Compare settings as JSON has them, in which a tuple is a list.
    asked = json.loads(json.dumps(settings))
    recorded = plan["cells"][0]["key"]["setting"]
    differing = [key for key in {**recorded, **asked} if recorded.get(key) != asked.get(key)]
    if not kept.is_file() or kept.read_text(encoding="utf-8") != scenario.text:
        differing.append("scenario")
    if (read_json(templates, _OTHER) if templates.is_file() else {}) != scenario.templates:
        differing.append("template")
    if differing:
        raise InputError(
            f"{path} holds a run with another {' and '.join(differing)}; "
            "go on with the same, or name another folder with --out"
        )


def _json(value: Mapping[str, object]) -> str:
    return json.dumps(value, indent=2) + "\n"
