"""The folder of a study: one whole file for each cell that has ended, whatever ends the study."""

import json
import os
import shutil
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
from filelock import FileLock

from beliefnest.errors import InputError
from beliefnest.scenarios.record_forms import checked_form, read_json, read_lines
from beliefnest.studies.forms import SecondsForm, cell_form, plan_form

__all__ = ["StudyFolder", "append_line"]

_PLAN = "study.json"
_FORM = "beliefnest study 1"
_AGAIN = "delete it to run it again"
_PLAN_AGAIN = "delete it and run the study again, which keeps the cells that have ended"


@dataclass(frozen=True, slots=True)
class StudyFolder:
    """The folder of a study.

    What is in it: `study.json`, what was planned last; `cells/`, what came of each cell that has
    ended; `seconds.jsonl`, how long each took, which is not the same twice; `answers/`, kept
    answers of models; `spent.jsonl`, what answers took; `runs/`, recorded runs.
    """

    path: Path

    @staticmethod
    def open(path: str | Path) -> "StudyFolder":
        """Make the folder, or go on in it.

        Raises:
            InputError: It cannot be made, or holds something else.
        """
        folder = StudyFolder(Path(path))
        try:
            folder.path.mkdir(parents=True, exist_ok=True)
            # Kept answers alone are where a study begins that is to repeat another one.
            strange = any(each != folder.answers for each in folder.path.iterdir())
            strange = strange and not (folder.path / _PLAN).is_file()
            if strange and not (folder.path / "cells").is_dir():
                raise InputError(f"{path} is not empty and holds no study; name another folder")
            folder.cells.mkdir(exist_ok=True)
        except OSError as error:
            raise InputError(f"the folder {path} cannot be written: {error.strerror}") from None
        return folder

    @staticmethod
    def existing(path: str | Path) -> "StudyFolder":
        """Return the folder of a study that is there; InputError if there is none."""
        folder = StudyFolder(Path(path))
        if not folder.cells.is_dir():
            raise InputError(f"there is no study at {path}")
        return folder

    def lock(self) -> FileLock:
        """Held by the one process that runs the study."""
        return FileLock(self.path / "study.lock", timeout=0)

    @property
    def cells(self) -> Path:
        """One file for each cell that has ended."""
        return self.path / "cells"

    @property
    def answers(self) -> Path:
        """Kept answers of models."""
        return self.path / "answers"

    @property
    def ledger(self) -> Path:
        """What answers took, one line each."""
        return self.path / "spent.jsonl"

    def run(self, cell: str) -> Path:
        """Return the recorded run of a cell."""
        return self.path / "runs" / f"{cell}.bn"

    def stores(self) -> list[Path]:
        """Return the recorded runs of all cells."""
        return sorted((self.path / "runs").glob("*.bn"))

    def names(self) -> set[str]:
        """Return names of the cells that have ended."""
        return {file.stem for file in self.cells.glob("*.json")}

    def cell(self, name: str) -> dict[str, Any] | None:
        """What came of a cell; None: it has not ended.

        Raises:
            InputError: Its file is damaged.
        """
        file = self.cells / f"{name}.json"
        if not file.is_file():
            return None
        content = read_json(file, _AGAIN)
        checked_form(content, cell_form(content), file, _AGAIN)
        return content

    def write_cell(self, name: str, content: Mapping[str, Any]) -> None:
        """Keep what came of a cell, whole or not at all."""
        _write(self.cells / f"{name}.json", _json(content))

    def note_seconds(self, name: str, seconds: float) -> None:
        """Note how long a cell took."""
        append_line(self._times, json.dumps({"cell": name, "seconds": round(seconds, 3)}))

    def seconds(self) -> dict[str, float]:
        """How long cells took, as far as it is known."""
        return {noted.cell: noted.seconds for noted in read_lines(self._times, SecondsForm)}

    def write_plan(self, plan: Mapping[str, Any]) -> None:
        """Keep what was planned last."""
        _write(self.path / _PLAN, _json({"form": _FORM, **plan}))

    def plan(self) -> dict[str, Any]:
        """What was planned last; InputError if there is nothing, or it is damaged."""
        file = self.path / _PLAN
        found = read_json(file, _PLAN_AGAIN)
        if found.get("form") != _FORM:
            raise InputError(f"{file} is not that of a study of this version; {_PLAN_AGAIN}")
        checked_form(found, plan_form(found), file, _PLAN_AGAIN)
        return found

    def check_subjects(self, plan: Mapping[str, Any]) -> None:
        """Refuse a folder that holds another study than the one that is to go on in it.

        Scenarios, tasks and all else may have been added and taken away since; another study is
        one that has no scenario or task in common with what was planned last.

        Args:
            plan: Of the study.

        Raises:
            InputError: It is that of another study, or damaged.
        """
        there = _subjects(self.plan()) if (self.path / _PLAN).is_file() else set()
        own = _subjects(plan)
        if there and own and there.isdisjoint(own):
            raise InputError(
                f"{self.path} holds a study of {', '.join(sorted(there))}, and this one is of "
                f"{', '.join(sorted(own))}; name another folder"
            )

    def take_over(self, others: Iterable[Path], planned: Collection[str]) -> int:
        """Take the cells of other folders of the same study, which other machines ran.

        With them come their recorded runs, and how long they took.

        Args:
            others: The folders.
            planned: Names of all cells of the study.

        Returns:
            How many were new here.

        Raises:
            InputError: A folder is none of a study, holds cells and none of this study, or two have
                different results of one cell; nothing was taken.
        """
        new: dict[str, dict[str, Any]] = {}
        homes: dict[str, StudyFolder] = {}
        for other in map(StudyFolder.existing, others):
            if other.names() and other.names().isdisjoint(planned):
                raise InputError(
                    f"{other.path} holds no cell of this study; another study ran there, or one "
                    "with other files, seeds or settings"
                )
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
        return len(new)

    @property
    def _times(self) -> Path:
        """How long each cell took, one line each."""
        return self.path / "seconds.jsonl"


def _subjects(plan: Mapping[str, Any]) -> set[str]:
    """Return names of scenarios and tasks that are played."""
    keys = (cell["key"] for cell in plan["cells"])
    return {str(key.get("scenario") or key["task"]) for key in keys}


def _json(content: Mapping[str, Any]) -> str:
    # The library's own encoder takes five times as long where it sets lines.
    flat = json.dumps(content, sort_keys=True, ensure_ascii=False)
    return msgspec.json.format(flat, indent=1) + "\n"


def append_line(file: Path, line: str) -> None:
    """Write a line at the end of a file, after whatever was cut off there."""
    with file.open("ab+") as opened:
        size = opened.seek(0, os.SEEK_END)
        opened.seek(max(0, size - 1))
        begin = b"\n" if opened.read(1) not in (b"", b"\n") else b""
        opened.write(begin + line.encode() + b"\n")


def _copy(source: Path, target: Path) -> None:
    target.parent.mkdir(exist_ok=True)
    draft = target.with_name(f"{target.name}.{os.getpid()}.part")
    shutil.copyfile(source, draft)
    draft.replace(target)


def _write(path: Path, text: str) -> None:
    """Replace a file as a whole, so that whoever reads it never finds half of it."""
    draft = path.with_name(f"{path.name}.{os.getpid()}.part")
    draft.write_text(text, encoding="utf-8")
    draft.replace(path)
