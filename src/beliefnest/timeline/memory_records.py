"""What a run in memory notes beside its timelines."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace

from beliefnest.timeline.journal import TimelineKey
from beliefnest.timeline.records import ProgramRecord, PromptRecord

__all__ = ["MemoryRecords"]

Path = tuple[str, ...]


class MemoryRecords:
    """Notes of a run that end with the process."""

    def __init__(self) -> None:
        self._selected: dict[Path, str] = {}
        self._programs: list[ProgramRecord] = []
        self._ever = 0
        self._prompts: list[PromptRecord] = []
        self._versions: dict[str, str] = {}
        self._states: dict[str, bytes] = {}

    @contextmanager
    def together(self) -> Iterator[None]:
        """Take back what was noted inside if it raises."""
        selected, versions = self._selected.copy(), self._versions.copy()
        states = self._states.copy()
        programs, prompts = self._programs.copy(), self._prompts.copy()
        ever = self._ever
        try:
            yield
        except BaseException:
            self._selected, self._versions = selected, versions
            self._programs, self._prompts = programs, prompts
            self._ever, self._states = ever, states
            raise

    def put_state(self, name: str, value: bytes) -> None:
        """Keep bytes under a name, in place of what was there."""
        self._states[name] = value

    def state(self, name: str) -> bytes | None:
        """The bytes last put under a name; None if there are none."""
        return self._states.get(name)

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

    def follow_rename(self, path: Path, branch: str, name: str) -> None:
        """Let all that names a branch name it anew."""
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

    def forget_branch(self, path: Path, branch: str) -> None:
        """Remove what belongs to a deleted branch."""
        self._programs = [p for p in self._programs if (p.path, p.branch) != (path, branch)]
        self._prompts = [p for p in self._prompts if p.timeline != TimelineKey(path, branch)]
        if self._selected.get(path) == branch:
            del self._selected[path]
