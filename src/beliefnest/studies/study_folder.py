"""Folder of a study: one complete file for each finished cell, even if the study is killed."""

import json
import shutil
from collections.abc import Collection, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Literal

import msgspec

from beliefnest.errors import InputError
from beliefnest.files import make_folder, os_errors_of, read_regular, replace_file, replacing
from beliefnest.llm.budget import RunLimits
from beliefnest.llm.stored_exchange import Exchange, decode_exchange
from beliefnest.locking import is_lock
from beliefnest.plan.spending import append_line
from beliefnest.plan.terms import Terms
from beliefnest.scenarios.record_forms import checked_form, read_json, read_lines
from beliefnest.studies.forms import FailedCell, PeopleForm, PlanKind, SecondsForm, read_marked
from beliefnest.studies.kinds import RUN_KIND, kind_named
from beliefnest.studies.table import CellKind
from beliefnest.world.texts import quoted

_PLAN = "study.json"
_CELLS = "cells"
_PEOPLE = "people.json"
_FORM = "beliefnest study 3"
_PEOPLE_FORM = "beliefnest people 1"
_READ_AGAIN = "delete it and read the answers of people again"
_AGAIN = "delete it to run it again"
_PLAN_AGAIN = "delete it and run the study again, which keeps the cells that have ended"


class PersonCell(msgspec.Struct, frozen=True):
    """Cell that a participant answered.

    Attributes:
        planned: Its entry, as those of a plan.
        found: Content of its file.
    """

    planned: Mapping[str, Any]
    found: Mapping[str, Any]


_OTHER_FOLDERS = {
    "set.json": "a set of items, which has no answers; ask models with `beliefnest items FOLDER "
    "--models NAMES -o OUT`, and give OUT",
    "functional.json": "a folder of `beliefnest items --functional`; its tables are in "
    "functional.json, and its studies are the folders below it",
}
"""Files that folders of other commands have, and what to say of these folders."""


