"""What a nest notes beside its timelines, in memory or in the file.

That is which branches are selected, programs, requests to models, and what ran them.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import replace
from typing import Protocol

from beliefnest.bodies.protocol import ProgramResult
from beliefnest.timeline.journal import Journal, TimelineInfo, TimelineKey
from beliefnest.timeline.records import ProgramRecord, PromptRecord
from beliefnest.timeline.store import SqliteJournal

__all__ = ["FileLog", "MemoryLog", "RunLog", "note_programs"]

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

    def next_group(self) -> int:
        """A number for programs that run at the same time, which none before has had."""

    def programs(self) -> Sequence[ProgramRecord]:
        """All programs of branches that are there, in order of their end."""

    def add_prompt(self, prompt: PromptRecord) -> None:
        """Note a request to a model and what came of it."""

    def prompts(self) -> Sequence[PromptRecord]:
        """All requests to models from branches that are there, in order."""

    def add_versions(self, versions: Mapping[str, str]) -> None:
        """Note what runs from now on, if it is not what ran before."""

    def versions(self) -> Sequence[Mapping[str, str]]:
        """Program to version, when the run began and whenever it went on with others."""

    def renamed(self, path: Path, branch: str, name: str) -> None:
        """Follow a branch that got another name."""

    def forgotten(self, path: Path, branch: str) -> None:
        """Follow a branch that was deleted."""


class MemoryLog:
    """Notes that end with the process, beside the timelines of a journal that does."""

    def __init__(self, journal: Journal) -> None:
        self._journal = journal
        self._selected: dict[Path, str] = {}
        self._programs: list[ProgramRecord] = []
        self._ever = 0
        self._prompts: list[PromptRecord] = []
        self._versions: dict[str, str] = {}

    @contextmanager
    def together(self) -> Iterator[None]:
        """Take back what was noted and recorded inside if it raises."""
        selected, versions = self._selected.copy(), self._versions.copy()
        programs, prompts = self._programs.copy(), self._prompts.copy()
        ever = self._ever
        try:
            with self._journal.together():
                yield
        except BaseException:
            self._selected, self._versions = selected, versions
            self._programs, self._prompts = programs, prompts
            self._ever = ever
            raise

    def select(self, path: Path, branch: str) -> None:
        """Note which branch a simulator is on."""
        self._selected[path] = branch

    def selected(self) -> Mapping[Path, str]:
        """The branch each simulator is on, of those that were noted."""
        return self._selected

    def add_program(self, program: ProgramRecord) -> None:
        """Note a program that has ended."""
        self._programs.append(program)
        self._ever += 1

    def next_group(self) -> int:
        """A number for programs that run at the same time, which none before has had."""
        return self._ever + 1

    def programs(self) -> Sequence[ProgramRecord]:
        """All programs of branches that are there, in order of their end."""
        return tuple(self._programs)

    def add_prompt(self, prompt: PromptRecord) -> None:
        """Note a request to a model and what came of it."""
        self._prompts.append(prompt)

    def prompts(self) -> Sequence[PromptRecord]:
        """All requests to models from branches that are there, in order."""
        return tuple(self._prompts)

    def add_versions(self, versions: Mapping[str, str]) -> None:
        """Note what runs; in one process that is added to and does not change."""
        self._versions |= versions

    def versions(self) -> Sequence[Mapping[str, str]]:
        """Program to version."""
        return (self._versions,)

    def renamed(self, path: Path, branch: str, name: str) -> None:
        """Follow a branch that got another name."""
        self._programs = [
            replace(each, branch=name) if (each.path, each.branch) == (path, branch) else each
            for each in self._programs
        ]
        old, new = TimelineKey(path, branch), TimelineKey(path, name)
        self._prompts = [
            replace(each, timeline=new) if each.timeline == old else each for each in self._prompts
        ]
        if self._selected.get(path) == branch:
            self._selected[path] = name

    def forgotten(self, path: Path, branch: str) -> None:
        """Follow a branch that was deleted."""
        self._programs = [p for p in self._programs if (p.path, p.branch) != (path, branch)]
        self._prompts = [p for p in self._prompts if p.timeline != TimelineKey(path, branch)]
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

    def next_group(self) -> int:
        """A number for programs that run at the same time, which none before has had."""
        return self._journal.records.next_group()

    def programs(self) -> Sequence[ProgramRecord]:
        """All programs of branches that are there, in order of their end."""
        return self._journal.records.programs()

    def add_prompt(self, prompt: PromptRecord) -> None:
        """Note a request to a model and what came of it."""
        self._journal.records.add_prompt(prompt)

    def prompts(self) -> Sequence[PromptRecord]:
        """All requests to models from branches that are there, in order."""
        return self._journal.records.prompts()

    def add_versions(self, versions: Mapping[str, str]) -> None:
        """Note what runs from now on, if it is not what ran before."""
        self._journal.records.add_versions(versions)

    def versions(self) -> Sequence[Mapping[str, str]]:
        """Program to version, when the run began and whenever it went on with others."""
        return self._journal.records.versions()

    def renamed(self, path: Path, branch: str, name: str) -> None:
        """Nothing to do."""

    def forgotten(self, path: Path, branch: str) -> None:
        """Nothing to do."""


def note_programs(
    log: RunLog,
    before: TimelineInfo,
    programs: Mapping[str, str],
    results: Mapping[str, ProgramResult],
    detail: Mapping[str, str],
) -> None:
    """Note programs that ran together, with their results.

    Args:
        log: Where.
        before: The timeline they ran on, as it was when they began.
        programs: Their texts by agent.
        results: What became of them.
        detail: Further facts of the caller.
    """
    group = log.next_group()
    for agent, result in results.items():
        log.add_program(
            ProgramRecord(
                path=before.key.path,
                branch=before.key.branch,
                agent=agent,
                code=programs[agent],
                tick=before.head,
                ok=result.ok,
                error=None if result.error is None else str(result.error),
                ticks=result.ticks,
                group=group,
                lines=result.lines,
                log=result.log,
                unfinished=tuple(map(str, result.unfinished)),
                detail={**detail, "entries": str(before.entries)},
            )
        )
