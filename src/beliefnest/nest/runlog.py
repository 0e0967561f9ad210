"""What a nest notes beside its timelines: selections and programs, in memory or in the file."""

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from typing import Protocol

from beliefnest.timeline.records import ProgramRecord
from beliefnest.timeline.store import SqliteJournal

__all__ = ["FileLog", "MemoryLog", "RunLog"]

Path = tuple[str, ...]


class RunLog(Protocol):
    """Notes of a run that belong to the timelines of its journal."""

    def together(self) -> AbstractContextManager[None]:
        """What is noted and recorded inside is kept together; what raises, not at all."""

    def select(self, path: Path, branch: str) -> None:
        """Note which branch a simulator is on."""

    def selected(self) -> Mapping[Path, str]:
        """The branch each simulator is on, of those that were noted."""

    def add_program(self, program: ProgramRecord) -> None:
        """Note a program that has ended."""

    def programs(self) -> Sequence[ProgramRecord]:
        """All programs of branches that are there, in order of their end."""

    def renamed(self, path: Path, branch: str, name: str) -> None:
        """Follow a branch that got another name."""

    def forgotten(self, path: Path, branch: str) -> None:
        """Follow a branch that was deleted."""


class MemoryLog:
    """Notes that end with the process."""

    def __init__(self) -> None:
        self._selected: dict[Path, str] = {}
        self._programs: list[ProgramRecord] = []

    def together(self) -> AbstractContextManager[None]:
        """Nothing to do: what is in memory ends together."""
        return nullcontext()

    def select(self, path: Path, branch: str) -> None:
        """Note which branch a simulator is on."""
        self._selected[path] = branch

    def selected(self) -> Mapping[Path, str]:
        """The branch each simulator is on, of those that were noted."""
        return self._selected

    def add_program(self, program: ProgramRecord) -> None:
        """Note a program that has ended."""
        self._programs.append(program)

    def programs(self) -> Sequence[ProgramRecord]:
        """All programs of branches that are there, in order of their end."""
        return tuple(self._programs)

    def renamed(self, path: Path, branch: str, name: str) -> None:
        """Follow a branch that got another name."""
        self._programs = [
            replace(each, branch=name) if (each.path, each.branch) == (path, branch) else each
            for each in self._programs
        ]
        if self._selected.get(path) == branch:
            self._selected[path] = name

    def forgotten(self, path: Path, branch: str) -> None:
        """Follow a branch that was deleted."""
        self._programs = [p for p in self._programs if (p.path, p.branch) != (path, branch)]
        if self._selected.get(path) == branch:
            del self._selected[path]


class FileLog:
    """Notes in the run file of a journal, which follows renamed and deleted branches itself."""

    def __init__(self, journal: SqliteJournal) -> None:
        self._journal = journal

    def together(self) -> AbstractContextManager[None]:
        """One transaction of the run file."""
        return self._journal.together()

    def select(self, path: Path, branch: str) -> None:
        """Note which branch a simulator is on."""
        self._journal.records.select(path, branch)

    def selected(self) -> Mapping[Path, str]:
        """The branch each simulator is on, of those that were noted."""
        return self._journal.records.selected()

    def add_program(self, program: ProgramRecord) -> None:
        """Note a program that has ended."""
        self._journal.records.add_program(program)

    def programs(self) -> Sequence[ProgramRecord]:
        """All programs of branches that are there, in order of their end."""
        return self._journal.records.programs()

    def renamed(self, path: Path, branch: str, name: str) -> None:
        """Nothing to do."""

    def forgotten(self, path: Path, branch: str) -> None:
        """Nothing to do."""