class StudyFolder(msgspec.Struct, frozen=True):
    """Folder of a study, a suite or a run.

    It holds `study.json` (the latest plan), `cells/` (the result of each finished cell),
    `people.json` (entries of cells that participants answered), `seconds.jsonl` (wall times, which
    vary between runs), `answers/` (cached answers of models), `spent.jsonl` (usage of answers) and
    `runs/` (recorded runs). That of a run has a folder for each cell in place of `runs/`, and all
    requests in `model.jsonl`.

    Attributes:
        path: The folder.
        kind: Kind of the cells.
    """

    path: Path
    kind: CellKind

    @staticmethod
    def open(path: str | Path, kind: CellKind) -> "StudyFolder":
        """Make the folder, or open it to continue its study.

        Raises:
            InputError: The folder cannot be made, or holds something else.
        """
        folder = StudyFolder(Path(path), kind)
        make_folder(folder.path)
        with os_errors_of(f"the folder {path}", "written"):
            # A study that repeats another one may begin with a folder of cached answers alone.
            strange = any(
                each != folder.answers and not is_lock(each) for each in folder.path.iterdir()
            )
            strange = strange and not (folder.path / _PLAN).is_file()
            if strange and not folder.cells.is_dir():
                raise InputError(f"{path} is not empty and holds no study; name another folder")
            folder.cells.mkdir(exist_ok=True)
        return folder

    @staticmethod
    def existing(path: str | Path) -> "StudyFolder":
        """Return the folder of an existing study.

        Raises:
            InputError: There is none, its plan cannot be read, or another version wrote it.
        """
        folder = Path(path)
        if not (folder / _CELLS).is_dir():
            if (folder / "run.json").exists():
                raise InputError(
                    f"{path} holds a run of an earlier version; run it again in a new folder"
                )
            for file, what in _OTHER_FOLDERS.items():
                if (folder / file).exists():
                    raise InputError(f"{path} is {what}")
            raise InputError(f"there is no study at {path}; give a folder of `beliefnest study`")
        return StudyFolder(folder, _kind_in(folder / _PLAN))

    @property
    def of(self) -> Literal["study", "run"]:
        """Return what it is the folder of."""
        return "run" if self.kind is RUN_KIND else "study"

    @property
    def cells(self) -> Path:
        """Folder with one file for each finished cell."""
        return self.path / _CELLS

    @property
    def answers(self) -> Path:
        """Folder of cached answers of models."""
        return self.path / "answers"

    @property
    def ledger(self) -> Path:
        """File with the usage of each answer, one line each."""
        return self.path / "spent.jsonl"

    @property
    def requests(self) -> Path:
        """File with all requests of a run to models and their answers, one line each."""
        return self.path / "model.jsonl"

    def terms(self, limits: RunLimits, *, record: bool = False) -> Terms:
        """Return the terms of a plan whose answers and usage this folder keeps.

        Args:
            limits: Limits of tokens and cost of the whole plan.
            record: Record the runs in this folder.
        """
        runs = (self.path / "runs").absolute() if record else None
        return Terms(self.answers.absolute(), self.ledger.absolute(), runs, limits)

    def run(self, cell: str) -> Path:
        """Return the path of a cell's run file."""
        return self.path / "runs" / f"{cell}.bn"

    def stores(self) -> list[Path]:
        """Return the run files of all cells."""
        return sorted((self.path / "runs").glob("*.bn"))

    def names(self) -> set[str]:
        """Return the names of the finished cells."""
        return {file.stem for file in self.cells.glob("*.json")}

    def cell(self, name: str) -> dict[str, Any] | None:
        """Return the content of a cell's file; None: the cell has not finished.

        Raises:
            InputError: The file is damaged.
        """
        file = self.cells / f"{name}.json"
        if not file.is_file():
            return None
        content = read_json(file, _AGAIN)
        form = self.kind.cell if content.get("error") is None else FailedCell
        checked_form(content, form, file, _AGAIN)
        return content

    def write_cell(self, name: str, content: Mapping[str, Any]) -> None:
        """Write the file of a cell, completely or not at all."""
        # Tables and pages of runs keep the order of play.
        text = _json(content, sort_keys=self.kind is not RUN_KIND)
        replace_file(self.cells / f"{name}.json", text)

    def note_seconds(self, name: str, seconds: float) -> None:
        """Append the wall time of a cell."""
        append_line(self._times, json.dumps({"cell": name, "seconds": round(seconds, 3)}))

    def exchanges(self) -> list[Exchange]:
        """Return the recorded answers; raise InputError if a file is damaged."""
        exchanges = []
        for place, text in self._answers():
            try:
                exchanges.append(decode_exchange(text))
            except msgspec.MsgspecError as error:
                raise InputError(f"{place} is damaged: {error}; delete it") from None
        return exchanges

    def _answers(self) -> Iterator[tuple[str, bytes]]:
        """Yield each recorded answer with its place; of a run also those from elsewhere."""
        if self.kind is RUN_KIND:
            lines = read_regular(self.requests).splitlines() if self.requests.is_file() else ()
            yield from ((f"{self.requests}:{number}", line) for number, line in enumerate(lines, 1))
            return
        for file in sorted(self.answers.glob("*.json")):
            yield str(file), read_regular(file)

    def seconds(self) -> dict[str, float]:
        """Return the known wall times of cells, in seconds."""
        return {noted.cell: noted.seconds for noted in read_lines(self._times, SecondsForm)}

    def write_plan(self, plan: Mapping[str, Any]) -> None:
        """Write the plan."""
        replace_file(self.path / _PLAN, _json({**plan, "form": _FORM, "kind": self.kind.name}))

    @property
    def has_plan(self) -> bool:
        """Return True if a plan was written."""
        return (self.path / _PLAN).is_file()

    def plan(self) -> dict[str, Any]:
        """Return the latest plan.

        Raises:
            InputError: It is missing or damaged, or one of cells of another kind.
        """
        file = self.path / _PLAN
        there = _kind_in(file)
        if there is not self.kind:
            raise InputError(
                f"{self.path} holds a study of {there.name}, and this one is of {self.kind.name}; "
                "name another folder"
            )
        return read_marked(file, _FORM, there.plan, _PLAN_AGAIN)

    def people(self) -> list[dict[str, Any]]:
        """Return the entries of all cells that participants answered.

        Raises:
            InputError: The file is damaged.
        """
        file = self.path / _PEOPLE
        if not file.is_file():
            return []
        return list(read_marked(file, _PEOPLE_FORM, PeopleForm, _READ_AGAIN)["cells"])

    def sessions(self) -> dict[str, dict[str, Any]]:
        """Return how many participants of each name began, ended and stopped; empty: not noted.

        `excluded` has the number of excluded participants by reason.

        Raises:
            InputError: The file is damaged.
        """
        self.people()
        file = self.path / _PEOPLE
        return dict(read_json(file, _READ_AGAIN)["sessions"]) if file.is_file() else {}

    def write_people(
        self, name: str, cells: Iterable[PersonCell], sessions: Mapping[str, Any]
    ) -> None:
        """Replace the cells of the people of a name; those of other names stay.

        Args:
            name: Name of the people in the column `model`.
            cells: Their cells.
            sessions: Numbers of participants who began, ended and stopped.
        """
        noted = {**self.sessions(), name: dict(sessions)}
        before = self.people()
        others = [each for each in before if each["key"]["model"] != name]
        own = {str(cell.planned["name"]): cell for cell in cells}
        for each in before:
            if each["key"]["model"] == name and each["name"] not in own:
                (self.cells / f"{each['name']}.json").unlink(missing_ok=True)
        for cell, person in own.items():
            self.write_cell(cell, person.found)
        self._write_entries([*others, *(dict(cell.planned) for cell in own.values())], noted)

    def _write_entries(
        self, entries: Iterable[Mapping[str, Any]], sessions: Mapping[str, Mapping[str, Any]]
    ) -> None:
        content = {"form": _PEOPLE_FORM, "cells": list(entries), "sessions": sessions}
        replace_file(self.path / _PEOPLE, _json(content))

    def check_subjects(self, plan: Mapping[str, Any]) -> None:
        """Refuse a folder that holds another study than the given one.

        A study may have changed since its last run. It counts as another study only if it has no
        scenario or task in common with the latest plan.

        Args:
            plan: Plan of the study to continue here.

        Raises:
            InputError: The folder holds another study, or is damaged.
        """
        there = self._subjects(self.plan()) if self.has_plan else set()
        own = self._subjects(plan)
        if there and own and there.isdisjoint(own):
            raise InputError(
                f"{self.path} holds a study of {', '.join(sorted(there))}, and this one is of "
                f"{', '.join(sorted(own))}; name another folder"
            )

    def take_over(self, others: Iterable[Path], planned: Collection[str]) -> int:
        """Copy the cells of other folders of the same study, with their runs and wall times.

        Args:
            others: Folders of shards, which other machines played.
            planned: Names of all cells of the study.

        Returns:
            Number of cells that are new here.

        Raises:
            InputError: A folder holds no study or only cells of other studies, or two folders have
                different results of one cell. Nothing is copied.
        """
        people = {each["name"]: each for each in self.people()}
        sessions = self.sessions()
        new: dict[str, dict[str, Any]] = {}
        homes: dict[str, StudyFolder] = {}
        for other in map(StudyFolder.existing, others):
            own = {*planned, *(each["name"] for each in other.people())}
            if other.names() and other.names().isdisjoint(own):
                raise InputError(
                    f"{other.path} holds no cell of this study; another study ran there, or one "
                    "with other files, seeds or settings"
                )
            people |= {each["name"]: each for each in other.people()}
            sessions |= other.sessions()
            for name in sorted(other.names()):
                theirs = other.cell(name) or {}
                ours = new.get(name) or self.cell(name)
                if ours is None or ours.get("error") is not None:
                    new[name], homes[name] = theirs, other
                elif theirs.get("error") is None and theirs != ours:
                    raise InputError(
                        f"{other.path} and {self.path} have different results of the cell {name}; "
                        "one of them ran with another version or model"
                    )
        seconds = {other.path: other.seconds() for other in homes.values()}
        for name, content in new.items():
            other = homes[name]
            run = other.path / str(content.get("run") or f"runs/{name}.bn")
            if run.is_file():
                _copy(run, self.run(name))
            if name in seconds[other.path]:
                self.note_seconds(name, seconds[other.path][name])
            self.write_cell(name, content)
        if people:
            self._write_entries(people.values(), sessions)
        return len(new)

    def _subjects(self, plan: Mapping[str, Any]) -> set[str]:
        """Return the names of the scenarios or tasks in a plan."""
        return {str(cell["key"][self.kind.subject]) for cell in plan["cells"]}

    @property
    def _times(self) -> Path:
        """File with the wall time of each cell, one line each."""
        return self.path / "seconds.jsonl"


def _kind_in(file: Path) -> CellKind:
    """Return the kind of cells of a plan; raise InputError if the plan names none of ours."""
    name = read_marked(file, _FORM, PlanKind, _PLAN_AGAIN)["kind"]
    kind = kind_named(name)
    if kind is None:
        raise InputError(f"{file} is damaged: there are no cells of {quoted(name)}; {_PLAN_AGAIN}")
    return kind


def _json(content: Mapping[str, Any], *, sort_keys: bool = True) -> str:
    # The encoder of `json` takes five times as long with `indent`; let msgspec add the lines.
    flat = json.dumps(content, sort_keys=sort_keys, ensure_ascii=False)
    return msgspec.json.format(flat, indent=1) + "\n"


def _copy(source: Path, target: Path) -> None:
    target.parent.mkdir(exist_ok=True)
    with source.open("rb") as theirs, replacing(target) as ours:
        shutil.copyfileobj(theirs, ours)
